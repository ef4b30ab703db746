//! How deliveries are signed: after the Standard Webhooks specification, <https://www.standardwebhooks.com>.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use hmac::{Hmac, KeyInit as _, Mac as _};
use sha2::Sha256;

use crate::store::webhooks::Secret;

/// The fewest and the most characters of a secret.
pub const SECRET_CHARS: (usize, usize) = (16, 256);
/// What a secret begins with whose rest is the key in base64.
const PREFIX: &str = "whsec_";
/// The bytes of a generated key.
const KEY_BYTES: usize = 32;

/// A new secret from the operating system's randomness.
///
/// # Errors
/// The operating system has no randomness.
pub fn generate() -> Result<Secret, getrandom::Error> {
    let mut key = [0; KEY_BYTES];
    getrandom::fill(&mut key)?;
    Ok(Secret::new(format!("{PREFIX}{}", STANDARD.encode(key))))
}

/// The secret that a client chose: 16 to 256 visible ASCII characters. After `whsec_` it is the key in base64, of at least as many
/// bytes; otherwise its characters are the key.
///
/// # Errors
/// What is wrong with it. The secret is not repeated.
pub fn parse(text: &str) -> Result<Secret, String> {
    let (min, max) = SECRET_CHARS;
    let chars = text.chars().count();
    if !(min..=max).contains(&chars) {
        return Err(format!("found {chars} characters, expected {min} to {max}"));
    }
    if !text.bytes().all(|byte| byte.is_ascii_graphic()) {
        return Err("found characters other than visible ASCII, expected none".into());
    }
    match text.strip_prefix(PREFIX).map(|rest| STANDARD.decode(rest)) {
        None => Ok(Secret::new(text)),
        Some(Ok(key)) if key.len() >= min => Ok(Secret::new(text)),
        Some(_) => Err(format!("found no base64 of {min} bytes or more after {PREFIX}, expected the key there")),
    }
}

/// The value of the header `webhook-signature`: `v1,` and the HMAC-SHA256 of `id.timestamp.body` in base64.
#[must_use]
pub fn sign(secret: &Secret, id: &str, timestamp_s: i64, body: &str) -> String {
    let mut mac = Hmac::<Sha256>::new_from_slice(&key(secret)).expect("a key may have any length");
    mac.update(format!("{id}.{timestamp_s}.{body}").as_bytes());
    format!("v1,{}", STANDARD.encode(mac.finalize().into_bytes()))
}

/// The key that a secret stands for.
fn key(secret: &Secret) -> Vec<u8> {
    let text = secret.reveal();
    let coded = text.strip_prefix(PREFIX).and_then(|rest| STANDARD.decode(rest).ok());
    coded.unwrap_or_else(|| text.as_bytes().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of the specification's reference libraries.
    #[test]
    fn validate_the_example_of_the_standard() {
        let secret = parse("whsec_MfKQ9r8GKYqrTwjUPD8ILPZIo2LaLaSw").unwrap();
        let signature = sign(&secret, "msg_p5jXN8AQM9LWM0D4loKWxJek", 1_614_265_330, r#"{"test": 2432232314}"#);
        assert_eq!(signature, "v1,g0hM9SsE+OTPJTGt/tmIKtSyZlE3uFJELVlNIOLJ1OE=");
    }

    #[test]
    fn a_secret_without_the_prefix_is_the_key_itself() {
        let one = sign(&Secret::new("0123456789abcdef"), "a", 1, "b");
        let coded = Secret::new(format!("whsec_{}", STANDARD.encode("0123456789abcdef")));
        assert_eq!(one, sign(&coded, "a", 1, "b"));
        assert_ne!(one, sign(&Secret::new("0123456789abcdeg"), "a", 1, "b"));
    }

    #[test]
    fn a_secret_is_long_enough_and_of_visible_characters_and_no_error_repeats_it() {
        assert!(parse(&"x".repeat(16)).is_ok() && parse(&"x".repeat(256)).is_ok());
        for wrong in ["xhort", "x with some spaces", "whsec_xxxxxxxxxxxxx!", "whsec_eHg=xxxxxxxx", &"x".repeat(257)] {
            let error = parse(wrong).unwrap_err();
            assert!(error.starts_with("found ") && !error.contains(wrong), "{error}");
        }
    }

    #[test]
    fn generated_secrets_differ_and_are_good_ones() {
        let (one, two) = (generate().unwrap(), generate().unwrap());
        assert_ne!(one, two);
        assert_eq!(key(&one).len(), KEY_BYTES);
        assert_eq!(parse(one.reveal()), Ok(one));
    }

    #[test]
    fn a_secret_is_not_shown_when_it_is_printed() {
        assert_eq!(format!("{:?}", Secret::new("hunter2")), "Secret(..)");
    }
}
