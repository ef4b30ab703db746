//! Webhooks: how alerts leave the service. What is to be told waits in the store's outbox; a task of its own signs it and posts
//! it until the receiver takes it (docs/alerts.md).

pub mod address;
mod post;
mod schedule;
pub mod sender;
pub mod signature;
