//! A dead zone: nothing passes until the input leaves it.
//!
//! Source: section 4.1.2, the play Kgioco between the feedback spring's ball and the spool.
//! Signs: the output has the input's sign.
//! Range: any width from zero, where the output is the input.
//! Limits: none.

/// What is left of the input beyond half the `width` to either side of zero.
#[inline(always)]
#[must_use]
pub fn step(width: f64, input: f64) -> f64 {
    if width == 0.0 {
        return input;
    }
    let half = 0.5 * width;
    input - input.max(-half).min(half)
}

#[cfg(test)]
mod tests {
    use super::step;

    #[test]
    fn passes_what_lies_beyond_half_the_width() {
        assert_eq!([0.0, 0.1, -0.1, 0.3, -0.5].map(|x| step(0.2, x)), [0.0, 0.0, 0.0, 0.3 - 0.1, -0.5 + 0.1]);
        assert_eq!(step(0.0, 0.3), 0.3);
    }
}
