"""A laboratory of simulated robots on the MuJoCo engine; shares no code with the Rust crates."""
