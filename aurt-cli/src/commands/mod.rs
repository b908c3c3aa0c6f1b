//! One command a file.

mod calibrate;
mod calibrate_validate;
mod check;
mod checked_setup;
mod compile_rbd;
pub mod compile_rd;
mod completions;
mod data_options;
mod demo;
mod diagnose;
mod excite;
mod explain;
mod export;
mod gains;
mod init;
mod man;
mod models;
mod new_plugin;
mod next;
mod planned_robot;
pub mod plots;
mod predict;
mod robots;
pub mod run;
mod sensitivity;
mod simulate;
mod sweep;
mod track;
mod trust;

use std::ffi::OsString;

use aurt_experiment::workbench::failure::Failure;
use aurt_plugins::Registry;
use clap::Subcommand;

use crate::rendering::terminal::{Report, Terminal};

/// The commands, and how each is run.
macro_rules! commands {
    ($($name:ident($command:ty),)+) => {
        /// What to do.
        #[derive(Debug, Subcommand)]
        pub enum Command {
            $($name($command),)+
        }

        impl Command {
            pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
                match self {
                    $(Self::$name(command) => command.run(session),)+
                }
            }
        }
    };
}

commands! {
    Run(run::Run),
    Demo(demo::Demo),
    Check(check::Check),
    Init(init::Init),
    CompileRbd(compile_rbd::CompileRbd),
    CompileRd(compile_rd::CompileRd),
    Calibrate(calibrate::Calibrate),
    CalibrateValidate(calibrate_validate::CalibrateValidate),
    Predict(predict::Predict),
    Diagnose(diagnose::Diagnose),
    Next(next::NextMotion),
    Sweep(sweep::Sweep),
    Sensitivity(sensitivity::Sensitivity),
    Track(track::Track),
    Gains(gains::GainsCommand),
    Simulate(simulate::Simulate),
    Excite(excite::Excite),
    Models(models::Models),
    Robots(robots::Robots),
    Explain(explain::Explain),
    Export(export::Export),
    NewPlugin(new_plugin::NewPlugin),
    Trust(trust::TrustLibraries),
    Completions(completions::Completions),
    Man(man::Man),
}

/// The commands by what they are for, as `--help` shows them.
pub const GROUPS: [(&str, &[&str]); 7] = [
    ("Start here", &["demo", "init", "check", "run"]),
    ("Which model, what is missing", &["sweep", "diagnose", "next", "sensitivity", "track", "gains"]),
    ("Motions and simulation", &["excite", "simulate"]),
    ("Models in other programs", &["export"]),
    (
        "Step by step, as in the paper",
        &["compile-rbd", "compile-rd", "calibrate", "calibrate-validate", "predict"],
    ),
    ("Models and words", &["models", "robots", "explain", "new-plugin", "trust"]),
    ("Shell", &["completions", "man", "help"]),
];

/// What every command has at hand.
#[derive(Debug)]
pub struct Session<'a> {
    /// Where it reports.
    pub terminal: &'a Terminal,
    /// The models that can be named.
    pub registry: Registry,
    /// The command line that starts this program.
    pub program: &'a [OsString],
    pub definition: fn() -> clap::Command,
}
