//! What section 6.2 says of friction.

use super::{Family, REACHED, TRANSIENT_S, amplitudes, over, told_amplitude, trend};
use crate::models::trace::{Channel, Trace};
use crate::reproduction::claims::{
    Claim, change_percent, first_above, grows, listed, mean, mean_magnitude, peak, swing,
};
use crate::reproduction::responses::{FDJ_LEVELS_N, RAMP, STEADY_S, STEP};

/// The statements of section 6.2; the area is the jack's.
pub fn claims(family: &Family<'_>, area_m2: f64) -> [Claim; 4] {
    let Family { step, ramp, sine } = family;
    [step_over_fdj(step), ramp_over_fdj(ramp, area_m2), sine_over_fdj(sine), pressure_of_the_step(step, ramp, sine)]
}

/// The steady pressure at every level, kPa.
pub fn steady_pressure_kpa(family: &[&Trace; 5], command: usize) -> [f64; 5] {
    over(family, |trace| mean(trace, Channel::LoadPressure, STEADY_S[command]) * 1e-3)
}

fn step_over_fdj(step: &[&Trace; 5]) -> Claim {
    let pressure_kpa = steady_pressure_kpa(step, STEP);
    let others = [
        over(step, |trace| first_above(trace, Channel::JackPosition, REACHED * 0.1)),
        over(step, |trace| peak(trace, Channel::JackVelocity)),
        over(step, |trace| peak(trace, Channel::SpoolPosition)),
        over(step, |trace| mean_magnitude(trace, Channel::ServovalveCurrent, TRANSIENT_S)),
    ];
    let steady = [Channel::ServovalveCurrent, Channel::SpoolPosition, Channel::JackVelocity]
        .map(|channel| over(step, |trace| mean(trace, channel, STEADY_S[STEP])));
    Claim {
        section: "6.2.1",
        thesis: "Only P12 shows a trend: after an oscillating transient its steady value grows with the friction",
        ours: format!(
            "Steady P12: {} kPa, {:+.0} %. From 200 to 1000 N the time to 90 %, the peaks of DXJ and XS and the mean current change by \
             {} %; the peaks of DXJ, {} m/s, do not go one way. 1.1 s after the step Cor, XS and DXJ change by {} %.",
            listed(&pressure_kpa, 2),
            change_percent(&pressure_kpa),
            listed(&others.map(|values| change_percent(&values)), 1),
            listed(&others[1], 3),
            listed(&steady.map(|values| change_percent(&values)), 1)
        ),
        agrees: trend(&pressure_kpa) && !others.iter().chain(&steady).any(trend),
        why: Some(
            "1.1 s after the step the jack creeps, against more friction from a larger error; next to the change of P12 that is little",
        ),
    }
}

fn ramp_over_fdj(ramp: &[&Trace; 5], area_m2: f64) -> Claim {
    let pressure_kpa = steady_pressure_kpa(ramp, RAMP);
    let swing_mpa = over(ramp, |trace| swing(trace, Channel::LoadPressure, STEADY_S[RAMP]) * 1e-6);
    let beyond_n: [f64; 5] = std::array::from_fn(|at| pressure_kpa[at] * 1e3 * area_m2 - FDJ_LEVELS_N[at]);
    Claim {
        section: "6.2.2",
        thesis: "No physical quantity can be useful as a prognostic parameter",
        ours: format!(
            "P12 at the end of the ramp: {} kPa, {:+.0} % from 200 to 1000 N. Times the jack's area it is FDJ and {} N. \
             Around that mean it swings by {} MPa.",
            listed(&pressure_kpa, 2),
            change_percent(&pressure_kpa),
            listed(&beyond_n, 1),
            listed(&swing_mpa, 3)
        ),
        agrees: !trend(&pressure_kpa),
        why: Some(
            "The jack moves against its friction all along the ramp, and only P12 can push it: by the thesis's own equations P12 \
             times the area is FDJ, and what the damping takes. Where the jack sticks and slips, a mean over the swings shows it",
        ),
    }
}

fn sine_over_fdj(sine: &[&Trace; 5]) -> Claim {
    let of = amplitudes(sine);
    let told = (0..5).map(|at| told_amplitude(at, &of)).collect::<Vec<_>>().join("; ");
    Claim {
        section: "6.2.3",
        thesis: "No quantity varies markedly",
        ours: format!("Amplitudes from 200 to 1000 N: {told}."),
        agrees: !of.iter().any(trend),
        why: Some(
            "The jack moves against its friction on the sine too, so the amplitude of P12 holds FDJ over the area",
        ),
    }
}

fn pressure_of_the_step(step: &[&Trace; 5], ramp: &[&Trace; 5], sine: &[&Trace; 5]) -> Claim {
    let on_step = steady_pressure_kpa(step, STEP);
    let (of_step, of_ramp) = (change_percent(&on_step), change_percent(&steady_pressure_kpa(ramp, RAMP)));
    let of_sine = change_percent(&amplitudes(sine)[2]);
    Claim {
        section: "6.2.4",
        thesis: "The step is the command, and its steady pressure the quantity, that shows friction best",
        ours: format!(
            "From 200 to 1000 N the steady P12 of the step changes by {of_step:+.1} %, that of the ramp by {of_ramp:+.1} %, its \
             amplitude on the sine by {of_sine:+.1} %."
        ),
        agrees: grows(&on_step) && of_step > of_ramp.abs() && of_step > of_sine.abs(),
        why: None,
    }
}
