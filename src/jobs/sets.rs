//! Parameter sets by name: the built-in one, which goes with the program, and the versions that the store keeps.
//!
//! `NAME` means the version of that name that was kept last, `NAME@HASH` the one whose hash begins with HASH. The
//! built-in set's name alone always means the set of the running program.

use std::sync::Arc;

use thiserror::Error;

use crate::models::checks::ParamsError;
use crate::models::parameters::ParameterSet;
use crate::store::records::{self, Id, ParameterSetRecord};
use crate::store::{Records, StoreError};

/// The fewest digits of a hash that name a version.
pub const HASH_CHARS_MIN: usize = 8;
/// The most characters that are shown of what is no set's name.
const SHOWN_CHARS_MAX: usize = 140;
/// The digits of a whole hash.
pub const HASH_CHARS: usize = 64;

/// Why no parameter set can be had under a name.
#[derive(Debug, Error)]
pub enum SetError {
    /// The text is no name.
    #[error(
        "found {found:?}, expected NAME or NAME@HASH, HASH being the first {HASH_CHARS_MIN} or more digits of its hash"
    )]
    Unreadable {
        /// What was given.
        found: String,
    },
    /// No set has this name.
    #[error("found {found:?}, expected {} or a set that the service keeps", ParameterSet::reference_name())]
    Unknown {
        /// What was given.
        found: String,
    },
    /// No version of a set has this hash, or there is no such set at all.
    #[error("found {found:?}, expected a set and the hash of a version of it that the service keeps")]
    UnknownVersion {
        /// What was given.
        found: String,
    },
    /// Several versions have hashes that begin so.
    #[error("found {found:?}, which means more than one version, expected more digits of the hash")]
    Ambiguous {
        /// What was given.
        found: String,
    },
    /// The set was kept by another version of the program, and this one cannot use it.
    #[error("{set} is not valid in elevon {}: {}", crate::VERSION, list(errors))]
    Invalid {
        /// Its name and hash.
        set: String,
        /// All that is wrong with it.
        errors: Vec<ParamsError>,
    },
    /// The set's values have another hash than when it was kept.
    #[error("{set} changed in the store, or elevon {} reads it otherwise: its hash is {found}", crate::VERSION)]
    Changed {
        /// Its name and hash.
        set: String,
        /// The hash of its values now.
        found: String,
    },
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

fn list(errors: &[ParamsError]) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
}

/// Whether a text is the beginning of a hash that names a version, or a whole one.
#[must_use]
pub fn is_hash(text: &str) -> bool {
    (HASH_CHARS_MIN..=HASH_CHARS).contains(&text.len())
        && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// A set as a new record.
#[must_use]
pub fn record(set: &ParameterSet) -> ParameterSetRecord {
    let (name, hash) = (set.name().to_owned(), set.hash().to_owned());
    ParameterSetRecord { id: Id::now(), name, hash, parameters: set.to_json(), created_at: records::now() }
}

/// At a start: keeps the built-in set, so that it is listed and its older versions stay known by their hashes, and pins
/// the actuators of its name to it.
///
/// # Errors
/// The store fails.
pub async fn keep_built_in(records: &dyn Records) -> Result<(), StoreError> {
    records.keep_built_in_set(&record(&ParameterSet::reference())).await
}

/// The record that `NAME` or `NAME@HASH` means.
///
/// # Errors
/// A text that is neither, a set that is not kept, a hash that means several versions, a failing store.
pub async fn find(records: &dyn Records, text: &str) -> Result<ParameterSetRecord, SetError> {
    let found = || text.chars().take(SHOWN_CHARS_MAX).collect();
    let built_in = ParameterSet::reference();
    let (name, hash) = match text.split_once('@') {
        Some((name, hash)) if is_hash(hash) => (name, Some(hash)),
        Some(_) => return Err(SetError::Unreadable { found: found() }),
        None if text == built_in.name() => (text, Some(built_in.hash())),
        None => (text, None),
    };
    if !ParameterSet::is_name(name) {
        return Err(SetError::Unreadable { found: found() });
    }
    let Some(hash) = hash else {
        return records.newest_parameter_set(name).await?.ok_or_else(|| SetError::Unknown { found: found() });
    };
    let mut versions = records.parameter_sets_by_hash(name, hash).await?;
    match (versions.pop(), versions.is_empty()) {
        (Some(only), true) => Ok(only),
        (Some(_), false) => Err(SetError::Ambiguous { found: found() }),
        (None, _) => Err(SetError::UnknownVersion { found: found() }),
    }
}

/// The set that a record keeps, exactly as it was kept.
///
/// # Errors
/// Values that this version of the program cannot use, or that have another hash.
pub fn usable(record: &ParameterSetRecord) -> Result<ParameterSet, SetError> {
    let ParameterSetRecord { name, hash, parameters, .. } = record;
    let set = || format!("{name}@{hash}");
    let read = ParameterSet::from_json(name, parameters).map_err(|errors| SetError::Invalid { set: set(), errors })?;
    if read.hash() == hash { Ok(read) } else { Err(SetError::Changed { set: set(), found: read.hash().to_owned() }) }
}

/// The set that `NAME` or `NAME@HASH` means.
///
/// # Errors
/// As [`find`] and [`usable`].
pub async fn resolve(records: &dyn Records, text: &str) -> Result<Arc<ParameterSet>, SetError> {
    let built_in = ParameterSet::reference();
    if text == built_in.name() || text == named(&built_in) {
        return Ok(Arc::new(built_in));
    }
    usable(&find(records, text).await?).map(Arc::new)
}

/// A set's name with its whole hash, which means this set and no other.
#[must_use]
pub fn named(set: &ParameterSet) -> String {
    format!("{}@{}", set.name(), set.hash())
}
