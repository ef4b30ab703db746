//! Parameter sets as they come in, in JSON or as their TOML file, and as they go out.

use jiff::Timestamp;
use serde::Serialize;
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};

use crate::http::error::{ApiError, ApiResult};
use crate::http::extract::json;
use crate::http::extract::query::{Fields, FromQuery};
use crate::http::problem::FieldError;
use crate::jobs::sets::{self, SetError};
use crate::models::checks::ParamsError;
use crate::models::parameters::{ParameterSet, Tree};
use crate::store::records::{Id, ParameterSetRecord};

/// What stands for a name that is missing, so that the parameters are checked all the same.
const NAMELESS: &str = "nameless";

/// A parameter set to keep.
#[derive(Debug, ToSchema)]
#[schema(example = json!({"name": "aileron-servo", "parameters": {"controller": {"proportional_gain_a_per_m": 0.6}}}))]
pub struct NewParameterSet {
    /// Its name: 1 to 64 of the characters A-Z, a-z, 0-9, `.`, `_` and `-`.
    #[schema(min_length = 1, max_length = 64, pattern = "^[A-Za-z0-9._-]+$")]
    pub name: String,
    /// Every parameter, in the sections of a parameter file.
    #[schema(value_type = Object)]
    pub parameters: Value,
}

/// What is known of a version of a parameter set beside its values.
#[derive(Debug, Serialize, ToSchema)]
pub struct ParameterSetItem {
    /// Opaque id.
    id: Id,
    /// Its name.
    name: String,
    /// SHA-256 of its name and values, in hexadecimal: what estimates and simulations name it by.
    hash: String,
    /// When the service first had it.
    created_at: Timestamp,
    /// Whether it came with the program, this version of it or an earlier one.
    built_in: bool,
}

/// A version of a parameter set.
#[derive(Debug, Serialize, ToSchema)]
pub struct ParameterSetDocument {
    #[serde(flatten)]
    item: ParameterSetItem,
    /// Every parameter, in the sections of a parameter file.
    #[schema(value_type = Object)]
    parameters: Value,
    /// The range of every number among them.
    limits: Vec<ParameterLimits>,
    /// Why this version of elevon cannot use the set, which another one kept; empty when it can.
    errors: Vec<FieldError>,
}

/// What a number may be.
#[derive(Debug, Serialize, ToSchema)]
struct ParameterLimits {
    /// Where it stands in this document.
    #[schema(example = "/parameters/jack/area_m2")]
    pointer: String,
    /// The least allowed, given the other values.
    min: f64,
    /// The most allowed, given the other values.
    max: f64,
    /// Its unit; empty without one.
    #[schema(example = "m2")]
    unit: &'static str,
    /// The models that it is a parameter of: `reference`, `monitoring` or `both`.
    #[schema(example = "both")]
    models: &'static str,
}

/// Which version of a parameter set.
#[derive(Debug, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct VersionQuery {
    /// The first 8 or more digits of its hash; without it, the version that was kept last.
    #[param(min_length = 8, max_length = 64, pattern = "^[0-9a-f]+$")]
    pub hash: Option<String>,
}

impl FromQuery for VersionQuery {
    fn from_query(fields: &mut Fields) -> Option<Self> {
        let expected = format!("{} to {} of the digits 0-9 and a-f", sets::HASH_CHARS_MIN, sets::HASH_CHARS);
        Some(Self { hash: fields.parse_with("hash", expected, |text| sets::is_hash(text).then(|| text.to_owned())) })
    }
}

impl From<&ParameterSetRecord> for ParameterSetItem {
    fn from(record: &ParameterSetRecord) -> Self {
        let ParameterSetRecord { id, name, hash, created_at, .. } = record.clone();
        let built_in = name == ParameterSet::reference_name();
        Self { id, name, hash, created_at, built_in }
    }
}

impl From<ParameterSetRecord> for ParameterSetDocument {
    fn from(record: ParameterSetRecord) -> Self {
        let item = ParameterSetItem::from(&record);
        let (limits, errors) = match sets::usable(&record) {
            Ok(set) => (limits(&set), Vec::new()),
            Err(SetError::Invalid { errors, .. }) => (Vec::new(), errors.iter().map(in_parameters).collect()),
            Err(other) => (Vec::new(), vec![FieldError::new("/hash", other.to_string())]),
        };
        Self { item, parameters: record.parameters, limits, errors }
    }
}

fn limits(set: &ParameterSet) -> Vec<ParameterLimits> {
    let of = |parameter: crate::models::parameters::Parameter| {
        let pointer = format!("/parameters/{}", parameter.name.replace('.', "/"));
        let models = parameter.models();
        parameter.limits.map(|limits| ParameterLimits {
            pointer,
            min: limits.min,
            max: limits.max,
            unit: limits.unit,
            models,
        })
    };
    set.parameters().into_iter().filter_map(of).collect()
}

/// The set in a body of JSON.
///
/// # Errors
/// Everything that is wrong with it, each with its pointer.
pub fn from_json(bytes: &[u8]) -> ApiResult<ParameterSet> {
    let Tree::Table(entries) = json::read(bytes)? else {
        return Err(ApiError::malformed("", "found no object, expected one with name and parameters"));
    };
    let (mut name, mut parameters, mut unreadable) = (None, None, Vec::new());
    for (key, value) in entries {
        match (key.as_str(), value) {
            ("name", Tree::Text(text)) => name = Some(text),
            ("name", other) => {
                name = Some(NAMELESS.into());
                unreadable.push(FieldError::new("/name", format!("found {}, expected a text", other.describe())));
            }
            ("parameters", value) => parameters = Some(value),
            (unknown, _) => {
                let pointer = format!("/{}", unknown.replace('~', "~0").replace('/', "~1"));
                unreadable.push(FieldError::new(pointer, "found an unknown field, expected name or parameters"));
            }
        }
    }
    if name.is_none() {
        unreadable.push(FieldError::new("/name", "missing, expected a text"));
    }
    let name = name.as_deref().unwrap_or(NAMELESS);
    let read = match parameters {
        Some(parameters) => ParameterSet::from_parts(name, parameters),
        None => {
            unreadable.push(FieldError::new("/parameters", "missing, expected the sections of a parameter file"));
            Err(Vec::new())
        }
    };
    told(read, unreadable, in_parameters)
}

/// The set in a TOML file.
///
/// # Errors
/// Everything that is wrong with it, each with its pointer from the file's root; broken syntax with its line and column.
pub fn from_toml(bytes: &[u8]) -> ApiResult<ParameterSet> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| ApiError::malformed("", format!("found no UTF-8 text, expected TOML: {error}")))?;
    told(ParameterSet::parse(text), Vec::new(), |error| match error {
        ParamsError::Syntax { line, column, reason } => {
            FieldError::new(format!("line {line}, column {column}"), reason.clone())
        }
        other => FieldError::new(other.pointer(), other.detail()),
    })
}

/// An error of a set whose sections stand under `parameters`, its name beside them.
fn in_parameters(error: &ParamsError) -> FieldError {
    let pointer = match error {
        ParamsError::Unreadable { name, .. } if name == "name" => "/name".to_owned(),
        other => format!("/parameters{}", other.pointer()),
    };
    FieldError::new(pointer, error.detail())
}

/// The set, or everything that is wrong: 422 when all of it can be read, 400 otherwise.
fn told(
    read: Result<ParameterSet, Vec<ParamsError>>,
    mut unreadable: Vec<FieldError>,
    place: impl Fn(&ParamsError) -> FieldError,
) -> ApiResult<ParameterSet> {
    let errors = match read {
        Ok(set) if unreadable.is_empty() => return Ok(set),
        Ok(_) => Vec::new(),
        Err(errors) => errors,
    };
    let can_be_read = unreadable.is_empty() && errors.iter().all(is_out_of_range);
    unreadable.extend(errors.iter().map(place));
    Err(if can_be_read { ApiError::Invalid(unreadable) } else { ApiError::Malformed(unreadable) })
}

/// Whether a value is of the right type: a number out of its range, or a name with other characters than a name may have.
fn is_out_of_range(error: &ParamsError) -> bool {
    match error {
        ParamsError::OutOfRange { .. } => true,
        ParamsError::Unreadable { name, found, .. } => name == "name" && found.starts_with('"'),
        _ => false,
    }
}
