//! One parameter set.

use axum::Json;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};

use crate::http::App;
use crate::http::body::parameter_set::{ParameterSetDocument, VersionQuery};
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::accept::negotiate;
use crate::http::extract::id::PathId;
use crate::http::extract::query::Query;
use crate::http::openapi::{NotAcceptableProblem, RecordListProblems};
use crate::jobs::sets::{self, SetError};

const JSON: &str = "application/json";
const TOML: &str = "application/toml";

/// A parameter set with its values and their ranges, or as the file that the command line takes, as `Accept` prefers.
///
/// A set that an older version of elevon kept and this one cannot use is shown with its `errors`, in JSON only.
#[utoipa::path(
    get,
    path = "/v1/parameter-sets/{name}",
    tag = "parameter sets",
    params(
        ("name" = String, Path, description = "The set's name, or NAME@HASH as an actuator's `parameter_set` takes it"),
        VersionQuery,
        ("accept" = Option<String>, Header, description = "`application/json` (unless told) or `application/toml`")
    ),
    responses(
        (status = 200, description = "The set", content(
            (ParameterSetDocument = "application/json"), (String = "application/toml")
        )),
        RecordListProblems,
        NotAcceptableProblem
    )
)]
pub(super) async fn get_parameter_set(
    State(app): State<App>,
    name: PathId,
    Query(version): Query<VersionQuery>,
    headers: HeaderMap,
) -> ApiResult<Response> {
    let text = version.hash.iter().fold(name.text().to_owned(), |name, hash| format!("{name}@{hash}"));
    let record = sets::find(app.records.as_ref(), &text).await;
    let record = record.map_err(|error| match error {
        SetError::Store(error) => error.into(),
        SetError::Ambiguous { .. } => ApiError::invalid("?hash", error.to_string()),
        _ => ApiError::NotNamed { what: "parameter set", name: text },
    })?;
    let usable = sets::usable(&record).ok();
    let forms = if usable.is_some() { &[(JSON, false), (TOML, true)][..] } else { &[(JSON, false)] };
    let wants_toml = negotiate(&headers, forms)?;
    Ok(match usable.filter(|_| wants_toml) {
        Some(set) => ([(CONTENT_TYPE, TOML), (VARY, "accept")], set.to_toml()).into_response(),
        None => ([(VARY, "accept")], Json(ParameterSetDocument::from(record))).into_response(),
    })
}
