//! Keeping a parameter set.

use axum::Json;
use axum::extract::State;
use axum::http::StatusCode;
use axum::http::header::LOCATION;
use axum::response::{IntoResponse, Response};

use crate::http::App;
use crate::http::body::parameter_set::{NewParameterSet, ParameterSetItem, from_json, from_toml};
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::body::RawBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{BodyProblems, ConflictProblem};
use crate::jobs::sets;
use crate::models::parameters::{ParameterSet, TEXT_BYTES_MAX};

#[derive(Clone, Copy)]
enum Form {
    Json,
    Toml,
}

/// Keeps a parameter set, checked whole: everything that is wrong with it is told at once.
///
/// A kept set never changes. The same name with other values is a new version of it, and what the name means from then on;
/// actuators stay pinned to the version that they were registered with. The same name and values again change nothing.
/// The body is JSON, or a parameter file as the command line takes it.
#[utoipa::path(
    post,
    path = "/v1/parameter-sets",
    tag = "parameter sets",
    request_body(
        description = "The set, of at most 1000000 bytes",
        content(
            (NewParameterSet = "application/json"),
            (String = "application/toml", example = "name = \"aileron-servo\"\n\n[controller]\nproportional_gain_a_per_m = 0.6\n")
        )
    ),
    responses(
        (status = 201, description = "The set, kept now", body = ParameterSetItem,
         headers(("location" = String, description = "Its path"))),
        (status = 200, description = "The set, which was kept already with this name and these values",
         body = ParameterSetItem, headers(("location" = String, description = "Its path"))),
        BodyProblems,
        ConflictProblem
    )
)]
pub(super) async fn create_parameter_set(
    State(app): State<App>,
    _: Query<NoQuery>,
    body: RawBody,
) -> ApiResult<Response> {
    let form = body.kind(&[("application/json", Form::Json), ("application/toml", Form::Toml)])?;
    if body.bytes().len() > TEXT_BYTES_MAX {
        return Err(ApiError::TooLarge { limit_bytes: TEXT_BYTES_MAX });
    }
    let set = match form {
        Form::Json => from_json(body.bytes())?,
        Form::Toml => from_toml(body.bytes())?,
    };
    if set.name() == ParameterSet::reference_name() {
        return Err(ApiError::Reserved { field: "name", value: set.name().into() });
    }
    let (kept, new) = app.records.insert_parameter_set(&sets::record(&set)).await?;
    let status = if new { StatusCode::CREATED } else { StatusCode::OK };
    let location = format!("/v1/parameter-sets/{}?hash={}", kept.name, kept.hash);
    Ok((status, [(LOCATION, location)], Json(ParameterSetItem::from(&kept))).into_response())
}
