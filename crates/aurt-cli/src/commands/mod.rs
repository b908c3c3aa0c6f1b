//! One command a file.

mod calibrate;
mod calibrate_validate;
mod compile_rbd;
mod compile_rd;
mod data_options;
mod predict;
mod run;

use clap::Subcommand;

use crate::{
    failure::Failure,
    rendering::terminal::{Report, Terminal},
};

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    Run(run::Run),
    CompileRbd(compile_rbd::CompileRbd),
    CompileRd(compile_rd::CompileRd),
    Calibrate(calibrate::Calibrate),
    CalibrateValidate(calibrate_validate::CalibrateValidate),
    Predict(predict::Predict),
}

/// Does it.
///
/// # Errors
/// Why it could not be done.
pub fn run(command: &Command, terminal: &Terminal) -> Result<Report, Failure> {
    match command {
        Command::Run(command) => command.run(terminal),
        Command::CompileRbd(command) => command.run(),
        Command::CompileRd(command) => command.run(),
        Command::Calibrate(command) => command.run(terminal),
        Command::CalibrateValidate(command) => command.run(terminal),
        Command::Predict(command) => command.run(terminal),
    }
}
