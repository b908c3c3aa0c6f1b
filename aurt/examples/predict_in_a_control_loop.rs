//! Feed-forward currents in a control loop: one sample at a time, with the memory of friction, without taking memory from
//! the heap after the first sample.

use std::time::Instant;

use aurt::friction::hysteresis::dahl::Dahl;
use aurt::prelude::*;
use aurt::simulate;
use aurt::simulation::{Motion, Scenario, robots};

pub(crate) fn main() -> Result<(), aurt::Error> {
    let machine = robots::ur10e();
    let motion = Motion::MultiSine { duration_s: 15.0, harmonics: 8, top_hz: 1.0, share: 0.6 };
    let recording = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1)?, 1))?;
    let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
    let friction = Friction::load_dependent().hysteresis(Dahl::default()).viscous(1);
    let model = robot.model().friction(friction).build()?;
    let model = Calibrator::new(model).calibration(&recording).calibrate()?.calibrated;

    let mut predictor = model.predictor()?;
    let dt_s = 0.002;
    let mut longest = 0.0_f64;
    for k in 0..500 {
        let phase = 2.0 * f64::from(k) * dt_s;
        let (q, qd, qdd) = ([phase.sin(); 6], [2.0 * phase.cos(); 6], [-4.0 * phase.sin(); 6]);
        let begun = Instant::now();
        let current = predictor.torque(dt_s, &q, &qd, &qdd)?;
        longest = longest.max(begun.elapsed().as_secs_f64());
        if k % 100 == 0 {
            println!("{:.3} s: {:?} A", f64::from(k) * dt_s, current.map_rounded());
        }
    }
    println!("the slowest of 500 samples took {:.1} µs", 1e6 * longest);
    Ok(())
}

/// Numbers as people read them.
trait Rounded {
    fn map_rounded(&self) -> Vec<String>;
}

impl Rounded for [f64] {
    fn map_rounded(&self) -> Vec<String> {
        self.iter().map(|x| format!("{x:.2}")).collect()
    }
}
