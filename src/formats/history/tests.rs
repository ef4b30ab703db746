//! What is read of a history, and what is refused.

use serde_json::json;

use super::*;

fn csv(text: &str) -> History {
    read(Format::Csv, text.as_bytes()).unwrap().histories.remove(0)
}

fn json(document: &Value) -> Histories {
    read(Format::Json, document.to_string().as_bytes()).unwrap()
}

fn errors(format: Format, text: &str) -> Vec<String> {
    read(format, text.as_bytes()).unwrap_err().iter().map(ToString::to_string).collect()
}

#[test]
fn every_dialect_of_csv_gives_the_same_history() {
    let plain = csv("usage,value,std\n0,0.1,0.01\n10,0.2,\n");
    assert_eq!((&plain.usage[..], &plain.value[..]), (&[0.0, 10.0][..], &[0.1, 0.2][..]));
    assert_eq!(plain.std, [Some(0.01), None]);
    for text in [
        "usage;value;std\n0;0.1;0.01\n10;0.2;\n",
        "# of an actuator\nvalue\tStd\tnote\tusage\r\n0.1\t10m\t\t0\r\n\r\n# late\r\n0.2\t\tseen\t10\r\n",
        "t,h,\"value_std\"\n\"0\",0.1,0.01\n10,0.2,\"\"\n",
    ] {
        let history = csv(text);
        assert_eq!((&history.usage, &history.value, &history.std), (&plain.usage, &plain.value, &plain.std), "{text}");
    }
    assert_eq!(csv("usage,value\n0,1\n").std, [None]);
    assert_eq!(csv("flight_cycles,kgm\n0,1\n").asked.unit, Some(UsageUnit::FlightCycles));
}

#[test]
fn faulty_rows_are_named_by_line_and_column() {
    let text = "# one\nt,value,std\n0,0.1,0.01\n\n5,oops,0.01\n4,0.1,-1\n6,NaN,0.01\n7\n";
    let found = errors(Format::Csv, text);
    let expected = [
        "line 5, column value: found \"oops\", expected a number such as -0.5, 1e-3 or 25.1m",
        "line 7, column value: found \"NaN\", expected a finite number",
        "line 8, column value: found 1 fields, expected 3",
    ];
    assert_eq!(found, expected);
    let found = errors(Format::Csv, "t,value,std\n0,0.1,0.01\n# two\n5,0.1,0.01\n4,0.1,-1\n6,0.1,0\n");
    let expected = [
        "line 5, column t: found 4, expected 5 or more: usage does not fall",
        "line 5, column std: found -1, expected 0 or more",
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_csv_without_the_columns_or_rows_is_refused() {
    for (text, expected) in [
        ("", "file: found nothing, expected a history"),
        ("# nothing\n", "file: found only comments"),
        ("usage,value\n", "file: found no observation under the header line"),
        (
            "0,1\n1,2\n",
            "line 1: found numbers, expected a header line with the names of the columns, such as usage,value",
        ),
        ("usage,level\n0,1\n", "line 1: found the columns usage, level, expected one of value, kgm, fdj_n, h"),
        ("usage,kgm,fdj_n\n0,1,2\n", "line 1: found both kgm and fdj_n, expected one column of them"),
        ("usage,value\n0,1\0\n", "file: found bytes that are not text"),
    ] {
        let found = errors(Format::Csv, text);
        assert!(found.len() == 1 && found[0].starts_with(expected), "{found:?}");
    }
}

#[test]
fn one_history_or_a_batch_is_read_from_json() {
    let one = json(&json!({"threshold": 1, "direction": "rising", "usage": [0, 1], "value": [0.5, 2], "at": 7}));
    assert_eq!((one.batch, one.asked.threshold, one.asked.direction), (false, Some(1.0), Some(Direction::Rising)));
    let history = &one.histories[0];
    assert_eq!((&history.value[..], &history.std[..], &history.id), (&[0.5, 2.0][..], &[None, None][..], &None));
    assert_eq!(history.at, Some(At::One(7.0)));
    let batch = json(&json!({"histories": [
        {"id": "a", "usage": [0, 1], "value": [1, 1], "std": [0.1, null], "at": [9, 3], "threshold": 2, "eol": 8.5},
        {"t": [0], "h": [1], "cuts": {"early": 2.5, "late": 5}, "truth": {"k": [1]}},
    ], "seed": 1}));
    assert!(batch.batch);
    let [first, second] = &batch.histories[..] else { panic!("{batch:?}") };
    assert_eq!((first.id.as_ref().unwrap(), second.id.as_ref().unwrap()), (&json!("a"), &json!(1)));
    assert_eq!((first.asked.threshold, first.end_of_life), (Some(2.0), Some(8.5)));
    assert_eq!(first.std, [Some(0.1), None]);
    assert_eq!(first.at, Some(At::Many(vec![9.0, 3.0])));
    assert_eq!((&second.usage[..], &second.at), (&[0.0][..], &Some(At::Many(vec![2.5, 5.0]))));
}

#[test]
fn the_labels_of_cuts_keep_the_order_of_the_file() {
    let text = r#"{"t": [0], "h": [1], "cuts": {"z": 1, "a": 3, "m": 2}}"#;
    assert_eq!(read(Format::Json, text.as_bytes()).unwrap().histories[0].at, Some(At::Many(vec![1.0, 3.0, 2.0])));
}

#[test]
fn faulty_fields_of_json_are_named_by_their_pointers() {
    for (text, expected) in [
        (
            r#"{"histories": [{"t": [0, 2, 1], "h": [0, 1, "x"]}]}"#,
            "/histories/0/h/2: found the text \"x\", expected a number",
        ),
        (r#"{"histories": [{"t": [0, 2, 1], "h": [0, 1, 2]}]}"#, "/histories/0/t/2: found 1, expected 2 or more"),
        (r#"{"usage": [0], "value": [0], "std": [-0.5]}"#, "/std/0: found -0.5, expected 0 or more"),
        (r#"{"usage": [0], "value": [0, 1]}"#, "/value: found 2 numbers, expected 1, as many as in usage"),
        (r#"{"usage": [0], "value": [0], "std": [1, 1]}"#, "/std: found 2 numbers, expected 1"),
        (r#"{"usage": [0]}"#, "/value: found nothing, expected an array of numbers"),
        (r#"{"usage": [0], "t": [0], "value": [0]}"#, "/t: found both usage and t"),
        (r#"{"usage": [0], "value": [0], "at": 1, "cuts": [1]}"#, "/cuts: found both at and cuts"),
        (r#"{"usage": [0], "value": [NaN]}"#, "/value/0 (line 1, column 26): found NaN, expected a finite number"),
        (r#"{"usage": [0], "value": [0, -Infinity]}"#, "/value/1 (line 1, column 30): found -Infinity, expected"),
        (r#"{"usage": [1e999], "value": [0]}"#, "/usage/0: number out of range"),
        (r#"{"usage": [0], "value": [0], "direction": "up"}"#, "/direction: unknown variant `up`, expected `rising`"),
        (r#"{"usage": [0], "value": [0], "id": []}"#, "/id: found [], expected a text or a number"),
        (r#"{"histories": [{"histories": []}]}"#, "/histories/0/histories: found histories in a history"),
        (r#"{"histories": [], "usage": [0]}"#, "/histories: found a history beside them"),
        (r#"{"usage": [0], "value": [0]"#, "line 1, column"),
        ("[]", "line 1, column"),
    ] {
        let found = errors(Format::Json, text);
        assert!(found[0].starts_with(expected), "{text}: {found:?}");
    }
}

#[test]
fn places_are_those_of_the_file() {
    let history = csv("t,value\n\n0,1\n# two\n3,4\n");
    assert_eq!(history.place_of(Figure::Value, 1), "line 5, column value");
    assert_eq!(history.place_of_field("eol"), "eol");
    let batch = json(&json!({"histories": [{"t": [0], "value": [0]}]}));
    assert_eq!(batch.histories[0].place_of(Figure::Usage, 0), "/histories/0/t/0");
    assert_eq!(batch.histories[0].place_of_field("eol"), "/histories/0/eol");
}
