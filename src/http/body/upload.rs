//! Uploading a trace.

use std::ops::RangeInclusive;
use std::str::FromStr;

use jiff::Timestamp;
use utoipa::IntoParams;

use crate::estimation::method::{Choices, Method};
use crate::estimation::request::{Objective, Requested};
use crate::estimation::{GENERATIONS, POPULATION, Settings};
use crate::formats::{self, Format, FormatError, ReadOptions};
use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::query::{Fields, FromQuery};
use crate::http::limits::USAGE_MAX;
use crate::http::problem::FieldError;
use crate::numeric::digest;
use crate::store::records::{self, Id, TraceRecord};

/// What is known of an uploaded trace, and how to estimate from it.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct UploadQuery {
    /// When it was recorded: RFC 3339 with an offset.
    #[param(example = "2026-03-01T12:00:00Z")]
    pub recorded_at: Timestamp,
    /// The actuator's usage then, in its usage unit.
    #[param(minimum = 0, maximum = 10000000, example = 1250.5)]
    pub usage: f64,
    /// The method of the search, before the local polish; `ga` unless told.
    #[param(inline)]
    pub method: Option<Method>,
    /// What the genetic algorithm does at each stage, `thesis` unless told: any of `scaling=rank|proportional`,
    /// `selection=roulette|stochastic_uniform|tournament:SIZE`,
    /// `crossover=scattered|single_point|two_points|arithmetic|intermediate:RATIO|heuristic:RATIO`, `crossover_share=F`,
    /// `mutation=gaussian:SCALE:SHRINK|uniform:RATE|adaptive_feasible`, `elite_share=F`, with commas between them.
    #[param(value_type = Option<String>, example = "thesis")]
    pub ga: Option<Choices>,
    /// Seed of the search; 1 unless told.
    #[param(maximum = 18446744073709551615_u64)]
    pub seed: Option<u64>,
    /// Candidates in a generation.
    #[param(minimum = 4, maximum = 1000, default = 40)]
    pub population: Option<u32>,
    /// Generations.
    #[param(minimum = 0, maximum = 1000, default = 10)]
    pub generations: Option<u32>,
    /// What is minimised; `auto` unless told.
    #[param(inline)]
    pub objective: Option<Objective>,
    /// The faults to estimate, `kgm,fdj` unless told: some of `kgm`, `fdj`, `clearance`, `clogging`, `feedback_backlash`
    /// and `current_offset`, with commas between them. Those that are not named are held at their healthy values.
    #[param(value_type = Option<String>, example = "kgm,fdj")]
    pub faults: Option<Requested>,
    /// Names to replace, as in `Cor:servovalve_current_ma,P12:load_pressure_pa`.
    pub columns: Option<String>,
    /// Samples per second of a file without times, Hz.
    #[param(exclusive_minimum = 0)]
    pub sample_rate_hz: Option<f64>,
}

impl FromQuery for UploadQuery {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let (recorded_at, usage) = (fields.time("recorded_at"), usage(fields));
        fields.require("recorded_at", recorded_at.is_some());
        fields.require("usage", usage.is_some());
        let method = fields.parse("method", Method::ALL.map(Method::name).join(", "));
        let ga = choices(fields);
        let seed = fields.parse("seed", format!("an integer, 0 to {}", u64::MAX));
        let population = fields.integer("population", numbers(&POPULATION));
        let generations = fields.integer("generations", numbers(&GENERATIONS));
        let (objective, faults) = (told(fields, "objective"), told(fields, "faults"));
        let columns = fields.text("columns");
        for error in columns.iter().filter_map(|map| ReadOptions::parse_columns(map).err()).flatten() {
            fields.malformed("columns", error.detail);
        }
        let rate = |value: f64| value.is_finite() && value > 0.0;
        let sample_rate_hz = fields.number("sample_rate_hz", "a finite number above 0", rate);
        let (recorded_at, usage) = (recorded_at?, usage?);
        Some(Self {
            recorded_at,
            usage,
            method,
            ga,
            seed,
            population,
            generations,
            objective,
            faults,
            columns,
            sample_rate_hz,
        })
    }
}

fn choices(fields: &mut Fields) -> Option<Choices> {
    let text = fields.text("ga")?;
    match text.parse::<Choices>() {
        Ok(choices) => Some(choices),
        Err(error) => {
            fields.malformed("ga", format!("found {:?}, expected {}", error.found, error.expected));
            None
        }
    }
}

/// A value whose error says what was found and what was expected.
fn told<T: FromStr<Err = String>>(fields: &mut Fields, name: &'static str) -> Option<T> {
    let read = fields.text(name)?.parse();
    read.map_err(|detail| fields.malformed(name, detail)).ok()
}

fn usage(fields: &mut Fields) -> Option<f64> {
    fields.number("usage", &format!("0 to {USAGE_MAX}"), |value| (0.0..=USAGE_MAX).contains(&value))
}

impl UploadQuery {
    /// How to search.
    #[must_use]
    pub fn settings(&self) -> Settings {
        let default = Settings::default();
        Settings {
            method: self.method.unwrap_or(default.method),
            ga: self.ga.unwrap_or(default.ga),
            population: self.population.map_or(default.population, |value| value as usize),
            generations: self.generations.map_or(default.generations, |value| value as usize),
            seed: self.seed.unwrap_or(default.seed),
            objective: self.objective.unwrap_or(default.objective),
            faults: self.faults.unwrap_or(default.faults),
        }
    }

    /// The record of an uploaded file, which is read to its end: a long computation for a long file.
    ///
    /// # Errors
    /// Everything that is wrong with the file, each with its place.
    pub fn record(&self, actuator: Id, format: Format, bytes: &[u8]) -> ApiResult<TraceRecord> {
        let trace = formats::read(format, bytes, &self.options()?).map_err(bad_trace)?;
        Ok(TraceRecord {
            id: Id::now(),
            actuator_id: Some(actuator),
            recorded_at: Some(self.recorded_at),
            usage: Some(self.usage),
            media_type: format.media_type().into(),
            columns: self.columns.clone().unwrap_or_default(),
            sample_rate_hz: self.sample_rate_hz,
            size_bytes: bytes.len() as u64,
            sha256: digest::sha256_hex(bytes),
            samples: trace.samples() as u64,
            duration_s: trace.duration_s(),
            excluded: false,
            reason: String::new(),
            created_at: records::now(),
        })
    }

    /// How to read the file.
    fn options(&self) -> ApiResult<ReadOptions> {
        let columns = ReadOptions::parse_columns(self.columns.as_deref().unwrap_or_default()).map_err(bad_trace)?;
        Ok(ReadOptions { columns, sample_rate_hz: self.sample_rate_hz })
    }
}

/// What is wrong with a file; what is wrong with how the query told to read it points into the query.
fn bad_trace(errors: Vec<FormatError>) -> ApiError {
    let place = |place: String| match place.as_str() {
        "columns" | "sample_rate_hz" => format!("?{place}"),
        _ => place,
    };
    ApiError::BadTrace(errors.into_iter().map(|error| FieldError::new(place(error.place), error.detail)).collect())
}

/// A range of the estimation's settings, as a query's numbers.
fn numbers(range: &RangeInclusive<usize>) -> RangeInclusive<u32> {
    *range.start() as u32..=*range.end() as u32
}
