//! Writes torques, accelerations, mass matrices and regressors of every serial chain of robot description files, and of all
//! joints at once where a file has several chains, for comparison with other programs:
//!
//! `cargo run --release -p aurt-rbd --example chains -- FOLDER FILE…`
//!
//! For each file one line of JSON goes to the standard output, with the chains' joints, the inertial parameters and the
//! number of base parameters; `FOLDER/K.f64` holds the numbers of chain K: for each state q, q̇, q̈, τ, and the
//! accelerations of torques of the numbers of q̈ (N each; not a number where joints follow others), the mass matrix (N rows
//! of N) and the regressor (N rows of 10 M), in the computer's byte order. N joints move on their own, M with those that
//! follow them.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use aurt_rbd::robots::{Part, parse, tips};
use aurt_rbd::{ChainDynamics, JointKind, RobotDescription, base_parameters};
use aurt_traits::{Motion, RegressorTile, RigidBodyRegressor};
use serde_json::{Value, json};

/// Gravity in the frame of the base link.
const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];
const STATES: usize = 100;

/// Numbers of [−1, 1) by a linear congruence.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn series(&mut self, joints: usize, reach: f64) -> Vec<f64> {
        (0..joints).map(|_| reach * self.next()).collect()
    }
}

/// τ, the mass matrix and the regressor of one state. Column c of the mass matrix is the torque of q̈ = e_c at rest without
/// gravity.
fn dynamics(
    body: &dyn RigidBodyRegressor,
    standard: &[f64],
    [q, qd, qdd]: [&[f64]; 3],
) -> Result<[Vec<f64>; 3], Box<dyn std::error::Error>> {
    let (n, parameters) = (body.joints(), standard.len());
    let torque_of = |body: &dyn RigidBodyRegressor,
                     qd: &[f64],
                     qdd: &[f64]|
     -> Result<Vec<f64>, Box<dyn std::error::Error>> {
        let motion = Motion::new(n, vec![0.0], q.into(), qd.into(), qdd.into())?;
        let mut torque = vec![0.0; n];
        body.torque(motion.view(), standard, &mut torque, 1);
        Ok(torque)
    };
    let torque = torque_of(body, qd, qdd)?;
    let weightless = body.with_gravity([0.0; 3]);
    let mut mass = vec![0.0; n * n];
    for column in 0..n {
        let mut unit = vec![0.0; n];
        unit[column] = 1.0;
        for (row, value) in torque_of(&*weightless, &vec![0.0; n], &unit)?.into_iter().enumerate() {
            mass[row * n + column] = value;
        }
    }
    let mut regressor = vec![0.0; n * parameters];
    let destination: Vec<u32> = (0..n * parameters).map(|d| d as u32).collect();
    let motion = Motion::new(n, vec![0.0], q.into(), qd.into(), qdd.into())?;
    body.evaluate(motion.view(), &mut RegressorTile::new(&destination, parameters, 1, 1, &mut regressor));
    Ok([torque, mass, regressor])
}

/// The chains of one file; `first` is the number of the first.
pub fn chains(file: &Path, folder: &Path, first: usize) -> Result<Value, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(file)?;
    let tips = match tips(&text, file, None) {
        Ok(tips) => tips,
        Err(errors) => return Ok(json!({ "file": file, "refused": errors.to_string() })),
    };
    let mut chains = Vec::new();
    let mut parts: Vec<Part> = tips.into_iter().map(|tip| Part::Tips(vec![tip])).collect();
    if parts.len() > 1 {
        parts.push(Part::All);
    }
    for part in parts {
        let tip = if let Part::Tips(tips) = &part { tips.first() } else { None };
        let number = first + chains.len();
        let robot = match parse(&text, file, None, &part, None) {
            Ok(robot) => robot,
            Err(errors) => {
                chains.push(json!({ "tip": tip, "refused": errors.to_string() }));
                continue;
            }
        };
        let body = robot.rigid_body(GRAVITY_M_S2)?;
        let standard =
            robot.standard_parameters.clone().unwrap_or_else(|| vec![0.0; 10 * robot.joints.len()]);
        let base = base_parameters(&*body, 0);
        let n = body.joints();
        let mut forward = match robot.chain(GRAVITY_M_S2) {
            Ok(chain) => Some(ChainDynamics::new(chain, &standard)?),
            Err(_) => None,
        };
        let mut numbers = Numbers(number as u64);
        let mut out = BufWriter::new(File::create(folder.join(format!("{number}.f64")))?);
        for _ in 0..STATES {
            let (q, qd, qdd) = (numbers.series(n, 3.0), numbers.series(n, 2.0), numbers.series(n, 8.0));
            let [torque, mass, regressor] = dynamics(&*body, &standard, [&q, &qd, &qdd])?;
            let mut acceleration = vec![f64::NAN; n];
            if let Some(forward) = &mut forward {
                forward.forward_dynamics(&q, &qd, &qdd, &mut acceleration);
            }
            for value in [&q, &qd, &qdd, &torque, &acceleration, &mass, &regressor].into_iter().flatten() {
                out.write_all(&value.to_ne_bytes())?;
            }
        }
        out.flush()?;
        chains.push(json!({
            "number": number,
            "tip": tip,
            "joints": robot.joint_names,
            "prismatic": robot.kinds().iter().map(|k| *k == JointKind::Prismatic).collect::<Vec<_>>(),
            "frames": robot.frames,
            "limits": robot.limits.iter().map(|l| l.position_rad).collect::<Vec<_>>(),
            "armature": robot.armature_kg_m2,
            "damping": robot.friction.iter().map(|f| f.viscous_nm_s_rad).collect::<Vec<_>>(),
            "friction": robot.friction.iter().map(|f| f.coulomb_nm).collect::<Vec<_>>(),
            "standard_parameters": standard,
            "base_parameters": base.as_ref().map(|base| base.len()).ok(),
            "base_parameters_error": base.as_ref().err().map(ToString::to_string),
            "notes": robot.notes,
        }));
    }
    Ok(json!({ "file": file, "chains": chains }))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args_os().skip(1);
    let folder = arguments.next().ok_or("usage: chains FOLDER FILE…")?;
    let mut first = 0;
    for file in arguments {
        let found = chains(Path::new(&file), Path::new(&folder), first)?;
        first += found["chains"].as_array().map_or(0, Vec::len);
        println!("{found}");
    }
    Ok(())
}
