//! `current`: a current controller and a torque constant, τ = k_t i*(t − T).

use aurt_traits::{DriveInput, DriveTorque, Jet, drive_numbers};

use crate::drives::declare::drive;

drive_numbers! {
    /// A current controller and a torque constant, τ = k_t i*(t − T), gear included.
    pub struct CurrentDrive {
        /// k_t: torque on the joint per current.
        torque_constant_nm_per_a: "Nm/A" = 1.0, 1.0, [1e-6, 1e6];
        /// T: delay of the command.
        delay_s: "s" = 0.0, 0.01, [0.0, 0.5];
    }
}

drive!(CurrentDrive, "current", Current, Linear, |_| Vec::new(), law);

fn law(p: &[Jet], input: &DriveInput<'_>, _: &mut [Jet]) -> DriveTorque {
    DriveTorque { torque: p[0] * (input.command)(-p[1] + input.time_s, input.step_s), damping: Jet::ZERO }
}
