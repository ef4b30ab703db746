//! What sections 5.3 and 7.2 say of both models beside each other.

use super::friction::steady_pressure_kpa;
use super::{VISIBLE_PERCENT, over};
use crate::models::trace::{Channel, Trace};
use crate::reproduction::claims::{Claim, apart, listed, mean, swing};
use crate::reproduction::responses::{
    MONITORING, OVER_FDJ, OVER_KGM, QUANTITIES, RAMP, REFERENCE, Responses, SINE, STEADY_S, STEP,
};

/// The swing of a steady current, as a part of it, that can be seen in a plot (chosen).
const OSCILLATION_PART: f64 = 0.005;

/// Section 5.3.
pub fn alike(responses: &Responses) -> [Claim; 2] {
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

/// Section 7.2.
pub fn beside(responses: &Responses) -> [Claim; 3] {
    let [reference, monitoring] = [REFERENCE, MONITORING];
    let both = |command, over| [reference, monitoring].map(|model| responses.family(command, model, over));
    let current_ma = |trace: &Trace| mean(trace, Channel::ServovalveCurrent, STEADY_S[RAMP]) * 1e3;
    let [high, low] = both(RAMP, OVER_KGM).map(|family| over(&family, current_ma));
    let apart_ma: [f64; 5] = std::array::from_fn(|at| high[at] - low[at]);
    let ratio: [f64; 5] = std::array::from_fn(|at| high[at] / low[at]);
    let [high, low] = both(STEP, OVER_FDJ).map(|family| steady_pressure_kpa(&family, STEP));
    let far_percent: [f64; 5] = std::array::from_fn(|at| (low[at] / high[at] - 1.0) * 100.0);
    let swing_ma = |trace: &Trace| swing(trace, Channel::ServovalveCurrent, STEADY_S[RAMP]) * 1e3;
    let on_ramp = both(RAMP, OVER_FDJ);
    let steady_ma = over(&on_ramp[0], current_ma);
    let [high, low] = on_ramp.map(|family| over(&family, swing_ma));
    let visible: [bool; 5] = std::array::from_fn(|at| high[at] > OSCILLATION_PART * steady_ma[at]);
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
