//! Writes torques, mass matrices and regressors of every serial chain of robot description files, for comparison with
//! other programs:
//!
//! `cargo run --release -p aurt-robots --example chains -- FOLDER FILE…`
//!
//! For each file one line of JSON goes to the standard output, with the chains' joints, the inertial parameters and the
//! number of base parameters; `FOLDER/K.f64` holds the numbers of chain K: for each state q, q̇, q̈, τ (N each), the
//! mass matrix (N rows of N) and the regressor (N rows of 10 N), in the computer's byte order.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use aurt_rbd::{ChainDynamics, JointKind, RobotDescription, base_parameters};
use aurt_robots::{parse, tips};
use serde_json::{Value, json};

/// Gravity in the frame of the base link.
const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];
/// Random states of each chain.
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

/// The chains of one file; `first` is the number of the first.
pub fn chains(file: &Path, folder: &Path, first: usize) -> Result<Value, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(file)?;
    let tips = match tips(&text, file, None) {
        Ok(tips) => tips,
        Err(errors) => return Ok(json!({ "file": file, "refused": errors.to_string() })),
    };
    let mut chains = Vec::new();
    for tip in tips {
        let number = first + chains.len();
        let robot = match parse(&text, file, None, Some(&tip)) {
            Ok(robot) => robot,
            Err(errors) => {
                chains.push(json!({ "tip": tip, "refused": errors.to_string() }));
                continue;
            }
        };
        let chain = robot.chain(GRAVITY_M_S2)?;
        let standard =
            robot.standard_parameters.clone().unwrap_or_else(|| vec![0.0; 10 * robot.joints.len()]);
        let base = base_parameters(&chain, 0);
        let mut dynamics = ChainDynamics::new(chain.clone(), &standard)?;
        let n = robot.joints.len();
        let mut numbers = Numbers(number as u64);
        let mut out = BufWriter::new(File::create(folder.join(format!("{number}.f64")))?);
        for _ in 0..STATES {
            let (q, qd, qdd) = (numbers.series(n, 3.0), numbers.series(n, 2.0), numbers.series(n, 8.0));
            let mut torque = vec![0.0; n];
            dynamics.inverse_dynamics(&q, &qd, &qdd, &mut torque);
            let mut mass = vec![0.0; n * n];
            dynamics.mass_matrix(&q, &mut mass);
            let regressor = chain.regressor(&q, &qd, &qdd);
            for value in q.iter().chain(&qd).chain(&qdd).chain(&torque).chain(&mass).chain(&regressor) {
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
