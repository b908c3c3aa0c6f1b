//! Model, calibrate and explain the dynamics of robot manipulators from recordings of the real machine.

pub mod calibrated_file;
pub mod data;
pub mod demo;
pub mod failure;
pub mod fitting;
pub mod glossary;
pub mod injected;
pub mod inspection;
pub mod output;
pub mod progress;
pub mod proof;
pub mod rendering;
pub mod reports;
pub mod results;
pub mod sensitivity;
pub mod simulated;
pub mod streaming;
pub mod sweeping;
