//! A friction model of one's own: declared once, it can be named in models, experiments, saved files and diagnoses.

use aurt::prelude::*;
use aurt::simulate;
use aurt::simulation::{Motion, Scenario, robots};
use aurt::traits::friction_model;

friction_model! {
    /// Viscous friction that grows with the square of velocity, f_v = F_v q̇ |q̇|.
    pub struct Drag {}

    slot: Viscous,
    name: "drag",
    summary: "friction that grows with the square of velocity",
    equation: "f_v = F_v q̇ |q̇|",
    use_when: "a link moves through a liquid",
    source: "Newton, Principia, book II",
    example: r#"{ model = "drag" }"#,
    columns: ["F_v" in "Nm s^2/rad^2"],
    invariants: [OddInVelocity, ContinuousInVelocity, SignOfVelocity, Passive, Memoryless],
    reads_load: false,
    evaluate: |series, out| {
        for (drag, velocity) in out.column_mut(0).iter_mut().zip(series.velocity_rad_s) {
            *drag = velocity * velocity.abs();
        }
    },
}

pub(crate) fn main() -> Result<(), aurt::Error> {
    let machine = robots::two_link();
    let motion = Motion::MultiSine { duration_s: 15.0, harmonics: 8, top_hz: 1.0, share: 0.6 };
    let recording = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1)?, 1))?;
    let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
    let plain = Friction::coulomb().viscous(1);
    for (name, friction) in [("viscous", plain.clone()), (Drag::NAME, plain.velocity(Drag {}))] {
        let model = robot.model().friction(friction).build()?;
        let outcome = Calibrator::new(model).calibration(&recording).calibrate()?;
        println!("{name}: residual standard deviation by joint {:.4?}", outcome.calibrated.calibration.sigma);
    }
    Ok(())
}
