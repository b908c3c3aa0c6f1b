use aurt_rbd::SerialChain;
use aurt_traits::{CommandSignal, DriveModel, DriveParameter, UNLIMITED, drive_numbers};
use serde::{Deserialize, Serialize};

use crate::drives::DriveError;

drive_numbers! {
    /// What a joint has beside its links and its drive. Friction is that of the model `stribeck` with `load = "absolute"` and
    /// of `polynomial` with the power 1,
    /// τ_F = (F_C + F_L |τ_J| + F_S e^(−(q̇/v_S)²)) sgn q̇ + F_v q̇ + F_A |q̇|, set-valued at rest; τ_J is the torque of gravity, of
    /// velocities and of the floor.
    pub struct Mechanics {
        /// Inertia of rotor and gear, at the joint, in kg m².
        rotor_inertia_kg_m2: "kg m^2" = 0.01, 0.02, [1e-7, 1e6];
        /// F_C in Nm.
        coulomb_nm: "Nm" = 0.0, 0.2, [0.0, 1e6];
        /// F_L.
        coulomb_per_load: "1" = 0.0, 0.3, [0.0, 5.0];
        /// F_S in Nm, what break-away exceeds sliding by.
        static_nm: "Nm" = 0.0, 0.1, [0.0, 1e6];
        /// v_S in rad/s.
        stribeck_velocity_rad_s: "rad/s" = 0.05, 0.05, [1e-3, 10.0];
        /// F_v in Nm s/rad.
        viscous_nm_s_per_rad: "Nm s/rad" = 0.0, 0.5, [0.0, 1e6];
        /// F_A in Nm s/rad, what F_v is larger forwards and smaller backwards.
        viscous_asymmetry_nm_s_per_rad: "Nm s/rad" = 0.0, 0.2, [-1e6, 1e6];
        /// A constant torque on the joint, in Nm.
        torque_offset_nm: "Nm" = 0.0, 0.1, [-1e6, 1e6];
        /// What the description's coordinate of the joint exceeds the recorded position by, in rad.
        position_offset_rad: "rad" = 0.0, 0.1, [-7.0, 7.0];
        /// Factor of mass, first moment and inertia of the joint's link against its description.
        mass_scale: "1" = 1.0, 0.2, [0.01, 100.0];
        /// The least position, where the joint meets its stop, in rad.
        lower_stop_rad: "rad" = -UNLIMITED, 0.5, [-UNLIMITED, UNLIMITED];
        /// The greatest position, in rad.
        upper_stop_rad: "rad" = UNLIMITED, 0.5, [-UNLIMITED, UNLIMITED];
    }
}

drive_numbers! {
    /// A horizontal surface under a point of the last link: an elastic normal force, Coulomb friction along the surface.
    pub struct Floor {
        /// Height of the surface in the base frame, against gravity, in m.
        height_m: "m" = 0.0, 0.02, [-10.0, 10.0];
        /// Force per depth in N/m.
        stiffness_n_per_m: "N/m" = 2000.0, 2000.0, [1.0, 1e7];
        /// Coefficient of friction.
        friction: "1" = 0.0, 0.3, [0.0, 2.0];
        /// The point in the frame of the last link, in m.
        x_m: "m" = 0.0, 0.02, [-10.0, 10.0];
        /// As `x_m`.
        y_m: "m" = 0.0, 0.02, [-10.0, 10.0];
        /// As `x_m`.
        z_m: "m" = 0.0, 0.02, [-10.0, 10.0];
    }
}

/// A joint with its drive.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivenJoint {
    /// From the command to the torque.
    pub drive: Box<dyn DriveModel>,
    /// Friction, rotor and stops.
    pub mechanics: Mechanics,
}

/// An arm with a drive at each joint: what is simulated from commands.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrivenArm {
    /// Geometry and gravity.
    pub chain: SerialChain,
    /// Ten standard parameters a link {XX XY XZ YY YZ ZZ mX mY mZ m}, of its description.
    pub standard_parameters: Vec<f64>,
    /// One for each joint, base first.
    pub joints: Vec<DrivenJoint>,
    /// The commands between two samples; linear in files that do not state it.
    #[serde(default)]
    pub command: CommandSignal,
    /// What the last link can touch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floor: Option<Floor>,
}

impl DrivenArm {
    /// Whether the parts fit each other and every number is within its bounds.
    ///
    /// # Errors
    /// Every complaint.
    pub fn validate(&self) -> Result<(), DriveError> {
        let joints = self.chain.joints().len();
        let counts = [
            ("drives", self.joints.len(), joints),
            ("standard parameters", self.standard_parameters.len(), 10 * joints),
        ];
        if let Some((what, found, expected)) =
            counts.into_iter().find(|(_, found, expected)| found != expected)
        {
            return Err(DriveError::Count { what, expected, found });
        }
        let outside = |(name, p): (String, DriveParameter)| {
            let ok = p.value >= p.bounds[0] && p.value <= p.bounds[1];
            (!ok).then_some(DriveError::Bounds { name, value: p.value, bounds: p.bounds })
        };
        let names = self.names();
        names.into_iter().zip(self.numbers()).find_map(outside).map_or(Ok(()), Err)
    }

    /// Every number of the arm: each joint's drive, then its mechanics; the floor last.
    pub fn numbers(&self) -> Vec<DriveParameter> {
        let of = |joint: &DrivenJoint| [joint.drive.parameters(), joint.mechanics.numbers()].concat();
        let floor = self.floor.iter().flat_map(Floor::numbers);
        self.joints.iter().flat_map(of).chain(floor).collect()
    }

    /// The names of [`Self::numbers`], with their joint: `delay_s_2`.
    pub fn names(&self) -> Vec<String> {
        let of = |(j, joint): (usize, &DrivenJoint)| {
            let numbers = [joint.drive.parameters(), joint.mechanics.numbers()].concat();
            numbers.into_iter().map(move |p| format!("{}_{j}", p.parameter.name)).collect::<Vec<_>>()
        };
        let floor =
            self.floor.iter().flat_map(|f| f.numbers()).map(|p| format!("floor_{}", p.parameter.name));
        self.joints.iter().enumerate().flat_map(of).chain(floor).collect()
    }

    /// Sets all numbers, in the order of [`Self::numbers`].
    pub fn set_numbers(&mut self, values: &[f64]) {
        let mut rest = values;
        for joint in &mut self.joints {
            let (own, behind) = rest.split_at(joint.drive.parameters().len().min(rest.len()));
            joint.drive.set_parameters(own);
            let (own, behind) = behind.split_at(joint.mechanics.numbers().len().min(behind.len()));
            joint.mechanics.set_numbers(own);
            rest = behind;
        }
        if let Some(floor) = &mut self.floor {
            floor.set_numbers(rest);
        }
    }
}
