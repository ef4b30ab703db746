//! Uploading a trace.

use axum::extract::State;
use axum::http::Uri;
use tokio::task::spawn_blocking;

use super::FORMATS;
use crate::http::App;
use crate::http::body::accepted::UploadAccepted;
use crate::http::body::upload::UploadQuery;
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::body::RawBody;
use crate::http::extract::id::PathId;
use crate::http::extract::query;
use crate::http::openapi::RecordBodyProblems;
use crate::http::routes::actuator;
use crate::jobs::kind::JobSpec;

/// Uploads a trace of an actuator and queues its estimation.
///
/// The file is read to its end before anything is kept. Everything that is wrong with it, its syntax included, is told
/// with status 422 and its place: `line 12, column load_pressure_pa` in CSV, a JSON pointer in JSON. What was answered
/// with 202 survives a crash and a loss of power.
#[utoipa::path(
    post,
    path = "/v1/actuators/{id}/traces",
    tag = "traces",
    params(("id" = String, Path, description = "The actuator's id"), UploadQuery),
    request_body(
        description = "The file: `time_s` (or `sample_rate_hz` in the query), `position_command_m`, at least one of \
            `servovalve_current_a` and `load_pressure_pa`, and more, in any order and in any of the accepted units",
        content(
            (String = "text/csv", example = "time_ms,position_command_mm,servovalve_current_ma\n0,0,0\n0.1,0,0.1\n"),
            (serde_json::Value = "application/json", example = json!({"columns": {"time_s": [0.0, 0.0001],
                "position_command_m": [0.0, 0.0], "servovalve_current_a": [0.0, 0.0001]}, "metadata": {}}))
        )
    ),
    responses(
        (status = 202, description = "The trace, and the job that estimates from it", body = UploadAccepted,
         headers(("location" = String, description = "The job's path"))),
        RecordBodyProblems
    )
)]
pub(super) async fn upload_trace(
    State(app): State<App>,
    id: PathId,
    uri: Uri,
    body: RawBody,
) -> ApiResult<UploadAccepted> {
    let actuator = actuator(&app, &id).await?;
    let query: UploadQuery = query::read(&uri)?;
    let format = body.kind(&FORMATS)?;
    let settings = query.settings();
    let read = move || query.record(actuator.id, format, body.bytes()).map(|trace| (trace, body));
    let (trace, body) = spawn_blocking(read).await.map_err(ApiError::internal)??;
    let spec = JobSpec::Estimation { trace_id: trace.id, settings };
    let (bytes, permit) = body.into_bytes();
    let kept = trace.clone();
    // A task of its own holds the permit as long as the bytes, even when the client goes away.
    let uploading = tokio::spawn(async move {
        let uploaded = app.jobs.upload(kept, bytes, spec).await;
        drop(permit);
        uploaded
    });
    let job = uploading.await.map_err(ApiError::internal)??;
    Ok(UploadAccepted { trace, job })
}
