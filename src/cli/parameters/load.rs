//! A parameter set whose monitoring model is still to be fitted, by its name or file.

use std::path::Path;

use anyhow::Context;

use crate::cli::Failure;
use crate::cli::parameter_sets::{is_built_in, read, refused};
use crate::models::checks::ParamsError;
use crate::models::parameters::ParameterSet;

/// A set that may lack what belongs to the monitoring model alone: what is missing is the built-in set's, and named.
pub fn for_fit(name_or_file: &Path) -> Result<(ParameterSet, Vec<String>), Failure> {
    if is_built_in(name_or_file) {
        return Ok((ParameterSet::reference(), Vec::new()));
    }
    let text = read(name_or_file)?;
    let name = name_or_file.display().to_string();
    let errors = match ParameterSet::parse(&text) {
        Ok(set) => return Ok((set, Vec::new())),
        Err(errors) => errors,
    };
    let (missing, others): (Vec<ParamsError>, Vec<ParamsError>) = errors
        .into_iter()
        .partition(|error| matches!(error, ParamsError::Missing { name, .. } if name.starts_with("monitoring.")));
    if !others.is_empty() {
        return Err(refused(&name, &others));
    }
    let built_in = ParameterSet::reference().to_json();
    let mut table: toml::Table = text.parse().with_context(|| name.clone()).map_err(Failure::usage)?;
    let mut names = Vec::new();
    for error in missing {
        let value = built_in.pointer(&error.pointer()).and_then(serde_json::Value::as_f64);
        if let (ParamsError::Missing { name, .. }, Some(value)) = (error, value) {
            insert(&mut table, &name, value);
            names.push(name);
        }
    }
    ParameterSet::parse(&table.to_string()).map(|set| (set, names)).map_err(|errors| refused(&name, &errors))
}

/// Puts a number at a path of names, making the tables on the way.
fn insert(table: &mut toml::Table, path: &str, value: f64) {
    match path.split_once('.') {
        None => drop(table.insert(path.into(), toml::Value::Float(value))),
        Some((section, rest)) => {
            let inner = table.entry(section).or_insert_with(|| toml::Value::Table(toml::Table::new()));
            if let toml::Value::Table(inner) = inner {
                insert(inner, rest, value);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::*;
    use crate::cli::parameter_sets::load;

    fn file(text: &str) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("set.toml");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    fn error(failure: Failure) -> String {
        match failure {
            Failure::Usage(error) => format!("{error:#}"),
            Failure::Work(error) => panic!("{error:#}"),
        }
    }

    #[test]
    fn a_fit_needs_no_monitoring_sections_and_everything_else() {
        let whole = ParameterSet::reference().to_toml();
        let (_folder, path) = file(&whole[..whole.find("[monitoring.first_stage]").unwrap()]);
        let (set, missing) = for_fit(&path).unwrap();
        assert_eq!(set, ParameterSet::reference());
        assert!(missing.len() > 20 && missing.iter().all(|name| name.starts_with("monitoring.")), "{missing:?}");
        let refused = error(load(&path).unwrap_err());
        assert!(refused.contains("monitoring.fluid.spool_saturation_m: missing"), "{refused}");
    }

    #[test]
    fn everything_else_that_is_wrong_is_told_at_once() {
        let whole = ParameterSet::reference().to_toml();
        let text = whole[..whole.find("[monitoring.fluid]").unwrap()]
            .replace("area_m2 = 8.0e-4", "area_m2 = 8.0")
            .replace("spool_speed_gain_per_s", "spool_speed");
        let (_folder, path) = file(&text.replace("mass_kg = 10.0", ""));
        let refused = error(for_fit(&path).unwrap_err());
        for part in ["jack.area_m2: found 8, expected", "jack.mass_kg: missing", "spool_speed: found an unknown"] {
            assert!(refused.contains(part), "{part} is not in {refused}");
        }
        assert!(
            error(for_fit(Path::new("nowhere.toml")).unwrap_err())
                .contains("nowhere.toml: expected reference or a file")
        );
    }
}
