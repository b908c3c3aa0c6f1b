//! The world of another engine: cases that a Python program makes with MuJoCo.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use super::place::Place;
use super::source::{Ingredients, Planned, Source};
use crate::case::Plan;
use crate::product::Failure;
use aurt_simulation::SimulationError;

/// Names the Python interpreter; `python3` without it.
const PYTHON: &str = "AURT_PYTHON";
/// Names the program that makes the cases; without it the repository's own.
const PROGRAM: &str = "AURT_MUJOCO_WORLD";
/// The repository's own, seen from its root.
const OWN_PROGRAM: &str = "aurt-lab/mujoco/mujoco_world.py";

#[derive(Debug)]
pub struct Mujoco {
    python: OsString,
    program: PathBuf,
    plan: PathBuf,
    seed: u64,
    planned: Vec<Planned>,
}

impl Mujoco {
    /// The cases of a plan, or why there are none on this machine.
    pub fn new(ingredients: &Ingredients, place: &Place) -> Result<Result<Self, String>, Failure> {
        let python = std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into());
        let program = std::env::var_os(PROGRAM).map_or_else(|| PathBuf::from(OWN_PROGRAM), PathBuf::from);
        if !program.is_file() {
            let reason = format!(
                "{} is no file; run from the repository, or name it with {PROGRAM}",
                program.display()
            );
            return Ok(Err(reason));
        }
        let imports = run(Command::new(&python).args(["-c", "import mujoco"]));
        if !imports.is_ok_and(|output| output.status.success()) {
            let python = python.to_string_lossy();
            return Ok(Err(format!(
                "{python} cannot import mujoco; `pip install mujoco numpy`, or name another interpreter with {PYTHON}"
            )));
        }
        let plan = place.plan();
        write_plan(&plan, ingredients)?;
        let mut mujoco = Self { python, program, plan, seed: ingredients.seed, planned: Vec::new() };
        let list = mujoco.call(&["--list".into()]).map_err(|reason| mujoco.refusal(reason))?;
        mujoco.planned =
            serde_json::from_slice(&list).map_err(|error| mujoco.refusal(format!("--list: {error}")))?;
        Ok(Ok(mujoco))
    }

    fn refusal(&self, reason: String) -> Failure {
        Failure::unfit(self.program.clone(), reason, "correct the plan, or prove other worlds")
    }

    fn call(&self, options: &[OsString]) -> Result<Vec<u8>, String> {
        let mut command = Command::new(&self.python);
        command.arg(&self.program).arg("--plan").arg(&self.plan).arg("--seed").arg(self.seed.to_string());
        let output = run(command.args(options)).map_err(|error| error.to_string())?;
        if output.status.success() {
            Ok(output.stdout)
        } else {
            let said = String::from_utf8_lossy(&output.stderr);
            // A traceback ends in what went wrong.
            Err(said.trim().lines().last().unwrap_or("it failed without a message").to_owned())
        }
    }
}

fn run(command: &mut Command) -> std::io::Result<Output> {
    command.stdin(Stdio::null()).output()
}

fn write_plan(path: &Path, ingredients: &Ingredients) -> Result<(), Failure> {
    let text = crate::product::pretty(&serde_json::json!(ingredients.plan));
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder).map_err(|source| Failure::write(folder.to_owned(), source))?;
    crate::product::OutputFile::new("--out", path, &[])?.write(text.as_bytes())
}

impl Source for Mujoco {
    fn planned(&self) -> &[Planned] {
        &self.planned
    }

    fn write(&self, index: usize, cases: &Path, sealed: &Path) -> Result<(), SimulationError> {
        let options: [OsString; 6] = [
            "--index".into(),
            index.to_string().into(),
            "--cases".into(),
            cases.into(),
            "--sealed".into(),
            sealed.into(),
        ];
        let refused = |reason| SimulationError::unreadable(Plan::case_name(index), reason);
        self.call(&options).map(drop).map_err(refused)
    }
}
