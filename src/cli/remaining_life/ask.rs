//! From a file's histories to what is asked of each of them.

use anyhow::anyhow;

use super::RemainingLifeArgs;
use crate::cli::Failure;
use crate::formats::history::{self, At, Figure, Histories, History, UsageUnit};
use crate::prognostics::{
    Direction, LifePrior, Observation, Problem, Prognosis, PrognosisError, Question, remaining_life,
};

/// The first values that have to be on the same side of the threshold where the direction is inferred from them.
const VALUES_INFERRED_FROM: usize = 3;

/// A history and all that is asked of it but the usages.
#[derive(Debug)]
pub(super) struct Case<'a> {
    pub(super) history: &'a History,
    pub(super) unit: UsageUnit,
    pub(super) threshold: f64,
    pub(super) direction: Direction,
    /// Whether the direction is inferred.
    pub(super) inferred: bool,
    pub(super) life_start: Option<f64>,
    healthy: Option<f64>,
    horizon: Option<f64>,
    observations: Vec<Observation>,
}

/// The cases of a file. The command's options come first, then what the history says, then what the file says.
pub(super) fn cases<'a>(args: &RemainingLifeArgs, file: &'a Histories) -> Result<Vec<Case<'a>>, Failure> {
    let mut cases = Vec::with_capacity(file.histories.len());
    let mut open = Vec::new();
    for history in &file.histories {
        let asked = |field: fn(&history::Asked) -> Option<f64>| field(&history.asked).or(field(&file.asked));
        let threshold = args.threshold.or(asked(|asked| asked.threshold)).ok_or_else(|| {
            refused(args, &format!("{}: missing, expected --threshold F", history.place_of_field("threshold")))
        })?;
        let told = args.direction.or(history.asked.direction.or(file.asked.direction).map(known));
        if told.is_none() {
            open.push((history, threshold));
        }
        cases.push(Case {
            history,
            unit: args.unit.or(history.asked.unit).or(file.asked.unit).unwrap_or(UsageUnit::FlightHours),
            threshold,
            direction: told.unwrap_or(Direction::Rising),
            inferred: told.is_none(),
            healthy: args.healthy.or(asked(|asked| asked.healthy)),
            life_start: args.life_start.or(asked(|asked| asked.life_start)),
            horizon: args.horizon,
            observations: observations(history),
        });
    }
    if !open.is_empty() {
        let direction = inferred(&open).map_err(|found| {
            refused(args, &format!("direction: missing, and {found}; expected --direction rising or falling"))
        })?;
        cases.iter_mut().filter(|case| case.inferred).for_each(|case| case.direction = direction);
    }
    Ok(cases)
}

fn known(direction: history::Direction) -> Direction {
    match direction {
        history::Direction::Rising => Direction::Rising,
        history::Direction::Falling => Direction::Falling,
    }
}

fn observations(history: &History) -> Vec<Observation> {
    let figures = history.usage.iter().zip(&history.value).zip(&history.std);
    figures.map(|((&usage, &value), &std)| Observation { usage, value, std }).collect()
}

/// The direction of histories that nobody told, if their first values are on one side of their thresholds and they don't
/// mostly move away from them; else why it cannot be inferred.
fn inferred(histories: &[(&History, f64)]) -> Result<Direction, String> {
    let (mut below, mut above, mut towards, mut away) = (0, 0, 0, 0);
    for (history, threshold) in histories {
        for value in history.value.iter().take(VALUES_INFERRED_FROM) {
            below += usize::from(value < threshold);
            above += usize::from(value > threshold);
        }
        if let (Some(first), Some(last)) = (history.value.first(), history.value.last()) {
            let moved = (last - first) * (threshold - first).signum();
            towards += usize::from(moved > 0.0);
            away += usize::from(moved < 0.0);
        }
    }
    match (below, above) {
        (0, 0) => Err("no value tells it".into()),
        (1.., 1..) => Err("the first values are on both sides of the threshold".into()),
        _ if away > towards => Err("the values move away from the threshold".into()),
        (_, 0) => Ok(Direction::Rising),
        _ => Ok(Direction::Falling),
    }
}

impl Case<'_> {
    /// The usages at which a forecast is asked.
    pub(super) fn at(&self, args: &RemainingLifeArgs) -> Result<Vec<f64>, Failure> {
        match (args.at, &self.history.at, self.history.usage.last()) {
            (Some(at), ..) => Ok(vec![at]),
            (None, Some(At::One(at)), _) => Ok(vec![*at]),
            (None, Some(At::Many(usages)), _) => Ok(usages.clone()),
            (None, None, Some(last)) => Ok(vec![*last]),
            (None, None, None) => {
                Err(refused(args, &format!("{}: missing, expected --at T", self.history.place_of_field("at"))))
            }
        }
    }

    /// The usage at which this life began: as told, or the first.
    pub(super) fn start(&self) -> Option<f64> {
        self.life_start.or(self.history.usage.first().copied())
    }

    /// What the prognosis says at this usage, from the observations up to it; nothing where there are none of this life.
    pub(super) fn prognosis(&self, args: &RemainingLifeArgs, at: f64) -> Result<Option<Prognosis>, Failure> {
        let past = &self.observations[..self.observations.partition_point(|observation| observation.usage <= at)];
        let start = self.start().unwrap_or(f64::INFINITY);
        if past.last().is_none_or(|last| last.usage < start) {
            return Ok(None);
        }
        self.prognose(past, at).map(Some).map_err(|error| self.refused(args, &error))
    }

    /// The one place that asks the prognosis.
    fn prognose(&self, past: &[Observation], at: f64) -> Result<Prognosis, PrognosisError> {
        remaining_life(
            past,
            &Question {
                threshold: self.threshold,
                direction: self.direction,
                healthy: self.healthy,
                at,
                life_start: self.life_start,
                horizon: self.horizon,
                // The probability of failure within some usage is read off the forecast, which it is no part of.
                risk_window: 0.0,
                prior: LifePrior::Age,
            },
        )
    }

    /// A question or a history that the prognosis cannot answer.
    fn refused(&self, args: &RemainingLifeArgs, error: &PrognosisError) -> Failure {
        let told = |problem: &Problem| {
            format!("{}: found {}, expected {}", self.place(&problem.place), problem.found, problem.expected)
        };
        let more = match error.problems.len() {
            0 | 1 => String::new(),
            count => format!(" (and {} more)", count - 1),
        };
        refused(args, &format!("{}{more}", error.problems.first().map(told).unwrap_or_default()))
    }

    /// Where in the file the prognosis's `history[3].value` is, or its `threshold`.
    fn place(&self, place: &str) -> String {
        let observation = place.strip_prefix("history[").and_then(|rest| {
            let (index, field) = rest.split_once("].")?;
            let figure = match field {
                "usage" => Figure::Usage,
                "value" => Figure::Value,
                _ => Figure::Std,
            };
            Some(self.history.place_of(figure, index.parse().ok()?))
        });
        observation.unwrap_or_else(|| self.history.place_of_field(place))
    }
}

/// A file of which something cannot be used.
pub(super) fn refused(args: &RemainingLifeArgs, what: &str) -> Failure {
    Failure::usage(anyhow!("{}: {what}", args.file.display()))
}
