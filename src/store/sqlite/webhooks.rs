//! Webhooks and their outbox in SQLite.

use jiff::Timestamp;
use sqlx::sqlite::{SqlitePool, SqliteRow};
use sqlx::{Row as _, SqliteConnection};

use super::begin;
use super::row::{Reader, micros};
use crate::store::alerts::{Alert, AlertKind};
use crate::store::records::Id;
use crate::store::webhooks::{
    Attempt, Delivery, DueDelivery, Event, Followed, Notification, Secret, WEBHOOKS_MAX, Webhook, WebhookChange,
};
use crate::store::{Page, Paged, StoreError};

/// A query for deliveries: which, in which order.
macro_rules! select {
    ($rest:literal) => {
        concat!(
            "SELECT id, event, alert_id, state, attempts, next_attempt_at, last_status, last_error, created_at, delivered_at
            FROM deliveries ",
            $rest
        )
    };
}

const INSERT: &str =
    "INSERT INTO webhooks (id, url, secret, kinds, enabled, created_at) VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
const ONE: &str = "SELECT id, url, kinds, enabled, disabled_because, created_at FROM webhooks WHERE id = ?1";
pub(super) const LIST: &str = "SELECT id, url, kinds, enabled, disabled_because, created_at FROM webhooks WHERE id > ?1
    ORDER BY id LIMIT ?2";
const CHANGE: &str =
    "UPDATE webhooks SET url = coalesce(?2, url), secret = coalesce(?3, secret), kinds = coalesce(?4, kinds),
    enabled = coalesce(?5, enabled), disabled_because = CASE WHEN ?5 IS NULL THEN disabled_because ELSE NULL END
    WHERE id = ?1";
const TOLD: &str = "SELECT id, kinds FROM webhooks WHERE enabled = 1 ORDER BY id";
const QUEUE: &str = "INSERT INTO deliveries (id, webhook_id, alert_id, event, body, created_at, next_attempt_at)
    VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?6)";
const DELIVERY: &str = select!("WHERE id = ?1");
pub(super) const DELIVERIES: &str = select!("WHERE webhook_id = ?1 AND id < ?2 ORDER BY id DESC LIMIT ?3");
pub(super) const WAITING_PING: &str =
    "SELECT id FROM deliveries WHERE webhook_id = ?1 AND state = 'pending' AND event = 'ping' LIMIT 1";
/// The delivery of each enabled webhook that has been due for longest: one at a time for each, so that a slow receiver holds
/// up nobody else's.
pub(super) const DUE: &str = "SELECT d.id, w.id, w.url, w.secret, d.body, d.attempts, d.created_at
    FROM webhooks w CROSS JOIN deliveries d ON d.id = (
        SELECT n.id FROM deliveries n WHERE n.webhook_id = w.id AND n.state = 'pending' AND n.next_attempt_at <= ?1
        ORDER BY n.next_attempt_at, n.id LIMIT 1)
    WHERE w.id > '' AND w.enabled = 1";
const RECORD: &str =
    "UPDATE deliveries SET state = ?2, attempts = attempts + 1, next_attempt_at = ?3, last_status = ?4,
    last_error = ?5, delivered_at = ?6 WHERE id = ?1 AND state = 'pending'";
const DISABLE: &str = "UPDATE webhooks SET enabled = 0, disabled_because = ?3
    WHERE id = (SELECT webhook_id FROM deliveries WHERE id = ?1) AND url = ?2";
pub(super) const ABANDON: &str = "UPDATE deliveries SET state = 'failed', next_attempt_at = NULL, last_error = ?2
    WHERE state = 'pending' AND webhook_id = (SELECT webhook_id FROM deliveries WHERE id = ?1)";
pub(super) const FORGET: &str = "DELETE FROM deliveries WHERE state <> 'pending' AND created_at < ?1";

/// Later than every id: ids are made of hexadecimal digits.
const AFTER_ALL: &str = "~";
/// Why a webhook is disabled by the service.
const GONE: &str = "the receiver answered 410 Gone";

pub(super) async fn insert(writer: &SqlitePool, webhook: &Webhook, secret: &Secret) -> Result<(), StoreError> {
    let mut transaction = begin(writer).await?;
    let count: i64 = sqlx::query("SELECT count(*) FROM webhooks").fetch_one(&mut *transaction).await?.try_get(0)?;
    if count >= i64::from(WEBHOOKS_MAX) {
        return Err(StoreError::TooMany { what: "webhooks", limit: WEBHOOKS_MAX });
    }
    sqlx::query(INSERT)
        .bind(webhook.id.to_string())
        .bind(&webhook.url)
        .bind(secret.reveal())
        .bind(names(&webhook.kinds))
        .bind(webhook.enabled)
        .bind(micros(webhook.created_at))
        .execute(&mut *transaction)
        .await?;
    Ok(transaction.commit().await?)
}

pub(super) async fn one(executor: impl sqlx::SqliteExecutor<'_>, id: Id) -> Result<Option<Webhook>, StoreError> {
    let row = sqlx::query(ONE).bind(id.to_string()).fetch_optional(executor).await?;
    row.as_ref().map(read).transpose()
}

pub(super) async fn list(readers: &SqlitePool, page: &Page) -> Result<Paged<Webhook>, StoreError> {
    let after = page.start::<Id>(&["webhooks"])?.map(|id| id.to_string()).unwrap_or_default();
    let rows = sqlx::query(LIST).bind(after).bind(page.rows()).fetch_all(readers).await?;
    let items = rows.iter().map(read).collect::<Result<_, _>>()?;
    Ok(page.cut(&["webhooks"], items, |webhook: &Webhook| webhook.id))
}

pub(super) async fn change(writer: &SqlitePool, id: Id, change: &WebhookChange) -> Result<Option<Webhook>, StoreError> {
    let mut transaction = begin(writer).await?;
    sqlx::query(CHANGE)
        .bind(id.to_string())
        .bind(change.url.as_deref())
        .bind(change.secret.as_ref().map(Secret::reveal))
        .bind(change.kinds.as_deref().map(names))
        .bind(change.enabled)
        .execute(&mut *transaction)
        .await?;
    let webhook = one(&mut *transaction, id).await?;
    transaction.commit().await?;
    Ok(webhook)
}

/// Deletes a webhook, its secret and its deliveries.
pub(super) async fn delete(writer: &SqlitePool, id: Id) -> Result<bool, StoreError> {
    let deleted = sqlx::query("DELETE FROM webhooks WHERE id = ?1").bind(id.to_string()).execute(writer).await?;
    Ok(deleted.rows_affected() > 0)
}

/// Writes into the outbox what every webhook that wants to know is told of an alert, within the transaction that changed it.
pub(super) async fn tell(
    connection: &mut SqliteConnection,
    event: Event,
    alert: &Alert,
    at: Timestamp,
) -> Result<(), StoreError> {
    for row in sqlx::query(TOLD).fetch_all(&mut *connection).await? {
        let mut row = Reader::new(&row, "webhook", 0);
        let (webhook, kinds): (Id, Vec<AlertKind>) = (row.id()?, row.document()?);
        if kinds.contains(&alert.kind) {
            queue(connection, webhook, event, Some(alert), at).await?;
        }
    }
    Ok(())
}

async fn queue(
    connection: &mut SqliteConnection,
    webhook: Id,
    event: Event,
    alert: Option<&Alert>,
    at: Timestamp,
) -> Result<Id, StoreError> {
    let delivery_id = Id::now();
    let body = Notification { event, delivery_id, created_at: at, alert };
    sqlx::query(QUEUE)
        .bind(delivery_id.to_string())
        .bind(webhook.to_string())
        .bind(alert.map(|alert| alert.id.to_string()))
        .bind(event.name())
        .bind(serde_json::to_string(&body).expect("a notification's fields have names"))
        .bind(micros(at))
        .execute(connection)
        .await?;
    Ok(delivery_id)
}

/// Queues a ping for a webhook, unless one waits already: the one that waits now.
pub(super) async fn ping(writer: &SqlitePool, webhook: Id, now: Timestamp) -> Result<Option<Delivery>, StoreError> {
    let mut transaction = begin(writer).await?;
    if one(&mut *transaction, webhook).await?.is_none() {
        return Ok(None);
    }
    let waiting = sqlx::query(WAITING_PING).bind(webhook.to_string()).fetch_optional(&mut *transaction).await?;
    let id = match waiting {
        Some(row) => Reader::new(&row, "delivery", 0).id()?,
        None => queue(&mut transaction, webhook, Event::Ping, None, now).await?,
    };
    let row = sqlx::query(DELIVERY).bind(id.to_string()).fetch_one(&mut *transaction).await?;
    transaction.commit().await?;
    read_delivery(&row).map(Some)
}

pub(super) async fn deliveries(readers: &SqlitePool, webhook: Id, page: &Page) -> Result<Paged<Delivery>, StoreError> {
    let webhook = webhook.to_string();
    let of = ["deliveries", &webhook];
    let before = page.start::<Id>(&of)?.map_or_else(|| AFTER_ALL.into(), |id| id.to_string());
    let rows = sqlx::query(DELIVERIES).bind(&webhook).bind(before).bind(page.rows()).fetch_all(readers).await?;
    let items = rows.iter().map(read_delivery).collect::<Result<_, _>>()?;
    Ok(page.cut(&of, items, |delivery: &Delivery| delivery.id))
}

pub(super) async fn due(readers: &SqlitePool, now: Timestamp) -> Result<Vec<DueDelivery>, StoreError> {
    let rows = sqlx::query(DUE).bind(micros(now)).fetch_all(readers).await?;
    rows.iter().map(read_due).collect()
}

/// Keeps how an attempt ended, if its delivery still waits: it may have been deleted meanwhile.
pub(super) async fn record(writer: &SqlitePool, id: Id, attempt: &Attempt) -> Result<bool, StoreError> {
    let (state, next, delivered_at) = match &attempt.followed {
        Followed::Delivered => ("delivered", None, Some(attempt.at)),
        Followed::Retry { at } => ("pending", Some(*at), None),
        Followed::GivenUp | Followed::Gone { .. } => ("failed", None, None),
    };
    let mut transaction = begin(writer).await?;
    let recorded = sqlx::query(RECORD)
        .bind(id.to_string())
        .bind(state)
        .bind(next.map(micros))
        .bind(attempt.status)
        .bind(&attempt.error)
        .bind(delivered_at.map(micros))
        .execute(&mut *transaction)
        .await?;
    if let Followed::Gone { url } = &attempt.followed {
        disable(&mut transaction, id, url).await?;
    }
    transaction.commit().await?;
    Ok(recorded.rows_affected() > 0)
}

/// Disables the webhook of a delivery, if it still has the address that wants nothing any more, and gives up what waits for it.
async fn disable(connection: &mut SqliteConnection, delivery: Id, url: &str) -> Result<(), StoreError> {
    let id = delivery.to_string();
    let disabled = sqlx::query(DISABLE).bind(&id).bind(url).bind(GONE).execute(&mut *connection).await?;
    if disabled.rows_affected() > 0 {
        sqlx::query(ABANDON).bind(&id).bind(format!("not sent: {GONE}")).execute(connection).await?;
    }
    Ok(())
}

/// Forgets deliveries that are over and older than a time; the number of them.
pub(super) async fn forget(writer: &SqlitePool, before: Timestamp) -> Result<u64, StoreError> {
    Ok(sqlx::query(FORGET).bind(micros(before)).execute(writer).await?.rows_affected())
}

fn names(kinds: &[AlertKind]) -> String {
    serde_json::to_string(kinds).expect("kinds have names")
}

fn read(row: &SqliteRow) -> Result<Webhook, StoreError> {
    let mut row = Reader::new(row, "webhook", 0);
    Ok(Webhook {
        id: row.id()?,
        url: row.value()?,
        kinds: row.document()?,
        enabled: row.value()?,
        disabled_because: row.value()?,
        created_at: row.time()?,
    })
}

fn read_delivery(row: &SqliteRow) -> Result<Delivery, StoreError> {
    let mut row = Reader::new(row, "delivery", 0);
    Ok(Delivery {
        id: row.id()?,
        event: row.name()?,
        alert_id: row.id_or_null()?,
        state: row.name()?,
        attempts: row.count()?,
        next_attempt_at: row.time_or_null()?,
        last_status: row.value()?,
        last_error: row.value()?,
        created_at: row.time()?,
        delivered_at: row.time_or_null()?,
    })
}

fn read_due(row: &SqliteRow) -> Result<DueDelivery, StoreError> {
    let mut row = Reader::new(row, "delivery", 0);
    Ok(DueDelivery {
        id: row.id()?,
        webhook_id: row.id()?,
        url: row.value()?,
        secret: Secret::new(row.value::<String>()?),
        body: row.value()?,
        attempts: row.count()?,
        created_at: row.time()?,
    })
}
