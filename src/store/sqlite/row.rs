//! Values in and out of rows: columns are read by their index, in the order of the query's list.

use jiff::Timestamp;
use serde::de::value::Error as NameError;
use serde::de::{DeserializeOwned, IntoDeserializer as _};
use sqlx::Row as _;
use sqlx::sqlite::SqliteRow;

use crate::store::StoreError;
use crate::store::records::Id;

/// A row that is being read, and what to call it when it cannot be.
pub(super) struct Reader<'r> {
    row: &'r SqliteRow,
    what: &'static str,
    next: usize,
}

impl<'r> Reader<'r> {
    /// Reads `row` from column `first` on.
    pub(super) fn new(row: &'r SqliteRow, what: &'static str, first: usize) -> Self {
        Self { row, what, next: first }
    }

    /// The next column as the database has it.
    pub(super) fn value<T>(&mut self) -> Result<T, StoreError>
    where
        T: sqlx::Decode<'r, sqlx::Sqlite> + sqlx::Type<sqlx::Sqlite>,
    {
        let value = self.row.try_get(self.next)?;
        self.next += 1;
        Ok(value)
    }

    fn corrupt(&self, reason: impl ToString) -> StoreError {
        let column = self.next - 1;
        let id = self.row.try_get(0).unwrap_or_default();
        StoreError::Corrupt { what: self.what, id, reason: format!("column {column}: {}", reason.to_string()) }
    }

    /// An id.
    pub(super) fn id(&mut self) -> Result<Id, StoreError> {
        let text: &str = self.value()?;
        text.parse().map_err(|error| self.corrupt(error))
    }

    /// An id or null.
    pub(super) fn id_or_null(&mut self) -> Result<Option<Id>, StoreError> {
        let text: Option<&str> = self.value()?;
        text.map(str::parse).transpose().map_err(|error| self.corrupt(error))
    }

    /// A time.
    pub(super) fn time(&mut self) -> Result<Timestamp, StoreError> {
        let micros = self.value()?;
        Timestamp::from_microsecond(micros).map_err(|error| self.corrupt(error))
    }

    /// A time or null.
    pub(super) fn time_or_null(&mut self) -> Result<Option<Timestamp>, StoreError> {
        let micros: Option<i64> = self.value()?;
        micros.map(Timestamp::from_microsecond).transpose().map_err(|error| self.corrupt(error))
    }

    /// A time, or none where a number stands for none.
    pub(super) fn time_unless(&mut self, none: i64) -> Result<Option<Timestamp>, StoreError> {
        let micros: i64 = self.value()?;
        let time = (micros != none).then(|| Timestamp::from_microsecond(micros));
        time.transpose().map_err(|error| self.corrupt(error))
    }

    /// A count, which SQLite keeps signed.
    pub(super) fn count<T: TryFrom<i64, Error: ToString>>(&mut self) -> Result<T, StoreError> {
        let value: i64 = self.value()?;
        T::try_from(value).map_err(|error| self.corrupt(error))
    }

    /// Numbers of equal width, one after the other.
    pub(super) fn numbers<T, const WIDTH: usize>(&mut self, read: fn([u8; WIDTH]) -> T) -> Result<Vec<T>, StoreError> {
        let bytes: &[u8] = self.value()?;
        let (numbers, rest) = bytes.as_chunks();
        if rest.is_empty() {
            return Ok(numbers.iter().copied().map(read).collect());
        }
        Err(self.corrupt(format!("{} bytes, expected a multiple of {WIDTH}", bytes.len())))
    }

    /// One of an enumeration's names.
    pub(super) fn name<T: DeserializeOwned>(&mut self) -> Result<T, StoreError> {
        let text: &str = self.value()?;
        T::deserialize(text.into_deserializer()).map_err(|error: NameError| self.corrupt(error))
    }

    /// One of an enumeration's names, or null.
    pub(super) fn name_or_null<T: DeserializeOwned>(&mut self) -> Result<Option<T>, StoreError> {
        let text: Option<&str> = self.value()?;
        let read = |text: &'r str| T::deserialize(text.into_deserializer());
        text.map(read).transpose().map_err(|error: NameError| self.corrupt(error))
    }

    /// One of an enumeration's names, or nothing where the text is empty.
    pub(super) fn name_or_empty<T: DeserializeOwned>(&mut self) -> Result<Option<T>, StoreError> {
        let text: &str = self.value()?;
        let read = |text: &'r str| T::deserialize(text.into_deserializer());
        Some(text).filter(|text| !text.is_empty()).map(read).transpose().map_err(|error: NameError| self.corrupt(error))
    }

    /// A JSON document of any form.
    pub(super) fn json(&mut self) -> Result<serde_json::Value, StoreError> {
        self.document()
    }

    /// A JSON document of a known form.
    pub(super) fn document<T: DeserializeOwned>(&mut self) -> Result<T, StoreError> {
        let text: &str = self.value()?;
        serde_json::from_str(text).map_err(|error| self.corrupt(error))
    }

    /// A JSON document or null.
    pub(super) fn json_or_null(&mut self) -> Result<Option<serde_json::Value>, StoreError> {
        let text: Option<&str> = self.value()?;
        text.map(serde_json::from_str).transpose().map_err(|error| self.corrupt(error))
    }
}

/// A time as it is kept.
pub(super) fn micros(time: Timestamp) -> i64 {
    time.as_microsecond()
}

/// A count as it is kept. None that elevon makes comes near the limit.
pub(super) fn signed(count: u64) -> i64 {
    i64::try_from(count).unwrap_or(i64::MAX)
}
