//! Setups of users, right ones and ones with a usual mistake, and what `aurt check` says of them.

mod answer;
mod arms;
mod board;
pub mod mistakes;
mod setup;

pub use answer::{Answer, Outcome};
pub use board::Board;
pub use mistakes::Kind;
pub use setup::{Columns, Geometry, Log, Setup, Units, file_name};

use std::path::Path;

use rayon::prelude::*;
use serde_json::json;

use crate::product::{Failure, OutputFolder, pretty};
use aurt_simulation::{Random, SimulationError};

#[derive(Debug, Clone, Copy)]
pub struct Counted {
    /// Setups without a mistake.
    pub right: usize,
    pub wrong: usize,
    pub seed: u64,
}

/// Makes setups, asks `program check` about each, and forgets its files unless `keep` is set.
pub fn counted(
    counted: Counted,
    program: &Path,
    out: &Path,
    keep: bool,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Board, Failure> {
    let ask = |what: &str, index: usize| {
        let name = format!("{what}_{:04}", index + 1);
        let file = format!("{}_{name}.json", counted.seed);
        let kept = out.join("answers").join(&file);
        if let Ok(known) = crate::json_file::read(&kept) {
            return Ok(known);
        }
        let (setup, kind) = made(&name, (what == "wrong").then_some(index), counted.seed)?;
        let answer = Answer::ask(&name, &setup, kind.as_ref(), program, out, keep)?;
        OutputFolder::nested("--out", &out.join("answers"))?
            .write(&[(file, pretty(&json!(answer)).into_bytes())])?;
        progress(&format!("{name}: {}", answer.outcome.name()));
        Ok::<_, Failure>(answer)
    };
    let all = |what: &'static str, count: usize| -> Result<Vec<Answer>, Failure> {
        (0..count).into_par_iter().map(|index| ask(what, index)).collect()
    };
    let right = all("right", counted.right)?;
    Ok(Board { seed: counted.seed, right, wrong: all("wrong", counted.wrong)? })
}

/// A setup: its robot, recordings and experiment are drawn, as is the mistake, if it is to have one.
fn made(name: &str, wrong: Option<usize>, seed: u64) -> Result<(Setup, Option<Kind>), SimulationError> {
    let mut random = Random::labelled(seed, name);
    let Some(index) = wrong else { return Ok((Setup::draw(&mut random)?, None)) };
    loop {
        let mut setup = Setup::draw(&mut random)?;
        // Every kind in turn; what a setup cannot have another one can.
        if let Some(kind) = Kind::make(index, &mut setup, &mut random) {
            return Ok((setup, Some(kind)));
        }
    }
}
