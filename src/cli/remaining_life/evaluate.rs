//! `--evaluate`: forecasts of histories whose ends are known, scored.

use std::fmt::Write;
use std::time::Instant;

use serde::Serialize;

use super::ask::{Case, refused};
use super::{RemainingLifeArgs, of_each};
use crate::cli::Failure;
use crate::prognostics::metrics::{self, Course, Criteria, Figures, Scored};

/// The parts of a life by which the figures are told.
const PARTS: usize = 5;

/// What came of it.
#[derive(Debug, Serialize)]
pub(super) struct Evaluation {
    #[serde(flatten)]
    criteria: Criteria,
    /// Forecasts that cannot be scored: at the end of life or after it, at its very beginning, or without an observation.
    left_out: usize,
    #[serde(flatten)]
    course: Course,
    overall: Figures,
    by_fraction_of_life: Vec<Part>,
    elapsed_s: Elapsed,
}

/// The figures of the forecasts that were made in one part of life.
#[derive(Debug, Serialize)]
struct Part {
    from: f64,
    to: f64,
    #[serde(flatten)]
    figures: Figures,
}

/// The time that a forecast took.
#[derive(Debug, Serialize)]
struct Elapsed {
    median: f64,
    max: f64,
}

/// The forecasts of one history.
#[derive(Default)]
struct Made {
    scored: Vec<Scored>,
    elapsed_s: Vec<f64>,
    left_out: usize,
}

/// Scores the forecasts of every history.
pub(super) fn evaluate(args: &RemainingLifeArgs, cases: &[Case<'_>]) -> Result<Evaluation, Failure> {
    let made = of_each(cases, |case| forecasts(args, case))?;
    let criteria = Criteria { alpha: args.alpha, beta: args.beta };
    let left_out = made.iter().map(|made| made.left_out).sum();
    let (scored, elapsed_s): (Vec<_>, Vec<_>) = made.into_iter().map(|made| (made.scored, made.elapsed_s)).unzip();
    let elapsed_s = elapsed_s.concat();
    let max = elapsed_s.iter().copied().fold(0.0, f64::max);
    let found = (metrics::figures(&scored, &criteria), metrics::course(&scored, &criteria), metrics::median(elapsed_s));
    let (Some(overall), Some(course), Some(median)) = found else {
        return Err(refused(args, "found no forecast within a life, expected at least one to score"));
    };
    let part = |i: usize| {
        let [from, to] = [i, i + 1].map(|i| i as f64 / PARTS as f64);
        metrics::figures_within(&scored, &criteria, &(from..to)).map(|figures| Part { from, to, figures })
    };
    let by_fraction_of_life = (0..PARTS).filter_map(part).collect();
    Ok(Evaluation { criteria, left_out, course, overall, by_fraction_of_life, elapsed_s: Elapsed { median, max } })
}

fn forecasts(args: &RemainingLifeArgs, case: &Case<'_>) -> Result<Made, Failure> {
    let end_of_life = case.history.end_of_life.ok_or_else(|| {
        let expected = "expected the usage at which life ended, to score the forecasts";
        refused(args, &format!("{}: missing, {expected}", case.history.place_of_field("eol")))
    })?;
    let mut made = Made::default();
    for at in case.at(args)? {
        let started = Instant::now();
        let prognosis = case.prognosis(args, at)?;
        let elapsed_s = started.elapsed().as_secs_f64();
        let known = prognosis.zip(case.start());
        let scored = known.and_then(|(prognosis, start)| Scored::of_prognosis(start, at, end_of_life, &prognosis));
        match scored {
            Some(scored) => {
                made.scored.push(scored);
                made.elapsed_s.push(elapsed_s);
            }
            None => made.left_out += 1,
        }
    }
    Ok(made)
}

/// An evaluation for a person.
pub(super) fn told(evaluation: &Evaluation) -> String {
    let Evaluation { criteria, left_out, course, overall, by_fraction_of_life, elapsed_s } = evaluation;
    let mut text = format!("{} forecasts of {} histories", overall.forecasts, course.histories);
    let mut line = |line: String| text.push_str(&line);
    if *left_out > 0 {
        line(format!(", {left_out} left out: not within a life, or without an observation"));
    }
    line(format!("\nalpha {}, beta {}\n\n", criteria.alpha, criteria.beta));
    line(format!("{:>16} {:>9} {HEADINGS}\n", "fraction of life", "forecasts"));
    for Part { from, to, figures } in by_fraction_of_life {
        line(row(&format!("{from:.1} to {to:.1}"), figures));
    }
    line(row("all", overall));
    let Course { prognostic_horizon, prognostic_horizon_lasting, convergence, .. } = course;
    line(format!(
        "\nprognostic horizon {prognostic_horizon:.3} of life, {prognostic_horizon_lasting:.3} that lasts\n\
         convergence {convergence:.3} of life\n\
         time per forecast {:.2} ms in the median, {:.2} ms at most\n",
        elapsed_s.median * 1e3,
        elapsed_s.max * 1e3
    ));
    text
}

/// The headings of the figures of a row.
const HEADINGS: &str = "    MRA    CRA    a-l a-l beta  nCRPS  cov50  cov90    w50    w90";

fn row(name: &str, figures: &Figures) -> String {
    let mut text = format!("{name:>16} {:>9}", figures.forecasts);
    let columns = [
        (figures.mra, 7),
        (figures.cra, 7),
        (figures.alpha_lambda, 7),
        (figures.alpha_lambda_beta, 9),
        (figures.ncrps, 7),
        (figures.coverage_50, 7),
        (figures.coverage_90, 7),
        (figures.width_50, 7),
        (figures.width_90, 7),
    ];
    for (value, width) in columns {
        let width = width - 1;
        write!(text, " {value:width$.3}").expect("memory takes every write");
    }
    text + "\n"
}
