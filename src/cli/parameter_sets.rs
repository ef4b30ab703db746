//! `--parameters NAME|FILE` and `--set KEY=VALUE`: the parameter set that a command works with.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow};
use clap::Args;

use super::Failure;
use crate::models::checks::ParamsError;
use crate::models::parameters::{ParameterSet, TEXT_BYTES_MAX};

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
        let set = self.parameters.as_deref().map_or_else(|| Ok(ParameterSet::reference()), load)?;
        if self.changes.is_empty() {
            return Ok(set);
        }
        let twice = |(at, (key, _)): (usize, &(String, String))| self.changes[..at].iter().any(|(k, _)| k == key);
        if let Some((_, (key, _))) = self.changes.iter().enumerate().find(|one| twice(*one)) {
            return Err(Failure::usage(anyhow!("--set: found {key} twice, expected each parameter once")));
        }
        set.with(&self.changes).map_err(|errors| refused("--set", &errors))
    }
}

/// The built-in set of this name, or else the set in this file.
pub(super) fn load(name_or_file: &Path) -> Result<ParameterSet, Failure> {
    if is_built_in(name_or_file) {
        return Ok(ParameterSet::reference());
    }
    ParameterSet::parse(&read(name_or_file)?).map_err(|errors| refused(&name_or_file.display().to_string(), &errors))
}

/// Whether this is the name of the built-in set.
pub(super) fn is_built_in(name_or_file: &Path) -> bool {
    name_or_file.as_os_str() == ParameterSet::reference_name()
}

/// Every error of a set, after where it comes from.
pub(super) fn refused(place: &str, errors: &[ParamsError]) -> Failure {
    let errors: Vec<_> = errors.iter().map(ToString::to_string).collect();
    Failure::usage(anyhow!("{place}: {}", errors.join("; ")))
}

/// The text of a file that may hold a set.
pub(super) fn read(path: &Path) -> Result<String, Failure> {
    let name = path.display();
    let unread = || format!("{name}: expected {} or a file", ParameterSet::reference_name());
    let mut bytes = Vec::new();
    let file = File::open(path).with_context(unread).map_err(Failure::usage)?;
    file.take(TEXT_BYTES_MAX as u64 + 1).read_to_end(&mut bytes).with_context(unread).map_err(Failure::usage)?;
    if bytes.len() > TEXT_BYTES_MAX {
        let text = anyhow!("{name}: found more than {TEXT_BYTES_MAX} bytes, expected a parameter set");
        return Err(Failure::usage(text));
    }
    String::from_utf8(bytes).map_err(|error| {
        let line = error.as_bytes()[..error.utf8_error().valid_up_to()].iter().filter(|byte| **byte == b'\n').count();
        Failure::usage(anyhow!("{name}: line {}: found bytes that are no UTF-8, expected text", line + 1))
    })
}
