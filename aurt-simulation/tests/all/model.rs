//! Forward dynamics of calibrated models: they move as their own inverse dynamics say.

use std::sync::Arc;

use aurt_friction as _;
use aurt_rbd::base_parameters;
use aurt_simulation::model::{ModelDrive, MovingModel, REST_RAD_S};
use aurt_simulation::{Robot, robots};
use aurt_traits::{JointStack, LoadTorque, Motion, RobotModel};
use serde_json::json;

/// A model of the robot with the given friction on every joint, and its coefficients: the robot's bodies, and of
/// each joint the given ones.
fn model(
    robot: &Robot,
    [coulomb, hysteresis]: [serde_json::Value; 2],
    friction: &[f64],
) -> (RobotModel, Vec<f64>) {
    let chain = robot.chain().unwrap();
    let base = base_parameters(&chain, 1).unwrap();
    let mut coefficients = base.values(&robot.standard_parameters());
    let stack = JointStack::new(
        serde_json::from_value(coulomb).unwrap(),
        serde_json::from_value(hysteresis).unwrap(),
        serde_json::from_value(json!({ "model": "polynomial", "powers": [1] })).unwrap(),
    )
    .unwrap();
    for _ in 0..robot.joints() {
        coefficients.extend(friction);
    }
    let model = RobotModel::new(Arc::new(chain), base, vec![stack; robot.joints()], Vec::new()).unwrap();
    assert_eq!(model.parameters().len(), coefficients.len());
    (model, coefficients)
}

/// A swing of all joints that begins and ends at rest.
fn swing(robot: &Robot, duration_s: f64, step_s: f64) -> Motion {
    let n = robot.joints();
    let samples = (duration_s / step_s).round() as usize + 1;
    let time: Vec<f64> = (0..samples).map(|k| k as f64 * step_s).collect();
    let (mut q, mut v, mut a) = (Vec::new(), Vec::new(), Vec::new());
    for (j, drive) in robot.drives.iter().enumerate() {
        let (w, size) = (std::f64::consts::TAU * (1.0 + j as f64) / duration_s, 0.3 / (1.0 + j as f64));
        q.extend(time.iter().map(|t| drive.home_rad + size * (1.0 - (w * t).cos())));
        v.extend(time.iter().map(|t| size * w * (w * t).sin()));
        a.extend(time.iter().map(|t| size * w * w * (w * t).cos()));
    }
    Motion::new(n, time, q, v, a).unwrap()
}

/// Coulomb and viscous friction, the first growing with the load: the measured torques of a motion, applied
/// without any controller, bring the motion back.
#[test]
fn torques_of_a_motion_bring_the_motion_back() {
    let robot = robots::two_link();
    let coulomb = json!({ "model": "absolute" });
    let sign = json!({ "model": "tanh", "velocity_rad_s": 0.01 });
    let (model, coefficients) = model(&robot, [coulomb, sign], &[3.0, 0.1, 2.0]);
    let load = LoadTorque::Fitted(coefficients.clone());
    let moving = MovingModel { model: &model, coefficients: &coefficients, load: &load };
    let motion = swing(&robot, 3.0, 1e-3);
    // What a controller needs for it is the measurement.
    let followed =
        moving.run(&ModelDrive::Follow { motion: motion.clone(), bandwidth_hz: 20.0 }, &mut |_| ()).unwrap();
    for j in 0..2 {
        let off = followed.position_rad[j]
            .iter()
            .zip(motion.view().position_rad(j))
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(off < 2e-3, "joint {j} is {off} rad off its command");
    }
    let drive = ModelDrive::Torques { motion: motion.clone(), torque: followed.torque.clone() };
    let moved = moving.run(&drive, &mut |_| ()).unwrap();
    for j in 0..2 {
        let off = moved.position_rad[j]
            .iter()
            .zip(&followed.position_rad[j])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(off < 5e-3, "joint {j} is {off} rad off");
    }
}

/// A joint that its friction can hold is held: it creeps with no more than what counts as rest.
#[test]
fn friction_holds() {
    let robot = robots::two_link();
    let friction = [json!({ "model": "constant" }), json!({ "model": "sign" })];
    let (model, coefficients) = model(&robot, friction, &[120.0, 2.0]);
    let load = LoadTorque::Literal;
    let moving = MovingModel { model: &model, coefficients: &coefficients, load: &load };
    let still = Motion::new(2, vec![0.0, 0.5, 1.0], vec![0.3; 6], vec![0.0; 6], vec![0.0; 6]).unwrap();
    let drive = ModelDrive::Torques { motion: still, torque: vec![vec![0.0; 3]; 2] };
    let moved = moving.run(&drive, &mut |_| ()).unwrap();
    for j in 0..2 {
        assert!(moved.velocity_rad_s[j].iter().all(|v| v.abs() < REST_RAD_S), "{:?}", moved.velocity_rad_s);
    }
}

/// Error against the time step of the drive's grid, smooth friction: the method is of order two.
#[test]
fn the_method_is_of_order_two() {
    let mut robot = robots::two_link();
    // Without gravity nothing comes to rest, where the torque is not smooth.
    robot.gravity_m_s2 = [0.0; 3];
    let friction = [json!({ "model": "absent" }), json!({ "model": "sign" })];
    let (model, coefficients) = model(&robot, friction, &[2.0]);
    let load = LoadTorque::Literal;
    let moving = MovingModel { model: &model, coefficients: &coefficients, load: &load };
    let end = |step_s: f64| {
        let samples = (0.4 / step_s).round() as usize + 1;
        let time = (0..samples).map(|k| k as f64 * step_s).collect();
        let still =
            Motion::new(2, time, vec![0.2; 2 * samples], vec![2.0; 2 * samples], vec![0.0; 2 * samples])
                .unwrap();
        let torque = vec![vec![3.0; samples]; 2];
        let moved = moving.run(&ModelDrive::Torques { motion: still, torque }, &mut |_| ()).unwrap();
        [0, 1].map(|j| moved.position_rad[j][samples - 1])
    };
    let best = end(2.5e-5);
    let error = |step_s: f64| {
        let [a, b] = end(step_s);
        (a - best[0]).hypot(b - best[1])
    };
    let errors = [error(1e-3), error(5e-4), error(2.5e-4)];
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.4).contains(&order), "{errors:?}: order {order}");
    }
}

#[test]
fn models_that_cannot_move_are_refused() {
    let robot = robots::two_link();
    let friction = || [json!({ "model": "constant" }), json!({ "model": "sign" })];
    let (model, good) = model(&robot, friction(), &[1.0, 2.0]);
    let load = LoadTorque::Literal;
    let motion = swing(&robot, 1.0, 1e-2);
    let refusal = |coefficients: &[f64], drive: &ModelDrive| {
        let moving = MovingModel { model: &model, coefficients, load: &load };
        moving.run(drive, &mut |_| ()).unwrap_err().to_string()
    };
    let follow = ModelDrive::Follow { motion: motion.clone(), bandwidth_hz: 10.0 };
    assert!(refusal(&good[1..], &follow).contains("coefficients of the model"));
    let one = ModelDrive::Torques { motion, torque: vec![vec![0.0; 101]] };
    assert!(refusal(&good, &one).contains("joints of the drive"));
    let nothing = vec![0.0; good.len()];
    assert!(refusal(&nothing, &follow).contains("inertia"), "{}", refusal(&nothing, &follow));
}
