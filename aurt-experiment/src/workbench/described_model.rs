//! The inertial parameters of a robot description as a model in their own right.

use std::path::Path;

use crate::Experiment;
use crate::experiment::Geometry;
use aurt::CalibratedModel;
use aurt::origins::Origins;
use aurt_calibration::{CalibratedParameter, Calibration, JointRange};
use aurt_plugins::Registry;
use aurt_plugins::model::RigidBodyDynamics;
use aurt_rbd::robots::{DescribedRobot, JointFriction, ParameterFile};
use aurt_rbd::{RobotDescription, carry_over};
use aurt_traits::{ColumnGroup, LoadTorque, MeasurementUnit, RobotModel, RobotNames};
use serde_json::json;

use crate::workbench::experiments::{check_robot_of, friction};
use crate::workbench::failure::Failure;

/// What a description may leave of a joint's torque in the experiment's geometry, over that torque: lengths rounded to a
/// millimetre leave less, another arm leaves tens of percent.
const SAME_ARM: f64 = 0.01;

/// How the names of description files end.
const ENDINGS: [&str; 4] = ["urdf", "xml", "mjcf", "xacro"];

/// The links between which a chain of a description file lies; where neither is named, those that the experiment names, if
/// the file has them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ChainEnds<'a> {
    pub base: Option<&'a str>,
    pub tip: Option<&'a str>,
}

#[derive(Debug, Clone)]
pub struct GivenModel {
    pub calibrated: CalibratedModel,
    pub notes: Vec<String>,
}

impl GivenModel {
    /// Reads a calibrated model, or the model that a URDF or MJCF file is (`.urdf`, `.xml`, `.mjcf`): its inertial parameters,
    /// friction and rotors in the geometry of the experiment, corrected by a file of `parameters`.
    pub fn read(
        path: &Path,
        ends: ChainEnds<'_>,
        parameters: Option<&Path>,
        experiment: &Experiment,
        registry: &Registry,
    ) -> Result<Self, Failure> {
        let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if ENDINGS.contains(&ending.as_str()) {
            let parameters = parameters.map(ParameterFile::read).transpose()?;
            let described = chain(path, ends, parameters.as_ref(), experiment)?;
            let calibrated = of_description(&described, path, experiment, registry)?;
            let mut notes = described.notes;
            let beyond: Vec<&str> = parameters.iter().flat_map(ParameterFile::of_drives).collect();
            if !beyond.is_empty() {
                notes.push(format!(
                    "parameters that no model of torques has are left out: {}",
                    beyond.join(", ")
                ));
            }
            return Ok(Self { calibrated, notes });
        }
        if ends != ChainEnds::default() || parameters.is_some() {
            return Err(Failure::unfit(
                path,
                "is no .urdf or .xml file, of which a chain could be chosen or parameters corrected",
                "leave out --base, --tip and --parameters",
            ));
        }
        let calibrated = CalibratedModel::read(path, registry)?;
        check_robot_of(&calibrated, experiment)?;
        Ok(Self { calibrated, notes: Vec::new() })
    }
}

fn chain(
    path: &Path,
    ends: ChainEnds<'_>,
    parameters: Option<&ParameterFile>,
    experiment: &Experiment,
) -> Result<DescribedRobot, Failure> {
    if let (ChainEnds { base: None, tip: None }, Geometry::Urdf { robot, .. }) =
        (ends, &experiment.robot.geometry)
        && aurt_rbd::robots::read(path, Some(&robot.base), &robot.part, None).is_ok()
    {
        return Ok(aurt_rbd::robots::read(path, Some(&robot.base), &robot.part, parameters)?);
    }
    Ok(aurt_rbd::robots::read(path, ends.base, &ends.tip.into(), parameters)?)
}

/// The model that a description states, in the geometry of an experiment.
fn of_description(
    described: &DescribedRobot,
    path: &Path,
    experiment: &Experiment,
    registry: &Registry,
) -> Result<CalibratedModel, Failure> {
    let refuse = |reason: String, remedy: &str| Failure::unfit(path, reason, remedy);
    let Some(standard) = &described.standard_parameters else {
        let remedy = "give its links `inertial` elements, or calibrate a model with `aurt run`";
        return Err(refuse("states no masses, so it is no model".into(), remedy));
    };
    let (joints, found) = (experiment.joints(), described.joints());
    if found != joints {
        let DescribedRobot { base, tip, .. } = described;
        let part = if tip.is_empty() { "tree".into() } else { format!("chain to `{tip}`") };
        return Err(refuse(
            format!("the {part} on `{base}` has {found} joints, the experiment's robot {joints}"),
            "name the links between which the robot's joints lie with --base and --tip",
        ));
    }
    let dynamics = experiment.rigid_body_dynamics()?;
    let own = described.rigid_body(experiment.robot.gravity_m_s2)?;
    let carried = carry_over(&*dynamics.rigid_body, &dynamics.base, &*own, standard)?;
    let worst = (0..joints).max_by(|a, b| carried.left[*a].total_cmp(&carried.left[*b])).unwrap_or(0);
    if carried.left[worst] > SAME_ARM {
        let left = 100.0 * carried.left[worst];
        let joint = RobotNames::of(&*dynamics.rigid_body).joint(worst);
        let said = if left < 100.0 {
            format!("{left:.0} % of the torque of {joint} are left by any masses")
        } else {
            format!("no masses explain anything of the torque of {joint}")
        };
        return Err(refuse(
            format!("is of another arm than `[robot]`: with its lengths and axes {said}"),
            "compare lengths, axes, their directions, zero positions, and `gravity_m_s2` in the base frames of both, or make \
             the file the geometry itself: `[robot] urdf` or `mjcf`",
        ));
    }
    let model = model(described, dynamics, registry)?;
    let values = coefficients(described, &carried.values, &model);
    let calibration = Calibration {
        unit: MeasurementUnit::NewtonMetre,
        options: experiment.calibration,
        f_dyn_hz: experiment.preprocess.f_dyn_hz,
        parameters: exact_parameters(&model, &values),
        covariance: Vec::new(),
        load: LoadTorque::Fitted(values),
        sigma: vec![0.0; joints],
        samples_per_joint: vec![0; joints],
        condition_number: 1.0,
        ranges: vec![JointRange { velocity_rad_s: f64::MAX, load_torque: None }; joints],
        recordings: Vec::new(),
        warnings: Vec::new(),
        about_physics: Vec::new(),
        shape_fit: None,
        consistent: None,
        essential: None,
        position_bias: None,
        robust: None,
    };
    Ok(CalibratedModel {
        model,
        calibration,
        preprocessing: experiment.preprocess.clone(),
        instrument: experiment.instrument.clone(),
        origins: Origins::default(),
    })
}

/// The parameters of a model, known without uncertainty.
pub(super) fn exact_parameters(model: &RobotModel, values: &[f64]) -> Vec<CalibratedParameter> {
    let parameters = model.parameters().iter().zip(values).enumerate();
    parameters
        .map(|(column, (parameter, value))| CalibratedParameter {
            name: parameter.name.clone(),
            unit: model.unit(column, MeasurementUnit::NewtonMetre),
            value: *value,
            std_dev: None,
            relative_std_dev_percent: None,
            interval_95: None,
            excited: true,
        })
        .collect()
}

/// The structure: friction and rotors in the joints for which the description states them.
pub(super) fn model(
    described: &DescribedRobot,
    dynamics: RigidBodyDynamics,
    registry: &Registry,
) -> Result<RobotModel, Failure> {
    let stack = |stated: &JointFriction| {
        let level = if stated.coulomb_nm == 0.0 { "absent" } else { "constant" };
        let powers: &[u32] = if stated.viscous_nm_s_rad == 0.0 { &[] } else { &[1] };
        friction(registry, level, "sign", powers)
    };
    let stacks = described.friction.iter().map(stack).collect::<Result<_, _>>()?;
    let rotors: Vec<usize> =
        (0..described.joints()).filter(|j| described.armature_kg_m2[*j] != 0.0).collect();
    let mut terms = Vec::new();
    if !rotors.is_empty() {
        let term = json!({ "model": "rotor_inertia", "joints": rotors });
        terms.push(registry.build_from_json(&term)?);
    }
    Ok(dynamics.with_joint_dynamics(stacks, terms)?)
}

pub(super) fn coefficients(described: &DescribedRobot, base: &[f64], model: &RobotModel) -> Vec<f64> {
    let mut values = vec![0.0; model.parameters().len()];
    let mut put = |group, own: &[f64]| values[model.group(group)].copy_from_slice(own);
    put(ColumnGroup::RigidBody, base);
    let stated = |values: &[f64]| values.iter().copied().filter(|v| *v != 0.0).collect::<Vec<f64>>();
    for (j, friction) in described.friction.iter().enumerate() {
        put(ColumnGroup::JointDynamics(j), &stated(&[friction.coulomb_nm, friction.viscous_nm_s_rad]));
    }
    if !model.arm_terms().is_empty() {
        put(ColumnGroup::ArmTerm(0), &stated(&described.armature_kg_m2));
    }
    values
}
