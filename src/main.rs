//! The `elevon` program.

use std::process::ExitCode;

fn main() -> ExitCode {
    elevon::cli::run(std::env::args_os())
}
