//! The estimation on traces of the reference model, whose faults are known, and on traces that must not be believed.

use std::collections::BTreeMap;
use std::sync::Mutex;

use elevon::estimation::method::Method;
use elevon::estimation::request::Objective;
use elevon::estimation::{Estimate, EstimationError, Settings, Verdict, estimate};
use elevon::models::fault::Faults;
use elevon::models::parameters::ParameterSet;
use elevon::models::simulate::{ModelKind, Simulation, simulate};
use elevon::models::trace::{Channel, Trace};
use elevon::numeric::rng::Seed;
use elevon::numeric::watch::{Unwatched, Watch};
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;

/// A trace of the reference model at 1 kHz.
fn recorded(command: &str, kgm: f64, fdj_n: f64, noise_power_ma2_s: f64, seed: u64) -> Trace {
    let faults = Faults { kgm, fdj_n, ..Faults::default() };
    let quiet = Simulation::new(ModelKind::Reference, command.parse().unwrap(), faults, 6.0, 1000.0);
    let recipe = Simulation { noise_power_ma2_s, seed, ..quiet };
    simulate(&recipe, &ParameterSet::reference(), &Unwatched).unwrap()
}

fn diagnostic(kgm: f64, fdj_n: f64) -> Trace {
    recorded("diagnostic", kgm, fdj_n, 0.0, 1)
}

fn estimated(trace: &Trace) -> Estimate {
    estimate(trace, &ParameterSet::reference(), &Settings::default(), &Unwatched).unwrap()
}

/// The same trace with every sample (time, then the channels that were recorded) sent through a function.
fn altered(trace: &Trace, alter: impl Fn(Option<Channel>, f64, f64) -> f64) -> Trace {
    let time_s = trace.time_s();
    let column = |channel: Channel| {
        let values = trace.channel(channel)?;
        Some((channel, values.iter().zip(time_s).map(|(&v, &t)| alter(Some(channel), t, v)).collect()))
    };
    let channels: BTreeMap<Channel, Vec<f64>> = Channel::ALL.into_iter().filter_map(column).collect();
    Trace::try_new(time_s.iter().map(|&t| alter(None, t, t)).collect(), channels, Vec::new()).unwrap()
}

/// Every fifth sample of a trace, and of those not the ones that a recorder would drop now and then.
fn fewer(trace: &Trace) -> Trace {
    let kept =
        |values: &[f64]| values.iter().step_by(5).enumerate().filter(|(i, _)| i % 17 != 3).map(|(_, &v)| v).collect();
    let channels = Channel::ALL.into_iter().filter_map(|channel| Some((channel, kept(trace.channel(channel)?))));
    Trace::try_new(kept(trace.time_s()), channels.collect(), Vec::new()).unwrap()
}

/// An inconclusive estimate, without a figure and with a reason that says this.
fn assert_inconclusive(found: &Estimate, why: &str) {
    assert_eq!(found.verdict, Verdict::Inconclusive, "{found:?}");
    assert_eq!((found.kgm, found.kgm_std, found.fdj_n, found.fdj_n_std), (None, None, None, None));
    assert!(found.reasons.iter().any(|reason| reason.contains(why)), "{why}: {:?}", found.reasons);
}

#[test]
fn recovers_faults_between_those_of_the_thesis_s_tables() {
    let pairs = [(0.0, 210.0), (0.03, 470.0), (0.12, 333.0), (0.27, 555.0), (0.33, 910.0), (0.45, 1100.0)];
    pairs.par_iter().for_each(|&(kgm, fdj_n)| {
        let found = estimated(&diagnostic(kgm, fdj_n));
        assert_eq!(found.verdict, Verdict::Conclusive, "{found:?}");
        assert!((found.kgm.unwrap() - kgm).abs() < 0.003, "KGM {kgm}, FDJ {fdj_n}: {found:?}");
        assert!((found.fdj_n.unwrap() / fdj_n - 1.0).abs() < 0.001, "KGM {kgm}, FDJ {fdj_n}: {found:?}");
    });
}

#[test]
fn recovers_faults_through_the_thesis_s_noise_and_knows_how_well() {
    let truths: Vec<(f64, f64, u64)> =
        (0..20u32).map(|i| (0.02 * f64::from(i), 220.0 + 40.0 * f64::from(i), u64::from(i) + 1)).collect();
    let within: usize = truths
        .par_iter()
        .map(|&(kgm, fdj_n, seed)| {
            let found = estimated(&recorded("diagnostic", kgm, fdj_n, 5e-6, seed));
            let (kgm_error, fdj_error) = (found.kgm.unwrap() - kgm, found.fdj_n.unwrap() - fdj_n);
            assert!(kgm_error.abs() < 0.02 && fdj_error.abs() < 0.02 * fdj_n, "KGM {kgm}, FDJ {fdj_n}: {found:?}");
            usize::from(kgm_error.abs() < 2.0 * found.kgm_std.unwrap())
                + usize::from(fdj_error.abs() < 2.0 * found.fdj_n_std.unwrap())
        })
        .sum();
    // Of 40 figures, 38 are expected within two standard deviations; 32 or fewer would be a rare accident.
    assert!(within > 32, "{within} of 40");
}

#[test]
fn recovers_the_same_from_a_later_start_the_other_direction_and_fewer_samples() {
    let trace = diagnostic(0.2, 600.0);
    let plain = estimated(&trace);
    let later = altered(&trace, |channel, _, value| if channel.is_none() { value + 1000.0 } else { value });
    let mirrored = altered(&trace, |channel, _, value| if channel.is_none() { value } else { -value });
    for (what, other, tolerance) in
        [("later", later, 1e-5), ("mirrored", mirrored, 1e-5), ("fewer", fewer(&trace), 1e-3)]
    {
        let found = estimated(&other);
        assert!((found.kgm.unwrap() - plain.kgm.unwrap()).abs() < tolerance, "{what}: {found:?}");
        assert!((found.fdj_n.unwrap() - plain.fdj_n.unwrap()).abs() < 5e3 * tolerance, "{what}: {found:?}");
    }
}

#[test]
fn a_command_without_the_manoeuvres_is_inconclusive_by_its_features() {
    let reason = "the command has no manoeuvre that is known to show the fault";
    let by_features = Settings { objective: Objective::Features, ..Settings::default() };
    for command in ["step:0", "sine:0.05@0.5", "sequence:0.05@0,-0.025@0.5,0.0125@1,-0.05@1.5,0@2", "ramp:0.02"] {
        let trace = recorded(command, 0.2, 600.0, 0.0, 1);
        assert_inconclusive(&estimate(&trace, &ParameterSet::reference(), &by_features, &Unwatched).unwrap(), reason);
    }
    assert_inconclusive(&estimated(&recorded("step:0", 0.2, 600.0, 0.0, 1)), "the command does not move");
}

/// A trace whose sensors are wrong in one way, with and without a recorded position.
fn assert_disbelieved(which: Channel, to: impl Fn(f64) -> f64, with_position: &str, without: &str) {
    let recorded = altered(&diagnostic(0.35, 900.0), |channel, _, v| if channel == Some(which) { to(v) } else { v });
    let kept = [Channel::PositionCommand, Channel::ServovalveCurrent, Channel::LoadPressure];
    let channels = kept.map(|channel| (channel, recorded.channel(channel).unwrap().to_vec()));
    let bare = Trace::try_new(recorded.time_s().to_vec(), channels.into(), Vec::new()).unwrap();
    assert_inconclusive(&estimated(&recorded), with_position);
    assert_inconclusive(&estimated(&bare), without);
}

#[test]
fn a_sensor_that_is_dead_stuck_clipped_or_wrongly_wired_is_not_believed() {
    let (current, pressure) = (Channel::ServovalveCurrent, Channel::LoadPressure);
    let (asked, short) = ("command and jack position ask for", "after the step where");
    let (stuck, fit) = ("stuck or clipped", "no faults explain");
    assert_disbelieved(current, |_| 0.0, asked, short);
    assert_disbelieved(current, |_| 10e-3, asked, stuck);
    assert_disbelieved(current, |a| a.clamp(-12e-3, 12e-3), asked, short);
    assert_disbelieved(current, |a| -a, asked, short);
    assert_disbelieved(pressure, |_| 0.0, fit, fit);
    assert_disbelieved(pressure, |_| 1e6, stuck, stuck);
    assert_disbelieved(pressure, |pa| 10.0 * pa, fit, fit);
    assert_disbelieved(pressure, |pa| -pa, fit, fit);
}

#[test]
fn a_biased_current_sensor_is_not_believed_where_the_position_is_known() {
    let biased = altered(&diagnostic(0.2, 600.0), |channel, _, value| match channel {
        Some(Channel::ServovalveCurrent) => value + 1e-3,
        _ => value,
    });
    assert_inconclusive(&estimated(&biased), "command and jack position ask for");
}

#[test]
fn a_recorded_load_or_another_supply_is_inconclusive() {
    let with = |channel: Channel, value: f64| {
        let trace = diagnostic(0.2, 600.0);
        let mut channels: BTreeMap<Channel, Vec<f64>> =
            Channel::ALL.into_iter().filter_map(|c| Some((c, trace.channel(c)?.to_vec()))).collect();
        channels.insert(channel, vec![value; trace.samples()]);
        estimated(&Trace::try_new(trace.time_s().to_vec(), channels, Vec::new()).unwrap())
    };
    // A load and a supply that were recorded but did not act.
    assert_inconclusive(&with(Channel::ExternalLoad, 1000.0), "do not explain load_pressure_pa");
    assert_inconclusive(&with(Channel::SupplyPressure, 15.6e6), "do not explain");
    assert_eq!(with(Channel::ExternalLoad, 0.0).verdict, Verdict::Conclusive);
    assert_eq!(with(Channel::SupplyPressure, 20.6e6).verdict, Verdict::Conclusive);
}

#[test]
fn an_actuator_that_two_features_take_for_another_one_is_told_by_the_rest_of_its_trace() {
    let usual = [Channel::PositionCommand, Channel::ServovalveCurrent, Channel::LoadPressure, Channel::JackPosition];
    let others = [
        ("jack.area_m2", "0.00104"),
        ("reference.fluid.supply_pressure_pa", "15e6"),
        ("reference.fluid.clearance_extra_m", "30e-6"),
    ];
    others.par_iter().for_each(|(name, value)| {
        let set = ParameterSet::reference().with(&[((*name).to_owned(), (*value).to_owned())]).unwrap();
        let faults = Faults { kgm: 0.15, fdj_n: 500.0, ..Faults::default() };
        let recipe = Simulation::new(ModelKind::Reference, "diagnostic".parse().unwrap(), faults, 6.0, 1000.0);
        let trace = simulate(&recipe, &set, &Unwatched).unwrap();
        let channels = usual.map(|channel| (channel, trace.channel(channel).unwrap().to_vec()));
        let bare = Trace::try_new(trace.time_s().to_vec(), channels.into(), Vec::new()).unwrap();
        let by_features = Settings { objective: Objective::Features, ..Settings::default() };
        let taken_in = estimate(&bare, &ParameterSet::reference(), &by_features, &Unwatched).unwrap();
        assert_eq!(taken_in.verdict, Verdict::Conclusive, "{name}: {taken_in:?}");
        assert_inconclusive(&estimated(&bare), "do not explain servovalve_current_a");
    });
}

#[test]
fn a_random_walk_of_both_sensors_is_not_believed() {
    let command_m = diagnostic(0.1, 300.0);
    let walks = (0..30u64).into_par_iter().filter(|&seed| {
        let mut rng = Seed(seed).stream("walk", 0);
        let mut walk = |scale: f64| -> Vec<f64> {
            let step = |sum: &mut f64, _: usize| {
                *sum += scale * Distribution::<f64>::sample(&StandardNormal, &mut rng);
                Some(*sum)
            };
            (0..command_m.samples()).scan(0.0, step).collect()
        };
        let channels = [
            (Channel::PositionCommand, command_m.position_command_m().to_vec()),
            (Channel::ServovalveCurrent, walk(3e-4)),
            (Channel::LoadPressure, walk(2e4)),
        ];
        let trace = Trace::try_new(command_m.time_s().to_vec(), channels.into(), Vec::new()).unwrap();
        estimated(&trace).verdict == Verdict::Conclusive
    });
    assert_eq!(walks.count(), 0);
}

#[test]
fn a_trace_that_starts_in_mid_ramp_is_estimated_from_where_the_jack_is() {
    let trace = diagnostic(0.35, 900.0);
    let late = |values: &[f64]| values[1000..].to_vec();
    let channels = Channel::ALL.into_iter().filter_map(|c| Some((c, late(trace.channel(c)?)))).collect();
    let found = estimated(&Trace::try_new(late(trace.time_s()), channels, Vec::new()).unwrap());
    assert!((found.kgm.unwrap() - 0.35).abs() < 0.01 && (found.fdj_n.unwrap() / 900.0 - 1.0).abs() < 0.01, "{found:?}");
}

#[test]
fn a_saturated_current_and_a_jack_that_stands_still_are_inconclusive() {
    let stalled = recorded("diagnostic", 0.9, 600.0, 0.0, 1);
    assert_inconclusive(&estimated(&stalled), "the current is saturated");
    let stuck = altered(&diagnostic(0.2, 600.0), |channel, _, value| match channel {
        Some(Channel::JackPosition | Channel::JackVelocity) => 0.0,
        _ => value,
    });
    assert_inconclusive(&estimated(&stuck), "the jack does not follow the ramp");
}

#[test]
fn a_channel_that_was_not_recorded_is_named_by_the_features() {
    let trace = diagnostic(0.2, 600.0);
    let channels =
        [Channel::PositionCommand, Channel::ServovalveCurrent].map(|c| (c, trace.channel(c).unwrap().to_vec()));
    let partial = Trace::try_new(trace.time_s().to_vec(), channels.into(), Vec::new()).unwrap();
    let by_features = Settings { objective: Objective::Features, ..Settings::default() };
    let found = estimate(&partial, &ParameterSet::reference(), &by_features, &Unwatched).unwrap();
    assert_inconclusive(&found, "load_pressure_pa was not recorded");
}

#[test]
fn determinism_the_same_seed_gives_the_same_bits_on_any_number_of_threads() {
    let traces: Vec<Trace> = [(0.1, 300.0), (0.3, 700.0)].map(|(kgm, fdj_n)| diagnostic(kgm, fdj_n)).into();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| traces.par_iter().map(estimated).collect::<Vec<_>>())
    };
    let alone: Vec<Estimate> = traces.iter().map(estimated).collect();
    assert_eq!(on(1), alone);
    assert_eq!(on(4), alone);
}

#[test]
fn every_seed_of_the_search_ends_at_the_same_faults() {
    let trace = diagnostic(0.25, 480.0);
    let set = ParameterSet::reference();
    let found: Vec<Estimate> = (0..12u64)
        .into_par_iter()
        .map(|seed| estimate(&trace, &set, &Settings { seed, ..Settings::default() }, &Unwatched).unwrap())
        .collect();
    for other in &found {
        assert!((other.kgm.unwrap() - found[0].kgm.unwrap()).abs() < 1e-5, "{other:?}");
        assert!((other.fdj_n.unwrap() - found[0].fdj_n.unwrap()).abs() < 0.05, "{other:?}");
    }
}

#[test]
fn every_method_and_every_choice_of_the_genetic_algorithm_ends_at_the_same_faults() {
    let trace = diagnostic(0.25, 480.0);
    let set = ParameterSet::reference();
    let thesis = Settings::default();
    let methods = Method::ALL.map(|method| (Settings { method, ..thesis }, method.name().to_owned()));
    let choices = ["scaling=rank,selection=tournament:3", "crossover=heuristic:1.2,mutation=gaussian:0.25:1"];
    let choices = choices.map(|text| (Settings { ga: text.parse().unwrap(), ..thesis }, format!("ga({text})")));
    let all: Vec<(Settings, String)> = methods.into_iter().chain(choices).collect();
    all.par_iter().for_each(|(settings, told)| {
        let found = estimate(&trace, &set, settings, &Unwatched).unwrap();
        assert_eq!(found.method, *told);
        assert!((found.kgm.unwrap() - 0.25).abs() < 0.002, "{found:?}");
        assert!((found.fdj_n.unwrap() - 480.0).abs() < 0.2, "{found:?}");
        assert_eq!(estimate(&trace, &set, settings, &Unwatched).unwrap(), found, "the same seed, the same answer");
    });
}

#[test]
fn settings_out_of_range_are_refused_with_their_range() {
    let settings = Settings { population: 3, ..Settings::default() };
    let refused = estimate(&diagnostic(0.1, 300.0), &ParameterSet::reference(), &settings, &Unwatched).unwrap_err();
    assert_eq!(refused.to_string(), "population: found 3, expected 4 to 1000");
}

#[test]
fn progress_rises_to_its_end_and_a_cancelled_search_ends_at_once() {
    /// Keeps what it is told, and asks for an end after so many reports.
    struct Looker {
        reports: Mutex<Vec<f64>>,
        patience: usize,
    }
    impl Watch for Looker {
        fn progress(&self, fraction: f64) {
            self.reports.lock().unwrap().push(fraction);
        }

        fn cancelled(&self) -> bool {
            self.reports.lock().unwrap().len() >= self.patience
        }
    }
    let trace = diagnostic(0.1, 300.0);
    let watched = |patience: usize| {
        let looker = Looker { reports: Mutex::default(), patience };
        let found = estimate(&trace, &ParameterSet::reference(), &Settings::default(), &looker);
        (found, looker.reports.into_inner().unwrap())
    };
    let (found, reports) = watched(usize::MAX);
    assert_eq!(found.unwrap().verdict, Verdict::Conclusive);
    assert!(reports.len() > 11 && reports.windows(2).all(|pair| pair[0] < pair[1]), "{reports:?}");
    assert!(reports.iter().all(|fraction| (0.0..=1.0).contains(fraction)));
    let (found, reports) = watched(3);
    assert_eq!((found, reports.len()), (Err(EstimationError::Cancelled), 3));
}
