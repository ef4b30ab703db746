//! The address of a webhook.

use url::Url;

/// The most characters of an address.
pub const URL_CHARS_MAX: usize = 2048;

/// The address that a text names, in its normal form: http or https, with a host, without credentials and fragment. It may be
/// of a private network: the service runs inside one.
///
/// # Errors
/// What is wrong with it: what was found, and what was expected. Credentials are not repeated.
pub fn parse(text: &str) -> Result<String, String> {
    let chars = text.chars().count();
    if !(1..=URL_CHARS_MAX).contains(&chars) {
        return Err(format!("found {chars} characters, expected 1 to {URL_CHARS_MAX}"));
    }
    if text.chars().any(|c| c.is_whitespace() || c.is_control()) {
        return Err("found white space or a control character, expected none".into());
    }
    let url = Url::parse(text).map_err(|error| format!("{error}, expected an http or https URL"))?;
    if !matches!(url.scheme(), "http" | "https") {
        return Err(format!("found the scheme {:?}, expected http or https", url.scheme()));
    }
    if url.host_str().is_none_or(str::is_empty) {
        return Err("found no host, expected one".into());
    }
    if !url.username().is_empty() || url.password().is_some() {
        return Err("found a user name or a password, expected none: deliveries are signed instead".into());
    }
    if url.fragment().is_some() {
        return Err("found a fragment, expected none: it would not be sent".into());
    }
    let normal = url.to_string();
    match normal.len() {
        0..=URL_CHARS_MAX => Ok(normal),
        long => Err(format!("found {long} characters once it is encoded, expected at most {URL_CHARS_MAX}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_of_http_are_taken_private_ones_too() {
        for (text, normal) in [
            ("https://example.com/hooks?a=b", "https://example.com/hooks?a=b"),
            ("HTTP://10.1.2.3:8080", "http://10.1.2.3:8080/"),
            ("http://[::1]:9/x", "http://[::1]:9/x"),
            ("http://localhost/", "http://localhost/"),
        ] {
            assert_eq!(parse(text).as_deref(), Ok(normal));
        }
    }

    #[test]
    fn what_nothing_can_be_posted_to_is_refused_with_the_reason() {
        let long = format!("http://a/{}", "x".repeat(URL_CHARS_MAX));
        let encoded = format!("http://a/{}", "é".repeat(1000));
        for (text, reason) in [
            ("", "0 characters"),
            ("example.com", "expected an http or https URL"),
            ("ftp://example.com", "scheme \"ftp\""),
            ("file:///etc/passwd", "scheme \"file\""),
            ("http://", "expected an http or https URL"),
            ("http://user@example.com", "user name"),
            ("http://:secret@example.com", "password"),
            ("http://example.com/#x", "fragment"),
            ("http://exa mple.com", "white space"),
            ("http://example.com/\n", "white space"),
            ("http://example.com:99999", "port"),
            (&long, "2057 characters"),
            (&encoded, "once it is encoded"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(reason), "{text}: {error}");
            assert!(!error.contains("secret"), "{error}");
        }
    }
}
