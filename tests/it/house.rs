//! The house's own rules, read from the sources: the layers, what the core must not name, the table of symbols.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Layers that compute and must not touch the world.
const CORE: [&str; 8] =
    ["units", "numeric", "models", "optimiser", "estimation", "characterisation", "prognostics", "reproduction"];

/// The world, as it would be named.
const WORLD: [&str; 12] = [
    "tokio",
    "axum",
    "sqlx",
    "std::fs",
    "std::env::",
    "std::net",
    "std::thread",
    "SystemTime",
    "Instant",
    "Timestamp::now",
    "getrandom",
    "rand::rng()",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Every source file with its layer: the first part of its path under `src`.
fn sources() -> Vec<(String, PathBuf, String)> {
    let mut open = vec![root().join("src")];
    let mut found = Vec::new();
    while let Some(path) = open.pop() {
        if path.is_dir() {
            open.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let inside = path.strip_prefix(root().join("src")).unwrap().to_owned();
            let layer = inside.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
            let text = fs::read_to_string(&path).unwrap();
            found.push((layer.to_owned(), inside, text));
        }
    }
    found
}

/// The names that follow a prefix in a text.
fn names_after<'a>(text: &'a str, prefix: &str) -> BTreeSet<&'a str> {
    let name = |rest: &'a str| rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap();
    text.match_indices(prefix).map(|(at, _)| name(&text[at + prefix.len()..])).collect()
}

/// What each layer may name of the others, as docs/architecture.md says: indented lines of `layer -> others`.
fn layers() -> BTreeMap<String, BTreeSet<String>> {
    let document = fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let arrow = |line: &str| {
        let (layer, others) = line.strip_prefix("    ")?.split_once(" ->")?;
        let others = others.split(',').map(|other| other.trim().to_owned()).filter(|other| !other.is_empty());
        (!layer.starts_with(' ')).then(|| (layer.to_owned(), others.collect()))
    };
    document.lines().filter_map(arrow).collect()
}

#[test]
fn dependencies_point_inward_only() {
    let may_name = layers();
    for (layer, path, text) in sources() {
        if layer == "lib" {
            continue;
        }
        let allowed = may_name.get(&layer).unwrap_or_else(|| panic!("{layer} has no place in the house"));
        let prefix = if layer == "main" { "elevon::" } else { "crate::" };
        assert!(!text.contains(&format!("{prefix}{{")), "{} names several layers in one line", path.display());
        for named in names_after(&text, prefix) {
            let known = may_name.contains_key(named);
            assert!(!known || named == layer || allowed.contains(named), "{} names {named}", path.display());
        }
    }
}

#[test]
fn the_core_does_not_touch_the_world() {
    for (layer, path, text) in sources() {
        // What follows is the file's own tests.
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
        for thing in WORLD.iter().filter(|_| CORE.contains(&layer.as_str())) {
            assert!(!code.contains(thing), "{} names {thing}", path.display());
        }
    }
}

#[test]
fn the_two_models_never_import_each_other() {
    for (_, path, text) in sources() {
        for (one, other) in [("models/reference", "monitoring"), ("models/monitoring", "reference")] {
            let names_it = |line: &str| line.trim_start().starts_with("use ") && line.contains(other);
            let imports = text.contains(&format!("{other}::")) || text.lines().any(names_it);
            assert!(!path.starts_with(one) || !imports, "{} names the {other} model", path.display());
        }
    }
}

#[test]
fn every_source_file_that_a_document_names_exists() {
    let documents = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let mut named = 0;
    for document in documents.filter(|path| path.extension().is_some_and(|extension| extension == "md")) {
        let text = fs::read_to_string(&document).unwrap();
        let quoted = text.split('`').skip(1).step_by(2);
        for file in
            quoted.filter(|quoted| quoted.starts_with("src/") && quoted.ends_with(".rs") && !quoted.contains('{'))
        {
            assert!(root().join(file).is_file(), "{}: {file} does not exist", document.display());
            named += 1;
        }
    }
    assert!(named > 40, "only {named} were found");
}

#[test]
fn every_link_of_the_documents_leads_somewhere() {
    let mut documents = vec![root().join("README.md")];
    documents.extend(fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path()));
    for document in documents.iter().filter(|path| path.is_file()) {
        let text = fs::read_to_string(document).unwrap();
        for (at, _) in text.match_indices("](") {
            let target = text[at + 2..].split(')').next().unwrap();
            let path = document.parent().unwrap().join(target);
            assert!(target.contains("://") || path.exists(), "{}: {target} is not there", document.display());
        }
    }
}

#[test]
fn the_table_of_symbols_agrees_with_the_code_and_the_parameter_file() {
    let table = fs::read_to_string(root().join("docs/symbols.md")).unwrap();
    let rows = table.split("## Parameters").nth(1).unwrap().lines().filter(|line| line.contains("models::"));
    let mut values = BTreeMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        let (symbol, parameter, path, value) = (cells[1], cells[2], cells[3], cells[6]);
        let (module, field) = path.rsplit_once("::").unwrap();
        let file = module.rsplit_once("::").unwrap().0.replace("::", "/");
        let code = [format!("src/{file}.rs"), format!("src/{file}/mod.rs")]
            .iter()
            .find_map(|file| fs::read_to_string(root().join(file)).ok())
            .unwrap_or_else(|| panic!("{path}: no such file"));
        assert!(code.contains(&format!("pub {field}: f64")), "{path} is not in the code");
        if symbol.chars().all(|c| c.is_ascii_uppercase()) {
            let alias = format!("#[doc(alias = \"{}\")]", symbol.trim_end_matches('0'));
            assert!(
                code.contains(&alias) || code.contains(&format!("\"{symbol}\"")),
                "{path} lacks the alias {symbol}"
            );
        }
        values.insert(parameter.to_owned(), value.parse::<f64>().unwrap());
    }
    let file = fs::read_to_string(root().join("config/actuators/reference.toml")).unwrap();
    let mut in_file = BTreeMap::new();
    flatten("", &file.parse().unwrap(), &mut in_file);
    assert_eq!(values, in_file);
}

/// The numbers of a table under their full keys.
fn flatten(prefix: &str, table: &toml::Table, into: &mut BTreeMap<String, f64>) {
    for (key, value) in table {
        match value {
            toml::Value::Table(inner) => flatten(&format!("{prefix}{key}."), inner, into),
            toml::Value::Float(number) => drop(into.insert(format!("{prefix}{key}"), *number)),
            _ => {}
        }
    }
}
