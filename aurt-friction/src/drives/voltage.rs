//! `voltage`: a motor at a voltage, with its back-EMF, τ = (k_t/R) u(t − T) − (k_t k_e/R) q̇.
//!
//! Viscous friction of the joint and the back-EMF are one column: only their sum is determined by recordings of one kind.

use aurt_traits::{DriveInput, DriveTorque, Jet, drive_numbers};

use crate::drives::declare::drive;

drive_numbers! {
    /// A motor at a voltage with its back-EMF, τ = (k_t/R) u(t − T) − (k_t k_e/R) q̇; a PWM drive is one with u = duty ·
    /// supply.
    pub struct VoltageDrive {
        /// k_t/R: torque at rest per voltage.
        torque_nm_per_v: "Nm/V" = 1.0, 1.0, [1e-9, 1e9];
        /// k_t k_e/R: braking by the back-EMF.
        back_emf_nm_s_per_rad: "Nm s/rad" = 0.0, 1.0, [0.0, 1e9];
        /// T: delay of the command.
        delay_s: "s" = 0.0, 0.01, [0.0, 0.5];
    }
}

drive!(VoltageDrive, "voltage", Voltage, Linear, |_| Vec::new(), law);

fn law(p: &[Jet], input: &DriveInput<'_>, _: &mut [Jet]) -> DriveTorque {
    let driven = p[0] * (input.command)(-p[2] + input.time_s, input.step_s);
    DriveTorque { torque: driven - p[1] * input.velocity_rad_s, damping: p[1] }
}
