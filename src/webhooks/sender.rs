//! The task that empties the outbox: at least once, one delivery at a time for each webhook, all webhooks at once.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use jiff::{SignedDuration, Timestamp};
use tokio::task::{self, JoinSet, spawn_blocking};
use tokio::time::{interval, sleep, timeout};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

use super::post::{Poster, Stamp};
use super::schedule::Schedule;
use super::signature::sign;
use crate::jobs::text::causes;
use crate::store::Records;
use crate::store::records::{Id, now};
use crate::store::webhooks::{Attempt, DueDelivery, Followed};

/// How long the sender waits before it asks a failed store again.
const STORE_PAUSE: Duration = Duration::from_secs(1);
/// How often deliveries that are over are looked at for their age.
const FORGET_EVERY: Duration = Duration::from_secs(3600);

/// How deliveries are sent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SenderSettings {
    /// The longest time from the connection to the answer.
    pub timeout: Duration,
    /// The wait after the first failed attempt; each one after it is five times as long.
    pub retry_first: Duration,
    /// The longest wait between two attempts.
    pub retry_max: Duration,
    /// The attempts after which a delivery is given up.
    pub attempts_max: u32,
    /// The age at which a delivery is given up, after one more attempt.
    pub age_max: Duration,
    /// How often the outbox is looked into.
    pub poll: Duration,
    /// How long deliveries that are over are listed.
    pub keep: Duration,
    /// The longest that a stop waits for what is being sent.
    pub stop_limit: Duration,
}

/// Sends what waits in the outbox. A clone shares everything.
#[derive(Clone)]
pub struct Sender {
    records: Arc<dyn Records>,
    poster: Poster,
    settings: SenderSettings,
    stop: CancellationToken,
    tasks: TaskTracker,
}

impl Sender {
    /// The sender of an outbox. Nothing is sent before [`Sender::start`].
    #[must_use]
    pub fn new(records: Arc<dyn Records>, settings: SenderSettings) -> Self {
        let poster = Poster::new(settings.timeout);
        Self { records, poster, settings, stop: CancellationToken::new(), tasks: TaskTracker::new() }
    }

    /// Starts the task that sends what is due, now and later.
    pub fn start(&self) {
        self.tasks.spawn(self.clone().work());
    }

    /// Ends the task. What is being sent has a little time left; what has not ended is sent again after the next start.
    pub async fn stop(&self) {
        self.stop.cancel();
        self.tasks.close();
        if timeout(self.settings.stop_limit, self.tasks.wait()).await.is_err() {
            tracing::warn!("deliveries that do not end are left; the next start sends them again");
        }
    }

    /// Sends of each webhook the delivery that has been due at `now` for longest, all at once, and returns how many: the sender's
    /// single step.
    pub async fn send_due(&self, now: Timestamp) -> usize {
        let due = self.due(now).await;
        let count = due.len();
        let mut sending: JoinSet<()> = due.into_iter().map(|due| self.clone().deliver(due, now)).collect();
        while sending.join_next().await.is_some() {}
        count
    }

    async fn work(self) {
        let mut sending = JoinSet::new();
        let mut busy: HashMap<task::Id, Id> = HashMap::new();
        let mut forget = interval(FORGET_EVERY);
        while !self.stop.is_cancelled() {
            for due in self.due(now()).await {
                let webhook = due.webhook_id;
                if !busy.values().any(|id| *id == webhook) {
                    busy.insert(sending.spawn(self.clone().deliver(due, now())).id(), webhook);
                }
            }
            tokio::select! {
                () = self.stop.cancelled() => {}
                () = sleep(self.settings.poll) => {}
                Some(ended) = sending.join_next_with_id() => {
                    let id = ended.as_ref().map_or_else(|error| error.id(), |(id, ())| *id);
                    busy.remove(&id);
                }
                _ = forget.tick() => self.forget().await,
            }
        }
        while sending.join_next().await.is_some() {}
    }

    async fn due(&self, now: Timestamp) -> Vec<DueDelivery> {
        self.records.due_deliveries(now).await.unwrap_or_else(|error| {
            tracing::warn!(error = causes(&error), "the outbox cannot be read; it is read again");
            Vec::new()
        })
    }

    async fn forget(&self) {
        let before = now().checked_sub(self.settings.keep).unwrap_or(Timestamp::MIN);
        if let Err(error) = self.records.forget_deliveries(before).await {
            tracing::warn!(error = causes(&error), "old deliveries not forgotten");
        }
    }

    /// Sends a delivery once and keeps how that ended.
    async fn deliver(self, due: DueDelivery, now: Timestamp) {
        let started = Instant::now();
        let id = due.id.to_string();
        let timestamp_s = now.as_second();
        let signature = sign(&due.secret, &id, timestamp_s, &due.body);
        let stamp = Stamp { id, timestamp_s, signature };
        let (poster, url, body) = (self.poster.clone(), due.url.clone(), due.body.clone());
        let answer = spawn_blocking(move || poster.post(&url, &stamp, &body)).await;
        let answer = answer.unwrap_or_else(|_| Err("the delivery could not be sent".into()));
        let at = now.checked_add(started.elapsed()).unwrap_or(now);
        let attempt = self.judge(&due, answer, at);
        tell(&due, &attempt);
        self.record(due.id, &attempt).await;
    }

    /// What follows from an answer that came at a time.
    fn judge(&self, due: &DueDelivery, answer: Result<u16, String>, at: Timestamp) -> Attempt {
        let status = answer.as_ref().ok().copied();
        let (error, followed) = match answer {
            Ok(200..=299) => (None, Followed::Delivered),
            Ok(410) => (Some("the receiver answered 410 Gone".into()), Followed::Gone { url: due.url.clone() }),
            Ok(status @ 300..=399) => {
                (Some(format!("the receiver answered {status}, and redirects are not followed")), self.again(due, at))
            }
            Ok(status) => (Some(format!("the receiver answered {status}")), self.again(due, at)),
            Err(error) => (Some(error), self.again(due, at)),
        };
        Attempt { at, status, error, followed }
    }

    /// Whether and when a delivery that failed at a time is sent again.
    fn again(&self, due: &DueDelivery, at: Timestamp) -> Followed {
        let SenderSettings { retry_first: first, retry_max: max, attempts_max, age_max, .. } = self.settings;
        let attempts = due.attempts.saturating_add(1);
        let next = at.checked_add(Schedule { first, max }.wait(due.id, attempts)).unwrap_or(Timestamp::MAX);
        let age = next.duration_since(due.created_at);
        if attempts >= attempts_max || age > SignedDuration::try_from(age_max).unwrap_or(SignedDuration::MAX) {
            return Followed::GivenUp;
        }
        Followed::Retry { at: next }
    }

    /// Keeps how an attempt ended, however long the store needs; only a stop ends the trying, and then it is sent again.
    async fn record(&self, delivery: Id, attempt: &Attempt) {
        while let Err(error) = self.records.record_attempt(delivery, attempt).await {
            tracing::warn!(delivery_id = %delivery, error = causes(&error), "an attempt is not kept; it is tried again");
            tokio::select! {
                () = self.stop.cancelled() => return,
                () = sleep(STORE_PAUSE) => {}
            }
        }
    }
}

/// Says how an attempt ended, to the log and to the metrics, without the address and the secret.
fn tell(due: &DueDelivery, attempt: &Attempt) {
    let (delivery_id, webhook_id) = (due.id, due.webhook_id);
    let (status, error) = (attempt.status, attempt.error.as_deref());
    let outcome = match attempt.followed {
        Followed::Delivered => "delivered",
        Followed::Retry { .. } => "retried",
        Followed::GivenUp => "given_up",
        Followed::Gone { .. } => "gone",
    };
    metrics::counter!("elevon_webhook_attempts_total", "outcome" => outcome).increment(1);
    match attempt.followed {
        Followed::Delivered => tracing::debug!(%delivery_id, %webhook_id, status, "delivered"),
        Followed::Retry { .. } => {
            tracing::info!(%delivery_id, %webhook_id, status, error, "delivery failed; it is sent again")
        }
        Followed::GivenUp => tracing::warn!(%delivery_id, %webhook_id, status, error, "delivery given up"),
        Followed::Gone { .. } => {
            tracing::warn!(%delivery_id, %webhook_id, status, "webhook disabled: its receiver is gone")
        }
    }
}
