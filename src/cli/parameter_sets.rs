//! `--parameters NAME|FILE`: the parameter set that a command works with.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use anyhow::{Context, anyhow};

use super::Failure;
use crate::models::parameters::ParameterSet;

/// The longest file of a parameter set, bytes (chosen: a hundred times the built-in one).
const FILE_BYTES_MAX: u64 = 1_000_000;

/// The built-in set of this name, or else the set in this file; without one, the built-in reference set.
pub(super) fn load(name_or_file: Option<&Path>) -> Result<ParameterSet, Failure> {
    let Some(path) = name_or_file.filter(|path| path.as_os_str() != ParameterSet::reference_name()) else {
        return Ok(ParameterSet::reference());
    };
    let file = path.display();
    let text = read(path).map_err(Failure::usage)?;
    ParameterSet::parse(&text).map_err(|errors| {
        let errors: Vec<_> = errors.iter().map(ToString::to_string).collect();
        Failure::usage(anyhow!("{file}: {}", errors.join("; ")))
    })
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
