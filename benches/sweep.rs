//! How far the features of the optimiser's large step are from those of the semi-implicit step at 1e-5 s, over all faults,
//! and how far these themselves are from half that step: `cargo bench --bench sweep`, a minute or two.
#![allow(clippy::unwrap_used, reason = "a measurement that cannot go on should panic")]

#[path = "../tests/it/models/fine.rs"]
mod fine;

use rand::RngExt;
use rayon::prelude::*;

use elevon::estimation::evaluate::Proposal;
use elevon::numeric::rng::Seed;

/// Points drawn beside the grid of 20 by 19.
const DRAWN: usize = 400;
/// The bands of demagnetisation that a row of the table stands for.
const BANDS: [(f64, f64); 6] = [(0.0, 0.2), (0.2, 0.4), (0.4, 0.6), (0.6, 0.7), (0.7, 0.79), (0.79, 0.95)];

fn main() {
    let mut points: Vec<Proposal> = (0..20)
        .flat_map(|i| (0..19).map(move |j| (f64::from(i) * 0.05, 200.0 + 100.0 * f64::from(j))))
        .map(|(kgm, fdj_n)| Proposal { kgm, fdj_n })
        .collect();
    let mut rng = Seed(1).stream("sweep", 0);
    points.extend(
        (0..DRAWN).map(|_| Proposal { kgm: rng.random_range(0.0..=0.95), fdj_n: rng.random_range(200.0..=2000.0) }),
    );
    let large = fine::evaluator().features(&points);
    // Of the large step, and of half the fine one.
    let errors: Vec<[[f64; 4]; 2]> = points
        .par_iter()
        .zip(&large)
        .map(|(at, large)| {
            let [tens, fives] = [100_000, 200_000].map(|rate| fine::features(at.kgm, at.fdj_n, rate));
            [fine::errors(large, &tens), fine::errors(&fives, &tens)]
        })
        .collect();
    println!(
        "{} points, KGM 0 to 0.95, FDJ 200 to 2000 N; the largest difference from the step of 1e-5 s",
        points.len()
    );
    println!("of: ramp's current, pressure after the step, ramp's pressure, current after the step");
    for (from, to) in BANDS {
        let inside = |at: &Proposal| (from..to).contains(&at.kgm) || (to == 0.95 && at.kgm >= to);
        let most = |of: usize| {
            let rows = points.iter().zip(&errors).filter(|(at, _)| inside(at)).map(|(_, e)| e[of]);
            rows.fold([0.0_f64; 4], |most, e| [0, 1, 2, 3].map(|i| most[i].max(e[i])))
        };
        let told = |e: [f64; 4]| e.map(|e| format!("{e:.1e}")).join("  ");
        println!("KGM {from:.2} to {to:.2}: large step {}; 5e-6 s {}", told(most(0)), told(most(1)));
    }
    let most = |of: usize| errors.iter().map(|e| e[0][of]).fold(0.0, f64::max);
    println!("largest: {:.2e} of the current, {:.2e} of the pressure", most(0), most(1));
}
