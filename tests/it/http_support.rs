//! A service in a folder of its own, asked without a socket and its jobs run one step at a time.

use std::path::PathBuf;
use std::time::Duration;

use axum::body::{Body, Bytes};
use axum::http::header::{CONTENT_TYPE, HeaderMap};
use axum::http::{Method, Request, StatusCode};
use elevon::app::Application;
use elevon::config::Config;
use elevon::jobs::Step;
use elevon::webhooks::sender::Sender;
use serde_json::{Value, json};
use sqlx::sqlite::{SqliteConnectOptions, SqlitePool};
use tempfile::TempDir;
use tower::ServiceExt as _;

/// What an upload needs to be told.
pub const RECORDED: &str = "recorded_at=2026-03-01T12:00:00Z&usage=100.5";
/// The longest wait for what must come.
pub const PATIENCE: Duration = Duration::from_secs(120);
/// Between two looks at a service that works by itself: the one exception to tests that do not wait for time to pass.
pub const PAUSE: Duration = Duration::from_millis(20);

pub struct Service {
    application: Application,
    data: TempDir,
}

impl Service {
    pub async fn new() -> Self {
        Self::with(|_| ()).await
    }

    /// A service with other settings than the defaults.
    pub async fn with(change: impl FnOnce(&mut Config)) -> Self {
        Self::over(tempfile::tempdir().unwrap(), change).await
    }

    /// The same service after its process ended and started again.
    pub async fn restarted(self) -> Self {
        self.restarted_with(|_| ()).await
    }

    /// The same with other settings than the defaults.
    pub async fn restarted_with(self, change: impl FnOnce(&mut Config)) -> Self {
        let Self { application, data } = self;
        drop(application);
        Self::over(data, change).await
    }

    async fn over(data: TempDir, change: impl FnOnce(&mut Config)) -> Self {
        let mut config = Config::default();
        config.http.listen.set_port(0);
        config.store.data = data.path().to_path_buf();
        change(&mut config);
        Self { application: Application::build(&config).await.unwrap(), data }
    }

    pub async fn send(&self, request: Request<Body>) -> Answer {
        let response = self.application.router().oneshot(request).await.unwrap();
        let (status, headers) = (response.status(), response.headers().clone());
        let body = axum::body::to_bytes(response.into_body(), usize::MAX).await.unwrap();
        Answer { status, headers, body }
    }

    pub async fn get(&self, path: &str) -> Answer {
        self.send(request(Method::GET, path, None, Body::empty())).await
    }

    pub async fn delete(&self, path: &str) -> Answer {
        self.send(request(Method::DELETE, path, None, Body::empty())).await
    }

    pub async fn post(&self, path: &str, media_type: Option<&str>, body: impl Into<Body>) -> Answer {
        self.send(request(Method::POST, path, media_type, body.into())).await
    }

    pub async fn post_json(&self, path: &str, body: &Value) -> Answer {
        self.post(path, Some("application/json"), body.to_string()).await
    }

    pub async fn patch_json(&self, path: &str, body: &Value) -> Answer {
        self.send(request(Method::PATCH, path, Some("application/json"), body.to_string().into())).await
    }

    /// Registers an actuator and returns its id.
    pub async fn registered(&self, serial_number: &str) -> String {
        let body = json!({"serial_number": serial_number, "tail_number": "I-ELVN", "location": "left aileron"});
        self.post_json("/v1/actuators", &body).await.expect(StatusCode::CREATED).text("/id")
    }

    /// Registers an actuator and returns the path of its uploads, with all that is required.
    pub async fn upload_path(&self) -> String {
        format!("/v1/actuators/{}/traces?{RECORDED}", self.registered("EHA-1").await)
    }

    /// What sends the outbox.
    pub fn sender(&self) -> &Sender {
        self.application.sender()
    }

    /// Runs every job that waits.
    pub async fn work(&self) {
        while self.application.jobs().try_run_next().await != Step::Empty {}
    }

    /// Asserts that neither trace nor job was kept.
    pub async fn assert_nothing_is_stored(&self) {
        assert_eq!(self.get("/v1/jobs").await.expect(StatusCode::OK).value("/items"), json!([]));
        let folders = std::fs::read_dir(self.data.path().join("traces")).unwrap().map(|folder| folder.unwrap().path());
        let files = folders.flat_map(|folder| std::fs::read_dir(folder).unwrap()).count();
        assert_eq!(files, 0, "a refused trace left bytes behind");
        let rows: i64 =
            sqlx::query_scalar("SELECT count(*) FROM traces").fetch_one(&self.database().await).await.unwrap();
        assert_eq!(rows, 0, "a refused trace left a record behind");
    }

    /// Where a trace's bytes are kept.
    pub fn trace_file(&self, id: &str) -> PathBuf {
        self.data.path().join("traces").join(&id[id.len() - 2..]).join(id)
    }

    /// The database, reached beside the service.
    pub async fn database(&self) -> SqlitePool {
        let file = self.data.path().join(elevon::store::sqlite::FILE);
        SqlitePool::connect_with(SqliteConnectOptions::new().filename(file)).await.unwrap()
    }
}

pub fn request(method: Method, path: &str, media_type: Option<&str>, body: Body) -> Request<Body> {
    let builder = Request::builder().method(method).uri(path);
    let builder = media_type.into_iter().fold(builder, |builder, media_type| builder.header(CONTENT_TYPE, media_type));
    builder.body(body).unwrap()
}

pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Bytes,
}

impl Answer {
    #[track_caller]
    pub fn expect(self, status: StatusCode) -> Self {
        assert_eq!(self.status, status, "{}", String::from_utf8_lossy(&self.body));
        self
    }

    /// Asserts a problem document whose errors point to these places, in this order.
    #[track_caller]
    pub fn expect_problem(self, status: u16, pointers: &[&str]) -> Self {
        let problem = self.json();
        assert_eq!(self.status.as_u16(), status, "{problem:#}");
        assert_eq!(self.headers[CONTENT_TYPE], "application/problem+json");
        assert_eq!(problem["status"], status);
        assert_eq!(problem["request_id"], self.headers["x-request-id"].to_str().unwrap());
        let texts = ["type", "title", "detail", "request_id"];
        assert!(texts.iter().all(|name| problem[name].as_str().is_some_and(|text| !text.is_empty())), "{problem:#}");
        let errors = problem["errors"].as_array().unwrap();
        assert!(errors.iter().all(|error| !error["detail"].as_str().unwrap().is_empty()), "{problem:#}");
        let found: Vec<_> = errors.iter().map(|error| error["pointer"].as_str().unwrap()).collect();
        assert_eq!(found, pointers, "{problem:#}");
        self
    }

    #[track_caller]
    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap()
    }

    #[track_caller]
    pub fn value(&self, pointer: &str) -> Value {
        let json = self.json();
        json.pointer(pointer).unwrap_or_else(|| panic!("nothing at {pointer} of {json:#}")).clone()
    }

    #[track_caller]
    pub fn text(&self, pointer: &str) -> String {
        self.value(pointer).as_str().unwrap().to_owned()
    }

    pub fn header(&self, name: &str) -> &str {
        self.headers[name].to_str().unwrap()
    }
}

/// A trace of 20 samples that says nothing of any fault.
pub fn still_csv() -> String {
    let rows = (0..20).map(|k| format!("{},0,0,0\n", f64::from(k) * 1e-3));
    format!("time_s,position_command_m,servovalve_current_a,load_pressure_pa\n{}", rows.collect::<String>())
}

/// The same with one line (counted from 1, the header's) replaced.
pub fn csv_with_line(line: usize, text: &str) -> String {
    let mut lines: Vec<_> = still_csv().lines().map(str::to_owned).collect();
    lines[line - 1] = text.into();
    lines.join("\n")
}
