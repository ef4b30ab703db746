//! Numbers as text files hold them.

use super::errors::clip;
use crate::units::prefix_exponent;

/// Reads a number with a decimal point. Spaces and quotation marks around it and an SI prefix after it (`25.1m`, `-3k`)
/// are accepted; the prefix moves the decimal point exactly.
///
/// # Errors
/// What was found and what was expected, when the text is empty, no number, or not finite.
pub(super) fn parse(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().or_else(|| {
        let text = bare(text);
        text.parse().ok().or_else(|| with_prefix(text))
    });
    match found {
        Some(value) if f64::is_finite(value) => Ok(value),
        Some(_) => Err(format!("found \"{}\", expected a finite number", clip(bare(text)))),
        None if bare(text).is_empty() => Err("found nothing, expected a number".into()),
        None => Err(format!("found \"{}\", expected a number such as -0.5, 1e-3 or 25.1m", clip(bare(text)))),
    }
}

/// Text without the spaces, and then the pair of quotation marks, around it.
pub(super) fn bare(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')).map_or(text, str::trim)
}

fn with_prefix(text: &str) -> Option<f64> {
    let prefix = text.chars().next_back()?;
    let exponent = prefix_exponent(prefix)?;
    let digits = &text[..text.len() - prefix.len_utf8()];
    format!("{digits}e{exponent}").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prefixes_give_the_same_bits_as_the_number_written_out() {
        for (text, expected) in [
            ("25.1m", 25.1e-3),
            ("-3k", -3e3),
            ("+.5u", 0.5e-6),
            ("7µ", 7e-6),
            ("7μ", 7e-6),
            ("1y", 1e-24),
            ("1.5z", 1.5e-21),
            ("2a", 2e-18),
            ("2f", 2e-15),
            ("3.3p", 3.3e-12),
            ("4n", 4e-9),
            ("21M", 21e6),
            ("0.3G", 0.3e9),
            ("1T", 1e12),
            ("1P", 1e15),
            ("5E", 5e18),
            ("1Z", 1e21),
            ("6.02Y", 6.02e24),
            (" 1e3 ", 1e3),
            (" \" 2.5m\" ", 2.5e-3),
            ("1E5", 1e5),
        ] {
            assert_eq!(parse(text).unwrap().to_bits(), f64::to_bits(expected), "{text}");
        }
    }

    #[test]
    fn what_is_not_finite_is_refused_with_the_text_that_was_found() {
        for text in ["nan", "NaN", "inf", "-Infinity", "1e999", "-1e999"] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(text) && error.contains("finite"), "{error}");
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in ["abc", "0,5", "m", "1mm", "1 m", "1e3m", "infm", "nanm", "--1", "0x10", "1µµ", "\"", "1_000"] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(&format!("\"{text}\"")) && error.contains("expected a number"), "{error}");
        }
        for text in ["", "  ", "\"\""] {
            assert_eq!(parse(text).unwrap_err(), "found nothing, expected a number");
        }
    }
}
