//! Content negotiation: which of the forms that an answer can take the request prefers (RFC 9110, section 12.5.1).

use axum::http::HeaderMap;
use axum::http::header::ACCEPT;

use crate::http::error::ApiError;

/// The form of the answer that `Accept` prefers; ties go to the one named first in `forms`, as does no `Accept` at all.
///
/// # Errors
/// [`ApiError::NotAcceptable`] when it accepts none of them.
pub fn negotiate<T: Copy>(headers: &HeaderMap, forms: &[(&str, T)]) -> Result<T, ApiError> {
    let values: Vec<_> =
        headers.get_all(ACCEPT).iter().map(|value| String::from_utf8_lossy(value.as_bytes())).collect();
    let accept = if values.is_empty() { "*/*".to_owned() } else { values.join(",") };
    let mut best: Option<(f64, T)> = None;
    for &(media_type, form) in forms {
        let quality = quality(&accept, media_type);
        if quality > best.map_or(0.0, |(best, _)| best) {
            best = Some((quality, form));
        }
    }
    best.map(|(_, form)| form).ok_or_else(|| ApiError::NotAcceptable {
        found: accept,
        expected: forms.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", "),
    })
}

/// The quality, 0 to 1, that the most specific matching range of an `Accept` gives to a media type.
fn quality(accept: &str, media_type: &str) -> f64 {
    let main = media_type.split('/').next().unwrap_or_default();
    let mut best = (0, 0.0);
    for range in accept.split(',') {
        let mut parts = range.split(';').map(str::trim);
        let name = parts.next().unwrap_or_default();
        let specificity = match name.split_once('/') {
            Some(("*", "*")) => 1,
            Some((first, "*")) if first.eq_ignore_ascii_case(main) => 2,
            _ if name.eq_ignore_ascii_case(media_type) => 3,
            _ => continue,
        };
        let quality = parts
            .filter_map(|part| part.split_once('='))
            .find(|(name, _)| name.trim().eq_ignore_ascii_case("q"))
            .map_or(1.0, |(_, value)| value.trim().parse::<f64>().unwrap_or(0.0).clamp(0.0, 1.0));
        if specificity > best.0 {
            best = (specificity, quality);
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    const FORMS: [(&str, char); 2] = [("text/csv", 'c'), ("application/json", 'j')];

    fn chosen(accept: &str) -> Option<char> {
        negotiate(&HeaderMap::from_iter([(ACCEPT, accept.parse().unwrap())]), &FORMS).ok()
    }

    #[test]
    fn the_preferred_form_is_chosen() {
        for (accept, form) in [
            ("application/json", Some('j')),
            ("*/*", Some('c')),
            ("text/*", Some('c')),
            ("text/csv;q=0.5, application/json", Some('j')),
            ("application/json;q=0.9, */*;q=0.1", Some('j')),
            ("text/csv;q=0, */*", Some('j')),
            ("TEXT/CSV; charset=utf-8", Some('c')),
            ("text/html", None),
            ("text/csv;q=0", None),
            ("", None),
        ] {
            assert_eq!(chosen(accept), form, "{accept}");
        }
    }

    #[test]
    fn without_accept_the_first_form_is_chosen() {
        assert_eq!(negotiate(&HeaderMap::new(), &FORMS).unwrap(), 'c');
    }
}
