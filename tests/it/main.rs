//! The integration tests: everything that needs two modules, in one binary.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on should panic")]

mod cli;
mod cli_parameters;
mod cli_remaining_life;
mod estimation;
mod house;
mod http_actuators;
mod http_alerts;
mod http_baseline;
mod http_estimations;
mod http_health;
mod http_jobs;
mod http_parameter_sets;
mod http_process;
mod http_remaining_life;
mod http_service;
mod http_sockets;
mod http_support;
mod http_uploads;
mod http_webhooks;
mod jobs;
mod models;
mod parameter_files;
mod ramp_current;
mod reproduction;
mod simulate;
mod store_contract;
mod webhook_receiver;
mod whole_traces;
