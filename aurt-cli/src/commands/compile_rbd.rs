//! `aurt compile-rbd`: from modified Denavit–Hartenberg parameters to rigid-body dynamics (paper, section II-A).

use std::path::PathBuf;
use std::sync::Arc;

use aurt::file_contents;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFile;
use aurt_plugins::model::model_file::{read_base_parameters, rigid_body_to_json};
use aurt_plugins::model::{BASE_PARAMETER_SEED, RigidBodyDynamics};
use aurt_rbd::{MdhRows, MdhTable, SerialChain};
use aurt_report::rendering::table::Table;
use clap::Args;
use serde_json::json;

use super::Session;
use crate::rendering::terminal::Report;
use crate::values::{Choice, Gravity, choice, parse_gravity};

/// Compile rigid-body dynamics from modified Denavit–Hartenberg parameters.
///
/// Finds the base inertial parameters, the minimal set that joint torques determine, and writes them with
/// the geometry to a model file. The columns alpha, a, d may be in any order; cells may be expressions such
/// as pi/2.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt compile-rbd --mdh mdh.csv --gravity 0 0 -9.81 --out rbd.json")]
pub struct CompileRbd {
    /// Table of modified Denavit–Hartenberg parameters, one row per joint
    #[arg(long, value_name = "MDH.csv")]
    mdh: PathBuf,
    /// Gravitational acceleration in the base frame, m/s²; describes how the base is mounted
    #[arg(long, value_name = "X Y Z", value_parser = parse_gravity, allow_hyphen_values = true)]
    gravity: Gravity,
    /// Which joint a row's alpha and a lead to
    #[arg(long, value_parser = choice(ROWS), default_value = "next")]
    mdh_rows: MdhRows,
    /// Names of the joints, base first, by which recordings are matched
    #[arg(long, value_name = "NAME,NAME,…", value_delimiter = ',')]
    joint_names: Vec<String>,
    /// File for the rigid-body dynamics
    #[arg(long, value_name = "JSON")]
    out: PathBuf,
}

/// The joint that alpha and a of a row lead to.
pub const ROWS: &[Choice<MdhRows>] = &[
    (
        "next",
        "The next one, as in the paper's Table I; alpha and a of the first joint are zero",
        MdhRows::Next,
    ),
    ("previous", "The row's own, as in Craig's book", MdhRows::Previous),
];

impl CompileRbd {
    pub fn run(&self, _: &Session<'_>) -> Result<Report, Failure> {
        let out = OutputFile::new("--out", &self.out, &[&self.mdh])?;
        let table = MdhTable::from_path(&self.mdh, self.mdh_rows)?;
        let chain =
            SerialChain::from_mdh(&table, self.gravity.0)?.with_joint_names(self.joint_names.clone())?;
        let dynamics = RigidBodyDynamics::new(Arc::new(chain), BASE_PARAMETER_SEED)?;
        out.write(&file_contents(rigid_body_to_json(&dynamics)?))?;

        let joints = dynamics.rigid_body.joints();
        let standard = dynamics.rigid_body.standard_parameters().len();
        let base = read_base_parameters(&*dynamics.rigid_body, &dynamics.base);
        let notes = table.notes();
        let mut listing = Table::new(["parameter", "unit", "stands for"]).left(3);
        for parameter in &base {
            listing.row([&parameter.name, &parameter.unit, &parameter.stands_for]);
        }
        let mut text = format!(
            "{joints} joints, {} base parameters of {standard} standard ones, gravity {}\n\n{}\n",
            base.len(),
            self.gravity,
            listing.render()
        );
        text.extend(notes.iter().map(|note| format!("note: {note}\n")));
        text.push_str(&format!("written: {}\n", out.path().display()));
        let parameters: Vec<_> = base
            .iter()
            .map(|p| json!({ "name": p.name, "unit": p.unit, "stands_for": p.stands_for }))
            .collect();
        let json = json!({
            "command": "compile-rbd",
            "joints": joints,
            "standard_parameters": standard,
            "base_parameters": base.len(),
            "gravity_m_s2": self.gravity.0,
            "parameters": parameters,
            "notes": notes,
            "outputs": [out.path()],
        });
        Ok(Report { text, json, findings: false })
    }
}
