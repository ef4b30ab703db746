//! What the lives of the actuators of a cohort say, in SQLite: the share of each actuator, and their sums.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use sqlx::SqliteConnection;
use sqlx::sqlite::SqlitePool;

use super::row::{Reader, signed};
use crate::store::StoreError;
use crate::store::records::{FleetShare, FleetTally, Id};

pub(super) const SHARE: &str = "SELECT cohort, tally, prior FROM fleet_shares WHERE actuator_id = ?1 AND fault = ?2";
pub(super) const SHARE_IN: &str =
    "SELECT cohort, tally, prior FROM fleet_shares WHERE actuator_id = ?1 AND cohort = ?2";
pub(super) const PRIOR: &str =
    "SELECT s.prior FROM actuators a JOIN fleet_shares s ON s.actuator_id = a.id AND s.fault = ?3
    WHERE a.id = ?1 AND a.forecast_revision = ?2";
const KEEP_SHARE: &str = "INSERT OR REPLACE INTO fleet_shares (actuator_id, fault, cohort, tally, prior)
    VALUES (?1, ?2, ?3, ?4, ?5)";
const FORGET_SHARE: &str = "DELETE FROM fleet_shares WHERE actuator_id = ?1 AND fault = ?2";
pub(super) const SUM: &str = "SELECT cohort, actuators, tally FROM fleet_tallies WHERE cohort = ?1";
const KEEP_SUM: &str = "INSERT OR REPLACE INTO fleet_tallies (cohort, actuators, tally) VALUES (?1, ?2, ?3)";
const FORGET_SUM: &str = "DELETE FROM fleet_tallies WHERE cohort = ?1";

/// Keeps a share in the place of the actuator's earlier one, within the transaction that keeps its forecast.
pub(super) async fn keep(
    connection: &mut SqliteConnection,
    actuator: Id,
    share: &FleetShare,
) -> Result<(), StoreError> {
    let before = share_at(connection, SHARE, actuator, &share.fault).await?;
    let after = Some(share).filter(|share| !share.tally.is_empty());
    let same =
        |(before, after): (&FleetShare, &FleetShare)| (&before.cohort, &before.tally) == (&after.cohort, &after.tally);
    if !before.as_ref().zip(after).is_some_and(same) {
        // Most often both are of one cohort, whose sum is then read and written once.
        let mut sums = BTreeMap::new();
        for (share, times) in before.iter().map(|share| (share, -1)).chain(after.map(|share| (share, 1))) {
            let sum = match sums.entry(&share.cohort) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(unread) => unread.insert(sum(connection, &share.cohort).await?),
            };
            change(sum, share, times)?;
        }
        for (cohort, sum) in sums {
            keep_sum(connection, cohort, &sum).await?;
        }
    }
    let query = if share.tally.is_empty() {
        sqlx::query(FORGET_SHARE).bind(actuator.to_string()).bind(&share.fault)
    } else {
        let tally: Vec<u8> = share.tally.iter().flat_map(|number| number.to_le_bytes()).collect();
        let prior: Vec<u8> = share.prior.iter().flat_map(|number| number.to_le_bytes()).collect();
        let query = sqlx::query(KEEP_SHARE).bind(actuator.to_string()).bind(&share.fault).bind(&share.cohort);
        query.bind(tally).bind(prior)
    };
    query.execute(connection).await?;
    Ok(())
}

/// The sum of a cohort's shares without that of one actuator.
pub(super) async fn tally(readers: &SqlitePool, cohort: &str, without: Id) -> Result<FleetTally, StoreError> {
    let mut snapshot = readers.begin().await?;
    let mut others = sum(&mut snapshot, cohort).await?;
    if let Some(own) = share_at(&mut snapshot, SHARE_IN, without, cohort).await? {
        change(&mut others, &own, -1)?;
    }
    Ok(others)
}

/// The prior that the kept forecast of a revision had of a fault.
pub(super) async fn prior(
    readers: &SqlitePool,
    actuator: Id,
    revision: i64,
    fault: &str,
) -> Result<Vec<f64>, StoreError> {
    let query = sqlx::query(PRIOR).bind(actuator.to_string()).bind(revision).bind(fault);
    let Some(row) = query.fetch_optional(readers).await? else { return Ok(Vec::new()) };
    Reader::new(&row, "prior of a forecast", 0).numbers(f64::from_le_bytes)
}

/// The share that a query finds by an actuator and its fault or cohort.
async fn share_at(
    connection: &mut SqliteConnection,
    query: &'static str,
    actuator: Id,
    by: &str,
) -> Result<Option<FleetShare>, StoreError> {
    let row = sqlx::query(query).bind(actuator.to_string()).bind(by).fetch_optional(connection).await?;
    let Some(row) = row else { return Ok(None) };
    let mut row = Reader::new(&row, "share of a cohort", 0);
    let (fault, cohort) = (by.to_owned(), row.value()?);
    Ok(Some(FleetShare {
        fault,
        cohort,
        tally: row.numbers(i32::from_le_bytes)?,
        prior: row.numbers(f64::from_le_bytes)?,
    }))
}

async fn sum(connection: &mut SqliteConnection, cohort: &str) -> Result<FleetTally, StoreError> {
    let Some(row) = sqlx::query(SUM).bind(cohort).fetch_optional(connection).await? else {
        return Ok(FleetTally::default());
    };
    let mut row = Reader::new(&row, "tally of a cohort", 1);
    Ok(FleetTally { actuators: row.count()?, tally: row.numbers(i64::from_le_bytes)? })
}

async fn keep_sum(connection: &mut SqliteConnection, cohort: &str, sum: &FleetTally) -> Result<(), StoreError> {
    let query = if sum.actuators == 0 {
        sqlx::query(FORGET_SUM).bind(cohort)
    } else {
        let tally: Vec<u8> = sum.tally.iter().flat_map(|number| number.to_le_bytes()).collect();
        sqlx::query(KEEP_SUM).bind(cohort).bind(signed(sum.actuators)).bind(tally)
    };
    query.execute(connection).await?;
    Ok(())
}

/// Adds a share to a sum, or takes it away (`times` -1).
fn change(sum: &mut FleetTally, share: &FleetShare, times: i64) -> Result<(), StoreError> {
    let FleetTally { actuators, tally } = sum;
    if tally.is_empty() {
        tally.resize(share.tally.len(), 0);
    }
    let after = actuators.checked_add_signed(times).filter(|_| tally.len() == share.tally.len());
    *actuators = after.ok_or_else(|| StoreError::Corrupt {
        what: "tally of a cohort",
        id: share.cohort.clone(),
        reason: format!("{actuators} shares of {} numbers, one has {}", tally.len(), share.tally.len()),
    })?;
    tally.iter_mut().zip(&share.tally).for_each(|(sum, &number)| *sum += times * i64::from(number));
    if *actuators == 0 {
        tally.clear();
    }
    Ok(())
}
