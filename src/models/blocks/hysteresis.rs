//! Magnetic hysteresis: the current that acts lags behind the one asked for, by the same amount on the way up and down.
//!
//! Source: sections 3.2.3 and 4.1.1, figure 4.4.
//! Signs: a rising signal is lowered by His, a falling one raised.
//! Range: any width from zero.
//! Limits: no minor loops: a reversal shifts the signal at once.

/// What the block remembers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// The signal of the step before, A.
    pub signal_a: f64,
    /// Its direction: 1 rising, -1 falling, 0 before it first moved.
    pub direction: f64,
}

/// The state with this signal and the signal after the hysteresis, A.
#[inline(always)]
#[must_use]
pub fn step(width_a: f64, s: &State, signal_a: f64) -> (State, f64) {
    let direction = if signal_a > s.signal_a {
        1.0
    } else if signal_a < s.signal_a {
        -1.0
    } else {
        s.direction
    };
    (State { signal_a, direction }, signal_a - width_a * direction)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn validate_section_4_1_1_a_rising_signal_is_lowered_and_a_falling_one_raised() {
        let mut s = State::default();
        let mut pass = |signal_a: f64| {
            let (after, passed_a) = step(0.5, &s, signal_a);
            s = after;
            passed_a
        };
        assert_eq!([0.0, 1.0, 1.0, 2.0, 1.0, 1.0].map(&mut pass), [0.0, 0.5, 0.5, 1.5, 1.5, 1.5]);
    }
}
