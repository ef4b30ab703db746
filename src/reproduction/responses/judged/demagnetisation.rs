//! What section 6.1 says of demagnetisation.

use super::{FULL_TRAVEL_S, Family, REACHED, TRANSIENT_S, VISIBLE_PERCENT, amplitudes, over, told_amplitude, trend};
use crate::models::trace::{Channel, Trace};
use crate::reproduction::claims::{
    Claim, change_percent, falls, first_above, grows, last_above, listed, mean, mean_magnitude, swing,
};
use crate::reproduction::responses::{RAMP, STEADY_S, STEP};

/// The statements of section 6.1.
pub fn claims(family: &Family<'_>) -> Vec<Claim> {
    let Family { step, ramp, sine } = family;
    let mut claims = step_over_kgm(step, ramp).to_vec();
    claims.extend(ramp_over_kgm(ramp));
    claims.extend(sine_over_kgm(sine));
    claims.push(current_of_the_ramp(step, ramp, sine));
    claims
}

fn step_over_kgm(step: &[&Trace; 5], ramp: &[&Trace; 5]) -> [Claim; 3] {
    let reached_s = over(step, |trace| first_above(trace, Channel::JackPosition, REACHED * 0.1));
    let mean_over = |channel, factor: f64| over(step, |trace| mean_magnitude(trace, channel, TRANSIENT_S) * factor);
    let velocity = mean_over(Channel::JackVelocity, 1.0);
    let spool_mm = mean_over(Channel::SpoolPosition, 1e3);
    let current_ma = mean_over(Channel::ServovalveCurrent, 1e3);
    let fallen_s = |channel, part| over(step, |trace| fallen_s(trace, channel, part));
    let (current_s, pressure_s) =
        (fallen_s(Channel::ServovalveCurrent, REACHED), fallen_s(Channel::LoadPressure, REACHED));
    let half_s = fallen_s(Channel::LoadPressure, 0.5);
    let of_ramp = change_percent(&over(ramp, |trace| mean(trace, Channel::ServovalveCurrent, STEADY_S[RAMP])));
    let all = [reached_s, velocity, spool_mm, current_ma, pressure_s];
    let changes = all.map(|values| change_percent(&values));
    [
        Claim {
            section: "6.1.1",
            thesis: "Demagnetisation makes the system slower: DXJ, XJ and XS",
            ours: format!(
                "From KGM 0 to 0.4, 90 % of the step is reached after {} s; over the first 0.5 s DXJ is {} m/s and XS {} mm in the \
                 mean. Their peaks are the same, for at every level the spool reaches its stop.",
                listed(&reached_s, 3),
                listed(&velocity, 4),
                listed(&spool_mm, 3)
            ),
            agrees: grows(&reached_s) && falls(&velocity) && falls(&spool_mm),
            why: None,
        },
        Claim {
            section: "6.1.1",
            thesis: "The servovalve consumes more current, and P12 and Cor are delayed in the transient",
            ours: format!(
                "Mean current of the first 0.5 s: {} mA; 90 % of the way from full travel to the steady value is passed by Cor \
                 after {} s and by P12 after {} s (half of it by P12 after {} s: it leaves full travel sooner, and settles later).",
                listed(&current_ma, 2),
                listed(&current_s, 3),
                listed(&pressure_s, 3),
                listed(&half_s, 3)
            ),
            agrees: grows(&current_ma) && grows(&current_s) && grows(&pressure_s) && grows(&half_s),
            why: Some(
                "A weaker motor closes the valve more slowly, but from an error at which a stronger one would still keep it open: P12 \
                 begins to fall sooner and ends later",
            ),
        },
        Claim {
            section: "6.1.1",
            thesis: "There is a trend in all quantities, of little use for prognosis",
            ours: format!(
                "From KGM 0 to 0.4 the time to 90 %, the means of DXJ and XS, the mean current and the time of P12 change by {} %, \
                 the steady current of a ramp by {of_ramp:.1} %.",
                listed(&changes, 1)
            ),
            agrees: all.iter().all(|values| grows(values) || falls(values))
                && changes.iter().all(|change| change.abs() < of_ramp),
            why: None,
        },
    ]
}

/// When a response to the step has come a part of the way from what it is at full travel to what it settles at, s.
fn fallen_s(trace: &Trace, channel: Channel, part: f64) -> f64 {
    let (full, steady) = (mean(trace, channel, FULL_TRAVEL_S), mean(trace, channel, STEADY_S[STEP]));
    last_above(trace, channel, full + part * (steady - full))
}

fn ramp_over_kgm(ramp: &[&Trace; 5]) -> [Claim; 4] {
    let lag_mm = over(ramp, |trace| {
        let command = mean(trace, Channel::PositionCommand, STEADY_S[RAMP]);
        (command - mean(trace, Channel::JackPosition, STEADY_S[RAMP])) * 1e3
    });
    let spool_s = over(ramp, |trace| {
        first_above(trace, Channel::SpoolPosition, REACHED * mean(trace, Channel::SpoolPosition, STEADY_S[RAMP]))
    });
    let jack_s = over(ramp, |trace| first_above(trace, Channel::JackVelocity, REACHED * 0.1));
    let steady = over(ramp, |trace| mean(trace, Channel::JackVelocity, STEADY_S[RAMP]));
    let swing_mpa = over(ramp, |trace| swing(trace, Channel::LoadPressure, TRANSIENT_S) * 1e-6);
    let current_ma = over(ramp, |trace| mean(trace, Channel::ServovalveCurrent, STEADY_S[RAMP]) * 1e3);
    let swing_change = change_percent(&swing_mpa);
    [
        Claim {
            section: "6.1.2",
            thesis: "The error between command and jack grows with KGM",
            ours: format!("{} mm at the end of the ramp.", listed(&lag_mm, 2)),
            agrees: grows(&lag_mm),
            why: None,
        },
        Claim {
            section: "6.1.2",
            thesis: "XS and DXJ show the same decrease of the system's velocity",
            ours: format!(
                "90 % of the steady spool position is reached after {} s and 90 % of the velocity after {} s; the steady velocity \
                 itself is {} m/s.",
                listed(&spool_s, 4),
                listed(&jack_s, 4),
                listed(&steady, 4)
            ),
            agrees: grows(&spool_s) && grows(&jack_s),
            why: None,
        },
        Claim {
            section: "6.1.2",
            thesis: "P12 shows only a little higher oscillation",
            ours: format!(
                "P12 swings by {} MPa in the first 0.5 s: {swing_change:+.1} % from KGM 0 to 0.4.",
                listed(&swing_mpa, 4)
            ),
            agrees: swing_change > 0.0 && swing_change < VISIBLE_PERCENT,
            why: None,
        },
        Claim {
            section: "6.1.2",
            thesis: "Cor grows visibly with KGM",
            ours: format!(
                "{} mA at the end of the ramp: {:+.1} %.",
                listed(&current_ma, 3),
                change_percent(&current_ma)
            ),
            agrees: grows(&current_ma) && change_percent(&current_ma) > VISIBLE_PERCENT,
            why: None,
        },
    ]
}

fn sine_over_kgm(sine: &[&Trace; 5]) -> [Claim; 2] {
    let of = amplitudes(sine);
    let unseen = |at: usize| !trend(&of[at]);
    let told = |which: &[usize]| which.iter().map(|&at| told_amplitude(at, &of)).collect::<Vec<_>>().join("; ");
    [
        Claim {
            section: "6.1.3",
            thesis: "Cor, DXJ and P12 show no visible trend",
            ours: format!("Amplitudes: {}.", told(&[0, 1, 2])),
            agrees: [0, 1, 2].into_iter().all(unseen),
            why: Some(
                "The current saturates at every level; with less torque behind it the spool and so the jack move less",
            ),
        },
        Claim {
            section: "6.1.3",
            thesis: "With almost the same current XS and XJ have a lower amplitude",
            ours: format!("Amplitudes: {}.", told(&[3, 4])),
            agrees: unseen(0) && falls(&of[3]) && falls(&of[4]),
            why: Some(
                "Against its largest current the spool reaches its stop at every level, so the jack gets the same flow; the thesis \
                 prints neither the stop nor the largest current, and with its own values less torque must end before the stop",
            ),
        },
    ]
}

fn current_of_the_ramp(step: &[&Trace; 5], ramp: &[&Trace; 5], sine: &[&Trace; 5]) -> Claim {
    let of = Channel::ServovalveCurrent;
    let on_ramp = over(ramp, |trace| mean(trace, of, STEADY_S[RAMP]));
    let on_step = change_percent(&over(step, |trace| mean_magnitude(trace, of, TRANSIENT_S)));
    let after_step = change_percent(&over(step, |trace| mean(trace, of, STEADY_S[STEP])));
    let on_sine = change_percent(&amplitudes(sine)[0]);
    let ramp = change_percent(&on_ramp);
    Claim {
        section: "6.1.4",
        thesis: "The ramp is the command, and its steady current the quantity, that shows demagnetisation best",
        ours: format!(
            "From KGM 0 to 0.4 the steady current of the ramp changes by {ramp:+.1} %, the mean current of the step's transient by \
             {on_step:+.1} %, the current 1.1 s after the step by {after_step:+.1} %, the current's amplitude on the sine by \
             {on_sine:+.1} %."
        ),
        agrees: grows(&on_ramp) && [on_step, after_step, on_sine].iter().all(|other| ramp > other.abs()),
        why: Some(
            "1.1 s after the step the jack still creeps, and a weaker motor leaves more of the error; but that current is a tenth of the \
             ramp's and smaller, and falls from moment to moment, where the ramp's is held",
        ),
    }
}
