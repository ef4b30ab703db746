//! The collected faults of a file, and how foreign text is shown in them.

use super::FormatError;

/// The most faults of one file that are told one by one.
const FAULTS_MAX: usize = 20;
/// The most characters of foreign text that a fault shows.
const SHOWN_MAX: usize = 60;

/// The faults found so far. The first [`FAULTS_MAX`] are kept, the rest are counted.
#[derive(Debug, Default)]
pub(super) struct FormatErrors {
    kept: Vec<FormatError>,
    more: usize,
}

impl FormatErrors {
    /// Adds a fault. `detail` is only asked for when the fault is kept.
    pub(super) fn add(&mut self, place: impl FnOnce() -> String, detail: impl FnOnce() -> String) {
        if self.kept.len() < FAULTS_MAX {
            self.kept.push(FormatError { place: place(), detail: detail() });
        } else {
            self.more += 1;
        }
    }

    /// Adds the faults of a part of the file, whose places continue the part's own.
    pub(super) fn add_part(&mut self, part_place: &str, part: Self) {
        self.more += part.more;
        for error in part.kept {
            self.add(|| format!("{part_place}{}", error.place), || error.detail);
        }
    }

    /// Every fault that was kept, and a last note that counts the others.
    pub(super) fn into_errors(mut self) -> Vec<FormatError> {
        if self.more > 0 {
            self.kept.push(FormatError { place: "file".into(), detail: format!("{} more errors", self.more) });
        }
        self.kept
    }

    /// `Ok` when nothing was found.
    pub(super) fn into_result(self) -> Result<(), Vec<FormatError>> {
        if self.kept.is_empty() { Ok(()) } else { Err(self.into_errors()) }
    }
}

/// A single fault that ends the reading.
pub(super) fn only(place: impl Into<String>, detail: impl Into<String>) -> Vec<FormatError> {
    vec![FormatError { place: place.into(), detail: detail.into() }]
}

/// Foreign text on one line and of a bearable length.
pub(super) fn clip(text: &str) -> String {
    let mut clipped: String =
        text.chars().take(SHOWN_MAX).map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect();
    if text.chars().nth(SHOWN_MAX).is_some() {
        clipped.push('…');
    }
    clipped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_faults_are_told_and_the_others_are_counted() {
        let mut part = FormatErrors::default();
        (0..25).for_each(|i| part.add(|| format!("/{i}"), || "found nothing".into()));
        let mut faults = FormatErrors::default();
        faults.add(|| "file".into(), || "found nothing".into());
        faults.add_part("/columns/time_s", part);
        let errors = faults.into_result().unwrap_err();
        assert_eq!(errors.len(), FAULTS_MAX + 1);
        assert_eq!(errors[1].place, "/columns/time_s/0");
        assert_eq!(errors[FAULTS_MAX].detail, "6 more errors");
    }

    #[test]
    fn long_text_and_line_breaks_are_not_repeated_in_an_error() {
        assert_eq!(clip("a\nb"), "a\u{fffd}b");
        assert_eq!(clip(&"µ".repeat(1000)).chars().count(), SHOWN_MAX + 1);
    }
}
