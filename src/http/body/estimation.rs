//! Asking for an estimation of a trace that is kept.

use std::fmt;
use std::ops::RangeInclusive;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};
use utoipa::ToSchema;

use super::check::FieldErrors;
use crate::estimation::method::{Choices, Method};
use crate::estimation::request::{Fault, Objective, Requested};
use crate::estimation::{GENERATIONS, POPULATION, Settings};
use crate::http::error::ApiResult;
use crate::jobs::kind::JobSpec;
use crate::store::records::Id;

/// The most characters that are shown of what is no trace's id.
const SHOWN_CHARS_MAX: usize = 100;

/// An estimation to make of a trace that is kept.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(example = json!({
    "trace_id": "01890a5d-ac96-774b-bcce-b302099a8057", "method": "ga", "population": 40, "generations": 10, "seed": 1,
    "objective": "auto", "faults": ["kgm", "fdj"]
}))]
pub struct NewEstimation {
    /// The trace.
    trace_id: String,
    /// The method of the search, before the local polish; `ga` unless told.
    #[serde(default)]
    method: Option<Method>,
    /// What the genetic algorithm does at each stage, `thesis` unless told: as `ga` of an upload.
    #[serde(default)]
    #[schema(value_type = Option<String>, example = "thesis")]
    ga: Option<Choices>,
    /// Candidates in a generation.
    #[serde(default)]
    #[schema(minimum = 4, maximum = 1000, default = 40)]
    population: Option<u64>,
    /// Generations.
    #[serde(default)]
    #[schema(minimum = 0, maximum = 1000, default = 10)]
    generations: Option<u64>,
    /// Seed of the search; 1 unless told.
    #[serde(default)]
    #[schema(maximum = 18446744073709551615_u64, default = 1)]
    seed: Option<u64>,
    /// What is minimised; `auto` unless told.
    #[serde(default)]
    objective: Option<Objective>,
    /// The faults to estimate, `kgm,fdj` unless told: their names in an array, or in one text with commas between them.
    /// Those that are not named are held at their healthy values.
    #[serde(default)]
    #[schema(value_type = Option<FaultNames>)]
    faults: Option<AskedFaults>,
}

/// Names of faults, as a body gives them.
#[derive(ToSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only described; AskedFaults reads them and tells what is wrong by its place")]
enum FaultNames {
    /// With commas between them.
    Text(String),
    /// One by one.
    Names(Vec<Fault>),
}

/// Faults out of a text with commas or an array of names.
#[derive(Debug, Clone, Copy)]
struct AskedFaults(Requested);

impl<'de> Deserialize<'de> for AskedFaults {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Names).map(Self)
    }
}

struct Names;

impl<'de> Visitor<'de> for Names {
    type Value = Requested;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("names of faults, in an array or with commas between them")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Requested, E> {
        text.parse().map_err(E::custom)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut names: A) -> Result<Requested, A::Error> {
        let mut found = Vec::new();
        while let Some(fault) = names.next_element::<Fault>()? {
            found.push(fault.name());
        }
        if found.is_empty() {
            let expected = Fault::ALL.map(Fault::name).join(", ");
            return Err(A::Error::custom(format_args!("found an empty array, expected some of {expected}")));
        }
        found.join(",").parse().map_err(A::Error::custom)
    }
}

impl NewEstimation {
    /// The trace's id; `None` when the text is none.
    #[must_use]
    pub fn trace_id(&self) -> Option<Id> {
        self.trace_id.parse().ok()
    }

    /// The job to queue for the trace that was found under the body's `trace_id`, if one was.
    ///
    /// # Errors
    /// Every field out of its range; a trace that is not kept.
    pub fn check(self, trace: Option<Id>) -> ApiResult<JobSpec> {
        let mut errors = FieldErrors::default();
        if trace.is_none() {
            let shown: String = self.trace_id.chars().take(SHOWN_CHARS_MAX).collect();
            errors.add("/trace_id", format!("found {shown:?}, expected the id of a trace that the service keeps"));
        }
        let default = Settings::default();
        let settings = Settings {
            method: self.method.unwrap_or(default.method),
            ga: self.ga.unwrap_or(default.ga),
            population: count(&mut errors, "/population", self.population, &POPULATION).unwrap_or(default.population),
            generations: count(&mut errors, "/generations", self.generations, &GENERATIONS)
                .unwrap_or(default.generations),
            seed: self.seed.unwrap_or(default.seed),
            objective: self.objective.unwrap_or(default.objective),
            faults: self.faults.map_or(default.faults, |asked| asked.0),
        };
        let trace_id = errors.pass(trace)?.expect("its absence was noted");
        Ok(JobSpec::Estimation { trace_id, settings })
    }
}

/// A count in its range.
fn count(errors: &mut FieldErrors, pointer: &str, found: Option<u64>, range: &RangeInclusive<usize>) -> Option<usize> {
    let found = found?;
    let count = usize::try_from(found).ok().filter(|count| range.contains(count));
    if count.is_none() {
        errors.add(pointer, format!("found {found}, expected an integer, {} to {}", range.start(), range.end()));
    }
    count
}
