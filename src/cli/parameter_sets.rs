//! `--parameters NAME|FILE` and `--set KEY=VALUE`: the parameter set that a command works with.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::Args;

use super::Failure;
use crate::models::checks::ParamsError;
use crate::models::parameters::ParameterSet;

/// The longest file of a parameter set, bytes (chosen: a hundred times the built-in one).
const FILE_BYTES_MAX: u64 = 1_000_000;

/// Which parameter set a command works with.
#[derive(Debug, Args)]
pub(super) struct Choice {
    /// The actuator's parameter set: reference, which is built in, or a file as config/actuators/reference.toml
    #[arg(long, value_name = "NAME|FILE")]
    parameters: Option<PathBuf>,
    /// One of its parameters changed, as reference.friction.model=karnopp or jack.mass_kg=12; as many as there are
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_change)]
    changes: Vec<(String, String)>,
}

fn parse_change(text: &str) -> Result<(String, String), String> {
    let (key, value) = text.split_once('=').ok_or("expected KEY=VALUE")?;
    Ok((key.trim().to_owned(), value.trim().to_owned()))
}

impl Choice {
    /// The set.
    pub(super) fn load(&self) -> Result<ParameterSet, Failure> {
        let set = load(self.parameters.as_deref())?;
        if self.changes.is_empty() {
            return Ok(set);
        }
        set.with(&self.changes).map_err(|errors| refused("--set", &errors))
    }
}

/// The built-in set of this name, or else the set in this file; without one, the built-in reference set.
pub(super) fn load(name_or_file: Option<&Path>) -> Result<ParameterSet, Failure> {
    let Some(path) = name_or_file.filter(|path| path.as_os_str() != ParameterSet::reference_name()) else {
        return Ok(ParameterSet::reference());
    };
    let text = read(path).map_err(Failure::usage)?;
    ParameterSet::parse(&text).map_err(|errors| refused(&path.display().to_string(), &errors))
}

/// Every error of a set, after where it comes from.
fn refused(place: &str, errors: &[ParamsError]) -> Failure {
    let errors: Vec<_> = errors.iter().map(ToString::to_string).collect();
    Failure::usage(anyhow!("{place}: {}", errors.join("; ")))
}

fn read(path: &Path) -> anyhow::Result<String> {
    let name = path.display();
    let context = || format!("--parameters {name}: expected {} or a file", ParameterSet::reference_name());
    let mut bytes = Vec::new();
    let file = File::open(path).with_context(context)?;
    file.take(FILE_BYTES_MAX + 1).read_to_end(&mut bytes).with_context(context)?;
    if bytes.len() as u64 > FILE_BYTES_MAX {
        return Err(anyhow!("{name}: found more than {FILE_BYTES_MAX} bytes, expected a parameter set"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let line = error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
        anyhow!("{name}: line {}: found bytes that are no UTF-8, expected text", line + 1)
    })
}
