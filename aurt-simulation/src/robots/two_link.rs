use aurt_traits::MeasurementUnit;

use super::{Drive, Robot, bodies, row};

/// Two rods of 1 m that turn about parallel horizontal axes; torques in Nm.
///
/// The geometry is the two-link example of the AURT paper (Madsen et al., 2022). Bodies are uniform rods of
/// 5 and 3 kg, 60 mm thick; drives are of the size of a small robot's.
#[must_use]
pub fn two_link() -> Robot {
    let drive = |coulomb_nm, viscous_nm_s, rotor_inertia_kg_m2, torque_noise_nm, home_rad| Drive {
        gear_ratio: 100.0,
        rotor_inertia_kg_m2,
        torque_constant_nm_per_a: 10.0,
        coulomb_nm,
        viscous_nm_s,
        load_coefficient: 0.0,
        gear_stiffness_nm_rad: 2.0e4,
        position_limit_rad: [-3.0, 3.0],
        velocity_limit_rad_s: 3.0,
        acceleration_limit_rad_s2: 12.0,
        torque_limit_nm: 300.0,
        torque_rate_limit_nm_s: 2.0e4,
        home_rad,
        encoder_resolution_rad: 6.0e-6,
        encoder_noise_rad: 2.0e-6,
        torque_noise_nm,
    };
    Robot {
        name: "two_link".into(),
        mdh: vec![row(0.0, 0.0, 0.0), row(0.0, 1.0, 0.0)],
        gravity_m_s2: [0.0, -9.81, 0.0],
        links: bodies(&[
            [5.0, 0.5, 0.0, 0.0, 0.00225, 0.0, 0.0, 0.4178, 0.0, 0.4178],
            [3.0, 0.5, 0.0, 0.0, 0.00135, 0.0, 0.0, 0.2507, 0.0, 0.2507],
        ]),
        drives: vec![drive(6.0, 5.0, 0.8, 0.8, -1.2), drive(3.0, 2.5, 0.3, 0.4, 0.6)],
        unit: MeasurementUnit::NewtonMetre,
    }
}
