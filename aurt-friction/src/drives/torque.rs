//! `torque`: an ideal source of torque, τ = τ*(t − T).

use aurt_traits::{DriveInput, DriveTorque, Jet, drive_numbers};

use crate::drives::declare::drive;

drive_numbers! {
    /// An ideal source of torque, τ = τ*(t − T).
    pub struct TorqueDrive {
        /// T: delay of the command.
        delay_s: "s" = 0.0, 0.01, [0.0, 0.5];
    }
}

drive!(TorqueDrive, "torque", Torque, Linear, |_| Vec::new(), law);

fn law(p: &[Jet], input: &DriveInput<'_>, _: &mut [Jet]) -> DriveTorque {
    DriveTorque { torque: (input.command)(-p[0] + input.time_s, input.step_s), damping: Jet::ZERO }
}
