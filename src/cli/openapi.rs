//! `elevon openapi`: the specification of the HTTP interface.

use super::{Failure, print};
use crate::http::openapi;

/// Prints the specification.
pub(super) fn run() -> Result<(), Failure> {
    print(&openapi::yaml().map_err(Failure::work)?)
}
