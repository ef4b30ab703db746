use super::*;
use crate::optimiser::functions::{conforms, kinked, rosenbrock, run, sphere};

fn square() -> Bounds {
    Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)])
}

fn search(settings: Settings, seed: u64) -> Genetic {
    Genetic::new(&square(), settings, Seed(seed))
}

/// The thesis's settings with one choice changed.
fn with(change: impl FnOnce(&mut Settings)) -> Settings {
    let mut settings = Settings::thesis(40, 10);
    change(&mut settings);
    settings
}

#[test]
fn conforms_to_what_is_asked_of_every_search() {
    let make = |bounds: &Bounds, population, generations, seed| {
        Genetic::new(bounds, Settings::thesis(population, generations), seed)
    };
    conforms(make, [0.05, 0.5, 1.0]);
}

#[test]
fn the_thesis_s_budget_is_forty_and_ten_generations_less_the_elite() {
    let (_, evaluations) = run(&mut search(Settings::thesis(40, 10), 1), &square(), sphere);
    assert_eq!(evaluations, 40 + 10 * 38);
}

#[test]
fn every_choice_comes_near_the_optimum() {
    let mut all = vec![with(|s| s.scaling = Scaling::Rank)];
    all.extend([Selection::Roulette, Selection::Tournament { size: 3 }].map(|c| with(|s| s.selection = c)));
    let crossovers = [
        Crossover::SinglePoint,
        Crossover::TwoPoints,
        Crossover::Arithmetic,
        Crossover::Intermediate { ratio: 1.0 },
        Crossover::Heuristic { ratio: 1.2 },
    ];
    all.extend(crossovers.map(|c| with(|s| s.crossover = c)));
    let mutations = [Mutation::Gaussian { scale: 0.25, shrink: 1.0 }, Mutation::Uniform { rate: 0.5 }];
    all.extend(mutations.map(|c| with(|s| s.mutation = c)));
    for settings in all {
        let mut costs: Vec<f64> =
            (0..15).map(|seed| run(&mut search(settings, seed), &square(), sphere).0.cost).collect();
        costs.sort_by(f64::total_cmp);
        assert!(costs[7] < 0.01, "{settings:?}: {costs:?}");
    }
}

#[test]
fn a_given_population_comes_first_clipped_and_is_filled_up_at_random() {
    let given = vec![vec![0.3, 0.3], vec![9.0, -9.0]];
    let mut seeded = Genetic::from_population(&square(), Settings::thesis(6, 0), Seed(1), given);
    let asked = seeded.ask().to_vec();
    assert_eq!(asked.len(), 6);
    assert_eq!(asked[..2], [vec![0.3, 0.3], vec![2.0, -2.0]]);
    assert_eq!(asked[2..], search(Settings::thesis(6, 0), 1).ask()[..4]);
}

#[test]
fn the_elite_survives() {
    let settings = with(|s| {
        s.elite_share = 0.2;
        s.mutation = Mutation::Uniform { rate: 1.0 };
        s.crossover_share = 0.0;
    });
    let mut genetic = search(settings, 3);
    let mut last = f64::INFINITY;
    while genetic.stop().is_none() {
        let costs: Vec<f64> = genetic.ask().iter().map(|c| kinked(c)).collect();
        genetic.tell(&costs);
        let best = genetic.costs.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(best <= last);
        last = best;
    }
}

#[test]
fn settings_out_of_their_ranges_are_refused() {
    let bad = [
        with(|s| s.population = 3),
        with(|s| s.crossover_share = 1.5),
        with(|s| s.elite_share = f64::NAN),
        with(|s| s.crossover = Crossover::Heuristic { ratio: 0.0 }),
        with(|s| s.mutation = Mutation::Gaussian { scale: -1.0, shrink: 0.5 }),
        with(|s| s.mutation = Mutation::Uniform { rate: 1.1 }),
        with(|s| s.selection = Selection::Tournament { size: 0 }),
    ];
    for settings in bad {
        assert!(std::panic::catch_unwind(|| search(settings, 1)).is_err(), "{settings:?}");
    }
    assert!(run(&mut search(Settings::thesis(4, 1), 1), &square(), rosenbrock).0.cost.is_finite());
}
