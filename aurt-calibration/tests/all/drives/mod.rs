//! Arms with drives: simulation, output error, what numbers stand for.

mod absorbed;
mod closed_loop;
