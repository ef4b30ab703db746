//! Baselines: an actuator's own bias when new, from its first healthy traces, and the growth since then.
//!
//! The formulas are written down in `docs/baseline.md`.

/// An estimated value with its standard deviation, which is finite and above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figure {
    /// The value, in any unit.
    pub value: f64,
    /// Its standard deviation, in the same unit.
    pub std: f64,
}

impl Figure {
    /// A figure, where both the value and a standard deviation above 0 are there.
    #[must_use]
    pub fn of(value: Option<f64>, std: Option<f64>) -> Option<Self> {
        let (value, std) = (value?, std?);
        (value.is_finite() && std.is_finite() && std > 0.0).then_some(Self { value, std })
    }
}

/// What a conclusive trace says of an actuator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Torque-motor demagnetisation KGM, 0 to 1.
    pub kgm: Option<Figure>,
    /// Dynamic jack friction FDJ, N.
    pub fdj_n: Option<Figure>,
    /// Offset of the torque motor's current, A.
    pub current_offset_a: Option<Figure>,
}

/// The levels below which a trace counts as healthy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Healthy {
    /// Of KGM.
    pub kgm_below: f64,
    /// Of FDJ, N.
    pub fdj_n_below: f64,
}

/// The weighted mean of a figure over the traces of a baseline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mean {
    /// The mean, in the figure's unit.
    pub value: f64,
    /// Its standard deviation, in the same unit.
    pub std: f64,
    /// The traces that it is made of.
    pub traces: usize,
}

/// An actuator's own bias.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Baseline {
    /// Torque-motor demagnetisation KGM; the motor's gain is 1 less this.
    pub kgm: Mean,
    /// Dynamic jack friction FDJ, N.
    pub fdj_n: Mean,
    /// Offset of the torque motor's current, A, of those traces that determine it.
    pub current_offset_a: Option<Mean>,
}

/// Why a trace is not taken into a baseline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PassedOver {
    /// It does not determine both KGM and FDJ with their standard deviations.
    Undetermined,
    /// KGM, FDJ or both are not below their healthy levels.
    Beyond {
        /// Whether KGM is not.
        kgm: bool,
        /// Whether FDJ is not.
        fdj_n: bool,
    },
}

/// How far a baseline has come.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gathering {
    /// The readings that were taken, by their places, ascending.
    pub taken: Vec<usize>,
    /// Those before the last one taken, or among all while some are missing, that were not, and why.
    pub passed_over: Vec<(usize, PassedOver)>,
    /// The baseline, once as many were taken as it needs.
    pub baseline: Option<Baseline>,
}

/// Gathers a baseline from the readings of a life, ascending by time of recording: from the first `wanted` healthy ones.
#[must_use]
pub fn gather(readings: &[Reading], healthy: &Healthy, wanted: usize) -> Gathering {
    let mut gathering = Gathering::default();
    let mut taken: Vec<(Figure, Figure, Option<Figure>)> = Vec::new();
    for (place, reading) in readings.iter().enumerate() {
        if taken.len() >= wanted {
            break;
        }
        match judged(reading, healthy) {
            Ok((kgm, fdj_n)) => {
                gathering.taken.push(place);
                taken.push((kgm, fdj_n, reading.current_offset_a));
            }
            Err(why) => gathering.passed_over.push((place, why)),
        }
    }
    if taken.len() >= wanted {
        gathering.baseline = baseline(&taken);
    }
    gathering
}

/// Both faults of a healthy reading.
fn judged(reading: &Reading, healthy: &Healthy) -> Result<(Figure, Figure), PassedOver> {
    let (Some(kgm), Some(fdj_n)) = (reading.kgm, reading.fdj_n) else { return Err(PassedOver::Undetermined) };
    let (kgm_beyond, fdj_n_beyond) = (kgm.value >= healthy.kgm_below, fdj_n.value >= healthy.fdj_n_below);
    if kgm_beyond || fdj_n_beyond {
        return Err(PassedOver::Beyond { kgm: kgm_beyond, fdj_n: fdj_n_beyond });
    }
    Ok((kgm, fdj_n))
}

fn baseline(taken: &[(Figure, Figure, Option<Figure>)]) -> Option<Baseline> {
    Some(Baseline {
        kgm: weighted_mean(taken.iter().map(|(kgm, ..)| *kgm))?,
        fdj_n: weighted_mean(taken.iter().map(|(_, fdj_n, _)| *fdj_n))?,
        current_offset_a: weighted_mean(taken.iter().filter_map(|(.., offset)| *offset)),
    })
}

/// The mean with the weights 1 / std². Its standard deviation is what the figures' own make of it, or what their scatter
/// about it does where that is more. `None` of no figure.
#[must_use]
pub fn weighted_mean(figures: impl Iterator<Item = Figure> + Clone) -> Option<Mean> {
    let traces = figures.clone().count();
    // In units of the least standard deviation the weights are 1 or less, and no square of a small one is lost.
    let std_min = figures.clone().map(|figure| figure.std).reduce(f64::min)?;
    let weight = |figure: Figure| (std_min / figure.std).powi(2);
    let weights: f64 = figures.clone().map(weight).sum();
    let value = figures.clone().map(|figure| weight(figure) * figure.value).sum::<f64>() / weights;
    let own = std_min / weights.sqrt();
    let squares: f64 = figures.map(|figure| weight(figure) * (figure.value - value).powi(2)).sum();
    let scatter = if traces > 1 { (squares / ((traces - 1) as f64 * weights)).sqrt() } else { 0.0 };
    Some(Mean { value, std: own.max(scatter), traces })
}

/// How much a value has grown since its baseline, and the standard deviation of that where the value has one.
#[must_use]
pub fn growth(value: f64, std: Option<f64>, baseline: &Mean) -> (f64, Option<f64>) {
    (value - baseline.value, std.map(|std| std.hypot(baseline.std)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEALTHY: Healthy = Healthy { kgm_below: 0.2, fdj_n_below: 600.0 };

    fn figure(value: f64, std: f64) -> Figure {
        Figure { value, std }
    }

    fn reading(kgm: f64, fdj_n: f64) -> Reading {
        Reading { kgm: Some(figure(kgm, 0.01)), fdj_n: Some(figure(fdj_n, 4.0)), current_offset_a: None }
    }

    fn mean(figures: &[Figure]) -> Mean {
        weighted_mean(figures.iter().copied()).unwrap()
    }

    #[track_caller]
    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-12 * expected.abs(), "{found} {expected}");
    }

    #[test]
    fn figures_that_agree_have_the_standard_deviation_of_their_weighted_mean() {
        // Weights 1 and 1/4: (1 * 10 + 1/4 * 11) / (5/4) = 10.2; 1 / sqrt(5/4) = 2 / sqrt(5). The scatter is less:
        // (1 * 0.04 + 1/4 * 0.64) / (1 * 5/4) = 0.16, its root 0.4.
        let agreeing = mean(&[figure(10.0, 1.0), figure(11.0, 2.0)]);
        near(agreeing.value, 10.2);
        near(agreeing.std, 2.0 / 5.0f64.sqrt());
        assert_eq!(agreeing.traces, 2);
    }

    #[test]
    fn figures_that_scatter_more_than_they_say_have_their_scatter() {
        // Weights 1 and 1/4: (10 + 4) / (5/4) = 11.2; (1 * 1.44 + 1/4 * 23.04) / (1 * 5/4) = 7.2 / 1.25 = 5.76 = 2.4².
        let scattered = mean(&[figure(10.0, 1.0), figure(16.0, 2.0)]);
        near(scattered.value, 11.2);
        near(scattered.std, 2.4);
        // Three of equal weight: the standard error of 1, 3 and 8 is sqrt(((-3)² + (-1)² + 4²) / (2 * 3)) = sqrt(26 / 6).
        let equal = mean(&[figure(1.0, 0.1), figure(3.0, 0.1), figure(8.0, 0.1)]);
        near(equal.value, 4.0);
        near(equal.std, (26.0f64 / 6.0).sqrt());
    }

    #[test]
    fn one_figure_is_its_own_mean_and_none_has_no_mean() {
        assert_eq!(mean(&[figure(3.0, 0.5)]), Mean { value: 3.0, std: 0.5, traces: 1 });
        assert_eq!(weighted_mean(std::iter::empty()), None);
    }

    #[test]
    fn standard_deviations_of_any_size_keep_the_weights() {
        let tiny = mean(&[figure(10.0, 1e-200), figure(10.0, 2e-200)]);
        near(tiny.value, 10.0);
        near(tiny.std, 1e-200 * 2.0 / 5.0f64.sqrt());
    }

    #[test]
    fn the_first_healthy_readings_make_the_baseline_and_those_beyond_are_passed_over() {
        let readings = [
            reading(0.01, 210.0),
            reading(0.25, 210.0),
            Reading { kgm: None, ..reading(0.0, 210.0) },
            reading(0.2, 600.0),
            reading(0.03, 230.0),
            reading(0.9, 900.0),
            reading(0.15, 500.0),
        ];
        let gathering = gather(&readings, &HEALTHY, 2);
        assert_eq!(gathering.taken, [0, 4]);
        let beyond = |kgm, fdj_n| PassedOver::Beyond { kgm, fdj_n };
        let expected = [(1, beyond(true, false)), (2, PassedOver::Undetermined), (3, beyond(true, true))];
        assert_eq!(gathering.passed_over, expected);
        let baseline = gathering.baseline.unwrap();
        near(baseline.kgm.value, 0.02);
        // The scatter of 0.01 and 0.03, 0.01 each, is more than 0.01 / sqrt(2); that of 210 and 230, 10 each, than 4 / sqrt(2).
        near(baseline.kgm.std, 0.01);
        near(baseline.fdj_n.value, 220.0);
        near(baseline.fdj_n.std, 10.0);
        assert_eq!(baseline.current_offset_a, None);
    }

    #[test]
    fn until_enough_are_healthy_there_is_no_baseline() {
        let readings = [reading(0.01, 210.0), reading(0.3, 210.0)];
        let gathering = gather(&readings, &HEALTHY, 2);
        assert_eq!((gathering.taken, gathering.baseline), (vec![0], None));
        assert_eq!(gathering.passed_over.len(), 1);
        assert_eq!(gather(&[], &HEALTHY, 1), Gathering::default());
    }

    #[test]
    fn the_offset_is_of_those_that_determine_it() {
        let with = Reading { current_offset_a: Some(figure(2e-4, 1e-5)), ..reading(0.01, 210.0) };
        let baseline = gather(&[reading(0.01, 210.0), with], &HEALTHY, 2).baseline.unwrap();
        assert_eq!(baseline.current_offset_a, Some(Mean { value: 2e-4, std: 1e-5, traces: 1 }));
        assert_eq!((baseline.kgm.traces, baseline.fdj_n.traces), (2, 2));
    }

    #[test]
    fn growth_is_told_with_the_doubt_of_both() {
        let base = Mean { value: 200.0, std: 3.0, traces: 5 };
        assert_eq!(growth(320.0, Some(4.0), &base), (120.0, Some(5.0)));
        assert_eq!(growth(190.0, None, &base), (-10.0, None));
    }

    #[test]
    fn what_has_no_standard_deviation_is_no_figure() {
        assert_eq!(Figure::of(Some(1.0), Some(0.5)), Some(figure(1.0, 0.5)));
        for (value, std) in [(None, Some(1.0)), (Some(1.0), None), (Some(1.0), Some(0.0)), (Some(f64::NAN), Some(1.0))]
        {
            assert_eq!(Figure::of(value, std), None, "{value:?} {std:?}");
        }
    }
}
