//! What the service tells of itself: the log, on standard error, and the metrics.

use std::io::IsTerminal;
use std::sync::OnceLock;

use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};
use thiserror::Error;
use tracing_subscriber::EnvFilter;

use crate::config::{LogConfig, LogFormat};

/// Upper bounds of the durations' buckets, s (chosen: cheap reads take milliseconds, jobs up to minutes).
const DURATION_BUCKETS_S: [f64; 13] = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.5, 1.0, 5.0, 30.0, 120.0, 600.0];

/// Why the log could not be started.
#[derive(Debug, Error)]
pub enum TelemetryError {
    /// The filter is not one.
    #[error("log.filter: {0}")]
    Filter(#[from] tracing_subscriber::filter::ParseError),
}

/// Starts the log of this process. A second call keeps the first one's log.
///
/// # Errors
/// A filter that cannot be read.
pub fn start_log(config: &LogConfig) -> Result<(), TelemetryError> {
    let filter = EnvFilter::builder().parse(&config.filter)?;
    let builder = tracing_subscriber::fmt().with_env_filter(filter).with_writer(std::io::stderr);
    let started = match config.format {
        LogFormat::Text => builder.with_ansi(std::io::stderr().is_terminal()).with_target(false).try_init(),
        LogFormat::Json => builder.json().flatten_event(true).try_init(),
    };
    if started.is_err() {
        tracing::debug!("the log was started already");
    }
    Ok(())
}

/// The metrics of this process; the recorder is installed by the first call.
///
/// # Panics
/// When another recorder than this one was installed before: a programmer's error.
pub fn metrics() -> &'static PrometheusHandle {
    static HANDLE: OnceLock<PrometheusHandle> = OnceLock::new();
    HANDLE.get_or_init(|| {
        PrometheusBuilder::new()
            .set_buckets_for_metric(Matcher::Suffix("_seconds".into()), &DURATION_BUCKETS_S)
            .expect("the buckets are not empty")
            .install_recorder()
            .expect("no other recorder is installed")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_filter_that_cannot_be_read_names_the_key() {
        let config = LogConfig { filter: "elevon=loud".into(), ..LogConfig::default() };
        let error = start_log(&config).unwrap_err().to_string();
        assert!(error.starts_with("log.filter: "), "{error}");
    }

    #[test]
    fn the_recorder_is_installed_once_and_shared() {
        metrics();
        metrics::counter!("elevon_test_total").increment(1);
        assert!(metrics().render().contains("elevon_test_total"));
    }
}
