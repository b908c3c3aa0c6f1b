//! Calibrating a model with a friction of each joint on arrays, judging it on others, saving it.
//!
//! The arrays are those of a simulated UR10e here; from a real robot they come from its logger.

use aurt::prelude::*;
use aurt::simulate;
use aurt::simulation::{Motion, Scenario, robots};

pub(crate) fn main() -> Result<(), aurt::Error> {
    let machine = robots::ur10e();
    let (time_s, position_rad, current_a) = logged(&machine, 1)?;
    let calibration = Recording::from_arrays(time_s, position_rad)?
        .with_measurement(current_a, MeasurementUnit::Ampere)?
        .named("monday");
    let (time_s, position_rad, current_a) = logged(&machine, 2)?;
    let validation = Recording::from_arrays(time_s, position_rad)?
        .with_measurement(current_a, MeasurementUnit::Ampere)?
        .named("tuesday");

    let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
    // Joints 1 and 2 carry the arm: their friction grows with the load.
    let loaded = Friction::load_dependent().viscous(1);
    let model = robot
        .model()
        .friction(Friction::coulomb().viscous(1))
        .joint_friction(1, loaded.clone())
        .joint_friction(2, loaded)
        .arm_term(RotorInertia { joints: JointSelection::of(vec![2, 3, 4, 5]) })
        .build()?;
    let outcome = Calibrator::new(model).calibration(&calibration).validation(&validation).calibrate()?;

    for result in &outcome.recordings {
        let error = &result.validation.moving.nrmse;
        let percent: Vec<String> = error.iter().map(|e| format!("{:.1}", 100.0 * e)).collect();
        println!(
            "{}: error while moving, % of the measurement, by joint: {}",
            result.label,
            percent.join(" ")
        );
    }
    let folder = std::env::temp_dir().join(format!("aurt-example-{}", std::process::id()));
    let _ = std::fs::create_dir(&folder);
    let path = folder.join("rd_calibrated.json");
    outcome.calibrated.save(&path)?;
    let loaded = CalibratedModel::load(&path)?;
    assert_eq!(loaded.calibration, outcome.calibrated.calibration);
    let _ = std::fs::remove_dir_all(&folder);
    Ok(())
}

type Arrays = (Vec<f64>, Vec<Vec<f64>>, Vec<Vec<f64>>);

/// What the logger of a simulated robot has: time, and positions and currents by joint.
fn logged(machine: &aurt::simulation::Robot, seed: u64) -> Result<Arrays, aurt::Error> {
    let motion = Motion::MultiSine { duration_s: 15.0, harmonics: 8, top_hz: 1.0, share: 0.6 };
    let recording = simulate(&Scenario::new(machine.clone(), motion.plan(machine, seed)?, seed))?;
    Ok((recording.time_s, recording.position_rad, recording.measurement.unwrap_or_default()))
}
