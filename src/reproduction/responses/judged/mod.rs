//! What chapters 5 to 7 say of the responses, judged.

mod both_models;
mod demagnetisation;
mod friction;

use super::{OVER_FDJ, OVER_KGM, QUANTITIES, Quantity, RAMP, REFERENCE, Responses, SINE, STEADY_S, STEP};
use crate::models::trace::Trace;
use crate::reproduction::claims::{Claim, change_percent, falls, grows, listed, swing};

/// The responses of one model to the step, the ramp and the sine as one fault grows.
struct Family<'a> {
    step: [&'a Trace; 5],
    ramp: [&'a Trace; 5],
    sine: [&'a Trace; 5],
}

/// The largest change of a quantity, %, that is not called visible (chosen).
const VISIBLE_PERCENT: f64 = 10.0;
/// The part of a step or of a velocity that counts as reached.
const REACHED: f64 = 0.9;
/// When the jack is at its full velocity after the step, s.
const FULL_TRAVEL_S: (f64, f64) = (0.1, 0.2);
/// While the step's transient lasts, and the ramp's, s.
const TRANSIENT_S: (f64, f64) = (0.0, 0.5);

/// Every statement, in the order of the thesis; the area is the jack's.
pub fn claims(responses: &Responses, area_m2: f64) -> Vec<Claim> {
    let family = |over| {
        let [step, ramp, sine] = [STEP, RAMP, SINE].map(|command| responses.family(command, REFERENCE, over));
        Family { step, ramp, sine }
    };
    let mut claims = both_models::alike(responses).to_vec();
    claims.extend(demagnetisation::claims(&family(OVER_KGM)));
    claims.extend(friction::claims(&family(OVER_FDJ), area_m2));
    claims.extend(both_models::beside(responses));
    claims
}

/// Whether a quantity has a visible trend: it goes one way from level to level, and far enough.
fn trend(values: &[f64; 5]) -> bool {
    (grows(values) || falls(values)) && change_percent(values).abs() > VISIBLE_PERCENT
}

fn over(family: &[&Trace; 5], measure: impl Fn(&Trace) -> f64) -> [f64; 5] {
    family.map(measure)
}

/// The amplitudes of a family on the sine, in the order of the quantities.
fn amplitudes(sine: &[&Trace; 5]) -> [[f64; 5]; 5] {
    QUANTITIES.each_ref().map(|q| over(sine, |trace| q.factor * 0.5 * swing(trace, q.channel, STEADY_S[SINE])))
}

fn told_amplitude(at: usize, of: &[[f64; 5]; 5]) -> String {
    let Quantity { symbol, unit, .. } = &QUANTITIES[at];
    format!("{symbol} {} {unit} ({:+.1} %)", listed(&of[at], 3), change_percent(&of[at]))
}
