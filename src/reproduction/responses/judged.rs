//! What chapters 5 to 7 say of the responses, judged.

use super::{
    FDJ_LEVELS_N, MONITORING, OVER_FDJ, OVER_KGM, QUANTITIES, Quantity, RAMP, REFERENCE, Responses, SINE, STEADY_S,
    STEP,
};
use crate::models::trace::{Channel, Trace};
use crate::reproduction::claims::{
    Claim, apart, change_percent, falls, first_above, grows, last_above, listed, mean, mean_magnitude, peak, swing,
};

/// The largest change of a quantity, %, that is not called a visible trend.
const VISIBLE_PERCENT: f64 = 10.0;
/// The part of a step or of a velocity that counts as reached.
const REACHED: f64 = 0.9;
/// While the step's transient lasts, and the ramp's, s.
const TRANSIENT_S: (f64, f64) = (0.0, 0.5);

/// Every statement, in the order of the thesis.
pub fn claims(responses: &Responses) -> Vec<Claim> {
    let family = |command, over| responses.family(command, REFERENCE, over);
    let mut claims = models_alike(responses).to_vec();
    let [step, ramp, sine] = [STEP, RAMP, SINE].map(|command| family(command, OVER_KGM));
    claims.extend(step_over_kgm(&step, &ramp));
    claims.extend(ramp_over_kgm(&ramp));
    claims.extend(sine_over_kgm(&sine));
    claims.push(current_of_the_ramp(&step, &ramp, &sine));
    let [step, ramp, sine] = [STEP, RAMP, SINE].map(|command| family(command, OVER_FDJ));
    claims.push(step_over_fdj(&step));
    claims.push(ramp_over_fdj(&ramp));
    claims.push(sine_over_fdj(&sine));
    claims.push(pressure_of_the_step(&step, &ramp, &sine));
    claims.extend(models_beside(responses));
    claims
}

fn over(family: &[&Trace; 5], measure: impl Fn(&Trace) -> f64) -> [f64; 5] {
    family.map(measure)
}

fn models_alike(responses: &Responses) -> [Claim; 2] {
    let far = QUANTITIES.each_ref().map(|quantity| {
        [STEP, RAMP, SINE].map(|command| {
            let of = |model| responses.nominal(command, model);
            100.0 * apart(of(REFERENCE), of(MONITORING), quantity.channel)
        })
    });
    let told = |at: usize| format!("{} {}", QUANTITIES[at].symbol, listed(&far[at], 2));
    let most = |at: usize| far[at].iter().copied().fold(0.0, f64::max);
    let [pressure, others] = [[2].as_slice(), &[0, 1, 3, 4]];
    let worst_other = others.iter().map(|&at| most(at)).fold(0.0, f64::max);
    [
        Claim {
            section: "5.3",
            thesis: "For great flows both models have almost the same behaviour",
            ours: format!(
                "Root mean square of the models' difference, % of the reference model's range, on step, ramp and sine: {}.",
                others.iter().map(|&at| told(at)).collect::<Vec<_>>().join("; ")
            ),
            agrees: worst_other < VISIBLE_PERCENT,
            why: None,
        },
        Claim {
            section: "5.3",
            thesis: "The peaks of P12 could not be matched perfectly",
            ours: format!("The same measure: {}; the largest of the others is {worst_other:.2} %.", told(pressure[0])),
            agrees: most(pressure[0]) > worst_other,
            why: None,
        },
    ]
}

fn step_over_kgm(step: &[&Trace; 5], ramp: &[&Trace; 5]) -> [Claim; 3] {
    let reached_s = over(step, |trace| first_above(trace, Channel::JackPosition, REACHED * 0.1));
    let velocity = over(step, |trace| peak(trace, Channel::JackVelocity));
    let spool_mm = over(step, |trace| peak(trace, Channel::SpoolPosition) * 1e3);
    let current_ma = over(step, |trace| mean_magnitude(trace, Channel::ServovalveCurrent, TRANSIENT_S) * 1e3);
    let fallen_s = over(step, |trace| {
        last_above(trace, Channel::ServovalveCurrent, 0.5 * peak(trace, Channel::ServovalveCurrent))
    });
    let braking_s = over(step, |trace| {
        let pressure = crate::reproduction::runs::values(trace, Channel::LoadPressure);
        let lowest = (0..pressure.len()).min_by(|&a, &b| pressure[a].total_cmp(&pressure[b]));
        lowest.map_or(0.0, |at| trace.time_s()[at])
    });
    let of_ramp = change_percent(&over(ramp, |trace| mean(trace, Channel::ServovalveCurrent, STEADY_S[RAMP])));
    let changes = [reached_s, velocity, spool_mm, current_ma].map(|values| change_percent(&values));
    [
        Claim {
            section: "6.1.1",
            thesis: "Demagnetisation makes the system slower: DXJ, XJ and XS",
            ours: format!(
                "From KGM 0 to 0.4, 90 % of the step is reached after {} s; DXJ peaks at {} m/s, XS at {} mm.",
                listed(&reached_s, 3),
                listed(&velocity, 3),
                listed(&spool_mm, 3)
            ),
            agrees: grows(&reached_s) && falls(&velocity) && falls(&spool_mm),
            why: None,
        },
        Claim {
            section: "6.1.1",
            thesis: "The servovalve consumes more current, and P12 and Cor are delayed in the transient",
            ours: format!(
                "Mean current of the first 0.5 s: {} mA; the current falls below half of its peak after {} s; P12 is lowest at \
                 {} s.",
                listed(&current_ma, 2),
                listed(&fallen_s, 3),
                listed(&braking_s, 3)
            ),
            agrees: grows(&current_ma) && grows(&fallen_s) && grows(&braking_s),
            why: None,
        },
        Claim {
            section: "6.1.1",
            thesis: "There is a trend in all quantities, of little use for prognosis",
            ours: format!(
                "From KGM 0 to 0.4 the time to 90 %, the peaks of DXJ and XS and the mean current change by {} %, the steady \
                 current of a ramp by {of_ramp:.1} %.",
                listed(&changes, 1)
            ),
            agrees: changes.iter().all(|change| change.abs() < of_ramp),
            why: None,
        },
    ]
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

/// The amplitudes of a family on the sine, in the order of the quantities.
fn amplitudes(sine: &[&Trace; 5]) -> [[f64; 5]; 5] {
    QUANTITIES.each_ref().map(|q| over(sine, |trace| q.factor * 0.5 * swing(trace, q.channel, STEADY_S[SINE])))
}

fn told_amplitude(at: usize, of: &[[f64; 5]; 5]) -> String {
    let Quantity { symbol, unit, .. } = &QUANTITIES[at];
    format!("{symbol} {} {unit} ({:+.1} %)", listed(&of[at], 3), change_percent(&of[at]))
}

fn sine_over_kgm(sine: &[&Trace; 5]) -> [Claim; 2] {
    let of = amplitudes(sine);
    let unseen = |at: usize| change_percent(&of[at]).abs() < VISIBLE_PERCENT;
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
            why: None,
        },
    ]
}

fn current_of_the_ramp(step: &[&Trace; 5], ramp: &[&Trace; 5], sine: &[&Trace; 5]) -> Claim {
    let of = Channel::ServovalveCurrent;
    let on_ramp = over(ramp, |trace| mean(trace, of, STEADY_S[RAMP]));
    let on_step = change_percent(&over(step, |trace| mean_magnitude(trace, of, TRANSIENT_S)));
    let on_sine = change_percent(&amplitudes(sine)[0]);
    let ramp = change_percent(&on_ramp);
    Claim {
        section: "6.1.4",
        thesis: "The ramp is the command, and its steady current the quantity, that shows demagnetisation best",
        ours: format!(
            "From KGM 0 to 0.4 the steady current of the ramp changes by {ramp:+.1} %, the mean current of the step's transient by \
             {on_step:+.1} %, the current's amplitude on the sine by {on_sine:+.1} %."
        ),
        agrees: grows(&on_ramp) && ramp > on_step.abs() && ramp > on_sine.abs(),
        why: None,
    }
}

/// A pressure beside the friction over the jack's area, % of it, at every level.
fn steady_pressure_kpa(family: &[&Trace; 5], command: usize) -> [f64; 5] {
    over(family, |trace| mean(trace, Channel::LoadPressure, STEADY_S[command]) * 1e-3)
}

fn step_over_fdj(step: &[&Trace; 5]) -> Claim {
    let pressure_kpa = steady_pressure_kpa(step, STEP);
    let changes = [
        change_percent(&over(step, |trace| first_above(trace, Channel::JackPosition, REACHED * 0.1))),
        change_percent(&over(step, |trace| peak(trace, Channel::JackVelocity))),
        change_percent(&over(step, |trace| peak(trace, Channel::SpoolPosition))),
        change_percent(&over(step, |trace| mean_magnitude(trace, Channel::ServovalveCurrent, TRANSIENT_S))),
    ];
    Claim {
        section: "6.2.1",
        thesis: "Only P12 shows a trend: after an oscillating transient its steady value grows with the friction",
        ours: format!(
            "Steady P12: {} kPa; the time to 90 %, the peaks of DXJ and XS and the mean current change by {} % from 200 to 1000 N.",
            listed(&pressure_kpa, 2),
            listed(&changes, 1)
        ),
        agrees: grows(&pressure_kpa) && changes.iter().all(|change| change.abs() < VISIBLE_PERCENT),
        why: None,
    }
}

fn ramp_over_fdj(ramp: &[&Trace; 5]) -> Claim {
    let pressure_kpa = steady_pressure_kpa(ramp, RAMP);
    let [first, last] = [0, 4].map(|at| pressure_kpa[at] * 1e3 / FDJ_LEVELS_N[at] * 1e4);
    Claim {
        section: "6.2.2",
        thesis: "No physical quantity can be useful as a prognostic parameter",
        ours: format!(
            "P12 at the end of the ramp: {} kPa, {:+.0} % from 200 to 1000 N; over FDJ it is 1/({:.2} cm²) to 1/({:.2} cm²).",
            listed(&pressure_kpa, 2),
            change_percent(&pressure_kpa),
            1e8 / first,
            1e8 / last
        ),
        agrees: !grows(&pressure_kpa) || change_percent(&pressure_kpa) < VISIBLE_PERCENT,
        why: Some(
            "The jack moves against its friction all along the ramp, and only P12 can push it: by the thesis's own equations \
             P12 times the area is FDJ, plus what the damping takes",
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
        agrees: of.iter().all(|values| change_percent(values).abs() < VISIBLE_PERCENT),
        why: None,
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

fn models_beside(responses: &Responses) -> [Claim; 3] {
    let [reference, monitoring] = [REFERENCE, MONITORING];
    let both = |command, over| [reference, monitoring].map(|model| responses.family(command, model, over));
    let current_ma = |trace: &Trace| mean(trace, Channel::ServovalveCurrent, STEADY_S[RAMP]) * 1e3;
    let [high, low] = both(RAMP, OVER_KGM).map(|family| over(&family, current_ma));
    let apart_ma: [f64; 5] = std::array::from_fn(|at| high[at] - low[at]);
    let ratio: [f64; 5] = std::array::from_fn(|at| high[at] / low[at]);
    let [high, low] = both(STEP, OVER_FDJ).map(|family| steady_pressure_kpa(&family, STEP));
    let far_percent: [f64; 5] = std::array::from_fn(|at| (low[at] / high[at] - 1.0) * 100.0);
    let swing_ma = |trace: &Trace| swing(trace, Channel::ServovalveCurrent, STEADY_S[RAMP]) * 1e3;
    let [high, low] = both(RAMP, OVER_FDJ).map(|family| over(&family, swing_ma));
    let visible = high.map(|swing_ma| swing_ma > 0.1 * high[4]);
    [
        Claim {
            section: "7.2",
            thesis: "The models' currents differ by 0.15 mA at every KGM",
            ours: format!("They differ by {} mA; their ratio is {}.", listed(&apart_ma, 3), listed(&ratio, 5)),
            agrees: apart_ma.iter().all(|ma| (ma - 0.15).abs() < 0.01),
            why: Some(
                "In table 6.3 Cor (1 − KGM) is constant, so what the reference model needs more of grows with 1/(1 − KGM)",
            ),
        },
        Claim {
            section: "7.2",
            thesis: "The models' pressures after the step correspond well at every friction",
            ours: format!("The monitoring model's is {} % off 1.1 s after the step.", listed(&far_percent, 4)),
            agrees: far_percent.iter().all(|percent| percent.abs() < 1.0),
            why: None,
        },
        Claim {
            section: "7.2",
            thesis: "Above 600 N the reference model's current oscillates all along the ramp",
            ours: format!(
                "Swing at the end of the ramp, from 200 to 1000 N: {} mA; the monitoring model's: {} mA.",
                listed(&high, 4),
                listed(&low, 4)
            ),
            agrees: visible == [false, false, false, true, true],
            why: None,
        },
    ]
}
