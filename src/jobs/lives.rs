//! The lives of an actuator: when each began and ended, and what was recorded in it.

use jiff::{SignedDuration, Timestamp};

use crate::store::records::{Id, Maintenance, MaintenanceKind};
use crate::store::{LifeHistory, Page, Paged, Records, StoreError};

/// Records that are read at once.
const AT_ONCE: u32 = 500;

/// One life of an actuator: what was recorded from its start to the start of the next.
#[derive(Debug, Clone, PartialEq)]
pub struct Life {
    /// The event that began it; none began the first.
    pub start: Option<Maintenance>,
    /// When the next began.
    pub end: Option<Timestamp>,
}

impl Life {
    /// When it began; none of the first.
    #[must_use]
    pub fn since(&self) -> Option<Timestamp> {
        self.start.as_ref().map(|event| event.at)
    }

    /// Whether something was recorded in it.
    #[must_use]
    pub fn has(&self, at: Timestamp) -> bool {
        self.since().is_none_or(|since| since <= at) && self.end.is_none_or(|end| at < end)
    }
}

/// Every life of an actuator, ascending; at least the first.
pub(super) async fn lives(records: &dyn Records, actuator: Id) -> Result<Vec<Life>, StoreError> {
    let mut lives = vec![Life { start: None, end: None }];
    let mut page = Page { after: None, limit: AT_ONCE };
    loop {
        let Paged { items, next_cursor } = records.maintenance(actuator, &page).await?;
        for event in items.into_iter().filter(|event| event.kind != MaintenanceKind::Inspected) {
            if let Some(before) = lives.last_mut() {
                before.end = Some(event.at);
            }
            lives.push(Life { start: Some(event), end: None });
        }
        page.after = next_cursor;
        if page.after.is_none() {
            return Ok(lives);
        }
    }
}

/// The history of the life in which something was recorded at a time, up to that time: a life that may be over.
pub(super) async fn up_to(records: &dyn Records, actuator: Id, at: Timestamp) -> Result<LifeHistory, StoreError> {
    let Some(life) = lives(records, actuator).await?.into_iter().find(|life| life.has(at)) else {
        return Ok(LifeHistory::default());
    };
    // The end of a span is not part of it.
    let end = at.checked_add(SignedDuration::from_micros(1)).unwrap_or(at);
    records_of(records, actuator, &life, Some(end)).await
}

/// The history of a life up to a time, which is not part of it.
pub(super) async fn records_of(
    records: &dyn Records,
    actuator: Id,
    life: &Life,
    end: Option<Timestamp>,
) -> Result<LifeHistory, StoreError> {
    let mut history = LifeHistory {
        life_started_at: life.since(),
        life_start_usage: life.start.as_ref().map(|event| event.usage),
        ..LifeHistory::default()
    };
    let mut page = Page { after: None, limit: AT_ONCE };
    loop {
        let Paged { items, next_cursor } = records.health(actuator, history.life_started_at, end, &page).await?;
        history.records.extend(items);
        page.after = next_cursor;
        if page.after.is_none() {
            return Ok(history);
        }
    }
}
