//! `elevon remaining-life`: the distribution of the remaining life from a history, without a server.

mod answer;
mod ask;
mod evaluate;
mod told;

use std::path::PathBuf;

use clap::Args;
use rayon::prelude::*;
use serde::Serialize;
use serde_json::Value;

use super::{Failure, print, read_file, refused};
use crate::formats::history::{self, At, UsageUnit};
use crate::prognostics::Direction;
use crate::prognostics::metrics::Criteria;
use answer::Answer;
use ask::Case;

/// Arguments of `elevon remaining-life`.
#[derive(Debug, Args)]
pub struct RemainingLifeArgs {
    /// A history: .csv with the columns usage, value and perhaps std, or .json with arrays of these names; or a batch of
    /// histories, .json
    file: PathBuf,
    /// The value at which life ends, unless the file says it
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = finite)]
    threshold: Option<f64>,
    /// Whether larger or smaller is worse: rising or falling. Unless told, it is inferred where the values tell it
    #[arg(long, value_name = "NAME", value_parser = direction)]
    direction: Option<Direction>,
    /// The usage from which remaining life counts; later observations are not used. Unless told, the file's, or the last
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = finite)]
    at: Option<f64>,
    /// How far the forecast reaches, in usage [default: 20 times the age]
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = above_zero, conflicts_with = "evaluate")]
    horizon: Option<f64>,
    /// The value when new; unless told, it is learnt from the history
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = finite)]
    healthy: Option<f64>,
    /// The usage at which this life began; earlier observations are not used [default: the first usage]
    #[arg(long, value_name = "T", allow_negative_numbers = true, value_parser = finite)]
    life_start: Option<f64>,
    /// Tell the probability of failure within this usage
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = not_below_zero)]
    within: Option<f64>,
    /// Tell the usage by which to act for this probability of failure before it
    #[arg(long, value_name = "P", default_value_t = 0.05, allow_negative_numbers = true, value_parser = probability)]
    risk: f64,
    /// What usage counts: flight_hours or flight_cycles [default: the file's, or flight_hours]
    #[arg(long, value_name = "NAME", value_parser = unit)]
    unit: Option<UsageUnit>,
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
    /// Score the forecasts of histories whose ends of life are known (eol in the JSON file)
    #[arg(long)]
    evaluate: bool,
    /// The relative error that --evaluate allows
    #[arg(long, value_name = "F", default_value_t = Criteria::default().alpha, allow_negative_numbers = true,
        value_parser = above_zero, requires = "evaluate")]
    alpha: f64,
    /// The probability that --evaluate expects within that error
    #[arg(long, value_name = "P", default_value_t = Criteria::default().beta, allow_negative_numbers = true,
        value_parser = probability, requires = "evaluate")]
    beta: f64,
}

fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|number: &f64| number.is_finite()).ok_or_else(|| "expected a finite number".into())
}

fn above_zero(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number > 0.0).ok_or_else(|| "expected a finite number above 0".into())
}

fn not_below_zero(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|number| *number >= 0.0).ok_or_else(|| "expected a finite number, 0 or more".into())
}

fn probability(text: &str) -> Result<f64, String> {
    let inside = |number: &f64| *number > 0.0 && *number < 1.0;
    finite(text).ok().filter(inside).ok_or_else(|| "expected a probability above 0 and below 1".into())
}

fn direction(text: &str) -> Result<Direction, String> {
    match text {
        "rising" => Ok(Direction::Rising),
        "falling" => Ok(Direction::Falling),
        _ => Err("expected rising or falling".into()),
    }
}

fn unit(text: &str) -> Result<UsageUnit, String> {
    match text {
        "flight_hours" => Ok(UsageUnit::FlightHours),
        "flight_cycles" => Ok(UsageUnit::FlightCycles),
        _ => Err("expected flight_hours or flight_cycles".into()),
    }
}

/// The forecasts of one history.
#[derive(Debug, Serialize)]
struct Answers<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'a Value>,
    forecasts: Vec<Answer>,
}

/// Runs the command.
pub fn run(args: &RemainingLifeArgs) -> Result<(), Failure> {
    let (format, bytes) = read_file(&args.file)?;
    let file = history::read(format, &bytes).map_err(|errors| refused(&args.file, &errors))?;
    drop(bytes);
    let cases = ask::cases(args, &file)?;
    if args.evaluate {
        let evaluation = evaluate::evaluate(args, &cases)?;
        let told = if args.json { json(&evaluation)? } else { evaluate::told(&evaluation) };
        return print(&told);
    }
    let answers = of_each(&cases, |case| {
        let forecasts =
            case.at(args)?.into_iter().map(|at| answer::answer(args, case, at)).collect::<Result<_, _>>()?;
        Ok(Answers { id: case.history.id.as_ref(), forecasts })
    })?;
    let alone = !file.batch && !matches!((args.at, &file.histories[0].at), (None, Some(At::Many(_))));
    print(&match (args.json, file.batch, alone) {
        (false, ..) => told::told(&args.file, &cases, &answers),
        (true, true, _) => json(&answers)?,
        (true, false, true) => json(&answers[0].forecasts[0])?,
        (true, false, false) => json(&answers[0])?,
    })
}

/// What is made of each case, over the cores. Of several failures the first in the order of the file is told.
fn of_each<'a, T: Send>(
    cases: &'a [Case<'a>],
    make: impl Fn(&'a Case<'a>) -> Result<T, Failure> + Send + Sync,
) -> Result<Vec<T>, Failure> {
    cases.par_iter().map(make).collect::<Vec<_>>().into_iter().collect()
}

fn json(document: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(document).map_err(Failure::work)? + "\n")
}
