//! A parameter set whose monitoring model is still to be fitted, by its name or file.

use std::path::Path;

use anyhow::{Context, anyhow};
use toml_edit::{DocumentMut, Item, Table, Value};

use crate::characterisation::report::{Change, flow_power};
use crate::cli::Failure;
use crate::cli::parameter_sets::{is_built_in, read, refused};
use crate::models::checks::ParamsError;
use crate::models::parameters::ParameterSet;

/// A set that may lack what belongs to the monitoring model alone: what is missing is the built-in set's, what is a flow of it by
/// the jack's area, and named.
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
    let reference = ParameterSet::reference();
    let built_in = reference.to_json();
    let mut table: toml::Table = text.parse().with_context(|| name.clone()).map_err(Failure::usage)?;
    let area_m2 = table.get("jack").and_then(|jack| jack.get("area_m2")).and_then(toml::Value::as_float);
    let scale = area_m2.map_or(1.0, |area_m2| area_m2 / reference.shared().jack.area_m2);
    let mut names = Vec::new();
    for error in missing {
        let value = built_in.pointer(&error.pointer()).and_then(serde_json::Value::as_f64);
        if let (ParamsError::Missing { name, .. }, Some(value)) = (error, value) {
            insert(&mut table, &name, value * scale.powi(flow_power(&name)));
            names.push(name);
        }
    }
    // A set without any bias has the built-in one's whole, to begin with.
    if names.iter().any(|name| name == "monitoring.bias.current_ratio") {
        let surface: toml::Table = reference.bias_surface_toml().unwrap_or_default().parse().map_err(Failure::work)?;
        merge(&mut table, surface);
    }
    ParameterSet::parse(&table.to_string()).map(|set| (set, names)).map_err(|errors| refused(&name, &errors))
}

/// The text of a set with other values of the monitoring model's parameters, and another surface of its bias (a section of a file);
/// everything else stays as it was written, with its remarks.
pub fn rewritten(name_or_file: &Path, changes: &[Change], surface: Option<&str>) -> Result<String, Failure> {
    let text = if is_built_in(name_or_file) { ParameterSet::reference().to_toml() } else { read(name_or_file)? };
    let name = name_or_file.display();
    let mut document: DocumentMut = text.parse().with_context(|| name.to_string()).map_err(Failure::usage)?;
    for Change { name, new, .. } in changes {
        let (section, key) = name.rsplit_once('.').unwrap_or(("", name));
        let mut table = document.as_table_mut();
        for part in section.split('.') {
            let inner = table.entry(part).or_insert_with(|| {
                let mut inner = Table::new();
                inner.set_implicit(true);
                Item::Table(inner)
            });
            let Some(inner) = inner.as_table_mut() else { return Err(inline_table(&name_or_file.display())) };
            table = inner;
        }
        let remark = table.get(key).and_then(Item::as_value).map(|value| value.decor().clone());
        table[key] = Item::Value(number(*new));
        if let (Some(value), Some(remark)) = (table[key].as_value_mut(), remark) {
            *value.decor_mut() = remark;
        }
    }
    match surface {
        Some(surface) => with_surface(document, surface),
        None => Ok(document.to_string()),
    }
}

/// The document with another surface of the bias, in its old one's place; its remark on the section stays.
fn with_surface(mut document: DocumentMut, section: &str) -> Result<String, Failure> {
    let read: DocumentMut = section.parse().map_err(Failure::work)?;
    let bias = document["monitoring"]["bias"].as_table_mut();
    let (Some(bias), Some(new)) = (bias, read["monitoring"]["bias"]["surface"].as_table()) else {
        return Err(Failure::work(anyhow!("the surface of the bias has no section")));
    };
    match bias.get_mut("surface").and_then(Item::as_table_mut) {
        Some(old) => {
            old.retain(|key, _| new.contains_key(key));
            for (key, values) in new {
                old[key] = values.clone();
            }
        }
        None => {
            let mut section = Table::new();
            section.decor_mut().set_prefix("\n");
            section.extend(new.iter().map(|(key, values)| (key.to_owned(), values.clone())));
            bias.insert("surface", Item::Table(section));
        }
    }
    Ok(document.to_string())
}

/// A number as a person writes it: with an exponent when it is very small or large.
fn number(value: f64) -> Value {
    format!("{value:?}").parse().expect("a finite number is a TOML value")
}

fn inline_table(file: &impl std::fmt::Display) -> Failure {
    Failure::usage(anyhow!("{file}: found a section in braces, expected [sections], to write the fitted values into"))
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

/// Adds the entries of a table that another one lacks, section by section.
fn merge(into: &mut toml::Table, from: toml::Table) {
    for (key, value) in from {
        match (into.get_mut(&key), value) {
            (Some(toml::Value::Table(inner)), toml::Value::Table(more)) => merge(inner, more),
            (Some(_), _) => {}
            (None, value) => drop(into.insert(key, value)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::PathBuf;

    use super::*;
    use crate::characterisation::report::Origin;
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
    fn a_file_is_rewritten_with_its_remarks_and_without_a_section_it_gets_one() {
        let whole = format!("# mine\n{}", ParameterSet::reference().to_toml());
        let change = |name: &str, new| Change { name: name.into(), unit: "", old: None, new, origin: Origin::Fitted };
        let changes =
            [change("monitoring.fluid.spool_saturation_m", 41e-6), change("monitoring.bias.current_ratio", 1.5)];
        let (_folder, path) = file(&whole);
        let text = rewritten(&path, &changes, None).unwrap();
        assert_eq!(text.matches('#').count(), whole.matches('#').count());
        let set = ParameterSet::parse(&text).unwrap();
        assert_eq!(set.monitoring_model().fluid.spool_saturation_m, 41e-6);
        assert_eq!(set.monitoring_model().bias.current_ratio, 1.5);
        assert_eq!(set.reference_model(), ParameterSet::reference().reference_model());
        let (_folder, bare) = file(&whole[..whole.find("[monitoring.first_stage]").unwrap()]);
        let text = rewritten(&bare, &changes, None).unwrap();
        assert!(text.contains("[monitoring.fluid]") && text.starts_with("# mine"), "{text}");
    }

    #[test]
    fn a_surface_of_the_bias_takes_the_old_one_s_place_or_a_section_of_its_own() {
        let whole = ParameterSet::reference().to_toml();
        let surface = "[monitoring.bias.surface]\nkgm = [0.0, 0.5]\nfdj_n = [200.0, 900.0]\ncurrent_ratio = [[1.0, 1.0], [1.0, 1.1]]\n\
                       current_ratio_std = [0.0, 0.0]\nload_pressure_difference_pa = [[0.0, 0.0], [0.0, 0.0]]\n\
                       load_pressure_std_pa = [1.0, 1.0]\n";
        let without = &whole[..whole.find("\n[monitoring.bias.surface]").unwrap()];
        for text in [whole.as_str(), without] {
            let (_folder, path) = file(text);
            let written = rewritten(&path, &[], Some(surface)).unwrap();
            assert_eq!(written.matches('#').count(), text.matches('#').count());
            assert_eq!(written.matches("[monitoring.bias.surface]").count(), 1, "{written}");
            let set = ParameterSet::parse(&written).unwrap();
            assert_eq!(set.monitoring_model().bias.surface.as_ref().unwrap().kgm, [0.0, 0.5]);
        }
    }

    #[test]
    fn a_missing_flow_is_the_built_in_set_s_by_the_jack_s_area() {
        let whole = ParameterSet::reference().to_toml().replace("area_m2 = 8.0e-4", "area_m2 = 4.0e-4");
        let (_folder, path) = file(&whole[..whole.find("[monitoring.first_stage]").unwrap()]);
        let fluid = for_fit(&path).unwrap().0.monitoring_model().fluid;
        assert!((fluid.flow_reference_m3_per_s / 2.25e-6 - 1.0).abs() < 1e-12);
        assert!((fluid.lag_flow_slope_s_per_m3 / 3.33334e5 - 1.0).abs() < 1e-12);
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
