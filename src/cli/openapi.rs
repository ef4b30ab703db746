//! `elevon openapi`: the specification of the HTTP interface.

use std::io::Write as _;

use super::Failure;
use crate::http::openapi;

/// Prints the specification.
pub(super) fn run() -> Result<(), Failure> {
    let text = openapi::yaml().map_err(Failure::work)?;
    std::io::stdout().write_all(text.as_bytes()).map_err(Failure::work)
}
