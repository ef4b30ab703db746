//! Query strings, strictly: unknown and repeated names, wrong types and values out of range, all told at once.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::str::FromStr;

use axum::extract::FromRequestParts;
use axum::http::Uri;
use axum::http::request::Parts;
use jiff::Timestamp;

use super::time;
use crate::http::error::{ApiError, ApiResult};
use crate::http::problem::FieldError;

/// A query that can be read from its fields.
pub trait FromQuery: Sized {
    /// Takes every field that the query may have, noting what is wrong with it; `None` only after a fault was noted.
    fn from_query(fields: &mut Fields) -> Option<Self>;
}

/// The query of a request, read into `T`.
#[derive(Debug)]
pub struct Query<T>(pub T);

impl<T: FromQuery, S: Send + Sync> FromRequestParts<S> for Query<T> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> ApiResult<Self> {
        read(&parts.uri).map(Self)
    }
}

/// Reads the query of an address.
///
/// # Errors
/// Every fault: [`ApiError::Malformed`] when one value cannot be read, [`ApiError::Invalid`] when all can and some are out
/// of range.
pub fn read<T: FromQuery>(uri: &Uri) -> ApiResult<T> {
    let mut fields = Fields::of(uri)?;
    let value = T::from_query(&mut fields);
    fields.finish()?;
    value.ok_or_else(|| ApiError::malformed("", "the query cannot be read"))
}

/// The fields of a query that were not taken yet, and the faults found so far.
#[derive(Debug)]
pub struct Fields {
    pairs: Vec<(String, String)>,
    names: Vec<&'static str>,
    malformed: Vec<FieldError>,
    invalid: Vec<FieldError>,
}

impl Fields {
    fn of(uri: &Uri) -> ApiResult<Self> {
        let pairs =
            axum::extract::Query::try_from_uri(uri).map_err(|error| ApiError::malformed("", error.body_text()))?;
        Ok(Self { pairs: pairs.0, names: Vec::new(), malformed: Vec::new(), invalid: Vec::new() })
    }

    /// A text.
    pub fn text(&mut self, name: &'static str) -> Option<String> {
        self.names.push(name);
        let (mut found, rest): (Vec<_>, Vec<_>) = self.pairs.drain(..).partition(|(key, _)| key == name);
        self.pairs = rest;
        if found.len() > 1 {
            self.malformed(name, format!("found {} times, expected once", found.len()));
        }
        found.pop().map(|(_, value)| value)
    }

    /// A value of any type that can be read from a text.
    pub fn parse<T: FromStr>(&mut self, name: &'static str, expected: impl Display) -> Option<T> {
        self.parse_with(name, expected, |text| text.parse().ok())
    }

    /// A value that `read` reads from a text.
    pub fn parse_with<T>(
        &mut self,
        name: &'static str,
        expected: impl Display,
        read: impl FnOnce(&str) -> Option<T>,
    ) -> Option<T> {
        let text = self.text(name)?;
        let value = read(&text);
        if value.is_none() {
            self.malformed(name, format!("found {text:?}, expected {expected}"));
        }
        value
    }

    /// An RFC 3339 time.
    pub fn time(&mut self, name: &'static str) -> Option<Timestamp> {
        self.parse_with(name, time::EXPECTED, time::parse)
    }

    /// An integer in a range.
    pub fn integer(&mut self, name: &'static str, range: RangeInclusive<u32>) -> Option<u32> {
        let (min, max) = range.into_inner();
        let expected = format!("an integer, {min} to {max}");
        let found: i128 = self.parse(name, &expected)?;
        let value = u32::try_from(found).ok().filter(|value| (min..=max).contains(value));
        self.check(value.is_some(), name, format!("found {found}, expected {expected}"));
        value
    }

    /// A number for which `fits` holds.
    pub fn number(&mut self, name: &'static str, expected: &str, fits: impl FnOnce(f64) -> bool) -> Option<f64> {
        let found: f64 = self.parse(name, expected)?;
        let fits = fits(found);
        self.check(fits, name, format!("found {found}, expected {expected}"));
        fits.then_some(found)
    }

    /// Notes a name that must be there and is not.
    pub fn require(&mut self, name: &'static str, there: bool) {
        let noted = self.malformed.iter().chain(&self.invalid).any(|error| error.pointer == format!("?{name}"));
        if !there && !noted {
            self.malformed(name, "missing, and required");
        }
    }

    /// Notes a value that is out of its range.
    pub fn check(&mut self, fits: bool, name: &str, detail: impl Into<String>) {
        if !fits {
            self.invalid.push(FieldError::new(format!("?{name}"), detail));
        }
    }

    /// Notes a value that cannot be read.
    pub fn malformed(&mut self, name: &str, detail: impl Into<String>) {
        self.malformed.push(FieldError::new(format!("?{name}"), detail));
    }

    fn finish(mut self) -> ApiResult<()> {
        let names = if self.names.is_empty() { "no query".to_owned() } else { self.names.join(", ") };
        for (name, _) in std::mem::take(&mut self.pairs) {
            self.malformed(&name, format!("unknown name, expected {names}"));
        }
        if !self.malformed.is_empty() {
            self.malformed.append(&mut self.invalid);
            return Err(ApiError::Malformed(self.malformed));
        }
        if self.invalid.is_empty() { Ok(()) } else { Err(ApiError::Invalid(self.invalid)) }
    }
}

/// A query without names: every name is unknown.
#[derive(Debug)]
pub struct NoQuery;

impl FromQuery for NoQuery {
    fn from_query(_fields: &mut Fields) -> Option<Self> {
        Some(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug)]
    struct Two {
        limit: Option<u32>,
        usage: f64,
    }

    impl FromQuery for Two {
        fn from_query(fields: &mut Fields) -> Option<Self> {
            let limit = fields.integer("limit", 1..=500);
            let usage = fields.number("usage", "a number, at least 0", |value| value >= 0.0);
            fields.require("usage", usage.is_some());
            Some(Self { limit, usage: usage? })
        }
    }

    fn two(query: &str) -> ApiResult<Two> {
        read(&format!("/?{query}").parse().unwrap())
    }

    fn pointers(result: ApiResult<Two>) -> (u16, Vec<String>) {
        let (status, errors) = match result {
            Err(ApiError::Malformed(errors)) => (400, errors),
            Err(ApiError::Invalid(errors)) => (422, errors),
            other => panic!("{other:?}"),
        };
        (status, errors.into_iter().map(|error| error.pointer).collect())
    }

    #[test]
    fn a_good_query_is_read() {
        let query = two("usage=1.5&limit=7").unwrap();
        assert_eq!((query.usage, query.limit), (1.5, Some(7)));
    }

    #[test]
    fn every_fault_is_told_at_once_and_one_that_cannot_be_read_makes_it_400() {
        assert_eq!(pointers(two("usage=-1&limit=501")), (422, vec!["?limit".into(), "?usage".into()]));
        let (status, places) = pointers(two("usage=-1&limit=many&Limit=1"));
        assert_eq!((status, places), (400, vec!["?limit".into(), "?Limit".into(), "?usage".into()]));
    }

    #[test]
    fn a_missing_an_empty_and_a_repeated_name_are_faults() {
        assert_eq!(pointers(two("")), (400, vec!["?usage".into()]));
        assert_eq!(pointers(two("usage=")), (400, vec!["?usage".into()]));
        assert_eq!(pointers(two("usage=1&usage=2")), (400, vec!["?usage".into()]));
    }

    #[test]
    fn what_is_no_number_in_range_never_passes() {
        for limit in ["0", "-1", "99999999999999999999"] {
            assert_eq!(pointers(two(&format!("usage=1&limit={limit}"))), (422, vec!["?limit".into()]));
        }
        for limit in ["1.5", "x", "1e2", "%20"] {
            assert_eq!(pointers(two(&format!("usage=1&limit={limit}"))), (400, vec!["?limit".into()]));
        }
        assert_eq!(pointers(two("usage=nan")).0, 422);
    }
}
