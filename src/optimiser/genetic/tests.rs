use super::*;
use crate::optimiser::functions::{conforms, kinked, run, sphere};

fn square() -> Bounds {
    Bounds::new(&[(-2.0, 2.0), (-2.0, 2.0)])
}

fn search(settings: Settings, seed: u64) -> Genetic {
    Genetic::new(&square(), settings, Seed(seed))
}

/// The thesis's settings with one choice changed.
fn with(choice: &str) -> Settings {
    Settings { choices: choice.parse().unwrap(), ..Settings::thesis(40, 10) }
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
    for choice in [
        "scaling=rank",
        "selection=roulette",
        "selection=tournament:3",
        "crossover=single_point",
        "crossover=two_points",
        "crossover=arithmetic",
        "crossover=intermediate:1",
        "crossover=heuristic:1.2",
        "mutation=gaussian:0.25:1",
        "mutation=uniform:0.5",
    ] {
        let cost = |seed| run(&mut search(with(choice), seed), &square(), sphere).0.cost;
        let mut costs: Vec<f64> = (0..15).map(cost).collect();
        costs.sort_by(f64::total_cmp);
        assert!(costs[7] < 0.01, "{choice}: {costs:?}");
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
    let settings = with("elite_share=0.2,mutation=uniform:1,crossover_share=0");
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
#[should_panic(expected = "cannot breed")]
fn a_population_too_small_to_breed_is_refused() {
    let _ = search(Settings::thesis(3, 1), 1);
}
