//! Making a webhook.

use axum::extract::State;

use crate::http::App;
use crate::http::body::accepted::Created;
use crate::http::body::webhook::{NewWebhook, NewWebhookAnswer};
use crate::http::error::ApiResult;
use crate::http::extract::json::ObjectBody;
use crate::http::extract::query::{NoQuery, Query};
use crate::http::openapi::{BodyProblems, ConflictProblem};
use crate::store::records;

/// Makes a webhook: from now on, what happens to alerts is posted to it.
///
/// A delivery is a POST of JSON, signed after the Standard Webhooks specification with the headers `webhook-id`,
/// `webhook-timestamp` and `webhook-signature`; docs/alerts.md has its form, how to verify it, and what is promised. At most 32
/// webhooks can be made.
#[utoipa::path(
    post,
    path = "/v1/webhooks",
    tag = "webhooks",
    request_body = NewWebhook,
    responses(
        (status = 201, description = "The webhook", body = NewWebhookAnswer,
         headers(("location" = String, description = "The path of the webhook"))),
        BodyProblems,
        ConflictProblem
    )
)]
pub(super) async fn create_webhook(
    State(app): State<App>,
    _: Query<NoQuery>,
    ObjectBody(body): ObjectBody<NewWebhook>,
) -> ApiResult<Created<NewWebhookAnswer>> {
    let (webhook, kept, secret) = body.check(records::now())?;
    app.records.insert_webhook(&webhook, &kept).await?;
    let location = format!("/v1/webhooks/{}", webhook.id);
    Ok(Created { location, record: NewWebhookAnswer { webhook, secret } })
}
