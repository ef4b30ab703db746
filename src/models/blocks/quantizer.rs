//! A quantizer: a value as a converter with a finite step sees it.
//!
//! Source: section 4.1.4: the jack's position as it is acquired.
//! Signs: the output has the input's sign or is zero.
//! Range: any step from zero; the value passes unchanged at zero and where the step is finer than its own digits.
//! Limits: no saturation; halves are rounded away from zero.

/// From this many steps on a value has no digits finer than the step.
const STEPS_MAX: f64 = 1.0 / f64::EPSILON;

/// The multiple of `step` that is nearest to `value`.
#[inline(always)]
#[must_use]
pub fn quantize(step: f64, value: f64) -> f64 {
    if step == 0.0 {
        return value;
    }
    let steps = (value / step).round();
    if steps.abs() < STEPS_MAX { steps * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::quantize;

    #[test]
    fn a_value_is_never_moved_by_more_than_half_a_step() {
        for value in [-0.31, -0.05, 0.0, 0.049, 0.051, 7.77] {
            assert!((quantize(0.1, value) - value).abs() <= 0.05 + 1e-12);
        }
        assert_eq!(quantize(0.5, 0.8), 1.0);
        assert_eq!(quantize(0.0, 0.123), 0.123);
        assert_eq!(quantize(0.0, 0.0), 0.0);
        assert_eq!(quantize(f64::MIN_POSITIVE, 0.123), 0.123, "a step below the value's last digit");
    }
}
