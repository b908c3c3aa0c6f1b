//! The `aurt` command.
fn main() {}
