//! How good forecasts were, once the true ends of life are known.
//!
//! The metrics of Saxena et al., "Metrics for Offline Evaluation of Prognostic Performance", IJPHM 1(1), 2010, and the
//! continuous ranked probability score and interval coverage beside them. Defined in `docs/prognostic-metrics.md`.

use std::ops::Range;

use serde::Serialize;

use super::forecast::Prognosis;

/// Quantiles that stand for a prognosis.
const SAMPLE: usize = 199;

/// What a forecast says beyond this many ages counts as this many.
const REMAINING_AGES_MAX: f64 = 20.0;

/// A forecast, and the end that life came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Scored {
    life_start: f64,
    at: f64,
    end_of_life: f64,
    /// The forecast remaining life: an evenly weighted sample, rising.
    remaining: Vec<f64>,
}

/// What counts as a good forecast.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Criteria {
    /// The relative error that is allowed, alpha of Saxena et al.: above 0.
    pub alpha: f64,
    /// The probability that has to lie within that error, beta of Saxena et al.: 0 to 1.
    pub beta: f64,
}

impl Default for Criteria {
    fn default() -> Self {
        Self { alpha: 0.2, beta: 0.5 }
    }
}

impl Scored {
    /// A forecast made at the usage `at` of a life from `life_start` to `end_of_life`, as an evenly weighted sample of the
    /// remaining life, in usage. What is below 0 counts as 0, what is above 20 ages or no number as 20 ages.
    ///
    /// `None` without a sample, and where `at` is not strictly within the life: nothing is left there to be forecast, or
    /// nothing was lived to forecast from.
    #[must_use]
    pub fn of_sample(life_start: f64, at: f64, end_of_life: f64, mut sample: Vec<f64>) -> Option<Self> {
        let within = life_start < at && at < end_of_life && (end_of_life - life_start).is_finite();
        if !within || sample.is_empty() {
            return None;
        }
        let longest = REMAINING_AGES_MAX * (at - life_start);
        for remaining in &mut sample {
            *remaining = if remaining.is_nan() { longest } else { remaining.clamp(0.0, longest) };
        }
        sample.sort_unstable_by(f64::total_cmp);
        Some(Self { life_start, at, end_of_life, remaining: sample })
    }

    /// The same of a prognosis, by 199 of its quantiles; `None` also without a forecast.
    #[must_use]
    pub fn of_prognosis(life_start: f64, at: f64, end_of_life: f64, prognosis: &Prognosis) -> Option<Self> {
        prognosis.forecast.as_ref()?;
        let remaining = |i: usize| prognosis.quantile((i as f64 + 0.5) / SAMPLE as f64).unwrap_or(f64::INFINITY);
        Self::of_sample(life_start, at, end_of_life, (0..SAMPLE).map(remaining).collect())
    }

    /// The true remaining life, in usage.
    fn truth(&self) -> f64 {
        self.end_of_life - self.at
    }

    fn life(&self) -> f64 {
        self.end_of_life - self.life_start
    }

    /// The fraction of the life that was over at the forecast, above 0 and below 1.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        (self.at - self.life_start) / self.life()
    }

    /// The forecast's quantile at `p`, 0 to 1: linear between the sample's values, of which the least is at 0 and the
    /// greatest at 1.
    #[must_use]
    pub fn quantile(&self, p: f64) -> f64 {
        let place = p * (self.remaining.len() - 1) as f64;
        let (below, above) = (self.remaining[place.floor() as usize], self.remaining[place.ceil() as usize]);
        below + (above - below) * place.fract()
    }

    fn error(&self) -> f64 {
        (self.quantile(0.5) - self.truth()).abs()
    }

    /// Relative accuracy of the median: 1 less its error over the true remaining life, and no less than 0.
    #[must_use]
    pub fn relative_accuracy(&self) -> f64 {
        (1.0 - self.error() / self.truth()).max(0.0)
    }

    /// Whether the median is within alpha of the true remaining life.
    #[must_use]
    pub fn alpha_lambda(&self, criteria: &Criteria) -> bool {
        self.error() <= criteria.alpha * self.truth()
    }

    /// Whether a probability of beta or more lies within alpha of the true remaining life.
    #[must_use]
    pub fn alpha_lambda_beta(&self, criteria: &Criteria) -> bool {
        self.mass_within(criteria.alpha * self.truth()) >= criteria.beta
    }

    /// Whether a probability of beta or more lies within alpha of the whole life about the true end of life.
    fn foresees_end(&self, criteria: &Criteria) -> bool {
        self.mass_within(criteria.alpha * self.life()) >= criteria.beta
    }

    /// The probability that the forecast gives to what is no further than `distance` from the truth.
    fn mass_within(&self, distance: f64) -> f64 {
        let near = self.remaining.iter().filter(|remaining| (*remaining - self.truth()).abs() <= distance);
        near.count() as f64 / self.remaining.len() as f64
    }

    /// Whether the truth lies in the central interval of this probability.
    #[must_use]
    pub fn covered(&self, probability: f64) -> bool {
        let [low, high] = self.interval(probability);
        low <= self.truth() && self.truth() <= high
    }

    /// The width of the central interval of this probability, over the true remaining life.
    #[must_use]
    pub fn relative_width(&self, probability: f64) -> f64 {
        let [low, high] = self.interval(probability);
        (high - low) / self.truth()
    }

    fn interval(&self, probability: f64) -> [f64; 2] {
        let tail = 0.5 * (1.0 - probability);
        [self.quantile(tail), self.quantile(1.0 - tail)]
    }

    /// The continuous ranked probability score of the sample, in usage: 0 for a sure and true forecast.
    #[must_use]
    pub fn crps(&self) -> f64 {
        let n = self.remaining.len() as f64;
        let distance: f64 = self.remaining.iter().map(|remaining| (remaining - self.truth()).abs()).sum();
        let ranked = |(i, remaining): (usize, &f64)| (2.0 * (i + 1) as f64 - n - 1.0) * remaining;
        distance / n - self.remaining.iter().enumerate().map(ranked).sum::<f64>() / (n * n)
    }
}

/// The continuous ranked probability score at `truth`, exact, of the quantile function that is straight between these
/// (probability, quantile) pairs, both rising, and constant before the first and after the last. `None` of no pair.
#[must_use]
pub fn crps_of_quantiles(pairs: &[(f64, f64)], truth: f64) -> Option<f64> {
    let (first, last) = (pairs.first()?, pairs.last()?);
    let ends = [(0.0, first.1), (1.0, last.1)];
    let whole: Vec<(f64, f64)> = ends[..1].iter().chain(pairs).chain(&ends[1..]).copied().collect();
    Some(whole.windows(2).map(|piece| crps_of_piece(piece[0], piece[1], truth)).sum())
}

/// The part that one straight piece of a quantile function has in the score, which is the integral over p of twice the
/// quantile loss `(1[truth < q(p)] - p) (q(p) - truth)`.
fn crps_of_piece(from: (f64, f64), to: (f64, f64), truth: f64) -> f64 {
    let crossing = (truth - from.1) / (to.1 - from.1);
    if crossing > 0.0 && crossing < 1.0 {
        let middle = (from.0 + crossing * (to.0 - from.0), truth);
        return crps_of_piece(from, middle, truth) + crps_of_piece(middle, to, truth);
    }
    let above = if from.1 + to.1 > 2.0 * truth { 1.0 } else { 0.0 };
    let loss = |(p, quantile): (f64, f64)| 2.0 * (above - p) * (quantile - truth);
    // Simpson's rule is exact for the product of two straight lines.
    let middle = (0.5 * (from.0 + to.0), 0.5 * (from.1 + to.1));
    (to.0 - from.0) / 6.0 * (loss(from) + 4.0 * loss(middle) + loss(to))
}

/// What is said of forecasts one by one, and then averaged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figures {
    /// The forecasts that were scored.
    pub forecasts: usize,
    /// Mean relative accuracy, 0 to 1.
    pub mra: f64,
    /// Cumulative relative accuracy, 0 to 1: the mean over the histories of each one's weighted mean.
    pub cra: f64,
    /// The share of forecasts whose median is within alpha of the true remaining life.
    pub alpha_lambda: f64,
    /// The share of forecasts that give a probability of beta or more to what is within alpha of it.
    pub alpha_lambda_beta: f64,
    /// The mean continuous ranked probability score over the life.
    pub ncrps: f64,
    /// The share of forecasts whose 50 % interval holds the truth.
    pub coverage_50: f64,
    /// The share of forecasts whose 90 % interval holds the truth.
    pub coverage_90: f64,
    /// The median width of the 50 % interval over the true remaining life.
    pub width_50: f64,
    /// The median width of the 90 % interval over the true remaining life.
    pub width_90: f64,
}

/// The figures of the forecasts of each history; `None` without a forecast.
#[must_use]
pub fn figures(histories: &[Vec<Scored>], criteria: &Criteria) -> Option<Figures> {
    figures_within(histories, criteria, &(0.0..f64::INFINITY))
}

/// The same of those forecasts that were made in this part of the life, as fractions of it.
#[must_use]
pub fn figures_within(histories: &[Vec<Scored>], criteria: &Criteria, part: &Range<f64>) -> Option<Figures> {
    let of_part = |history: &Vec<Scored>| -> Vec<Scored> {
        history.iter().filter(|scored| part.contains(&scored.fraction())).cloned().collect()
    };
    let histories: Vec<Vec<Scored>> = histories.iter().map(of_part).filter(|history| !history.is_empty()).collect();
    let all: Vec<&Scored> = histories.iter().flatten().collect();
    let share = |holds: &dyn Fn(&Scored) -> bool| mean(all.iter().map(|scored| f64::from(u8::from(holds(scored)))));
    let width = |probability| median(all.iter().map(|scored| scored.relative_width(probability)).collect());
    Some(Figures {
        forecasts: all.len(),
        mra: mean(all.iter().map(|scored| scored.relative_accuracy()))?,
        cra: mean(histories.iter().filter_map(|history| cumulative_relative_accuracy(history)))?,
        alpha_lambda: share(&|scored| scored.alpha_lambda(criteria))?,
        alpha_lambda_beta: share(&|scored| scored.alpha_lambda_beta(criteria))?,
        ncrps: mean(all.iter().map(|scored| scored.crps() / scored.life()))?,
        coverage_50: share(&|scored| scored.covered(0.5))?,
        coverage_90: share(&|scored| scored.covered(0.9))?,
        width_50: width(0.5)?,
        width_90: width(0.9)?,
    })
}

/// Cumulative relative accuracy of the forecasts of one history: the mean of their relative accuracies, each weighted
/// with the fraction of life that was over, so that the later ones count more. `None` without a forecast.
#[must_use]
pub fn cumulative_relative_accuracy(history: &[Scored]) -> Option<f64> {
    let weights: f64 = history.iter().map(Scored::fraction).sum();
    let weighted: f64 = history.iter().map(|scored| scored.fraction() * scored.relative_accuracy()).sum();
    (!history.is_empty()).then(|| weighted / weights)
}

/// Prognostic horizon of the forecasts of one history, in usage: the true remaining life at the first of them that gives a
/// probability of beta or more to what is within alpha of the whole life about the true end. `None` where none does.
#[must_use]
pub fn prognostic_horizon(history: &[Scored], criteria: &Criteria) -> Option<f64> {
    let first = in_order(history).into_iter().find(|scored| scored.foresees_end(criteria));
    first.map(Scored::truth)
}

/// The prognostic horizon that lasts: the true remaining life at the first forecast from which on every one meets the
/// criterion. `None` where the last one does not.
#[must_use]
pub fn lasting_prognostic_horizon(history: &[Scored], criteria: &Criteria) -> Option<f64> {
    let meets = |scored: &&Scored| scored.foresees_end(criteria);
    in_order(history).into_iter().rev().take_while(meets).last().map(Scored::truth)
}

/// Convergence of the forecasts of one history: the distance of the centroid of the area under the error curve from the
/// curve's beginning on the axis, in lives; less is quicker. The curve is the median's error, each forecast's until the
/// next one is made, the last one's until the end of life. 0 where no forecast errs. `None` without a forecast.
#[must_use]
pub fn convergence(history: &[Scored]) -> Option<f64> {
    let ordered = in_order(history);
    let first = ordered.first()?;
    let next = ordered.iter().skip(1).map(|scored| scored.fraction()).chain([1.0]);
    let (mut area, mut moment_of_time, mut moment_of_error) = (0.0, 0.0, 0.0);
    for (scored, until) in ordered.iter().zip(next) {
        let (from, error) = (scored.fraction(), scored.error() / scored.life());
        area += (until - from) * error;
        moment_of_time += 0.5 * (until * until - from * from) * error;
        moment_of_error += 0.5 * (until - from) * error * error;
    }
    Some(if area > 0.0 { (moment_of_time / area - first.fraction()).hypot(moment_of_error / area) } else { 0.0 })
}

fn in_order(history: &[Scored]) -> Vec<&Scored> {
    let mut ordered: Vec<&Scored> = history.iter().collect();
    ordered.sort_by(|a, b| a.at.total_cmp(&b.at));
    ordered
}

/// What is said of whole histories, and then averaged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Course {
    /// The histories with a forecast that was scored.
    pub histories: usize,
    /// The mean prognostic horizon over the life, 0 to 1; a history whose forecasts never meet the criterion counts as 0.
    pub prognostic_horizon: f64,
    /// The same of the horizon that lasts.
    pub prognostic_horizon_lasting: f64,
    /// The mean convergence, in lives.
    pub convergence: f64,
}

/// The course of the forecasts of each history; `None` without a forecast.
#[must_use]
pub fn course(histories: &[Vec<Scored>], criteria: &Criteria) -> Option<Course> {
    let scored: Vec<(&Vec<Scored>, f64)> =
        histories.iter().filter_map(|history| Some((history, history.first()?.life()))).collect();
    let relative = |horizon: fn(&[Scored], &Criteria) -> Option<f64>| {
        mean(scored.iter().map(|(history, life)| horizon(history, criteria).unwrap_or(0.0) / life))
    };
    Some(Course {
        histories: scored.len(),
        prognostic_horizon: relative(prognostic_horizon)?,
        prognostic_horizon_lasting: relative(lasting_prognostic_horizon)?,
        convergence: mean(scored.iter().filter_map(|(history, _)| convergence(history)))?,
    })
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut count, mut sum) = (0_usize, 0.0);
    for value in values {
        count += 1;
        sum += value;
    }
    (count > 0).then(|| sum / count as f64)
}

/// The median, the mean of the middle two of an even number; `None` of no value.
#[must_use]
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    let upper = *values.get(middle)?;
    Some(if values.len() % 2 == 1 { upper } else { 0.5 * (values[middle - 1] + upper) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const CRITERIA: Criteria = Criteria { alpha: 0.2, beta: 0.5 };

    /// A life from 0 to 100.
    fn scored(at: f64, sample: &[f64]) -> Scored {
        Scored::of_sample(0.0, at, 100.0, sample.to_vec()).unwrap()
    }

    #[track_caller]
    fn near(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} {expected}");
    }

    #[test]
    fn one_forecast_is_scored_as_by_hand() {
        // The truth is 50, the median 44, the values' distances from the truth 30, 10, 6, 0 and 20.
        let forecast = scored(50.0, &[44.0, 20.0, 70.0, 40.0, 50.0]);
        near(forecast.fraction(), 0.5);
        near(forecast.relative_accuracy(), 1.0 - 6.0 / 50.0);
        assert!(forecast.alpha_lambda(&CRITERIA));
        // 40, 44 and 50 are within 10: three fifths.
        assert!(forecast.alpha_lambda_beta(&CRITERIA));
        assert!(!forecast.alpha_lambda_beta(&Criteria { beta: 0.7, ..CRITERIA }));
        assert!(!forecast.alpha_lambda(&Criteria { alpha: 0.1, ..CRITERIA }));
        // Quantiles at 0.25 and 0.75 are 40 and 50; at 0.05 20 + 0.2 * 20 = 24, at 0.95 50 + 0.8 * 20 = 66.
        near(forecast.quantile(0.05), 24.0);
        assert!(forecast.covered(0.5) && forecast.covered(0.9));
        near(forecast.relative_width(0.5), 10.0 / 50.0);
        near(forecast.relative_width(0.9), 42.0 / 50.0);
        // Mean distance from the truth 66/5; mean distance within the sample 2 (-4*20 - 2*40 + 2*50 + 4*70) / 25 = 17.6,
        // of which half is taken off.
        near(forecast.crps(), 66.0 / 5.0 - 8.8);
    }

    #[test]
    fn the_score_of_a_sample_is_half_of_what_its_own_scatter_takes_off_the_mean_distance() {
        let sample = [3.0_f64, 40.0, 41.0, 60.0, 77.5, 90.0];
        let mut within = 0.0;
        for (a, b) in sample.iter().flat_map(|a| sample.map(|b| (*a, b))) {
            within += (a - b).abs() / 36.0;
        }
        let distance = sample.iter().map(|value| (value - 50.0_f64).abs()).sum::<f64>() / 6.0;
        near(scored(50.0, &sample).crps(), distance - 0.5 * within);
    }

    #[test]
    fn the_score_of_a_quantile_function_is_exact() {
        // Uniform from 0 to 1: the integral of (x - 1[x > y])² over 0 to 1 is (y³ + (1 - y)³) / 3.
        let uniform = [(0.0, 0.0), (0.25, 0.25), (1.0, 1.0)];
        for truth in [0.0, 0.2, 0.5, 1.0_f64] {
            near(crps_of_quantiles(&uniform, truth).unwrap(), (truth.powi(3) + (1.0 - truth).powi(3)) / 3.0);
        }
        // Outside it the whole distance is added: 2 beyond the end.
        near(crps_of_quantiles(&uniform, 3.0).unwrap(), 2.0 + 1.0 / 3.0);
        // One value for sure: its distance. A step function: the same as the sample's.
        near(crps_of_quantiles(&[(0.5, 7.0)], 4.0).unwrap(), 3.0);
        let steps =
            [(0.2, 20.0), (0.2, 40.0), (0.4, 40.0), (0.4, 44.0), (0.6, 44.0), (0.6, 50.0), (0.8, 50.0), (0.8, 70.0)];
        near(crps_of_quantiles(&steps, 50.0).unwrap(), 66.0 / 5.0 - 8.8);
        assert_eq!(crps_of_quantiles(&[], 1.0), None);
    }

    #[test]
    fn what_cannot_be_is_cut_to_what_can() {
        let forecast = scored(2.0, &[-5.0, f64::NAN, f64::INFINITY, 98.0, 10.0]);
        assert_eq!(forecast.remaining, [0.0, 10.0, 40.0, 40.0, 40.0]);
        for (at, sample) in [(0.0, vec![1.0]), (100.0, vec![1.0]), (50.0, vec![]), (f64::NAN, vec![1.0])] {
            assert_eq!(Scored::of_sample(0.0, at, 100.0, sample), None);
        }
    }

    #[test]
    fn a_life_that_began_later_is_counted_from_its_beginning() {
        let early = Scored::of_sample(0.0, 30.0, 100.0, vec![60.0, 90.0]).unwrap();
        let late = Scored::of_sample(1000.0, 1030.0, 1100.0, vec![60.0, 90.0]).unwrap();
        near(late.fraction(), 0.3);
        let of = |scored: &Scored| figures(&[vec![scored.clone()]], &CRITERIA);
        assert_eq!(of(&early), of(&late));
    }

    #[test]
    fn later_forecasts_weigh_more_in_a_history() {
        // Relative accuracies 0 (the median 240 for 80), 0.5 (75 for 50) and 1.
        let history = [scored(20.0, &[240.0]), scored(50.0, &[75.0]), scored(80.0, &[20.0])];
        near(cumulative_relative_accuracy(&history).unwrap(), (0.5 * 0.5 + 0.8) / 1.5);
        assert_eq!(cumulative_relative_accuracy(&[]), None);
    }

    #[test]
    fn the_prognostic_horizon_is_what_was_left_when_the_end_was_first_foreseen() {
        // The end is foreseen within 20. The medians' ends: 160, 110, 130, 115.
        let history = [(20.0, 140.0), (40.0, 70.0), (60.0, 70.0), (80.0, 35.0)].map(|(at, q)| scored(at, &[q]));
        assert_eq!(prognostic_horizon(&history, &CRITERIA), Some(60.0));
        assert_eq!(lasting_prognostic_horizon(&history, &CRITERIA), Some(20.0));
        let mut mixed = history.clone();
        mixed.reverse();
        assert_eq!(prognostic_horizon(&mixed, &CRITERIA), Some(60.0));
        assert_eq!(lasting_prognostic_horizon(&mixed, &CRITERIA), Some(20.0));
        assert_eq!(lasting_prognostic_horizon(&history[..3], &CRITERIA), None);
        assert_eq!(prognostic_horizon(&history[..1], &CRITERIA), None);
        // Half of the mass is enough, a third is not.
        assert_eq!(prognostic_horizon(&[scored(50.0, &[50.0, 500.0])], &CRITERIA), Some(50.0));
        assert_eq!(prognostic_horizon(&[scored(50.0, &[50.0, 500.0, 500.0])], &CRITERIA), None);
    }

    #[test]
    fn convergence_is_the_distance_of_the_errors_centroid() {
        // Errors of 0.4 lives from 0.2 to 0.6, and of 0.1 from 0.6 to 1: areas 0.16 and 0.04 about the times 0.4 and 0.8
        // and the heights 0.2 and 0.05. The centroid: (0.064 + 0.032) / 0.2 = 0.48 and (0.032 + 0.002) / 0.2 = 0.17.
        let history = [scored(60.0, &[50.0]), scored(20.0, &[120.0])];
        near(convergence(&history).unwrap(), 0.28_f64.hypot(0.17));
        assert_eq!(convergence(&[scored(20.0, &[80.0])]), Some(0.0));
        assert_eq!(convergence(&[]), None);
        // The same errors at the end converge later.
        let late = [scored(20.0, &[90.0]), scored(60.0, &[80.0])];
        assert!(convergence(&late) > convergence(&history));
    }

    #[test]
    fn figures_average_over_forecasts_and_course_over_histories() {
        let (good, bad) = (scored(50.0, &[50.0]), scored(50.0, &[500.0]));
        let histories = [vec![good.clone(), scored(80.0, &[30.0])], vec![bad], vec![]];
        let all = figures(&histories, &CRITERIA).unwrap();
        assert_eq!(all.forecasts, 3);
        near(all.mra, (1.0 + 0.5) / 3.0);
        // (0.5 * 1 + 0.8 * 0.5) / 1.3 of the first history, 0 of the second.
        near(all.cra, 0.5 * 0.9 / 1.3);
        near(all.alpha_lambda, 1.0 / 3.0);
        near(all.alpha_lambda_beta, 1.0 / 3.0);
        near(all.ncrps, (0.0 + 0.1 + 4.5) / 3.0);
        near(all.coverage_90, 1.0 / 3.0);
        assert_eq!((all.width_50, all.width_90), (0.0, 0.0));
        let late = figures_within(&histories, &CRITERIA, &(0.6..1.0)).unwrap();
        assert_eq!((late.forecasts, late.mra, late.cra), (1, 0.5, 0.5));
        assert_eq!(figures_within(&histories, &CRITERIA, &(0.0..0.5)), None);
        let course = course(&histories, &CRITERIA).unwrap();
        assert_eq!(course.histories, 2);
        near(course.prognostic_horizon, 0.25);
        near(course.prognostic_horizon_lasting, 0.25);
        assert_eq!(figures(&[vec![]], &CRITERIA), None);
    }

    #[test]
    fn the_median_of_an_even_number_is_between_the_middle_two() {
        assert_eq!(median(vec![4.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 8.0]), Some(3.0));
        assert_eq!(median(vec![]), None);
    }
}
