use super::*;

/// What is wrong with the built-in set when these parts of its text are replaced.
fn errors(replaced: &[(&str, &str)]) -> Vec<String> {
    let mut text = REFERENCE.to_owned();
    for (from, to) in replaced {
        assert!(text.contains(from), "{from}");
        text = text.replacen(from, to, 1);
    }
    ParameterSet::parse(&text).unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn the_hash_follows_the_values_and_not_the_comments() {
    let same = ParameterSet::parse(&format!("# another comment\n{REFERENCE}")).unwrap();
    assert_eq!(same, ParameterSet::reference());
    let other = ParameterSet::parse(&REFERENCE.replace("mass_kg = 10.0", "mass_kg = 10.1")).unwrap();
    assert_ne!(other.hash(), same.hash());
}

#[test]
fn every_value_out_of_range_is_named_with_its_range_and_unit() {
    let found = errors(&[("area_m2 = 8.0e-4", "area_m2 = -1.0"), ("mass_kg = 10.0", "mass_kg = nan")]);
    assert_eq!(
        found,
        ["jack.area_m2: found -1, expected 1e-6 to 1 m2", "jack.mass_kg: found NaN, expected 0.01 to 10000 kg"]
    );
}

#[test]
fn unknown_missing_mistyped_and_out_of_range_parameters_are_told_together() {
    let found = errors(&[
        ("mass_kg = 10.0", "mass_lb = 22.0"),
        ("current_max_a = 0.038", "current_max_a = \"38 mA\""),
        ("lag_bell_a = 5.6", "lag_bell_a = [5.6]"),
        ("oil = \"constant\"", "oil = \"olive\""),
        ("model = \"borello\"", "model = \"none\""),
        ("spool_speed_gain_per_s = 1000.0", "spool_speed_gain_per_s = inf"),
    ]);
    let starts = [
        "torque_motor.current_max_a: found \"38 mA\", expected 1e-4 to 10 A",
        "jack.mass_lb: found an unknown parameter, expected area_m2, mass_kg, ",
        "jack.mass_kg: missing, expected 0.01 to 10000 kg",
        "reference.oil.oil: found \"olive\", expected one of constant, mil_prf_5606, mil_prf_83282",
        "reference.friction.model: found \"none\", expected one of coulomb, karnopp, borello",
        "monitoring.second_stage.spool_speed_gain_per_s: found inf, expected 1 to 1e6 1/s",
        "monitoring.fluid.lag_bell_a: found an array, expected 0.001 to 1000",
    ];
    assert_eq!(found.len(), starts.len(), "{found:#?}");
    for (found, start) in found.iter().zip(starts) {
        assert!(found.starts_with(start), "{found} does not start with {start}");
    }
}

#[test]
fn every_parameter_of_a_missing_section_is_named() {
    let end = REFERENCE.find("[monitoring.bias]").unwrap();
    let missing = ParameterSet::parse(&REFERENCE[..end]).unwrap_err();
    let names: Vec<_> = missing.iter().map(ParamsError::pointer).collect();
    let bias = ["current_ratio", "current_ratio_std", "load_pressure_std_pa"];
    assert_eq!(names, bias.map(|name| format!("/monitoring/bias/{name}")));
    let nothing = ParameterSet::parse("").unwrap_err();
    assert_eq!(nothing.len(), ParameterSet::reference().parameters().len() + 1, "all of them, and the name");
}

#[test]
fn a_set_may_lack_the_surface_of_the_bias_and_one_that_has_it_has_all_of_it() {
    let start = REFERENCE.find("[monitoring.bias.surface]").unwrap();
    let without = ParameterSet::parse(&REFERENCE[..start]).unwrap();
    assert_eq!(without.monitoring_model().bias.surface, None);
    assert_ne!(without.hash(), ParameterSet::reference().hash());
    assert_eq!(ParameterSet::parse(&without.to_toml()), Ok(without.clone()));
    assert_eq!(ParameterSet::from_json("reference", &without.to_json()), Ok(without));
    let of = "monitoring.bias.surface.";
    let told = |surface: &str| -> Vec<String> {
        let text = format!("{}[monitoring.bias.surface]\n{surface}", &REFERENCE[..start]);
        ParameterSet::parse(&text).unwrap_err().iter().map(ToString::to_string).collect()
    };
    let whole = "kgm = [0, 1]\nfdj_n = [200.0, 900]\ncurrent_ratio = [[1.0, 1.0], [1.0, 1.1]]\ncurrent_ratio_std = [0.0, 0.0]\n\
                 load_pressure_difference_pa = [[0.0, 0.0], [0.0, 0.0]]\nload_pressure_std_pa = [1.0, 1.0]\n";
    assert!(ParameterSet::parse(&format!("{}[monitoring.bias.surface]\n{whole}", &REFERENCE[..start])).is_ok());
    let missing = told(&whole.replace("kgm = [0, 1]\n", ""));
    assert_eq!(missing, [format!("{of}kgm: missing, expected an array of numbers, each 0 to 1")]);
    let rows = told(&whole.replace("[[1.0, 1.0], [1.0, 1.1]]", "[1.0, 1.1]"));
    assert_eq!(rows, [format!("{of}current_ratio: found an array, expected rows of numbers, each 0.5 to 2")]);
    let size = told(&whole.replace("[1.0, 1.1]]", "[1.0]]"));
    assert_eq!(size, [format!("{of}current_ratio: found 2 rows of 1 values, expected 2 rows of 2 values")]);
    let text = told(&whole.replace("[0, 1]", "[0, \"a\"]"));
    assert_eq!(text, [format!("{of}kgm: found an array, expected an array of numbers, each 0 to 1")]);
}

#[test]
fn a_range_that_a_missing_parameter_draws_is_not_guessed() {
    let high = ("friction_dynamic_n = 0.1", "friction_dynamic_n = 5.0");
    assert_eq!(errors(&[high]).len(), 1);
    let found = errors(&[high, ("friction_static_n = 0.2", "")]);
    assert_eq!(found, ["reference.second_stage.friction_static_n: missing, expected 0 to 1000 N"]);
}

#[test]
fn an_error_of_syntax_is_named_by_line_and_column() {
    let found = ParameterSet::parse("name = \"x\"\n[jack]\narea_m2 = = 1\n").unwrap_err();
    assert!(matches!(found[..], [ParamsError::Syntax { line: 3, column: 11, .. }]), "{found:?}");
    let twice = ParameterSet::parse("name = \"x\"\nname = \"y\"\n").unwrap_err();
    assert!(matches!(twice[..], [ParamsError::Syntax { line: 2, .. }]), "{twice:?}");
}

#[test]
fn a_bad_name_is_refused() {
    for name in ["", "a b", "a/b", "a@b", "é", &"x".repeat(65)] {
        assert!(!ParameterSet::is_name(name), "{name}");
        let found = errors(&[("name = \"reference\"", &format!("name = {name:?}"))]);
        assert!(found[0].starts_with("name: found "), "{found:?}");
    }
    assert!(ParameterSet::is_name("Servo_2.b-1"));
    let both = errors(&[("name = \"reference\"", "name = \"a b\""), ("mass_kg = 10.0", "mass_kg = -1.0")]);
    assert!(
        matches!(&both[..], [name, mass] if name.starts_with("name: ") && mass.starts_with("jack.mass_kg")),
        "{both:?}"
    );
}

#[test]
fn a_set_is_read_back_as_it_was_written() {
    let text = REFERENCE
        .replace("\"reference\"", "\"mine\"")
        .replace("mass_kg = 10.0", "mass_kg = 10")
        .replace("leakage_m3_per_s_per_pa = 5.69e-14", "leakage_m3_per_s_per_pa = 5.690000000000001e-14");
    let set = ParameterSet::parse(&text).unwrap();
    assert_eq!(ParameterSet::parse(&set.to_toml()), Ok(set.clone()));
    assert_eq!(ParameterSet::from_json("mine", &set.to_json()), Ok(set));
    let reference = ParameterSet::reference();
    assert_eq!(ParameterSet::parse(&reference.to_toml()), Ok(reference));
}

#[test]
fn a_json_document_s_errors_are_named_by_pointers_and_nothing_panics() {
    let mut json = ParameterSet::reference().to_json();
    json["jack"]["a/b~c"] = serde_json::json!(1);
    json["jack"]["area_m2"] = serde_json::json!(null);
    json["reference"]["fluid"] = serde_json::json!(7);
    let found = ParameterSet::from_json("mine", &json).unwrap_err();
    let pointers: Vec<_> = found.iter().map(ParamsError::pointer).collect();
    assert_eq!(pointers, ["/jack/a~1b~0c", "/jack/area_m2", "/reference/fluid"]);
    assert_eq!(found[1].detail(), "found null, expected 1e-6 to 1 m2");
    for odd in
        [serde_json::json!(null), serde_json::json!([]), serde_json::json!("x"), serde_json::json!({"name": "x"})]
    {
        assert!(!ParameterSet::from_json("mine", &odd).unwrap_err().is_empty(), "{odd}");
    }
}

#[test]
fn every_number_of_the_built_in_set_has_a_range() {
    let without = |parameter: &Parameter| matches!(parameter.value, Value::Number(_)) && parameter.limits.is_none();
    let found: Vec<_> = ParameterSet::reference().parameters().into_iter().filter(without).collect();
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn single_parameters_are_changed_by_name_and_checked_with_the_rest() {
    let changes = |pairs: &[(&str, &str)]| -> Vec<(String, String)> {
        pairs.iter().map(|&(name, value)| (name.to_owned(), value.to_owned())).collect()
    };
    let reference = ParameterSet::reference();
    let with = |pairs: &[(&str, &str)]| reference.with(&changes(pairs));
    let karnopp = with(&[("reference.friction.model", "karnopp"), ("jack.mass_kg", "12")]).unwrap();
    let mut text = REFERENCE.replace("model = \"borello\"", "model = \"karnopp\"");
    text = text.replacen("mass_kg = 10.0", "mass_kg = 12.0", 1);
    assert_eq!(karnopp, ParameterSet::parse(&text).unwrap());
    let told =
        |pairs: &[(&str, &str)]| -> Vec<String> { with(pairs).unwrap_err().iter().map(ToString::to_string).collect() };
    let found = told(&[("jack.mass_kg", "heavy"), ("jack.area_m2", "-1"), ("reference.friction.model", "none")]);
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[1].starts_with("jack.mass_kg: found \"heavy\", expected 0.01 to 10000 kg"), "{found:?}");
    let unknown = told(&[("jack.mass_lb", "1"), ("jack", "1"), ("name", "x"), ("a.b", "1")]);
    assert_eq!(unknown.len(), 4, "{unknown:?}");
    assert!(
        unknown[0].starts_with("jack.mass_lb: found an unknown parameter, expected area_m2, mass_kg"),
        "{unknown:?}"
    );
}
