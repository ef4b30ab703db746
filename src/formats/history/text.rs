//! One history as text of separated numbers under a header line.

use super::{Asked, Histories, History, Places, UsageUnit};
use crate::formats::FormatError;
use crate::formats::csv::{Rows, at, separator};
use crate::formats::errors::{FormatErrors, clip, only};
use crate::formats::number::{bare, parse};

/// The names of the column of usage.
const USAGE: [&str; 4] = ["usage", "flight_hours", "flight_cycles", "t"];
/// The names of the column of the value.
const VALUE: [&str; 4] = ["value", "kgm", "fdj_n", "h"];
/// The names of the column of the value's standard deviation.
const STD: [&str; 4] = ["std", "value_std", "kgm_std", "fdj_n_std"];

/// The places of the columns in a row.
struct Columns {
    usage: usize,
    value: usize,
    std: Option<usize>,
    count: usize,
}

/// Reads a history.
pub(super) fn read(text: &str) -> Result<Histories, Vec<FormatError>> {
    if text.contains('\0') {
        return Err(only("file", "found bytes that are not text, expected a header line and rows of numbers"));
    }
    let mut rows = Rows::new(text, separator(text));
    let Some(header) = rows.next() else {
        return Err(only("file", "found only comments, expected a header line and rows of numbers"));
    };
    let names: Vec<String> = header.iter().map(|name| bare(name).to_owned()).collect();
    let header = rows.line();
    if names.iter().all(|name| parse(name).is_ok()) {
        let expected = "expected a header line with the names of the columns, such as usage,value,std";
        return Err(only(format!("line {header}"), format!("found numbers, {expected}")));
    }
    let columns = columns(&names, header)?;
    let mut faults = FormatErrors::default();
    let history = observations(&mut rows, &columns, &names, header, &mut faults);
    if history.usage.is_empty() {
        faults.add(|| "file".into(), || "found no observation under the header line, expected at least one".into());
    }
    faults.into_result()?;
    Ok(Histories { asked: Asked::default(), histories: vec![history], batch: false })
}

fn columns(names: &[String], header: u64) -> Result<Columns, Vec<FormatError>> {
    let mut faults = FormatErrors::default();
    let mut find = |known: &[&str], needed: bool| {
        let is = |name: &&String| known.iter().any(|known| known.eq_ignore_ascii_case(name));
        let found: Vec<&String> = names.iter().filter(is).collect();
        let place = || format!("line {header}");
        if let [one, other, ..] = found[..] {
            faults.add(place, || format!("found both {} and {}, expected one column of them", clip(one), clip(other)));
        } else if found.is_empty() && needed {
            let all = clip(&names.join(", "));
            faults.add(place, || format!("found the columns {all}, expected one of {}", known.join(", ")));
        }
        names.iter().position(|name| is(&name))
    };
    let (usage, value, std) = (find(&USAGE, true), find(&VALUE, true), find(&STD, false));
    match (usage, value) {
        (Some(usage), Some(value)) => faults.into_result().map(|()| Columns { usage, value, std, count: names.len() }),
        _ => Err(faults.into_errors()),
    }
}

/// Reads every row. The numbers are of use only when there were no faults.
fn observations(
    rows: &mut Rows,
    columns: &Columns,
    names: &[String],
    header: u64,
    faults: &mut FormatErrors,
) -> History {
    let (mut lines, mut usage, mut value, mut std) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    while rows.next().is_some() {
        let (row, line) = (&rows.row, rows.line());
        lines.push(line);
        if row.len() != columns.count {
            let last = &names[row.len().min(columns.count - 1)];
            faults.add(|| at(line, last), || format!("found {} fields, expected {}", row.len(), columns.count));
            continue;
        }
        let mut number = |column: usize| {
            parse(&row[column]).unwrap_or_else(|detail| {
                faults.add(|| at(line, &names[column]), || detail);
                f64::NAN
            })
        };
        usage.push(number(columns.usage));
        value.push(number(columns.value));
        std.push(columns.std.filter(|&column| !bare(&row[column]).is_empty()).map(number));
    }
    let name = |column: Option<usize>| column.map_or_else(String::new, |column| names[column].clone());
    let names = [name(Some(columns.usage)), name(Some(columns.value)), name(columns.std)];
    let unit = match names[0].to_ascii_lowercase().as_str() {
        "flight_hours" => Some(UsageUnit::FlightHours),
        "flight_cycles" => Some(UsageUnit::FlightCycles),
        _ => None,
    };
    let asked = Asked { unit, ..Asked::default() };
    let places = Places::Lines { header, observations: lines, names };
    History { id: None, asked, usage, value, std, at: None, end_of_life: None, places }
}
