//! Faults beside demagnetisation and friction, as the monitoring model has them: a worn sleeve, a clogged filter, play in the
//! feedback spring, an offset of the current.
//!
//! Source: the reference model's blocks of sections 4.1.1 to 4.1.3, each made as cheap as this model; the sleeve is a fit to the
//! reference model's characteristic curves (docs/blocks.md).
//! Signs: a worn spool moves further for the same pressure and flow, in either direction.
//! Range: extra clearance 0 to 1e-4 m; clogging 0 to below 1.
//! Limits: rough, to a tenth of the effect: an estimate takes the rest from the reference model (docs/estimation.md).

use serde::{Deserialize, Serialize};

use crate::models::checks::Checks;
use crate::models::fault::Faults;
use crate::numeric::lane::{Lane, Lanes};

/// How the sleeve's wear acts, fitted to the reference model.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Params {
    /// How much further the spool must open per extra clearance once that is large, dimensionless.
    pub shift_per_clearance: f64,
    /// The extra clearance at which half of that is reached, m.
    pub shift_half_m: f64,
    /// The extra clearance at which the pressure gain at the null falls to 1/2 to the power of the exponent, m.
    pub gain_clearance_m: f64,
    /// The power with which the pressure gain at the null falls, dimensionless.
    pub gain_exponent: f64,
}

impl Params {
    pub(crate) fn check(&self, checks: &mut Checks) {
        checks.within("monitoring.wear.shift_per_clearance", self.shift_per_clearance, 0.0, 10.0, "");
        checks.within("monitoring.wear.shift_half_m", self.shift_half_m, 1e-7, 1e-3, "m");
        checks.within("monitoring.wear.gain_clearance_m", self.gain_clearance_m, 1e-7, 1e-3, "m");
        checks.within("monitoring.wear.gain_exponent", self.gain_exponent, 0.1, 5.0, "");
    }
}

/// What a candidate's wear does to the model. Nothing for `()`, at no cost.
pub trait Wear<L: Lane>: Copy {
    /// The current that flows where the controller asks for one, before the limit, A.
    fn offset(&self, asked_a: L) -> L;

    /// The part of the spool's position that the feedback spring does not feel, m; `None` where it feels all.
    fn slack(&self, spool_m: L) -> Option<L>;

    /// The spool's position after a step that would have led to `moved_m`, m.
    fn slowed(&self, spool_m: L, moved_m: L) -> L;

    /// The position at which a tight spool would meter the same, m.
    fn metered(&self, spool_m: L) -> L;
}

impl<L: Lane> Wear<L> for () {
    #[inline(always)]
    fn offset(&self, asked_a: L) -> L {
        asked_a
    }

    #[inline(always)]
    fn slack(&self, _: L) -> Option<L> {
        None
    }

    #[inline(always)]
    fn slowed(&self, _: L, moved_m: L) -> L {
        moved_m
    }

    #[inline(always)]
    fn metered(&self, spool_m: L) -> L {
        spool_m
    }
}

/// The wear of one candidate, or of several.
#[derive(Debug, Clone, Copy)]
pub struct Worn<L> {
    current_offset_a: L,
    /// Half the play of the feedback spring, m.
    half_play_m: L,
    /// The spool's speed over a clean filter's.
    speed: L,
    /// How much further a wide open spool must go, m.
    shift_m: L,
    /// The opening at which half of that is reached, m.
    spread_m: L,
}

impl<L: Lanes> Worn<L> {
    /// The wear of as many candidates as there are faults.
    ///
    /// # Panics
    /// Without faults.
    #[inline(always)]
    pub fn load(token: L::Token, p: &Params, faults: &[Faults]) -> Self {
        let column = |of: fn(&Params, &Faults) -> f64| {
            let values: Vec<f64> = faults.iter().map(|faults| of(p, faults)).collect();
            L::load(token, &values)
        };
        Self {
            current_offset_a: column(|_, faults| faults.current_offset_a),
            half_play_m: column(|_, faults| 0.5 * faults.feedback_backlash_m),
            // GPF falls with (1 - Kintas), the resistance with its root (section 4.1.2).
            speed: column(|_, faults| (1.0 - faults.clogging).max(0.0).sqrt()),
            shift_m: column(|p, faults| shift_m(p, faults.clearance_m)),
            spread_m: column(|p, faults| spread_m(p, faults.clearance_m)),
        }
    }
}

fn shift_m(p: &Params, clearance_m: f64) -> f64 {
    p.shift_per_clearance * clearance_m * clearance_m / (clearance_m + p.shift_half_m)
}

/// At the null the spool meters as a tight one at a part of its position; that part is the fall of the pressure gain.
fn spread_m(p: &Params, clearance_m: f64) -> f64 {
    let gain = (1.0 + clearance_m / p.gain_clearance_m).powf(-p.gain_exponent);
    let shift_m = shift_m(p, clearance_m);
    if shift_m > 0.0 { shift_m / (1.0 - gain) } else { 1.0 }
}

impl<L: Lane> Wear<L> for Worn<L> {
    #[inline(always)]
    fn offset(&self, asked_a: L) -> L {
        asked_a + self.current_offset_a
    }

    #[inline(always)]
    fn slack(&self, spool_m: L) -> Option<L> {
        Some(spool_m.clip(self.half_play_m))
    }

    #[inline(always)]
    fn slowed(&self, spool_m: L, moved_m: L) -> L {
        spool_m + (moved_m - spool_m) * self.speed
    }

    #[inline(always)]
    fn metered(&self, spool_m: L) -> L {
        spool_m - self.shift_m * spool_m / (spool_m.abs() + self.spread_m)
    }
}
