//! Text of separated numbers under a header line.

use std::io::Write;

use ::csv::{Reader, ReaderBuilder, StringRecord, Writer};

use super::columns::{Columns, Make, Places, Purpose, check_number};
use super::errors::{FormatErrors, clip, only};
use super::number::{bare, parse};
use super::{FormatError, ReadOptions};
use crate::models::trace::Trace;

/// The separators that are tried; of two that fit equally well the later one is taken.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

/// The lines of a file, counted from 1 with comments and blank lines.
struct Lines {
    header: u64,
    samples: Vec<u64>,
}

impl Places for Lines {
    fn names(&self) -> String {
        format!("line {}", self.header)
    }

    fn column(&self, name: &str) -> String {
        at(self.header, name)
    }

    fn value(&self, name: &str, row: usize) -> String {
        at(self.samples[row], name)
    }
}

/// A column on a line.
pub(super) fn at(line: u64, name: &str) -> String {
    format!("line {line}, column {}", clip(name))
}

/// The lines of a text that hold something, split into fields.
pub(super) struct Rows<'a> {
    text: &'a str,
    reader: Reader<&'a [u8]>,
    pub(super) row: StringRecord,
}

impl<'a> Rows<'a> {
    pub(super) fn new(text: &'a str, separator: u8) -> Self {
        let mut builder = ReaderBuilder::new();
        builder.delimiter(separator).comment(Some(b'#')).has_headers(false).flexible(true);
        Self { text, reader: builder.from_reader(text.as_bytes()), row: StringRecord::new() }
    }

    /// The next row, or `None` after the last one.
    pub(super) fn next(&mut self) -> Option<&StringRecord> {
        while self.reader.read_record(&mut self.row).expect("text in memory can be read, and its rows may be uneven") {
            if self.row.len() > 1 || self.row.iter().any(|field| !field.trim().is_empty()) {
                return Some(&self.row);
            }
        }
        None
    }

    /// The line on which the newest row begins. A row's position is where the one before it ended, ahead of comments
    /// and blank lines.
    pub(super) fn line(&self) -> u64 {
        let Some(position) = self.row.position() else { return 1 };
        let mut line = position.line();
        let mut rest = &self.text.as_bytes()[position.byte() as usize..];
        loop {
            let skipped = match rest.first() {
                Some(b'\n' | b'\r') => 1,
                Some(b'#') => 1 + rest.iter().take_while(|&&byte| byte != b'\n').count(),
                _ => return line,
            };
            let (before, after) = rest.split_at(skipped.min(rest.len()));
            line += u64::from(before.ends_with(b"\n"));
            rest = after;
        }
    }
}

/// The separator that splits the header into most names, preferably as many as the first row has fields.
pub(super) fn separator(text: &str) -> u8 {
    let fit = |&separator: &u8| {
        let mut rows = Rows::new(text, separator);
        let [names, fields] = [(); 2].map(|()| rows.next().map_or(0, StringRecord::len));
        (names > 1 && names == fields, names)
    };
    SEPARATORS.into_iter().max_by_key(fit).unwrap_or(b',')
}

/// Reads text, and makes something of it.
pub(super) fn read<T>(
    text: &str,
    options: &ReadOptions,
    purpose: Purpose,
    make: Make<T>,
) -> Result<T, Vec<FormatError>> {
    if text.contains('\0') {
        return Err(only("file", "found bytes that are not text, expected a header line and rows of numbers"));
    }
    let mut rows = Rows::new(text, separator(text));
    let Some(header) = rows.next() else {
        return Err(only("file", "found only comments, expected a header line and rows of numbers"));
    };
    let names: Vec<String> = header.iter().map(|name| bare(name).to_owned()).collect();
    let mut lines = Lines { header: rows.line(), samples: Vec::new() };
    if names.iter().all(|name| parse(name).is_ok()) {
        return Err(only(lines.names(), "found numbers, expected a header line with the names of the columns"));
    }
    let mut faults = FormatErrors::default();
    if let Some(empty) = names.iter().position(String::is_empty) {
        faults.add(|| lines.names(), || format!("found nothing as the name of column {}, expected a name", empty + 1));
    }
    check_number(&names, &lines)?;
    let columns = Columns::resolve(names, options, purpose, &lines, &mut faults);
    let data = read_numbers(&mut rows, &columns, &mut lines.samples, &mut faults);
    faults.into_result()?;
    columns.into(data, make, &lines)
}

/// Reads every row, and adds its line to `lines`. The numbers are of use only when there were no faults.
fn read_numbers(rows: &mut Rows, columns: &Columns, lines: &mut Vec<u64>, faults: &mut FormatErrors) -> Vec<Vec<f64>> {
    let expected = columns.len();
    let mut data = vec![Vec::new(); expected];
    while rows.next().is_some() {
        let (row, line) = (&rows.row, rows.line());
        lines.push(line);
        let found = row.len();
        if found != expected {
            let last = columns.name(found.min(expected - 1));
            faults.add(|| at(line, last), || format!("found {found} fields, expected {expected}"));
        }
        for (index, (field, values)) in row.iter().zip(&mut data).enumerate() {
            match parse(field) {
                Ok(value) => values.push(value),
                Err(detail) => faults.add(|| at(line, columns.name(index)), || detail),
            }
        }
    }
    data
}

/// Writes a trace as comma-separated text.
pub(super) fn write(trace: &Trace) -> Vec<u8> {
    const WRITES: &str = "memory takes every write";
    let (names, data): (Vec<&str>, Vec<&[f64]>) = trace.columns().unzip();
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(names).expect(WRITES);
    let mut text = writer.into_inner().expect(WRITES);
    for row in 0..trace.samples() {
        for (index, values) in data.iter().enumerate() {
            let separator = if index == 0 { "" } else { "," };
            write!(text, "{separator}{:?}", values[row]).expect(WRITES);
        }
        text.push(b'\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::super::tests::{EXAMPLE, errors, table};
    use super::*;

    const NAMES: [&str; 3] = ["time_s", "position_command_m", "load_pressure_pa"];

    fn read_plain(text: &str) -> Result<Trace, Vec<FormatError>> {
        super::super::read(super::super::Format::Csv, text.as_bytes(), &ReadOptions::default())
    }

    #[test]
    fn every_dialect_gives_the_same_trace() {
        let expected = read_plain(EXAMPLE).unwrap();
        let quoted: String = EXAMPLE
            .lines()
            .map(|line| line.split(',').map(|field| format!("\"{field}\"")).collect::<Vec<_>>().join("; ") + "\r\n")
            .collect();
        for text in [
            EXAMPLE.replace(',', ";"),
            EXAMPLE.replace(',', "\t"),
            EXAMPLE.replace(',', " ,\t"),
            EXAMPLE.replace('\n', "\r\n"),
            EXAMPLE.replace('\n', "\r"),
            EXAMPLE.trim_end().to_owned(),
            format!("\u{feff}# made, by; hand\n\n  \n{}", EXAMPLE.replace('\n', "\n# a \"comment\n\n")),
            EXAMPLE.replace("0.00", " +.00"),
            EXAMPLE.replace("544.9287", "0.5449287k"),
            quoted,
        ] {
            assert_eq!(read_plain(&text).as_ref(), Ok(&expected), "{text}");
        }
    }

    #[test]
    fn faulty_fields_are_named_by_line_and_column() {
        let text = table(&NAMES, |name, row| match (name, row) {
            ("load_pressure_pa", 1) => "off".into(),
            ("position_command_m", 3) => String::new(),
            ("position_command_m", 4) => "NaN".into(),
            ("load_pressure_pa", 5) => "1,2".into(),
            _ => row.to_string(),
        });
        let text = text.replace("\n6,6,6\n", "\n6,6\n");
        let found =
            errors(read_plain(&format!("# one\r\n\r\n# three\r\n{}", text.replace("\n2,", "\n\n# comment\n2,"))));
        let expected = [
            "line 6, column load_pressure_pa: found \"off\", expected a number such as -0.5, 1e-3 or 25.1m",
            "line 10, column position_command_m: found nothing, expected a number",
            "line 11, column position_command_m: found \"NaN\", expected a finite number",
            "line 12, column load_pressure_pa: found 4 fields, expected 3",
            "line 13, column load_pressure_pa: found 2 fields, expected 3",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn twenty_errors_are_told_and_the_others_counted() {
        let found = errors(read_plain(&table(&NAMES, |_, _| "x".into())));
        assert_eq!((found.len(), found[20].as_str()), (21, "file: 16 more errors"));
    }

    #[test]
    fn faulty_names_and_faulty_fields_are_told_together() {
        let found = errors(read_plain(&table(&["time_s", "position_command_ft", "load_pressure_pa"], |_, row| {
            if row == 11 { "?".into() } else { row.to_string() }
        })));
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found[0].starts_with("line 1, column position_command_ft"), "{found:?}");
        assert!(found[3].starts_with("line 13, column load_pressure_pa"), "{found:?}");
    }

    #[test]
    fn a_file_without_names_or_rows_is_refused() {
        for (text, expected) in [
            ("# nothing but this\n", "file: found only comments, expected a header line"),
            ("time_s,position_command_m,load_pressure_pa\n", "file: found 0 samples, expected at least 10"),
            ("0,1,2\n0.1,1,2\n", "line 1: found numbers, expected a header line"),
            ("a\0b,c\n1,2\n", "file: found bytes that are not text"),
        ] {
            let found = errors(read_plain(text));
            assert!(found.len() == 1 && found[0].starts_with(expected), "{found:?}");
        }
        let unnamed =
            errors(read_plain(&table(&["time_s", "position_command_m", "load_pressure_pa", ""], |_, row| {
                row.to_string()
            })));
        assert_eq!(unnamed, ["line 1: found nothing as the name of column 4, expected a name"]);
    }

    #[test]
    fn the_separator_is_found_beside_other_candidates() {
        let numbers = |names: &[&str]| table(names, |_, row| row.to_string()).replace(',', ";");
        let listed = numbers(&[&NAMES[..], &["p_q_r_s_t"]].concat()).replace("p_q_r_s_t", "p,q,r,s,t");
        assert_eq!(read_plain(&listed).unwrap().columns().last().unwrap().0, "p,q,r,s,t");
        let decimal_comma = errors(read_plain(&numbers(&NAMES).replacen(";5;", ";0,5;", 1)));
        assert!(decimal_comma[0].starts_with("line 7, column position_command_m: found \"0,5\""), "{decimal_comma:?}");
    }

    #[test]
    fn numbers_are_written_short() {
        let trace = read_plain(&table(&NAMES, |name, row| match name {
            "load_pressure_pa" => "1e300".into(),
            _ => format!("{row}e-7"),
        }));
        let text = String::from_utf8(write(&trace.unwrap())).unwrap();
        assert_eq!(text.lines().nth(2), Some("1e-7,1e-7,1e300"));
    }
}
