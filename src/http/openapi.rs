//! The specification, generated from the handlers.

use std::collections::BTreeMap;

use utoipa::openapi::{ArrayBuilder, ContentBuilder, Ref, RefOr, Response, ResponseBuilder, Schema};
use utoipa::{IntoResponses, OpenApi};

use super::problem::{FieldError, MEDIA_TYPE, ProblemDocument};
use super::router;

/// What the specification says beside the handlers.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "elevon",
        description = "Prognostic health monitoring of electro-hydraulic flight-control actuators.\n\n\
            Times are RFC 3339 in UTC; ids are opaque strings that sort by creation. Lists are read page by page with \
            `cursor` and `limit`. Every error is a problem document (RFC 9457) with `errors`, one entry for each field \
            at fault, and the `request_id` that the service's log has too.\n\n\
            What cannot be read is 400: broken syntax, an unknown query name or JSON field, a value of the wrong type. \
            What can be read and is out of its range is 422, every field at once. Whatever is wrong inside an uploaded \
            trace is 422, its syntax included. A request to a known path with another method is 405, with `Allow`; one \
            that is not answered in time is 504. One whose `Host` is not a loopback name is 421. A client may give its \
            own `x-request-id`, 1 to 128 visible ASCII characters; without one the service makes it."
    ),
    components(schemas(ProblemDocument, FieldError)),
    tags(
        (name = "actuators", description = "The fleet's actuators, their maintenance, health and forecasts"),
        (name = "parameter sets", description = "Actuator types: the parameters of the models, built in or a user's own"),
        (name = "traces", description = "What was recorded on an actuator, or simulated"),
        (name = "jobs", description = "Estimations and simulations: queued, running, over"),
        (name = "alerts", description = "What was noticed of an actuator, and what became of it"),
        (name = "webhooks", description = "Where alerts are sent to"),
        (name = "service", description = "The service itself")
    )
)]
struct Base;

/// The specification without any path.
#[must_use]
pub fn base() -> utoipa::openapi::OpenApi {
    Base::openapi()
}

/// Lets every list name the schema of its items, which the generator repeats in full.
pub(super) fn refer_to_items(document: &mut utoipa::openapi::OpenApi) {
    let Some(components) = &mut document.components else { return };
    for (name, list) in &mut components.schemas {
        let (Some(item), RefOr::T(Schema::Object(list))) = (name.strip_prefix("List_"), list) else { continue };
        let items = ArrayBuilder::new()
            .items(Ref::from_schema_name(item))
            .description(Some("The records, in the list's order."));
        list.properties.insert("items".into(), items.into());
    }
}

/// The specification as YAML.
///
/// # Errors
/// A document that YAML cannot hold: a programmer's error.
pub fn yaml() -> anyhow::Result<String> {
    Ok(router::specification().to_yaml()?)
}

/// The specification as JSON.
///
/// # Errors
/// A document that JSON cannot hold: a programmer's error.
pub fn json() -> anyhow::Result<String> {
    Ok(router::specification().to_pretty_json()?)
}

/// A set of problem responses, named by what kind of operation answers them.
macro_rules! problems {
    ($($(#[$doc:meta])* $name:ident: $($status:literal)+;)+) => {$(
        $(#[$doc])*
        pub struct $name;

        impl IntoResponses for $name {
            fn responses() -> BTreeMap<String, RefOr<Response>> {
                BTreeMap::from([$(problem($status)),+])
            }
        }
    )+};
}

problems! {
    /// Of an operation without query and body.
    PlainProblems: 500 504;
    /// Of an operation on one record.
    RecordProblems: 400 404 500 503 504;
    /// Of a list.
    ListProblems: 400 422 500 503 504;
    /// Of a list that belongs to a record.
    RecordListProblems: 400 404 422 500 503 504;
    /// Of an operation with a body.
    BodyProblems: 400 408 413 415 422 500 503 504;
    /// Of an operation with a body that belongs to a record.
    RecordBodyProblems: 400 404 408 413 415 422 500 503 504;
    /// Beside others: a value that is taken, or a state that forbids it.
    ConflictProblem: 409;
    /// Beside others: no form of the answer is acceptable.
    NotAcceptableProblem: 406;
}

/// One problem response, by its status.
fn problem(status: u16) -> (String, RefOr<Response>) {
    let description = match status {
        400 => "The request cannot be read: broken syntax, an unknown name, a wrong type, an empty body",
        404 => "No such record",
        406 => "`Accept` allows none of the forms that can be had",
        408 => "The body did not arrive in time",
        409 => "The value is taken, or the record's state forbids it",
        413 => "The body is longer than the limit, which `detail` tells",
        415 => "The media type is absent or not one of the accepted, or the body is encoded",
        422 => "Values are out of their range, or the file is no usable trace",
        503 => "As many jobs wait as may wait, or the store is full or busy: try again after the time in `Retry-After`",
        504 => "The request was not answered in time",
        _ => "The service failed",
    };
    let schema = Ref::from_schema_name("Problem");
    let content = ContentBuilder::new().schema(Some(schema)).build();
    let response = ResponseBuilder::new().description(description).content(MEDIA_TYPE, content).build();
    (status.to_string(), response.into())
}
