//! Backlash: free play between two coupled parts; the driven one moves only when a flank pushes it.
//!
//! Source: section 3.2.5; between jack and surface in section 4.1.4, and the same play is the threshold of section 3.2.2.
//! Signs: the output follows the input, behind it by half the width.
//! Range: any width from zero, where the output is the input.
//! Limits: the flanks are rigid, the driven part has no inertia.

/// The driven part's position, given where it was, for a total play of `width`.
#[inline(always)]
#[must_use]
pub fn step(width: f64, output: f64, input: f64) -> f64 {
    if width == 0.0 {
        return input;
    }
    let half = 0.5 * width;
    output.max(input - half).min(input + half)
}

#[cfg(test)]
mod tests {
    use super::step;

    #[test]
    fn validate_section_3_2_5_the_output_waits_for_the_whole_play_after_a_reversal() {
        let mut output = step(0.2, 0.0, 1.0);
        assert_eq!(output, 0.9);
        for input in [0.95, 0.9, 0.81] {
            output = step(0.2, output, input);
            assert_eq!(output, 0.9, "inside the play at {input}");
        }
        assert_eq!(step(0.2, output, 0.7), 0.7 + 0.1);
    }

    #[test]
    fn without_play_the_output_is_the_input() {
        assert_eq!(step(0.0, 5.0, -0.3), -0.3);
    }
}
