//! Files in and out: bytes to a trace and back, the same for the command line and for HTTP.

use thiserror::Error;

use crate::models::trace::Trace;

/// A file format of traces.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Comma, semicolon or tab separated text with a header line.
    Csv,
    /// `{"columns": {"time_s": [...], ...}, "metadata": {...}}`.
    Json,
}

impl Format {
    /// The format's media type, without parameters.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Csv => "text/csv",
            Self::Json => "application/json",
        }
    }

    /// The format of a media type.
    #[must_use]
    pub fn from_media_type(media_type: &str) -> Option<Self> {
        [Self::Csv, Self::Json].into_iter().find(|format| format.media_type() == media_type)
    }
}

/// How to read a file whose columns do not say everything.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Names to replace: (name in the file, name as elevon knows it).
    pub columns: Vec<(String, String)>,
    /// Samples per second of a file without times, Hz.
    pub sample_rate_hz: Option<f64>,
}

impl ReadOptions {
    /// Reads a column map such as `Cor:servovalve_current_ma,P12:load_pressure_pa`.
    ///
    /// # Errors
    /// Every entry that is not a pair of names; never empty.
    pub fn parse_columns(_map: &str) -> Result<Vec<(String, String)>, Vec<FormatError>> {
        Ok(Vec::new())
    }
}

/// A place in a file and what is wrong there.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{place}: {detail}")]
pub struct FormatError {
    /// The place: `line 12, column load_pressure_pa`, `/columns/time_s/3`, or `file`.
    pub place: String,
    /// What was found there and what was expected.
    pub detail: String,
}

/// Reads a trace.
///
/// # Errors
/// Everything that is wrong with the file, as far as reading could go on; never empty.
pub fn read(_format: Format, _bytes: &[u8], _options: &ReadOptions) -> Result<Trace, Vec<FormatError>> {
    Err(Vec::new())
}

/// Writes a trace in SI units.
#[must_use]
pub fn write(_format: Format, _trace: &Trace) -> Vec<u8> {
    Vec::new()
}
