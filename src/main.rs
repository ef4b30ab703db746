//! The `elevon` program.

fn main() {}
