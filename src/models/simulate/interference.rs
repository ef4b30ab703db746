//! Interference on the torque motor's current: band-limited white noise.
//!
//! Source: section 4.1.1, Simulink's block of that name: a normal draw of variance power / sample time, held for the sample time.
//! Signs: symmetrical about zero.
//! Range: any power from zero; a sample time below the time step counts as the time step.
//! Limits: the sample time is a whole number of time steps, the nearest.

use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::numeric::rng::Seed;

/// A source of interference.
pub(super) struct Interference {
    stream: Option<Xoshiro256PlusPlus>,
    deviation_a: f64,
    steps_per_draw: u64,
    step: u64,
    held_a: f64,
}

impl Interference {
    /// White noise of a power, mA² s; none where that is zero.
    pub fn new(power_ma2_s: f64, sample_time_s: f64, time_step_s: f64, seed: u64) -> Self {
        let steps_per_draw = (sample_time_s / time_step_s).round().max(1.0);
        Self {
            stream: (power_ma2_s > 0.0).then(|| Seed(seed).stream("current noise", 0)),
            deviation_a: (power_ma2_s / (steps_per_draw * time_step_s)).sqrt() * 1e-3,
            steps_per_draw: steps_per_draw as u64,
            step: 0,
            held_a: 0.0,
        }
    }

    /// Silence.
    pub fn none() -> Self {
        Self { stream: None, deviation_a: 0.0, steps_per_draw: 1, step: 0, held_a: 0.0 }
    }

    /// The current of the next time step, A.
    #[inline(always)]
    pub fn next(&mut self) -> f64 {
        if let Some(stream) = &mut self.stream {
            if self.step.is_multiple_of(self.steps_per_draw) {
                let draw: f64 = StandardNormal.sample(stream);
                self.held_a = draw * self.deviation_a;
            }
            self.step += 1;
        }
        self.held_a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draws(sample_time_s: f64, n: usize) -> Vec<f64> {
        let mut source = Interference::new(5e-6, sample_time_s, 1e-5, 3);
        (0..n).map(|_| source.next()).collect()
    }

    #[test]
    fn validate_section_4_1_1_the_variance_is_the_power_over_the_sample_time() {
        for (sample_time_s, steps) in [(0.0, 1), (1e-5, 1), (1e-3, 100)] {
            let drawn: Vec<f64> = draws(sample_time_s, 20_000 * steps).into_iter().step_by(steps).collect();
            let variance_ma2 = drawn.iter().map(|a| a * a * 1e6).sum::<f64>() / drawn.len() as f64;
            let expected = 5e-6 / (steps as f64 * 1e-5);
            // The variance of 20 000 draws is known to 1 %; three times that.
            assert!((variance_ma2 / expected - 1.0).abs() < 0.03, "{variance_ma2}, expected {expected}");
        }
    }

    #[test]
    fn a_draw_is_held_for_the_sample_time_and_silence_is_silent() {
        let held = draws(4e-5, 12);
        assert!(held.chunks(4).all(|part| part.iter().all(|a| *a == part[0])) && held[0] != held[4], "{held:?}");
        assert!(draws(4e-5, 4) == draws(4e-5, 4));
        assert_eq!(Interference::none().next(), 0.0);
        assert_eq!(Interference::new(0.0, 0.0, 1e-5, 1).next(), 0.0);
    }
}
