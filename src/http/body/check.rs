//! Checks of fields that were read; every error is noted, none ends the checking.

use std::ops::RangeInclusive;

use crate::http::error::{ApiError, ApiResult};
use crate::http::problem::FieldError;

/// The errors found so far.
#[derive(Debug, Default)]
pub struct FieldErrors(Vec<FieldError>);

impl FieldErrors {
    /// Notes an error.
    pub fn add(&mut self, pointer: impl Into<String>, detail: impl Into<String>) {
        self.0.push(FieldError::new(pointer, detail));
    }

    /// A text without the white space around it, of `min` to `max` characters, none of them a control character other
    /// than, where `lines` are allowed, a line's end or a tab.
    pub fn text(&mut self, pointer: &str, text: &str, (min, max): (usize, usize), lines: bool) -> String {
        let text = text.trim();
        let chars = text.chars().count();
        if !(min..=max).contains(&chars) {
            self.add(pointer, format!("found {chars} characters, expected {min} to {max}"));
        }
        let forbidden = |c: &char| c.is_control() && !(lines && matches!(c, '\n' | '\r' | '\t'));
        if let Some(found) = text.chars().find(forbidden) {
            self.add(pointer, format!("found the control character {found:?}, expected none"));
        }
        text.to_owned()
    }

    /// A number in a range, in a unit that is told with it.
    pub fn number(&mut self, pointer: &str, found: f64, range: RangeInclusive<f64>, unit: &str) {
        if !range.contains(&found) {
            self.add(pointer, format!("found {found:?}, expected {} to {}{unit}", range.start(), range.end()));
        }
    }

    /// Whether none was found so far.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The value that was checked.
    ///
    /// # Errors
    /// [`ApiError::Invalid`] with every one that was noted.
    pub fn pass<T>(self, value: T) -> ApiResult<T> {
        if self.0.is_empty() { Ok(value) } else { Err(ApiError::Invalid(self.0)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(text: &str, lines: bool) -> usize {
        let mut errors = FieldErrors::default();
        errors.text("/x", text, (1, 5), lines);
        errors.0.len()
    }

    #[test]
    fn texts_are_measured_in_characters_without_the_space_around_them() {
        assert_eq!(errors("  ééééé ", false), 0);
        assert_eq!(errors("éééééé", false), 1);
        assert_eq!(errors("   ", false), 1);
    }

    #[test]
    fn control_characters_are_refused_and_lines_only_where_they_belong() {
        assert_eq!(errors("a\u{7}b", true), 1);
        assert_eq!(errors("a\nb", false), 1);
        assert_eq!(errors("a\nb", true), 0);
    }
}
