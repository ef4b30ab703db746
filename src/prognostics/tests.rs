//! Remaining life on histories made for the purpose.

use proptest::prelude::*;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;

fn rising(at: f64) -> Question {
    let direction = Direction::Rising;
    let prior = LifePrior::Watched;
    Question {
        threshold: 1.0,
        direction,
        healthy: Some(0.0),
        at,
        life_start: None,
        horizon: None,
        risk_window: 10.0,
        prior,
    }
}

fn observed(values: impl IntoIterator<Item = (f64, f64)>) -> Vec<Observation> {
    values.into_iter().map(|(usage, value)| Observation { usage, value, std: None }).collect()
}

/// A level `slope * usage` seen `n` times up to usage 100 through noise.
fn noisy_line(n: usize, slope: f64, noise: f64, seed: u64) -> Vec<Observation> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    observed((0..n).map(|i| {
        let usage = 100.0 * i as f64 / (n - 1) as f64;
        let deviate: f64 = StandardNormal.sample(&mut random);
        (usage, slope * usage + noise * deviate)
    }))
}

fn forecast(history: &[Observation], question: &Question) -> Forecast {
    remaining_life(history, question).unwrap().forecast.unwrap()
}

fn places(history: &[Observation], question: &Question) -> Vec<String> {
    remaining_life(history, question).unwrap_err().problems.into_iter().map(|p| p.place).collect()
}

#[test]
fn the_90_percent_interval_covers_the_truth_of_straight_growth_at_least_four_times_in_five() {
    let mut covered = 0;
    for seed in 0..200 {
        let true_life = 50.0 + seed as f64;
        let history = noisy_line(20, 1.0 / (100.0 + true_life), 0.03, seed);
        let quantiles = forecast(&history, &rising(100.0)).quantiles;
        let inside = quantiles.q05.unwrap() <= true_life && quantiles.q95.is_none_or(|q| true_life <= q);
        covered += usize::from(inside);
    }
    assert!(covered >= 160, "{covered} of 200");
}

#[test]
fn the_median_is_near_the_truth_on_a_straight_history() {
    let median = forecast(&noisy_line(50, 0.005, 0.01, 1), &rising(100.0)).quantiles.q50.unwrap();
    assert!((median - 100.0).abs() < 10.0, "{median}");
}

#[test]
fn more_data_narrow_the_interval() {
    let width = |n, seed| {
        let forecast = forecast(&noisy_line(n, 0.006, 0.05, seed), &rising(100.0));
        forecast.quantiles.q95.unwrap_or(forecast.horizon) - forecast.quantiles.q05.unwrap()
    };
    // One history may be scattered more than another, so it is the mean of twenty that narrows.
    let width = |n| (0..20).map(|seed| width(n, seed)).sum::<f64>() / 20.0;
    let widths = [4, 16, 64].map(width);
    assert!(widths[0] > widths[1] && widths[1] > widths[2], "{widths:?}");
}

#[test]
fn a_healthy_flat_history_is_of_no_risk_and_lasts_for_ages() {
    let prognosis = remaining_life(&noisy_line(30, 0.0, 0.01, 5), &rising(100.0)).unwrap();
    let forecast = prognosis.forecast.unwrap();
    assert!(forecast.quantiles.q50.unwrap() > 300.0, "{forecast:?}");
    assert_eq!(forecast.quantiles.q95, None);
    assert_eq!(forecast.horizon, 2000.0);
    assert!(prognosis.risk.unwrap() < 0.02, "{:?}", prognosis.risk);
}

#[test]
fn one_noisy_value_past_the_threshold_is_not_reached() {
    let mut history = noisy_line(20, 0.004, 0.02, 7);
    history.last_mut().unwrap().value = 1.3;
    assert!(!forecast(&history, &rising(100.0)).reached);
    assert!(!forecast(&observed([(100.0, 1.3)]), &rising(100.0)).reached);
    let two = remaining_life(&observed([(50.0, 0.2), (100.0, 1.5)]), &rising(100.0)).unwrap();
    assert!(!two.forecast.unwrap().reached);
}

#[test]
fn a_clear_crossing_is_reached() {
    let prognosis = remaining_life(&noisy_line(20, 0.013, 0.02, 9), &rising(100.0)).unwrap();
    assert!(prognosis.risk.unwrap() > 0.95);
    assert_eq!(prognosis.band.len(), 1);
    let forecast = prognosis.forecast.unwrap();
    assert!(forecast.reached);
    assert_eq!(forecast.quantiles.q50, Some(0.0));
}

#[test]
fn a_value_that_goes_past_the_threshold_and_comes_back_is_not_reached() {
    let history = observed((0..20).map(|i| (5.0 * i as f64, if i == 8 || i == 9 { 1.2 } else { 0.3 })));
    assert!(!forecast(&history, &rising(95.0)).reached);
}

#[test]
fn falling_mirrors_rising_exactly() {
    let history = noisy_line(20, 0.006, 0.02, 11);
    let mirrored: Vec<_> = history.iter().map(|o| Observation { value: -o.value, ..*o }).collect();
    let question = rising(100.0);
    let fall = Question { threshold: -1.0, direction: Direction::Falling, healthy: Some(-0.0), ..question.clone() };
    let (up, down) = (remaining_life(&history, &question).unwrap(), remaining_life(&mirrored, &fall).unwrap());
    assert_eq!(up.forecast, down.forecast);
    assert_eq!(up.risk, down.risk);
    for (a, b) in up.band.iter().zip(&down.band) {
        assert_eq!((a.usage, a.low, a.median, a.high), (b.usage, -b.high, -b.median, -b.low));
    }
}

#[test]
fn the_forecast_does_not_depend_on_the_units() {
    let history = noisy_line(20, 0.006, 0.02, 13);
    let scaled: Vec<_> =
        history.iter().map(|o| Observation { usage: 3600.0 * o.usage, value: 1e-3 * o.value, std: None }).collect();
    let question = rising(100.0);
    let other = Question { threshold: 1e-3, at: 360_000.0, risk_window: 36_000.0, ..question.clone() };
    let (a, b) = (forecast(&history, &question), forecast(&scaled, &other));
    for ((_, a), (_, b)) in a.quantiles.pairs().into_iter().zip(b.quantiles.pairs()) {
        let (a, b) = (a.unwrap(), b.unwrap() / 3600.0);
        assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    }
}

#[test]
fn competing_faults_end_no_later_than_each_alone() {
    let question = rising(100.0);
    let slow = remaining_life(&noisy_line(20, 0.005, 0.02, 15), &question).unwrap();
    let fast = remaining_life(&noisy_line(20, 0.006, 0.02, 16), &question).unwrap();
    let none = remaining_life(&[], &question).unwrap();
    let both = competing(&[("kgm", &slow), ("fdj_n", &fast), ("clogging", &none)]).unwrap();
    let median = |p: &Prognosis| p.forecast.as_ref().unwrap().quantiles.q50.unwrap();
    assert!(median(&both) < median(&slow).min(median(&fast)));
    assert!(both.risk.unwrap() >= slow.risk.unwrap().max(fast.risk.unwrap()));
    let product = slow.survival(50.0).unwrap() * fast.survival(50.0).unwrap();
    assert!((both.survival(50.0).unwrap() - product).abs() < 1e-12);
    assert!(both.reasons.iter().any(|r| r.starts_with("clogging has no forecast")), "{:?}", both.reasons);
}

#[test]
fn competing_faults_asked_at_different_usages_are_refused() {
    let history = noisy_line(20, 0.005, 0.02, 15);
    let parts = [100.0, 120.0].map(|at| remaining_life(&history, &rising(at)).unwrap());
    let error = competing(&[("kgm", &parts[0]), ("fdj_n", &parts[1])]).unwrap_err();
    assert_eq!(error.to_string(), "fdj_n.at is 120, expected 100, as the first");
}

#[test]
fn nothing_competing_is_no_forecast() {
    let together = competing(&[]).unwrap();
    assert!(together.forecast.is_none() && together.risk.is_none());
    assert_eq!(together.reasons, ["no fault to forecast"]);
}

#[test]
fn no_observation_is_no_forecast_with_a_reason() {
    let prognosis = remaining_life(&observed([(200.0, 0.3)]), &rising(100.0)).unwrap();
    assert!(prognosis.forecast.is_none() && prognosis.risk.is_none() && prognosis.band.is_empty());
    assert_eq!(prognosis.reasons, ["no observation of this life up to usage 100"]);
}

#[test]
fn one_observation_gives_the_wide_answer_of_the_prior() {
    let question = Question { life_start: Some(0.0), ..rising(100.0) };
    let prognosis = remaining_life(&observed([(100.0, 0.1)]), &question).unwrap();
    let quantiles = prognosis.forecast.unwrap().quantiles;
    assert!(quantiles.q90.unwrap() > 4.0 * quantiles.q10.unwrap(), "{quantiles:?}");
    assert!(prognosis.reasons[0].starts_with("only one observation"), "{:?}", prognosis.reasons);
}

#[test]
fn a_life_of_no_age_gets_a_forecast() {
    let prognosis = remaining_life(&observed([(7.0, 0.1)]), &Question { risk_window: 0.0, ..rising(7.0) }).unwrap();
    assert_eq!(prognosis.forecast.unwrap().horizon, 20.0);
}

#[test]
fn observations_after_the_question_and_before_the_life_are_not_used() {
    let history = noisy_line(21, 0.006, 0.02, 17);
    let question = Question { life_start: Some(20.0), ..rising(60.0) };
    let used: Vec<_> = history.iter().filter(|o| (20.0..=60.0).contains(&o.usage)).copied().collect();
    assert!(used.len() < history.len() && forecast(&history, &question) == forecast(&used, &question));
}

#[test]
fn an_uncertain_observation_weighs_less() {
    let mut history = noisy_line(20, 0.004, 0.02, 19);
    history[19].value = 0.46;
    let median = |h: &[Observation]| forecast(h, &rising(100.0)).quantiles.q50.unwrap();
    let trusted = median(&history);
    history[19].std = Some(1.0);
    assert!(median(&history) > trusted);
}

#[test]
fn the_mean_of_a_narrow_forecast_lies_within_it_and_no_probability_is_negative() {
    let straight = observed((0..5000).map(|i| (f64::from(i), 0.5 * f64::from(i) / 5000.0)));
    let prognosis = remaining_life(&straight, &rising(4999.0)).unwrap();
    let Forecast { quantiles, mean, .. } = prognosis.forecast.unwrap();
    let (low, high) = (quantiles.q25.unwrap(), quantiles.q75.unwrap());
    assert!((low..high).contains(&mean.unwrap()), "{mean:?} of {quantiles:?}");
    assert!(prognosis.laws.iter().all(|(_, probability)| probability.is_sign_positive()), "{:?}", prognosis.laws);
}

#[test]
fn a_long_history_says_what_a_short_one_does_and_more_surely() {
    let width = |n| {
        let q = forecast(&noisy_line(n, 0.005, 0.05, 21), &rising(100.0)).quantiles;
        assert!((q.q50.unwrap() - 100.0).abs() < 25.0);
        q.q95.unwrap() - q.q05.unwrap()
    };
    assert!(width(20_000) < width(20));
}

#[test]
fn every_bad_field_is_named_with_its_index() {
    let mut history = observed([(0.0, f64::NAN), (5.0, 0.1), (4.0, 0.1), (6.0, 0.1)]);
    history[3].std = Some(-1.0);
    assert_eq!(places(&history, &rising(10.0)), ["history[0].value", "history[2].usage", "history[3].std"]);
    let question = Question { threshold: f64::INFINITY, horizon: Some(0.0), risk_window: f64::NAN, ..rising(10.0) };
    assert_eq!(places(&[], &question), ["threshold", "threshold", "horizon", "risk_window"]);
    assert_eq!(places(&[], &Question { direction: Direction::Falling, ..rising(10.0) }), ["threshold"]);
    assert_eq!(places(&[], &Question { life_start: Some(11.0), ..rising(10.0) }), ["life_start"]);
}

#[test]
fn quantiles_are_named_by_their_probabilities_in_json() {
    let json = serde_json::to_value(forecast(&noisy_line(20, 0.006, 0.02, 23), &rising(100.0))).unwrap();
    let names: Vec<_> = json["quantiles"].as_object().unwrap().keys().cloned().collect();
    assert_eq!(names, ["0.05", "0.1", "0.25", "0.5", "0.75", "0.9", "0.95"]);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn valid_input_gives_finite_ordered_answers(
        steps in prop::collection::vec((0.0..1e3_f64, -2.0..2.0_f64, prop::option::of(0.0..10.0_f64)), 1..40),
        exponent in -30..30_i32,
        ahead in 0.0..100.0_f64,
        risk_window in 0.0..1e4_f64,
    ) {
        let unit = 10_f64.powi(exponent);
        let mut usage = 0.0;
        let mut history = Vec::new();
        for (step, value, std) in steps {
            // Every third step or so is none: equal usages.
            usage += (step - 300.0).max(0.0);
            history.push(Observation { usage, value: value * unit, std: std.map(|s| s * unit) });
        }
        let question = Question { threshold: unit, risk_window, ..rising(usage + ahead) };
        let prognosis = remaining_life(&history, &question).unwrap();
        let forecast = prognosis.forecast.unwrap();
        let mut previous = 0.0;
        let mut ended = false;
        for (_, quantile) in forecast.quantiles.pairs() {
            match quantile {
                Some(q) => {
                    prop_assert!(!ended && q >= previous && q <= forecast.horizon, "{:?}", forecast);
                    previous = q;
                }
                None => ended = true,
            }
        }
        prop_assert!((0.0..=forecast.horizon).contains(&forecast.mean.unwrap()));
        prop_assert!((0.0..=1.0).contains(&prognosis.risk.unwrap()));
        prop_assert!((0.0..=1.0).contains(&forecast.probability_beyond_horizon));
        for point in &prognosis.band {
            prop_assert!(point.low <= point.median && point.median <= point.high && point.high.is_finite());
        }
    }
}

/// Values about 0.6 x (x 0 to 1) seen through noise, then changed.
fn changed(change: impl Fn(usize, &mut f64)) -> Prognosis {
    let mut history = noisy_line(40, 0.006, 0.01, 31);
    history.iter_mut().enumerate().for_each(|(i, o)| change(i, &mut o.value));
    remaining_life(&history, &rising(100.0)).unwrap()
}

#[test]
fn a_smooth_history_has_no_changes() {
    for seed in 0..50 {
        let history = noisy_line(40, 0.006, 0.01, seed);
        let changes = remaining_life(&history, &rising(100.0)).unwrap().changes;
        assert!(changes.is_empty(), "{seed}: {changes:?}");
    }
}

#[test]
fn an_outlier_is_named_and_hardly_moves_the_forecast() {
    let median = |p: &Prognosis| p.forecast.as_ref().unwrap().quantiles.q50.unwrap();
    let (clean, with) = (changed(|_, _| {}), changed(|i, value| *value += if i == 25 { 0.3 } else { 0.0 }));
    assert_eq!(with.changes.len(), 1, "{:?}", with.changes);
    assert_eq!((with.changes[0].kind, with.changes[0].usage), (ChangeKind::Outlier, 100.0 * 25.0 / 39.0));
    assert!((median(&with) / median(&clean) - 1.0).abs() < 0.1, "{} {}", median(&with), median(&clean));
}

#[test]
fn an_outlier_below_the_threshold_does_not_undo_a_history_past_it() {
    let history = observed((0..8).map(|i| (10.0 * i as f64, if i == 2 { 0.1 } else { 5.0 + 0.01 * (i % 2) as f64 })));
    let found = forecast(&history, &Question { healthy: None, ..rising(70.0) });
    assert!(found.reached, "{found:?}");
    assert_eq!(found.quantiles.q50, Some(0.0));
}

#[test]
fn a_step_is_named_with_its_size_and_growth_goes_on_from_there() {
    let with = changed(|i, value| *value += if i >= 25 { 0.2 } else { 0.0 });
    let step = with.changes[0];
    assert_eq!((with.changes.len(), step.kind, step.usage), (1, ChangeKind::Step, 100.0 * 25.0 / 39.0));
    assert!((step.size - 0.2).abs() < 0.03, "{step:?}");
    let median = with.forecast.unwrap().quantiles.q50.unwrap();
    assert!((20.0..50.0).contains(&median), "0.2 of the way is left at 0.006 an hour: {median}");
}

#[test]
fn a_repair_that_nobody_reported_is_named_and_begins_a_new_life() {
    let with = changed(|i, value| *value -= if i >= 20 { 0.3 } else { 0.0 });
    assert_eq!(with.changes[0].kind, ChangeKind::Renewal, "{:?}", with.changes);
    let usage = 100.0 * 20.0 / 39.0;
    assert_eq!(with.changes[0].usage, usage);
    let after: Vec<_> = noisy_line(40, 0.006, 0.01, 31)
        .split_off(20)
        .into_iter()
        .map(|o| Observation { value: o.value - 0.3, ..o })
        .collect();
    let alone = forecast(&after, &Question { life_start: Some(usage), ..rising(100.0) });
    // Read off at other nodes, as the horizon is the whole history's.
    let medians = [with.forecast.unwrap(), alone].map(|f| f.quantiles.q50.unwrap());
    assert!((medians[0] / medians[1] - 1.0).abs() < 1e-3, "{medians:?}");
}

#[test]
fn an_observation_more_moves_the_end_of_life_little() {
    let history = noisy_line(60, 0.008, 0.02, 11);
    let end = |n: usize| {
        let at = history[n - 1].usage;
        at + forecast(&history[..n], &rising(at)).quantiles.q50.unwrap()
    };
    let ends: Vec<f64> = (6..=60).map(end).collect();
    let moves: Vec<f64> = ends.windows(2).map(|pair| (pair[1] / pair[0] - 1.0).abs()).collect();
    let mean = moves.iter().sum::<f64>() / moves.len() as f64;
    let most = moves.iter().copied().fold(0.0, f64::max);
    assert!(mean < 0.03 && most < 0.25, "moved by {mean} in the mean, {most} at most: {ends:?}");
}

/// A straight life that ends at `life`, seen every 50 up to `at`.
fn straight(life: f64, at: f64, seed: u64) -> Vec<Observation> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let usages = (0..).map(|i| 50.0 * f64::from(i)).take_while(|&usage| usage <= at);
    observed(usages.map(|usage| {
        let deviate: f64 = StandardNormal.sample(&mut random);
        (usage, usage / life + 0.05 * deviate)
    }))
}

/// The tallies of actuators of one life each, added up.
fn added_up(lives: &[LifeEvidence]) -> Vec<i64> {
    let mut sum = Vec::new();
    for life in lives {
        let tally = tally(std::slice::from_ref(life)).unwrap();
        sum.resize(tally.len(), 0);
        sum.iter_mut().zip(tally).for_each(|(sum, count)| *sum += i64::from(count));
    }
    sum
}

#[test]
fn a_fleet_helps_the_early_forecasts_of_its_next_part() {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(41);
    let mut life = || {
        let deviate: f64 = StandardNormal.sample(&mut random);
        5000.0 * (0.2 * deviate).exp()
    };
    // Ten lives that ended and ten that are under way: what is known of these is censored.
    let lives: Vec<LifeEvidence> = (0..20)
        .map(|i| {
            let life = life();
            let at = if i < 10 { life } else { life * 0.1 * (f64::from(i) - 9.5) };
            let question = Question { life_start: Some(0.0), ..rising(at) };
            remaining_life(&straight(life, at, i as u64), &question).unwrap().evidence.unwrap()
        })
        .collect();
    let fleet = Fleet::new(&added_up(&lives), &[]).unwrap();
    let error = |prior: &LifePrior| {
        let mut random = Xoshiro256PlusPlus::seed_from_u64(43);
        (0..40)
            .map(|i| {
                let deviate: f64 = StandardNormal.sample(&mut random);
                let life = 5000.0 * (0.2 * deviate).exp();
                let at = 0.15 * life;
                let question = Question { life_start: Some(0.0), prior: prior.clone(), ..rising(at) };
                let median = forecast(&straight(life, at, 100 + i), &question).quantiles.q50.unwrap();
                (median - (life - at)).abs() / life
            })
            .sum::<f64>()
            / 40.0
    };
    let (alone, together) = (error(&LifePrior::Watched), error(&LifePrior::Fleet(fleet)));
    assert!(together < 0.5 * alone, "mean error over life: {together} with the fleet, {alone} without");
}

/// What a straight life of so many hours says of its length when seen up to a part of it.
fn evidence(life: f64, part: f64, seed: u64) -> LifeEvidence {
    let at = part * life;
    let question = Question { life_start: Some(0.0), ..rising(at) };
    remaining_life(&straight(life, at, seed), &question).unwrap().evidence.unwrap()
}

#[test]
fn a_fleet_of_young_parts_promises_what_the_age_alone_does() {
    for (count, age) in [(30, 0.02), (1000, 0.02), (300, 0.06)] {
        let young: Vec<LifeEvidence> = (0..count).map(|i| evidence(5000.0, age, i)).collect();
        let fleet = Fleet::new(&added_up(&young), &[]).unwrap();
        let quantiles = |prior: LifePrior| {
            let question = Question { life_start: Some(0.0), prior, ..rising(1000.0) };
            let found = forecast(&straight(5000.0, 1000.0, 7), &question).quantiles;
            [found.q05, found.q50, found.q95.or(Some(20_000.0))].map(Option::unwrap)
        };
        let (alone, among_them) = (quantiles(LifePrior::Watched), quantiles(LifePrior::Fleet(fleet)));
        for (alone, among_them) in alone.into_iter().zip(among_them) {
            let ratio = among_them / alone;
            assert!((0.5..2.0).contains(&ratio), "{count} at {age}: {among_them} among young parts, {alone} alone");
        }
    }
}

#[test]
fn the_earlier_lives_of_a_part_count_for_more_than_those_of_others() {
    let of_others: Vec<LifeEvidence> = (0..6).map(|i| evidence(4000.0 + 400.0 * i as f64, 1.0, i)).collect();
    let own: Vec<LifeEvidence> = (0..2).map(|i| evidence(10_000.0, 1.0, 10 + i)).collect();
    let median = |others: &[i64], own: &[LifeEvidence]| {
        let prior = LifePrior::Fleet(Fleet::new(others, own).unwrap());
        let question = Question { life_start: Some(0.0), horizon: Some(1e5), prior, ..rising(100.0) };
        100.0 + forecast(&straight(7000.0, 100.0, 21), &question).quantiles.q50.unwrap()
    };
    let others = added_up(&of_others);
    assert!((4000.0..6500.0).contains(&median(&others, &[])), "{}", median(&others, &[]));
    let pooled = added_up(&[of_others, own.clone()].concat());
    assert!(median(&others, &own) > 1.3 * median(&pooled, &[]), "own {}", median(&others, &own));
    assert!((7000.0..11_000.0).contains(&median(&others, &own)), "{}", median(&others, &own));
}

#[test]
fn the_heavy_law_has_its_tabled_quantile_and_the_slope_of_its_density() {
    // Student's law with 3 degrees of freedom has 0.95 at 2.353363.
    assert!((normal::heavy_cumulative(2.353_363) - 0.95).abs() < 1e-6);
    for z in [-4.0, -0.5, 0.0, 1.0, 3.0] {
        let slope = (normal::heavy_cumulative(z + 1e-4) - normal::heavy_cumulative(z - 1e-4)) / 2e-4;
        assert!((slope.ln() - normal::log_heavy(z, 1.0)).abs() < 1e-6, "{z}");
    }
    assert_eq!([f64::NEG_INFINITY, f64::INFINITY].map(|z| normal::heavy_cumulative(z).round()), [0.0, 1.0]);
}
