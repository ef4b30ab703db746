//! What holds for every format, and what the columns mean.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;
use crate::models::trace::Channel;

/// The first samples of a diagnostic ramp, as another program wrote them.
pub(super) const EXAMPLE: &str = "\
time_s,position_command_m,servovalve_current_ma,load_pressure_pa,jack_position_m
0,0,0,0,0
0.001,0.0001,0.05235,3.087266,0
0.002,0.0002,0.1047,51.99144,0
0.003,0.0003,0.15705,214.5651,0
0.004,0.0004,0.2094,544.9287,0
0.005,0.0005,0.26175,1087.422,0
0.006,0.0006,0.3141,1878.475,0
0.007,0.0007,0.36645,2990.395,0
0.008,0.0008,0.4188,5162.56,0
0.009,0.0009,0.47115,9600.024,0
0.01,0.001,0.5235,17399.69,0
0.011,0.0011,0.57585,29450.12,0
";

/// Text with these columns and 12 rows; `value(column, row)` is a field.
pub(super) fn table(names: &[&str], value: impl Fn(&str, usize) -> String) -> String {
    let row = |row| names.iter().map(|name| value(name, row)).collect::<Vec<_>>().join(",") + "\n";
    names.join(",") + "\n" + &(0..12).map(row).collect::<String>()
}

/// A trace of columns that count up from 1, in thousandths of their unit for the time.
fn counting(names: &[&str], options: &ReadOptions) -> Result<Trace, Vec<FormatError>> {
    let text = table(names, |_, row| (row + 1).to_string());
    read(Format::Csv, text.as_bytes(), options)
}

pub(super) fn errors(result: Result<Trace, Vec<FormatError>>) -> Vec<String> {
    result.unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn an_example_is_read_in_si_units() {
    let trace = read(Format::Csv, EXAMPLE.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((trace.samples(), trace.time_s()[11]), (12, 0.011));
    assert_eq!(trace.channel(Channel::ServovalveCurrent).unwrap()[2], 0.1047e-3);
    assert_eq!(trace.channel(Channel::LoadPressure).unwrap()[11], 29450.12);
    assert_eq!(trace.columns().count(), 5);
}

#[test]
fn a_file_with_too_many_columns_is_refused_at_once() {
    let names: Vec<String> = (0..2000).map(|i| format!("column_{i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let found = errors(counting(&names, &ReadOptions::default()));
    assert_eq!(found, ["line 1: found 2000 columns, expected at most 1000"]);
}

#[test]
fn every_unit_of_every_quantity_is_converted() {
    for (names, channel, si) in [
        (
            &["position_command_m", "position_command_mm", "position_command_in"][..],
            Channel::PositionCommand,
            &[1.0, 1e-3, 0.0254][..],
        ),
        (&["servovalve_current_a", "servovalve_current_ma"], Channel::ServovalveCurrent, &[1.0, 1e-3]),
        (
            &["load_pressure_pa", "load_pressure_kpa", "load_pressure_mpa", "load_pressure_bar", "load_pressure_psi"],
            Channel::LoadPressure,
            &[1.0, 1e3, 1e6, 1e5, 6894.757293168],
        ),
        (&["jack_velocity_mm_per_s", "jack_velocity_in_per_s"], Channel::JackVelocity, &[1e-3, 0.0254]),
        (&["external_load_kn", "external_load_lbf"], Channel::ExternalLoad, &[1e3, 4.4482216152605]),
        (&["supply_pressure_bar"], Channel::SupplyPressure, &[1e5]),
        (&["spool_position_mm"], Channel::SpoolPosition, &[1e-3]),
        (&["jack_position_in"], Channel::JackPosition, &[0.0254]),
    ] {
        for (name, si) in names.iter().zip(si) {
            let needed = ["time_ms", "position_command_m", "servovalve_current_a"];
            let others = needed.into_iter().filter(|needed| !needed.starts_with(name.rsplit_once('_').unwrap().0));
            let trace = counting(&[*name].into_iter().chain(others).collect::<Vec<_>>(), &ReadOptions::default());
            let trace = trace.unwrap();
            assert_eq!(trace.channel(channel).unwrap()[0], *si, "{name}");
            assert_eq!(trace.time_s()[0], 0.001);
        }
    }
}

#[test]
fn port_pressures_give_the_load_pressure_and_stay() {
    let names = ["time_s", "position_command_m", "port_2_pressure_pa", "port_1_pressure_kpa"];
    let trace = counting(&names, &ReadOptions::default()).unwrap();
    assert_eq!(trace.channel(Channel::LoadPressure).unwrap()[..2], [999.0, 1998.0]);
    let ports: Vec<_> = trace.columns().skip(3).map(|(name, values)| (name, values[1])).collect();
    assert_eq!(ports, [("port_2_pressure_pa", 2.0), ("port_1_pressure_pa", 2000.0)]);
}

#[test]
fn a_load_pressure_column_wins_over_the_ports_and_needs_no_second_one() {
    let names = ["time_s", "position_command_m", "port_1_pressure_pa", "port_2_pressure_pa", "load_pressure_bar"];
    for names in [&names[..], &[&names[..3], &names[4..]].concat()] {
        let trace = counting(names, &ReadOptions::default()).unwrap();
        assert_eq!(trace.channel(Channel::LoadPressure).unwrap()[0], 1e5);
    }
}

#[test]
fn one_port_alone_is_an_error_that_names_the_other() {
    for (one, other) in [("port_1_pressure_pa", "port_2_pressure_pa"), ("port_2_pressure_psi", "port_1_pressure_pa")] {
        let names = ["time_s", "position_command_m", "servovalve_current_a", one];
        let found = errors(counting(&names, &ReadOptions::default()));
        assert!(found.len() == 1 && found[0].contains(&format!("expected {other}")), "{found:?}");
    }
}

#[test]
fn an_unknown_unit_is_an_error_that_lists_the_accepted_names() {
    for name in ["load_pressure_furlong", "load_pressure"] {
        let found = errors(counting(&["time_s", "position_command_m", name], &ReadOptions::default()));
        let accepted = ["pa", "kpa", "mpa", "bar", "psi"].map(|unit| format!("load_pressure_{unit}")).join(" or ");
        assert_eq!(found, [format!("line 1, column {name}: found {name}, expected {accepted}")]);
    }
}

#[test]
fn unknown_columns_are_kept_as_they_are() {
    let names = ["oil_temperature_k", "time_s", "position_command_m", "servovalve_current_ma"];
    let trace = counting(&names, &ReadOptions::default()).unwrap();
    let last = trace.columns().last().unwrap();
    assert_eq!((last.0, last.1[11]), ("oil_temperature_k", 12.0));
}

#[test]
fn two_columns_for_one_quantity_are_an_error() {
    let names = ["time_s", "position_command_m", "time_ms", "x", "load_pressure_pa", "x"];
    let found = errors(counting(&names, &ReadOptions::default()));
    let expected = [
        "line 1, column time_ms: found a second column for time_s, expected only time_s",
        "line 1, column x: found a second column for x, expected only x",
    ];
    assert_eq!(found, expected);
}

#[test]
fn every_missing_column_is_named_at_once() {
    let found = errors(counting(&["x", "jack_position_m"], &ReadOptions::default()));
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0].contains("time_s") && found[0].contains("sample_rate_hz"), "{found:?}");
    assert!(found[1].contains("position_command_m"), "{found:?}");
    assert!(found[2].contains("servovalve_current_a") && found[2].contains("load_pressure_pa"), "{found:?}");
}

#[test]
fn a_sample_rate_gives_the_times_that_a_file_lacks() {
    let at = |rate| ReadOptions { sample_rate_hz: Some(rate), ..ReadOptions::default() };
    let names = ["position_command_m", "load_pressure_pa"];
    let trace = counting(&names, &at(1000.0)).unwrap();
    assert_eq!((trace.time_s()[0], trace.time_s()[3]), (0.0, 0.003));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
        let found = errors(counting(&names, &at(rate)));
        assert!(found.len() == 1 && found[0].starts_with("sample_rate_hz: found"), "{found:?}");
    }
    let own = counting(&["time_s", "position_command_m", "load_pressure_pa"], &at(1000.0)).unwrap();
    assert_eq!(own.time_s()[0], 1.0);
}

#[test]
fn a_column_map_is_parsed_and_used() {
    let columns = ReadOptions::parse_columns(" Cor:servovalve_current_ma, P12: x:load_pressure_pa").unwrap();
    assert_eq!(columns[1], ("P12: x".to_owned(), "load_pressure_pa".to_owned()));
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let trace = counting(&["time_s", "Cor", "P12: x", "position_command_m"], &options).unwrap();
    assert_eq!(trace.channel(Channel::ServovalveCurrent).unwrap()[0], 1e-3);
    assert_eq!(trace.channel(Channel::LoadPressure).unwrap()[0], 1.0);
    assert_eq!(ReadOptions::parse_columns(" "), Ok(Vec::new()));
}

#[test]
fn a_column_map_that_cannot_be_right_is_an_error() {
    let faults = ReadOptions::parse_columns("Cor,a:time_s,:time_s,b:").unwrap_err();
    assert!(faults.len() == 3 && faults.iter().all(|fault| fault.place == "columns"), "{faults:?}");
    assert!(faults[0].detail.contains("\"Cor\""), "{faults:?}");

    let columns =
        ReadOptions::parse_columns("Cor:servovalve_curent_ma,P12:load_pressure_atm,X:time_s,P12:time_s").unwrap();
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let found = errors(counting(&["time_s", "Cor", "P12", "position_command_m", "servovalve_current_a"], &options));
    for expected in ["servovalve_curent_ma for Cor", "no column X in the file", "P12 twice"] {
        assert!(found.iter().any(|error| error.starts_with("columns: ") && error.contains(expected)), "{found:?}");
    }
}

#[test]
fn faults_of_the_whole_trace_are_named_by_line_and_by_the_users_own_column() {
    let columns = vec![("t".to_owned(), "time_ms".to_owned())];
    let options = ReadOptions { columns, ..ReadOptions::default() };
    let with_times = |times: fn(usize) -> String| {
        let text = table(&["t", "position_command_m", "load_pressure_mpa"], |name, row| match name {
            "t" => times(row),
            "load_pressure_mpa" if row == 2 => "1e305".into(),
            _ => "1".into(),
        });
        errors(read(Format::Csv, format!("# a comment\n{text}").as_bytes(), &options))
    };
    let falling = with_times(|row| if row == 4 { "3".into() } else { row.to_string() });
    assert_eq!(falling[0], "line 7, column t: found 0.003 s after 0.003 s, expected a later time");
    assert!(falling[1].starts_with("line 5, column load_pressure_mpa: found inf after conversion"), "{falling:?}");
    let gap = with_times(|row| (row + 100 * usize::from(row > 5)).to_string());
    assert!(
        gap[0].starts_with(
            "line 9, column t: found a gap of 0.101 s, expected at most 10 times the median step of 0.001 s"
        ),
        "{gap:?}"
    );
}

#[test]
fn a_difference_of_port_pressures_that_is_not_finite_is_found_at_port_1() {
    let names = ["time_s", "position_command_m", "port_1_pressure_pa", "port_2_pressure_pa"];
    let text = table(&names, |name, row| match (name, row) {
        ("port_1_pressure_pa", 3) => "1e308".into(),
        ("port_2_pressure_pa", 3) => "-1e308".into(),
        _ => row.to_string(),
    });
    let found = errors(read(Format::Csv, text.as_bytes(), &ReadOptions::default()));
    assert!(found[0].starts_with("line 5, column port_1_pressure_pa: found inf"), "{found:?}");
}

#[test]
fn media_types_and_extensions_name_formats() {
    for format in Format::ALL {
        assert_eq!(Format::from_media_type(format.media_type()), Some(format));
        assert_eq!(Format::from_extension(format.extension()), Some(format));
    }
    assert_eq!(Format::from_media_type("Text/CSV ; charset=utf-8"), Some(Format::Csv));
    assert_eq!(Format::from_extension("JSON"), Some(Format::Json));
    assert_eq!((Format::from_media_type("text/html"), Format::from_extension("txt")), (None, None));
}

#[test]
fn what_is_not_text_or_empty_is_refused_in_every_format() {
    for format in Format::ALL {
        for (bytes, expected) in [
            (&b""[..], "file: found nothing"),
            (b"\xef\xbb\xbf \r\n", "file: found nothing"),
            (b"time_s\n\n1\xb5\n", "line 3: found the byte 0xb5, expected text in UTF-8"),
            (b"\x1f\x8b\x08\0\0", "line 1: found the byte 0x8b"),
        ] {
            let found = errors(read(format, bytes, &ReadOptions::default()));
            assert!(found.len() == 1 && found[0].starts_with(expected), "{found:?}");
        }
    }
}

/// Finite numbers of every size and sign, zeros and subnormal ones among them.
fn finite() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite())
}

fn traces() -> impl Strategy<Value = Trace> {
    let names = proptest::collection::btree_set("x[a-z,;\t\"/~ é]{0,8}x", 0..4);
    (10..40usize, names, any::<u8>()).prop_flat_map(|(samples, names, chosen)| {
        let known = Channel::ALL.into_iter().enumerate().filter(move |(i, _)| *i < 2 || chosen >> i & 1 == 1);
        let known: Vec<Channel> = known.map(|(_, channel)| channel).collect();
        let column = proptest::collection::vec(finite(), samples);
        let times = proptest::collection::vec(0.5..1.0, samples);
        let columns = proptest::collection::vec(column, known.len() + names.len());
        (Just(known), Just(names), times, columns).prop_map(|(known, names, steps, mut columns)| {
            let time_s = steps
                .iter()
                .scan(0.0, |time, step| {
                    *time += step;
                    Some(*time)
                })
                .collect();
            let others = columns.split_off(known.len());
            let channels: BTreeMap<_, _> = known.into_iter().zip(columns).collect();
            Trace::try_new(time_s, channels, names.into_iter().zip(others).collect()).unwrap()
        })
    })
}

fn bits(trace: &Trace) -> Vec<(String, Vec<u64>)> {
    trace.columns().map(|(name, values)| (name.into(), values.iter().map(|value| value.to_bits()).collect())).collect()
}

/// A trace, or at least one error.
fn is_answer(format: Format, bytes: &[u8], options: &ReadOptions) -> bool {
    read(format, bytes, options).map_or_else(|errors| !errors.is_empty(), |trace| trace.samples() >= 10)
}

proptest! {
    #[test]
    fn what_is_written_is_read_back_bit_for_bit(trace in traces()) {
        for format in Format::ALL {
            let back = read(format, &write(format, &trace), &ReadOptions::default());
            prop_assert_eq!(back.as_ref().map(bits), Ok(bits(&trace)));
        }
    }

    #[test]
    fn no_bytes_make_reading_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        for format in Format::ALL {
            prop_assert!(is_answer(format, &bytes, &ReadOptions::default()));
        }
    }

    #[test]
    fn no_text_of_the_right_letters_makes_reading_panic(
        csv in "(time_s|load_pressure_pa|[,;\t\n\r\"# 01.eEmµ-])*",
        json in "[{}\\[\\]\",:0-9.eE\\\\ a-z-]*",
    ) {
        for (format, text) in [(Format::Csv, csv), (Format::Json, json)] {
            prop_assert!(is_answer(format, text.as_bytes(), &ReadOptions::default()));
        }
    }

    #[test]
    fn no_damage_to_a_good_file_makes_reading_panic(
        at in 0..EXAMPLE.len(),
        length in 0..20usize,
        put: Vec<u8>,
        text in "[,;:\t\n\r\"# 01.eEmµ\\[\\]{}-]{0,6}",
        rate: Option<f64>,
    ) {
        let options = ReadOptions { sample_rate_hz: rate, ..ReadOptions::default() };
        let trace = read(Format::Csv, EXAMPLE.as_bytes(), &ReadOptions::default()).unwrap();
        for format in Format::ALL {
            for put in [&put[..], text.as_bytes()] {
                let mut bytes = write(format, &trace);
                let at = at.min(bytes.len());
                let end = (at + length).min(bytes.len());
                bytes.splice(at..end, put.iter().copied());
                prop_assert!(is_answer(format, &bytes, &options));
            }
        }
    }
}
