//! `pd_law`: a known law of control, τ = sat(K_p (q*(t − T) − q) − K_d q̇), that a torque-controlled drive carries out.

use aurt_traits::{DriveInput, DriveTorque, Jet, UNLIMITED, drive_numbers};

use crate::drives::declare::drive;

drive_numbers! {
    /// A law of control that a torque-controlled drive carries out, τ = sat(K_p (q*(t − T) − q) − K_d q̇): quadrupeds,
    /// direct drives.
    pub struct PdLaw {
        /// K_p: torque per position error.
        gain_nm_per_rad: "Nm/rad" = 10.0, 10.0, [0.0, 1e9];
        /// K_d: damping that the controller computes, within the saturation.
        damping_nm_s_per_rad: "Nm s/rad" = 0.0, 1.0, [0.0, 1e9];
        /// T: delay of the command.
        delay_s: "s" = 0.0, 0.01, [0.0, 0.5];
        /// sat: largest torque.
        torque_limit_nm: "Nm" = UNLIMITED, 10.0, [1e-9, UNLIMITED];
    }
}

drive!(PdLaw, "pd_law", Position, Linear, |_| Vec::new(), law);

fn law(p: &[Jet], input: &DriveInput<'_>, _: &mut [Jet]) -> DriveTorque {
    let wanted = p[0] * ((input.command)(-p[2] + input.time_s, input.step_s) - input.position_rad)
        - p[1] * input.velocity_rad_s;
    let torque = wanted.clamp(p[3]);
    DriveTorque { torque, damping: if torque == wanted { p[1] } else { Jet::ZERO } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use aurt_traits::DriveModel;

    #[test]
    fn the_law_is_followed_up_to_its_limit() {
        let law =
            PdLaw { gain_nm_per_rad: 20.0, damping_nm_s_per_rad: 1.5, torque_limit_nm: 5.0, delay_s: 0.1 };
        let p: Vec<Jet> = law.parameters().iter().map(|p| Jet::constant(p.value)).collect();
        let torque = |position: f64, velocity: f64| {
            let command = |t: Jet, _: f64| t;
            let input = DriveInput {
                time_s: 0.5,
                step_s: 0.01,
                command: &command,
                position_rad: position.into(),
                velocity_rad_s: velocity.into(),
            };
            let torque = law.torque(&p, &input, &mut []);
            (torque.torque.value, torque.damping.value)
        };
        let (value, damping) = torque(0.3, 0.2);
        assert!((value - (20.0 * (0.4 - 0.3) - 1.5 * 0.2)).abs() < 1e-12, "{value}");
        assert_eq!(damping, 1.5);
        assert_eq!(torque(-3.0, 0.0), (5.0, 0.0));
    }
}
