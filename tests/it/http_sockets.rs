//! What only shows on a socket: slow and oversized bodies, a graceful end, a data folder and an address in use.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::time::{Duration, Instant};

use elevon::app::{AppError, Application};
use elevon::config::Config;
use tokio::sync::oneshot;
use tokio::task::{JoinHandle, spawn_blocking};

fn config(data: &Path) -> Config {
    let mut config = Config::default();
    config.http.listen.set_port(0);
    config.store.data = data.to_path_buf();
    config
}

struct Running {
    address: SocketAddr,
    stop: oneshot::Sender<()>,
    ended: JoinHandle<Result<(), AppError>>,
}

async fn run(config: &Config) -> Running {
    let application = Application::build(config).await.unwrap();
    let address = application.address();
    let (stop, stopped) = oneshot::channel::<()>();
    let ended = tokio::spawn(application.run(async { stopped.await.unwrap() }));
    Running { address, stop, ended }
}

/// Writes a whole text, then reads the answer's first bytes.
async fn ask(address: SocketAddr, text: Vec<u8>) -> String {
    let asked = spawn_blocking(move || {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(&text).unwrap();
        let mut answer = [0; 12];
        stream.read_exact(&mut answer).unwrap();
        String::from_utf8(answer.to_vec()).unwrap()
    });
    asked.await.unwrap()
}

fn post(length: usize, body: &[u8]) -> Vec<u8> {
    let head = format!(
        "POST /v1/actuators HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: {length}\r\n\r\n"
    );
    [head.as_bytes(), body].concat()
}

#[tokio::test]
async fn a_body_that_does_not_arrive_in_time_is_given_up() {
    let data = tempfile::tempdir().unwrap();
    let mut config = config(data.path());
    config.http.body_time_s = 0.05;
    let running = run(&config).await;
    assert_eq!(ask(running.address, post(10, b"{")).await, "HTTP/1.1 408");
    running.stop.send(()).unwrap();
    running.ended.await.unwrap().unwrap();
}

#[tokio::test]
async fn a_client_that_writes_all_of_a_body_over_the_limit_still_reads_the_refusal() {
    let data = tempfile::tempdir().unwrap();
    let mut config = config(data.path());
    config.http.body_limit_bytes = 8 << 20;
    let running = run(&config).await;
    let length = 24 << 20;
    assert_eq!(ask(running.address, post(length, &vec![b' '; length])).await, "HTTP/1.1 413");
    running.stop.send(()).unwrap();
    running.ended.await.unwrap().unwrap();
}

#[tokio::test]
async fn a_body_announced_over_the_limit_is_refused_before_it_is_sent() {
    let data = tempfile::tempdir().unwrap();
    let mut config = config(data.path());
    config.http.body_limit_bytes = 1024;
    config.http.body_time_s = 0.01;
    config.http.bodies_at_once = 1;
    let running = run(&config).await;
    let unsent = post(1 << 40, b"");
    let waiting = String::from_utf8(unsent.clone()).unwrap().replace("\r\n\r\n", "\r\nexpect: 100-continue\r\n\r\n");
    for text in [unsent, waiting.into_bytes()] {
        assert_eq!(ask(running.address, text).await, "HTTP/1.1 413");
    }
    running.stop.send(()).unwrap();
    running.ended.await.unwrap().unwrap();
}

#[tokio::test]
async fn a_client_that_says_nothing_does_not_hold_a_service_that_is_told_to_end() {
    let data = tempfile::tempdir().unwrap();
    let running = run(&config(data.path())).await;
    let mut silent = TcpStream::connect(running.address).unwrap();
    silent.write_all(b"POST /v1/actuators HTTP/1.1\r\nhost: localhost\r\ncontent-length: 10\r\n\r\n{").unwrap();
    assert_eq!(
        ask(running.address, b"GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n".to_vec()).await,
        "HTTP/1.1 200"
    );
    let told = Instant::now();
    running.stop.send(()).unwrap();
    running.ended.await.unwrap().unwrap();
    assert!(told.elapsed() < Duration::from_secs(10), "{:?}", told.elapsed());
}

#[tokio::test]
async fn a_stopped_service_frees_its_address_and_its_data_folder() {
    let data = tempfile::tempdir().unwrap();
    let first = run(&config(data.path())).await;
    let mut again = config(data.path());
    again.http.listen = first.address;
    let refused = Application::build(&again).await.err().unwrap();
    assert!(matches!(refused, AppError::DataInUse { .. }), "{refused}");
    first.stop.send(()).unwrap();
    first.ended.await.unwrap().unwrap();
    assert_eq!(Application::build(&again).await.unwrap().address(), again.http.listen);
}

#[tokio::test]
async fn an_address_in_use_is_named() {
    let (one, two) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let first = Application::build(&config(one.path())).await.unwrap();
    let mut second = config(two.path());
    second.http.listen = first.address();
    let refused = Application::build(&second).await.err().unwrap();
    assert!(refused.to_string().starts_with(&format!("--listen {}: ", first.address())), "{refused}");
}

#[tokio::test]
async fn an_address_that_is_not_loopback_is_refused_before_anything_is_touched() {
    let data = tempfile::tempdir().unwrap();
    let mut config = config(&data.path().join("new"));
    for listen in ["0.0.0.0:0", "[::]:0", "192.0.2.1:80"] {
        config.http.listen = listen.parse().unwrap();
        let refused = Application::build(&config).await.err().unwrap();
        assert!(matches!(refused, AppError::NotLoopback { .. }), "{refused}");
    }
    assert!(!config.store.data.exists());
}
