//! Files in and out: bytes to a trace and back, the same for the command line and for HTTP.
//!
//! Every format has the same columns. A name is a quantity and its unit (`servovalve_current_ma`); values come out in
//! SI units. Columns with other names are kept as they are, and hold numbers too.

mod columns;
mod csv;
mod errors;
pub mod history;
mod json;
mod names;
mod number;

use serde_json::{Map, Value};
use thiserror::Error;

use crate::models::trace::{Channel, Trace, check_input};
use columns::{Make, Purpose};
use errors::{FormatErrors, clip, only};

/// A file format of traces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma, semicolon or tab separated text with a header line. Lines that are blank or begin with `#` do not count.
    Csv,
    /// `{"columns": {"time_s": [...], ...}, "metadata": {...}}`. The metadata may hold anything, or be left out; a
    /// trace does not keep them.
    Json,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 2] = [Self::Csv, Self::Json];

    /// The format's media type, without parameters.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Csv => "text/csv",
            Self::Json => "application/json",
        }
    }

    /// The ending of the names of such files, without the dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Json => "json",
        }
    }

    /// The format of a media type. Its parameters (`; charset=utf-8`) and its case do not matter.
    #[must_use]
    pub fn from_media_type(media_type: &str) -> Option<Self> {
        let essence = media_type.split(';').next().unwrap_or_default().trim();
        Self::ALL.into_iter().find(|format| format.media_type().eq_ignore_ascii_case(essence))
    }

    /// The format of files whose names end so, in any case, without the dot.
    #[must_use]
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| format.extension().eq_ignore_ascii_case(extension))
    }
}

/// How to read a file whose columns do not say everything.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Names to replace: (name in the file, name as elevon knows it).
    pub columns: Vec<(String, String)>,
    /// Samples per second of a file without times, Hz. A file's own times come first.
    pub sample_rate_hz: Option<f64>,
}

impl ReadOptions {
    /// Reads a column map such as `Cor:servovalve_current_ma,P12:load_pressure_pa`. Spaces around names do not
    /// matter; a name in the file may hold colons but no commas. An empty text is an empty map.
    ///
    /// # Errors
    /// Every entry that is not a pair of names; never empty. Whether the names exist is seen when a file is read.
    pub fn parse_columns(map: &str) -> Result<Vec<(String, String)>, Vec<FormatError>> {
        let mut faults = FormatErrors::default();
        let mut columns = Vec::new();
        for entry in map.split(',').filter(|_| !map.trim().is_empty()) {
            match entry.rsplit_once(':').map(|(from, to)| (from.trim(), to.trim())) {
                Some((from, to)) if !from.is_empty() && !to.is_empty() => columns.push((from.into(), to.into())),
                _ => faults.add(
                    || "columns".into(),
                    || {
                        format!(
                            "found \"{}\", expected NAME_IN_FILE:NAME such as Cor:servovalve_current_ma",
                            clip(entry)
                        )
                    },
                ),
            }
        }
        faults.into_result().map(|()| columns)
    }
}

/// A place in a file and what is wrong there.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {detail}")]
pub struct FormatError {
    /// The place: `line 12, column load_pressure_pa`, `/columns/time_s/3`, `file`, or the option `columns` or
    /// `sample_rate_hz`. Lines and columns of text count from 1, indexes in a JSON pointer from 0.
    pub place: String,
    /// What was found there and what was expected.
    pub detail: String,
}

/// Reads a trace.
///
/// Where the load pressure has no column of its own it is the pressure in port 1 minus the pressure in port 2; the
/// two stay in the trace as further columns, in Pa.
///
/// # Errors
/// Everything that is wrong with the file, as far as reading could go on; never empty. After 20 errors comes one that
/// counts the others.
pub fn read(format: Format, bytes: &[u8], options: &ReadOptions) -> Result<Trace, Vec<FormatError>> {
    read_for(format, bytes, options, Purpose::Measurement, |c| Trace::try_new(c.time_s, c.channels, c.others))
}

/// Reads one column of a file, and its times, to let it act on a model; no other column is needed, and two rows suffice.
///
/// # Errors
/// As [`read`].
pub fn read_input(
    format: Format,
    bytes: &[u8],
    options: &ReadOptions,
    channel: Channel,
) -> Result<(Vec<f64>, Vec<f64>), Vec<FormatError>> {
    let (time_s, mut channels) = read_for(format, bytes, options, Purpose::Input(channel), |c| {
        let named = c.channels.iter().map(|(channel, values)| (channel.column(), values.as_slice()));
        let errors = check_input(&c.time_s, named);
        if errors.is_empty() { Ok((c.time_s, c.channels)) } else { Err(errors) }
    })?;
    let values = channels.remove(&channel).expect("a file without the column was refused");
    Ok((time_s, values))
}

fn read_for<T>(
    format: Format,
    bytes: &[u8],
    options: &ReadOptions,
    purpose: Purpose,
    make: Make<T>,
) -> Result<T, Vec<FormatError>> {
    match format {
        Format::Csv => csv::read(text(bytes, "a trace")?, options, purpose, make),
        Format::Json => json::read(text(bytes, "a trace")?, options, purpose, make),
    }
}

/// Writes a trace in SI units, with the fewest digits that give the same numbers back: time first, then the known
/// channels, then the others.
#[must_use]
pub fn write(format: Format, trace: &Trace) -> Vec<u8> {
    write_with(format, trace, &Map::new())
}

/// The same with metadata, where the format has a place for them: JSON.
#[must_use]
pub fn write_with(format: Format, trace: &Trace, metadata: &Map<String, Value>) -> Vec<u8> {
    match format {
        Format::Csv => csv::write(trace),
        Format::Json => json::write(trace, metadata),
    }
}

/// The text of a file, without a byte order mark.
fn text<'a>(bytes: &'a [u8], expected: &str) -> Result<&'a str, Vec<FormatError>> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let (before, after) = bytes.split_at(error.valid_up_to());
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        only(format!("line {line}"), format!("found the byte 0x{:02x}, expected text in UTF-8", after[0]))
    })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.trim().is_empty() { Err(only("file", format!("found nothing, expected {expected}"))) } else { Ok(text) }
}

#[cfg(test)]
mod tests;
