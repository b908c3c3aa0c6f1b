//! `aurt compile-rd`: joint dynamics on top of compiled rigid bodies (paper, section II-B).

use std::path::PathBuf;

use aurt::file_contents;
use aurt_experiment::Experiment;
use aurt_experiment::workbench::experiments::friction;
use aurt_experiment::workbench::failure::Failure;
use aurt_experiment::workbench::output::OutputFile;
use aurt_plugins::model::model_file::{read_rigid_body, robot_model_to_json};
use aurt_report::rendering::table::Table;
use aurt_traits::{ColumnGroup, MeasurementUnit, RobotModel};
use clap::{Args, ValueEnum};
use serde_json::json;

use super::Session;
use crate::rendering::terminal::Report;

/// Compile robot dynamics: rigid bodies with the friction of the joints.
///
/// All joints have the same models, τ_JD = f_C(τ_J) sgn(q̇) + f_v(q̇). Other models, or different models
/// per joint, come from an experiment file. The rigid bodies are not compiled again.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  aurt compile-rd --model-rbd rbd.json --friction-torque-model square \
    --friction-viscous-powers 1 2 3 --out rd.json")]
pub struct CompileRd {
    /// Rigid-body dynamics from `aurt compile-rbd`
    #[arg(long, value_name = "JSON")]
    model_rbd: PathBuf,
    /// How Coulomb friction depends on the load torque
    #[arg(long, visible_alias = "friction-load-model", value_enum, required_unless_present = "experiment")]
    friction_torque_model: Option<LoadDependence>,
    /// Powers of the viscous friction polynomial
    #[arg(long, value_name = "POWER", num_args = 1.., required_unless_present = "experiment")]
    friction_viscous_powers: Vec<u32>,
    /// Experiment file to take `[joint_dynamics]` and `[[arm_terms]]` from
    #[arg(long, value_name = "EXPERIMENT.toml", conflicts_with_all = ["friction_torque_model", "friction_viscous_powers"])]
    experiment: Option<PathBuf>,
    /// File for the robot dynamics
    #[arg(long, value_name = "JSON")]
    out: PathBuf,
}

/// How Coulomb friction depends on the load torque τ_J.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum LoadDependence {
    /// f_C = F_C0
    #[value(alias = "none")]
    Constant,
    /// f_C = F_C0 + F_C1 τ_J²
    Square,
    /// f_C = F_C0 + F_C1 |τ_J|
    Absolute,
}

impl LoadDependence {
    const fn model(self) -> &'static str {
        match self {
            Self::Constant => "constant",
            Self::Square => "square",
            Self::Absolute => "absolute",
        }
    }
}

impl CompileRd {
    pub fn run(&self, session: &mut Session<'_>) -> Result<Report, Failure> {
        let mut inputs = vec![self.model_rbd.as_path()];
        inputs.extend(self.experiment.as_deref());
        let out = OutputFile::new("--out", &self.out, &inputs)?;
        let dynamics = read_rigid_body(&self.model_rbd)?;
        let joints = dynamics.rigid_body.joints();
        let (stacks, arm_terms) = match &self.experiment {
            Some(path) => {
                let experiment = Experiment::read(path, &mut session.registry)?;
                if experiment.joints() != joints {
                    return Err(Failure::argument(
                        "--experiment",
                        format!(
                            "{} describes a robot with {} joints, {} one with {joints}",
                            path.display(),
                            experiment.joints(),
                            self.model_rbd.display()
                        ),
                        "use files of one robot",
                    ));
                }
                (
                    experiment.joint_dynamics.stacks(joints).map_err(aurt_plugins::model::Error::Assembly)?,
                    experiment.arm_terms,
                )
            }
            None => {
                let coulomb = self.friction_torque_model.unwrap_or(LoadDependence::Constant).model();
                let powers = &self.friction_viscous_powers;
                (vec![friction(&session.registry, coulomb, "sign", powers)?; joints], Vec::new())
            }
        };
        let model = dynamics.with_joint_dynamics(stacks, arm_terms)?;
        out.write(&file_contents(robot_model_to_json(&model)?))?;

        let text = format!(
            "{joints} joints, {} parameters: {} base parameters and these of the joints\n\n{}\nwritten: {}\n",
            model.parameters().len(),
            model.base().len(),
            joint_parameters(&model).render(),
            out.path().display()
        );
        let json = json!({
            "command": "compile-rd",
            "joints": joints,
            "base_parameters": model.base().len(),
            "parameters": model.parameters().len(),
            "parameter_names": model.parameters().iter().map(|p| &p.name).collect::<Vec<_>>(),
            "outputs": [out.path()],
        });
        Ok(Report { text, json, findings: false })
    }
}

/// The coefficients that are not base parameters.
fn joint_parameters(model: &RobotModel) -> Table {
    let mut table = Table::new(["joint", "parameters"]).left(2);
    for (group, range) in model.groups() {
        let owner = match group {
            ColumnGroup::RigidBody => continue,
            ColumnGroup::JointDynamics(joint) => joint.to_string(),
            ColumnGroup::ArmTerm(_) => "arm".into(),
        };
        let named = |column: usize| {
            format!(
                "{} [{}]",
                model.parameters()[column].name,
                model.unit(column, MeasurementUnit::NewtonMetre)
            )
        };
        let names: Vec<String> = range.clone().map(named).collect();
        table.row([owner, names.join(", ")]);
    }
    table
}
