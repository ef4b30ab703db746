//! The program itself: `elevon serve` as a process, told by arguments and signals.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Output, Stdio};
use std::time::Instant;

use serde_json::{Value, json};

use super::http_support::{PATIENCE, PAUSE, still_csv};

fn elevon() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_elevon"));
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// A service in a process of its own, killed when the test ends.
struct Process {
    child: Child,
    base: String,
    _log: BufReader<ChildStderr>,
}

impl Process {
    fn start(data: &Path) -> Self {
        let mut child = elevon().args(["serve", "--listen", "127.0.0.1:0", "--data"]).arg(data).spawn().unwrap();
        let mut log = BufReader::new(child.stderr.take().unwrap());
        let mut line = String::new();
        let base = loop {
            line.clear();
            assert_ne!(log.read_line(&mut line).unwrap(), 0, "the service ended before it listened");
            if let Some(address) = line.split_whitespace().find_map(|word| word.strip_prefix("address=")) {
                break address.to_owned();
            }
        };
        Self { child, base, _log: log }
    }

    fn get(&self, path: &str) -> Value {
        ureq::get(format!("{}{path}", self.base)).call().unwrap().body_mut().read_json().unwrap()
    }

    fn post(&self, path: &str, media_type: &str, body: &str) -> Value {
        let request = ureq::post(format!("{}{path}", self.base)).content_type(media_type);
        request.send(body).unwrap().body_mut().read_json().unwrap()
    }

    fn jobs(&self, state: &str) -> Vec<Value> {
        self.get(&format!("/v1/jobs?state={state}&limit=500"))["items"].as_array().unwrap().clone()
    }

    /// Asks until `done` or until patience ends.
    fn wait_until(&self, what: &str, done: impl Fn(&Self) -> bool) {
        let started = Instant::now();
        while !done(self) {
            assert!(started.elapsed() < PATIENCE, "{what} did not come");
            std::thread::sleep(PAUSE);
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

/// An acknowledged upload is kept, and its job runs to one result, whenever the process is killed: the trace is durable
/// before its record, the record before the answer, and a result counts only for the attempt that runs.
#[test]
fn issue_2_kill_9_loses_no_acknowledged_upload_and_ends_every_job_exactly_once() {
    const UPLOADS: usize = 30;
    let data = tempfile::tempdir().unwrap();
    let mut first = Process::start(data.path());
    let body = json!({"serial_number": "EHA-1", "tail_number": "I-ELVN", "location": "left aileron"});
    let actuator = first.post("/v1/actuators", "application/json", &body.to_string());
    let actuator = format!("/v1/actuators/{}", actuator["id"].as_str().unwrap());
    let recipe = json!({"model": "monitoring", "command": "diagnostic", "faults": {"kgm": 0.2, "fdj_n": 600.0},
        "duration_s": 6.0, "sample_rate_hz": 500.0});
    let simulated = first.post("/v1/simulations", "application/json", &recipe.to_string());
    first.wait_until("the simulated trace", |service| service.jobs("succeeded").len() == 1);
    let simulated = first.get(&format!("/v1/jobs/{}", simulated["job"]["id"].as_str().unwrap()));
    let trace = format!("/v1/traces/{}/data", simulated["result"]["trace_id"].as_str().unwrap());
    let csv = ureq::get(format!("{}{trace}", first.base)).call().unwrap().body_mut().read_to_string().unwrap();

    let mut acknowledged: Vec<(String, String)> = Vec::new();
    for upload in 0..UPLOADS {
        let query = format!("recorded_at=2026-03-01T12:00:{upload:02}Z&usage={upload}&population=40&generations=10");
        let answer = first.post(&format!("{actuator}/traces?{query}"), "text/csv", &csv);
        let id = |what: &str| answer[what]["id"].as_str().unwrap().to_owned();
        acknowledged.push((id("trace"), id("job")));
    }
    first.wait_until("a running job", |service| !service.jobs("running").is_empty());
    assert!(!first.jobs("queued").is_empty(), "the kill comes while jobs wait");
    first.child.kill().unwrap();
    first.child.wait().unwrap();

    let second = Process::start(data.path());
    second.wait_until("the end of all jobs", |service| {
        service.jobs("queued").is_empty() && service.jobs("running").is_empty()
    });
    assert_eq!(second.jobs("succeeded").len(), UPLOADS + 1, "{:#?}", second.jobs("failed"));
    for (_, job) in &acknowledged {
        assert_eq!(second.get(&format!("/v1/jobs/{job}"))["state"], "succeeded");
    }
    let history = second.get(&format!("{actuator}/health?limit=500"));
    let rows = history["items"].as_array().unwrap().iter();
    let rows: Vec<_> = rows.map(|row| (row["trace_id"].as_str().unwrap(), row["job_id"].as_str().unwrap())).collect();
    let expected: Vec<_> = acknowledged.iter().map(|(trace, job)| (trace.as_str(), job.as_str())).collect();
    assert_eq!(rows, expected, "every trace once, in the order of recording");
}

/// One delivery as it was posted, and the connection that waits for its answer.
fn posted(receiver: &TcpListener) -> (String, String, TcpStream) {
    let (stream, _) = receiver.accept().unwrap();
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    let (mut id, mut length) = (String::new(), 0);
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        let Some((name, value)) = line.trim_end().split_once(": ") else {
            if line.trim_end().is_empty() {
                break;
            }
            continue;
        };
        match name {
            "webhook-id" => id = value.to_owned(),
            "content-length" => length = value.parse().unwrap(),
            _ => {}
        }
    }
    let mut body = vec![0; length];
    reader.read_exact(&mut body).unwrap();
    (id, String::from_utf8(body).unwrap(), stream)
}

#[test]
fn a_delivery_under_way_when_the_process_is_killed_is_posted_again_with_its_id_and_kept_as_delivered() {
    let data = tempfile::tempdir().unwrap();
    let receiver = TcpListener::bind("127.0.0.1:0").unwrap();
    let mut first = Process::start(data.path());
    let body = json!({"url": format!("http://{}/hook", receiver.local_addr().unwrap())});
    let hook = first.post("/v1/webhooks", "application/json", &body.to_string());
    let hook = format!("/v1/webhooks/{}", hook["id"].as_str().unwrap());
    let ping = first.post(&format!("{hook}/test"), "application/json", "");
    let (id, body, _unanswered) = posted(&receiver);
    assert_eq!(ping["delivery"]["id"], id.as_str());
    first.child.kill().unwrap();
    first.child.wait().unwrap();

    let second = Process::start(data.path());
    let (again, same, mut stream) = posted(&receiver);
    assert_eq!((again, same), (id, body));
    stream.write_all(b"HTTP/1.1 204 No Content\r\n\r\n").unwrap();
    let deliveries = format!("{hook}/deliveries");
    second.wait_until("the delivery", |service| service.get(&deliveries)["items"][0]["state"] == "delivered");
    assert_eq!(second.get(&deliveries)["items"].as_array().unwrap().len(), 1);
}

#[test]
fn a_second_process_on_one_data_folder_ends_with_one_line_and_status_1() {
    let data = tempfile::tempdir().unwrap();
    let _first = Process::start(data.path());
    let second = elevon().args(["serve", "--listen", "127.0.0.1:0", "--data"]).arg(data.path()).output().unwrap();
    assert_refused(&second, 1, "another elevon works in this folder");
}

#[test]
fn an_address_in_use_ends_with_one_line_and_status_1() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let first = Process::start(one.path());
    let address = first.base.trim_start_matches("http://");
    let second = elevon().args(["serve", "--listen", address, "--data"]).arg(two.path()).output().unwrap();
    assert_refused(&second, 1, address);
    assert_said_once(&second, "in use");
}

#[test]
fn bad_usage_and_bad_settings_end_with_one_line_and_status_2() {
    let data = tempfile::tempdir().unwrap();
    let file = data.path().join("elevon.toml");
    std::fs::write(&file, "[http]\nbody_limit = 5\n").unwrap();
    let config = file.to_str().unwrap();
    assert_refused(&elevon().args(["serve", "--listen", "0.0.0.0:0"]).output().unwrap(), 2, "loopback");
    assert_refused(&elevon().args(["serve", "--listen", "here"]).output().unwrap(), 2, "--listen");
    assert_refused(&elevon().args(["serve", "--fast"]).output().unwrap(), 2, "--fast");
    assert_refused(&elevon().arg("fly").output().unwrap(), 2, "fly");
    assert_refused(&elevon().args(["serve", "--config", config]).output().unwrap(), 2, "body_limit");
    let missing = elevon().args(["serve", "--config", "/none.toml"]).output().unwrap();
    assert_refused(&missing, 2, "/none.toml");
    assert_said_once(&missing, "No such file");
    let environment = |name: &str, value: &str| elevon().arg("serve").env(name, value).output().unwrap();
    assert_refused(&environment("ELEVON_JOBS_QUEUE_LIMIT", "0"), 2, "jobs.queue_limit");
    assert_refused(&environment("ELEVON_HTTP_SPEED", "9"), 2, "speed");
}

#[test]
fn a_data_folder_that_is_a_file_ends_with_one_line_and_status_1() {
    let data = tempfile::NamedTempFile::new().unwrap();
    let output = elevon().args(["serve", "--listen", "127.0.0.1:0", "--data"]).arg(data.path()).output().unwrap();
    assert_refused(&output, 1, "--data");
    assert_said_once(&output, "os error");
}

#[track_caller]
fn assert_said_once(output: &Output, said: &str) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(text.matches(said).count(), 1, "{text}");
}

#[track_caller]
fn assert_refused(output: &Output, status: i32, named: &str) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{text}");
    assert!(text.starts_with("elevon: ") && text.contains(named), "{text}");
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(output.stdout.is_empty());
}

#[test]
fn a_variable_wins_over_the_file_and_an_argument_over_both() {
    let data = tempfile::tempdir().unwrap();
    let file = data.path().join("elevon.toml");
    std::fs::write(&file, "[http]\nlisten = \"0.0.0.0:1\"\n").unwrap();
    let serve = || {
        let mut command = elevon();
        command.args(["serve", "--config"]).arg(&file);
        command
    };
    assert_refused(&serve().output().unwrap(), 2, "0.0.0.0:1");
    assert_refused(&serve().env("ELEVON_HTTP_LISTEN", "0.0.0.0:2").output().unwrap(), 2, "0.0.0.0:2");
    let both = serve().env("ELEVON_HTTP_LISTEN", "0.0.0.0:2").args(["--listen", "0.0.0.0:3"]).output().unwrap();
    assert_refused(&both, 2, "0.0.0.0:3");
}

#[test]
fn a_service_told_to_end_ends_with_status_0_and_its_work_is_there_at_the_next_start() {
    let data = tempfile::tempdir().unwrap();
    let mut first = Process::start(data.path());
    let body = json!({"serial_number": "EHA-1", "tail_number": "I-ELVN", "location": "left aileron"});
    let actuator = first.post("/v1/actuators", "application/json", &body.to_string());
    let path = format!("/v1/actuators/{}", actuator["id"].as_str().unwrap());
    first.post(&format!("{path}/traces?recorded_at=2026-03-01T12:00:00Z&usage=1"), "text/csv", &still_csv());
    let told = Command::new("kill").args(["-TERM", &first.child.id().to_string()]).status().unwrap();
    assert!(told.success());
    assert_eq!(first.child.wait().unwrap().code(), Some(0));
    let second = Process::start(data.path());
    second.wait_until("the estimate", |service| service.jobs("succeeded").len() == 1);
    assert_eq!(second.get(&path), actuator);
}

#[test]
fn openapi_prints_the_specification_and_nothing_else() {
    let output = elevon().arg("openapi").output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty());
    assert_eq!(String::from_utf8(output.stdout).unwrap(), elevon::http::openapi::yaml().unwrap());
}
