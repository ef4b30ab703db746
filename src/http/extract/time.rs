//! Times: RFC 3339 with an offset.

use jiff::Timestamp;
use serde::{Deserialize, Deserializer, de};

use crate::store::records::to_microsecond;

/// What a time must look like, for messages.
pub const EXPECTED: &str = "an RFC 3339 time with an offset, as 2026-03-01T12:00:00Z (in a query, + is written %2B)";

/// Reads an RFC 3339 time: date and time to the second at least, and `Z` or an offset. What is finer than a microsecond
/// is cut off, as the store keeps microseconds.
#[must_use]
pub fn parse(text: &str) -> Option<Timestamp> {
    let shape = |at: usize, allowed: &[u8]| text.as_bytes().get(at).is_some_and(|byte| allowed.contains(byte));
    let dashed = shape(4, b"-") && shape(7, b"-") && shape(10, b"Tt") && shape(13, b":") && shape(16, b":");
    let ends_in_offset =
        match text.get(19..)?.trim_start_matches(['.', '0', '1', '2', '3', '4', '5', '6', '7', '8', '9']) {
            "Z" | "z" => true,
            offset => offset.len() == 6 && offset.as_bytes()[3] == b':',
        };
    let time = if dashed && ends_in_offset { text.parse().ok() } else { None };
    time.map(to_microsecond)
}

/// Reads an RFC 3339 time out of JSON.
///
/// # Errors
/// What is not a string of that form.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Timestamp, D::Error> {
    let text = String::deserialize(deserializer)?;
    parse(&text).ok_or_else(|| de::Error::custom(format_args!("found {text:?}, expected {EXPECTED}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offset_is_needed_and_turned_into_utc() {
        assert_eq!(parse("2026-03-01T12:00:00+02:00").unwrap().to_string(), "2026-03-01T10:00:00Z");
        assert_eq!(parse("2026-03-01t12:00:00.5z").unwrap().to_string(), "2026-03-01T12:00:00.5Z");
    }

    #[test]
    fn what_is_not_rfc_3339_is_refused() {
        for wrong in [
            "2026-03-01T12:00:00",
            "2026-03-01 12:00:00Z",
            "2026-03-01T12:00Z",
            "2026-03-01T12:00:00 02:00",
            "2026-03-01T12:00:00+02",
            "2026-03-01T12:00:00Z[Europe/Rome]",
            "2026-02-30T12:00:00Z",
            "20260301T120000Z",
            "yesterday",
            "é026-03-01T12:00:00Zéééé",
            "",
        ] {
            assert!(parse(wrong).is_none(), "{wrong}");
        }
    }
}
