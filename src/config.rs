//! Settings: built-in defaults, overlaid by a TOML file, overlaid by the environment, each limit with its range.
//!
//! A variable `ELEVON_HTTP_BODY_LIMIT_BYTES` sets `http.body_limit_bytes`, `ELEVON_PROGNOSTICS_THRESHOLDS_KGM`
//! `prognostics.thresholds.kgm`. `config/elevon.toml` documents every key with
//! its default. A key that does not exist is an error wherever it stands.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};

use figment::Figment;
use figment::providers::{Env, Format, Serialized, Toml};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Everything that can be set.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Config {
    /// The service's door.
    pub http: HttpConfig,
    /// The work behind it.
    pub jobs: JobsConfig,
    /// Where records and traces are kept.
    pub store: StoreConfig,
    /// Forecasts and baselines.
    pub prognostics: PrognosticsConfig,
    /// When alerts are raised and cleared.
    pub alerts: AlertsConfig,
    /// How alerts are sent to webhooks.
    pub webhooks: WebhooksConfig,
    /// What is logged.
    pub log: LogConfig,
}

/// The service's door.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HttpConfig {
    /// The address to listen on; port 0 takes a free one.
    pub listen: SocketAddr,
    /// The longest request body, bytes, 1024 to 1 073 741 824.
    pub body_limit_bytes: u64,
    /// The longest time that a request's body may take to arrive, s, 0.01 to 600.
    pub body_time_s: f64,
    /// The longest time from a request's head to its answer, s, 0.01 to 600, at least `body_time_s`.
    pub request_time_s: f64,
    /// The most bodies that are held in memory at once, 1 to 1024; more wait.
    pub bodies_at_once: usize,
}

impl Default for HttpConfig {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from(([127, 0, 0, 1], 8080)),
            body_limit_bytes: 32 * 1024 * 1024,
            body_time_s: 20.0,
            request_time_s: 30.0,
            bodies_at_once: 4,
        }
    }
}

/// The work behind the door.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JobsConfig {
    /// Jobs that run at once, 0 to 256; 0 is one for each processor.
    pub workers: usize,
    /// The most jobs that may wait, 1 to 1 000 000.
    pub queue_limit: u64,
    /// How often a job is started before it counts as failed, 1 to 100.
    pub attempts_max: u32,
    /// The longest time that an attempt may take, s, 1 to 86 400.
    pub time_limit_s: f64,
}

impl Default for JobsConfig {
    fn default() -> Self {
        Self { workers: 0, queue_limit: 10_000, attempts_max: 3, time_limit_s: 300.0 }
    }
}

impl JobsConfig {
    /// The number of jobs that run at once: as set, or one for each processor.
    #[must_use]
    pub fn workers(&self) -> usize {
        let processors = || std::thread::available_parallelism().map_or(1, usize::from);
        if self.workers == 0 { processors() } else { self.workers }
    }
}

/// Where records and traces are kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StoreConfig {
    /// The data folder: database, traces and lock.
    pub data: PathBuf,
}

impl Default for StoreConfig {
    fn default() -> Self {
        Self { data: "./data".into() }
    }
}

/// Forecasts and baselines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PrognosticsConfig {
    /// A failure within this much further usage is the risk that orders the fleet, in the actuator's usage unit, above
    /// 0, at most 1 000 000.
    pub risk_window: f64,
    /// The probability of a failure at which to act, above 0 and below 1: forecasts tell the usage by which it is reached.
    pub act_at_risk: f64,
    /// The healthy traces that make an actuator's baseline, 1 to 100.
    pub baseline_traces: usize,
    /// The failure thresholds of an actuator that is registered without its own.
    pub thresholds: ThresholdsConfig,
}

impl Default for PrognosticsConfig {
    fn default() -> Self {
        Self { risk_window: 100.0, act_at_risk: 0.05, baseline_traces: 5, thresholds: ThresholdsConfig::default() }
    }
}

/// The fault levels at which an actuator counts as failed, in the ranges of a registration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThresholdsConfig {
    /// Torque-motor demagnetisation KGM, 0.01 to 1.
    pub kgm: f64,
    /// Dynamic jack friction FDJ, N, 210 to 2000.
    pub fdj_n: f64,
}

impl Default for ThresholdsConfig {
    fn default() -> Self {
        Self { kgm: 0.4, fdj_n: 1000.0 }
    }
}

/// When alerts are raised and cleared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlertsConfig {
    /// The probability of a failure within the risk window from which an alert is raised, 0.001 to 1.
    pub risk_raise: f64,
    /// The probability below which it is cleared, 0 to `risk_raise`.
    pub risk_clear: f64,
    /// The part of the way from healthy to the threshold below which a fault's level clears its alert, 0.1 to 1.
    pub threshold_clear: f64,
}

impl Default for AlertsConfig {
    fn default() -> Self {
        Self { risk_raise: 0.10, risk_clear: 0.05, threshold_clear: 0.9 }
    }
}

/// How alerts are sent to webhooks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WebhooksConfig {
    /// The longest time from the connection to the answer, s, 0.01 to 60.
    pub timeout_s: f64,
    /// The longest wait after the first failed attempt, s, 0.01 to 3600; each one after it is five times as long.
    pub retry_first_s: f64,
    /// The longest wait between two attempts, s, `retry_first_s` to 86 400.
    pub retry_max_s: f64,
    /// The attempts after which a delivery is given up, 1 to 1000.
    pub attempts_max: u32,
    /// The age at which a delivery is given up, s, 0 to 31 536 000.
    pub age_max_s: f64,
    /// How often the outbox is looked into, s, 0.01 to 60.
    pub poll_s: f64,
    /// How long deliveries that are over are listed, s, 60 to 315 360 000.
    pub keep_s: f64,
}

impl Default for WebhooksConfig {
    fn default() -> Self {
        Self {
            timeout_s: 10.0,
            retry_first_s: 5.0,
            retry_max_s: 3600.0,
            attempts_max: 100,
            age_max_s: 259_200.0,
            poll_s: 1.0,
            keep_s: 2_592_000.0,
        }
    }
}

/// What is logged, to standard error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogConfig {
    /// What to log, as in `info` or `warn,elevon::jobs=debug`.
    pub filter: String,
    /// How a line looks.
    pub format: LogFormat,
}

impl Default for LogConfig {
    fn default() -> Self {
        Self { filter: "info,sqlx=warn".into(), format: LogFormat::Text }
    }
}

/// How a line of the log looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogFormat {
    /// For people.
    Text,
    /// One JSON object per line.
    Json,
}

/// What is wrong with the settings.
#[derive(Debug, Error)]
pub enum ConfigError {
    /// The file is not there.
    #[error("{}: cannot be read", path.display())]
    File {
        /// The file that `--config` named.
        path: PathBuf,
        /// Why it cannot be read.
        source: std::io::Error,
    },
    /// A key does not exist or its value is of the wrong type; the text names it and where it stands.
    #[error("settings: {0}")]
    Keys(String),
    /// Values are out of their range; the text names each key, what was found and what was expected.
    #[error("settings: {0}")]
    Ranges(String),
}

impl Config {
    /// Reads the settings.
    ///
    /// # Errors
    /// A file that cannot be read, a key that does not exist, a value of the wrong type or out of its range.
    pub fn load(file: Option<&Path>) -> Result<Self, ConfigError> {
        let text = match file {
            Some(path) => std::fs::read_to_string(path)
                .map_err(|source| ConfigError::File { path: path.to_path_buf(), source })?,
            None => String::new(),
        };
        Self::from_sources(&text, Env::prefixed("ELEVON_"))
    }

    /// Overlays the defaults with a TOML text and the environment, and checks what comes of it.
    fn from_sources(toml: &str, environment: Env) -> Result<Self, ConfigError> {
        let environment = environment.map(|key| key_of(key.as_str()).into());
        let config: Self = Figment::from(Serialized::defaults(Self::default()))
            .merge(Toml::string(toml))
            .merge(environment)
            .extract()
            .map_err(|errors| ConfigError::Keys(join(errors.into_iter().map(|error| describe(&error)))))?;
        let faults = config.check();
        if faults.is_empty() { Ok(config) } else { Err(ConfigError::Ranges(join(faults.into_iter()))) }
    }

    /// Every value that is out of its range.
    fn check(&self) -> Vec<String> {
        let ranges = [
            ("http.body_limit_bytes", self.http.body_limit_bytes as f64, 1024.0, 1_073_741_824.0),
            ("http.body_time_s", self.http.body_time_s, 0.01, 600.0),
            ("http.request_time_s", self.http.request_time_s, self.http.body_time_s.max(0.01), 600.0),
            ("http.bodies_at_once", self.http.bodies_at_once as f64, 1.0, 1024.0),
            ("jobs.workers", self.jobs.workers as f64, 0.0, 256.0),
            ("jobs.queue_limit", self.jobs.queue_limit as f64, 1.0, 1e6),
            ("jobs.attempts_max", f64::from(self.jobs.attempts_max), 1.0, 100.0),
            ("jobs.time_limit_s", self.jobs.time_limit_s, 1.0, 86_400.0),
            ("prognostics.risk_window", self.prognostics.risk_window, f64::MIN_POSITIVE, 1e6),
            ("prognostics.act_at_risk", self.prognostics.act_at_risk, f64::MIN_POSITIVE, 1.0_f64.next_down()),
            ("prognostics.baseline_traces", self.prognostics.baseline_traces as f64, 1.0, 100.0),
            ("prognostics.thresholds.kgm", self.prognostics.thresholds.kgm, 0.01, 1.0),
            ("prognostics.thresholds.fdj_n", self.prognostics.thresholds.fdj_n, 210.0, 2000.0),
            ("alerts.risk_raise", self.alerts.risk_raise, 0.001, 1.0),
            ("alerts.risk_clear", self.alerts.risk_clear, 0.0, self.alerts.risk_raise),
            ("alerts.threshold_clear", self.alerts.threshold_clear, 0.1, 1.0),
            ("webhooks.timeout_s", self.webhooks.timeout_s, 0.01, 60.0),
            ("webhooks.retry_first_s", self.webhooks.retry_first_s, 0.01, 3600.0),
            ("webhooks.retry_max_s", self.webhooks.retry_max_s, self.webhooks.retry_first_s, 86_400.0),
            ("webhooks.attempts_max", f64::from(self.webhooks.attempts_max), 1.0, 1000.0),
            ("webhooks.age_max_s", self.webhooks.age_max_s, 0.0, 31_536_000.0),
            ("webhooks.poll_s", self.webhooks.poll_s, 0.01, 60.0),
            ("webhooks.keep_s", self.webhooks.keep_s, 60.0, 315_360_000.0),
        ];
        ranges
            .into_iter()
            .filter(|(_, found, min, max)| !(min..=max).contains(&found))
            .map(|(key, found, min, max)| match (min, max) {
                (f64::MIN_POSITIVE, ..1.0) => format!("{key}: found {found}, expected above 0, below 1"),
                (f64::MIN_POSITIVE, _) => format!("{key}: found {found}, expected above 0, at most {max}"),
                _ => format!("{key}: found {found}, expected {min} to {max}"),
            })
            .collect()
    }
}

/// The key that an environment variable sets, without its prefix: the section ends at the first underscore, a section within
/// it at the end of its name.
fn key_of(variable: &str) -> String {
    let key = variable.to_lowercase().replacen('_', ".", 1);
    key.replace("prognostics.thresholds_", "prognostics.thresholds.")
}

/// A figment error on one line: the key, what was found, what was expected, and where it stands.
fn describe(error: &figment::Error) -> String {
    let place = match &error.metadata {
        Some(source) if source.name.contains("environment") => " (environment)",
        _ => "",
    };
    match error.path.as_slice() {
        [] => format!("{}{place}", error.kind),
        path => format!("{}: {}{place}", path.join("."), error.kind),
    }
}

fn join(faults: impl Iterator<Item = String>) -> String {
    faults.collect::<Vec<_>>().join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from_toml(text: &str) -> Result<Config, String> {
        Config::from_sources(text, Env::prefixed("ELEVON_TEST_NONE_")).map_err(|error| error.to_string())
    }

    #[test]
    fn the_documented_file_equals_the_built_in_defaults() {
        let text = include_str!("../config/elevon.toml");
        assert_eq!(from_toml(text).unwrap(), Config::default());
        let documented: toml::Table = toml::from_str(text).unwrap();
        let built_in: toml::Table = toml::from_str(&toml::to_string(&Config::default()).unwrap()).unwrap();
        assert_eq!(documented, built_in, "every key is in the file");
    }

    #[test]
    fn a_file_overlays_the_defaults_key_by_key() {
        let config = from_toml("[jobs]\nqueue_limit = 7").unwrap();
        assert_eq!(config.jobs.queue_limit, 7);
        assert_eq!(config.jobs.attempts_max, JobsConfig::default().attempts_max);
    }

    #[test]
    fn an_unknown_key_is_named() {
        let error = from_toml("[http]\nbody_limit = 7").unwrap_err();
        assert!(error.contains("body_limit") && error.contains("body_limit_bytes"), "{error}");
    }

    #[test]
    fn a_value_of_the_wrong_type_is_named_by_its_key() {
        let error = from_toml("[http]\nbody_limit_bytes = \"big\"").unwrap_err();
        assert!(error.contains("http.body_limit_bytes") && error.contains("big"), "{error}");
    }

    #[test]
    fn every_value_out_of_range_is_named_at_once() {
        let error =
            from_toml("[jobs]\nqueue_limit = 0\n[prognostics]\nrisk_window = 0.0\nbaseline_traces = 0").unwrap_err();
        assert!(error.contains("jobs.queue_limit: found 0"), "{error}");
        assert!(error.contains("prognostics.risk_window: found 0"), "{error}");
        assert!(error.contains("prognostics.baseline_traces: found 0, expected 1 to 100"), "{error}");
    }

    #[test]
    fn a_risk_to_act_at_is_neither_nothing_nor_certain() {
        for risk in ["0.0", "1.0", "-0.1", "nan"] {
            let error = from_toml(&format!("[prognostics]\nact_at_risk = {risk}")).unwrap_err();
            assert!(error.contains("prognostics.act_at_risk: found") && error.contains("above 0, below 1"), "{error}");
        }
        assert_eq!(from_toml("[prognostics]\nact_at_risk = 0.2").unwrap().prognostics.act_at_risk, 0.2);
    }

    #[test]
    fn default_thresholds_are_in_the_ranges_of_a_registration() {
        let error = from_toml("[prognostics.thresholds]\nkgm = 0.009\nfdj_n = 2000.1").unwrap_err();
        assert!(error.contains("prognostics.thresholds.kgm: found 0.009, expected 0.01 to 1"), "{error}");
        assert!(error.contains("prognostics.thresholds.fdj_n: found 2000.1, expected 210 to 2000"), "{error}");
        let thresholds = from_toml("[prognostics.thresholds]\nkgm = 0.3").unwrap().prognostics.thresholds;
        assert_eq!(thresholds, ThresholdsConfig { kgm: 0.3, fdj_n: 1000.0 });
    }

    #[test]
    fn a_variable_names_a_key_by_its_sections() {
        assert_eq!(key_of("HTTP_BODY_LIMIT_BYTES"), "http.body_limit_bytes");
        assert_eq!(key_of("PROGNOSTICS_THRESHOLDS_FDJ_N"), "prognostics.thresholds.fdj_n");
        assert_eq!(key_of("PROGNOSTICS_RISK_WINDOW"), "prognostics.risk_window");
    }

    #[test]
    fn an_alert_is_cleared_no_higher_than_it_is_raised() {
        let error = from_toml("[alerts]\nrisk_raise = 0.2\nrisk_clear = 0.3").unwrap_err();
        assert!(error.contains("alerts.risk_clear: found 0.3, expected 0 to 0.2"), "{error}");
        assert!(from_toml("[alerts]\nrisk_clear = nan").is_err());
    }

    #[test]
    fn a_time_that_is_not_a_number_is_refused() {
        let error = from_toml("[http]\nrequest_time_s = nan").unwrap_err();
        assert!(error.contains("http.request_time_s: found NaN"), "{error}");
    }
}
