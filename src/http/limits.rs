//! What a request may cost: bytes, time and memory.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::Semaphore;

use crate::config::HttpConfig;

/// The fewest and the most records of one page.
pub const PAGE_LIMITS: (u32, u32) = (1, 500);
/// The records of one page, unless the request says otherwise.
pub const PAGE_LIMIT_DEFAULT: u32 = 50;
/// The most characters of a name or a place.
pub const NAME_CHARS_MAX: usize = 200;
/// The most characters of a note.
pub const NOTE_CHARS_MAX: usize = 2000;
/// The most usage, in any unit.
pub const USAGE_MAX: f64 = 1e7;
/// The most characters of a simulation's command.
pub const COMMAND_CHARS_MAX: usize = 10_000;
/// The most errors that one problem document lists.
pub const ERRORS_MAX: usize = 100;
/// When to try again after the queue was full or the store busy, s (chosen: an estimation takes about a second).
pub const RETRY_AFTER_S: u32 = 5;

/// The limits of one application; see [`HttpConfig`] for their ranges.
#[derive(Clone)]
pub struct Limits {
    /// The longest body, bytes.
    pub body_bytes: usize,
    /// The longest time that a body may take to arrive.
    pub body_time: Duration,
    /// The longest time from head to answer.
    pub request_time: Duration,
    /// One permit for each body that may be in memory.
    pub bodies: Arc<Semaphore>,
}

impl From<&HttpConfig> for Limits {
    fn from(config: &HttpConfig) -> Self {
        Self {
            body_bytes: usize::try_from(config.body_limit_bytes).unwrap_or(usize::MAX),
            body_time: Duration::from_secs_f64(config.body_time_s),
            request_time: Duration::from_secs_f64(config.request_time_s),
            bodies: Arc::new(Semaphore::new(config.bodies_at_once)),
        }
    }
}
