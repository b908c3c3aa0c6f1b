use std::f64::consts::FRAC_PI_2;

use aurt_traits::MeasurementUnit;

use super::{Drive, Robot, bodies, row};

/// A Universal Robots UR10e, upright; its logger writes motor currents.
///
/// Geometry: the maker's DH parameters. Masses, centres of mass and inertia: the maker's article
/// *DH parameters for calculations of kinematics and dynamics*, turned from the distal frames given there into
/// the frames used here; the last link's tensor, which is given as (0, 0.0004, 0.0003) and belongs to no body,
/// is a short cylinder's here. Torque constants: desired torque over desired current at rest on the public
/// recordings of Mamedov and Mikhel (2020). Friction: within 3–17 Nm and 2.6–14 Nm s, as fitted to these; noise: the level of their currents between 30 and 45 Hz.
///
/// Limits: data sheet.
#[must_use]
pub fn ur10e() -> Robot {
    let size_4 = Drive {
        gear_ratio: 101.0,
        rotor_inertia_kg_m2: 0.95,
        torque_constant_nm_per_a: 11.976,
        coulomb_nm: 12.0,
        viscous_nm_s: 13.5,
        load_coefficient: 0.0,
        gear_stiffness_nm_rad: 4.5e4,
        position_limit_rad: [-6.25, 6.25],
        velocity_limit_rad_s: 2.09,
        acceleration_limit_rad_s2: 10.0,
        torque_limit_nm: 330.0,
        torque_rate_limit_nm_s: 3.0e4,
        home_rad: 0.0,
        encoder_resolution_rad: 6.0e-6,
        encoder_noise_rad: 2.0e-6,
        torque_noise_nm: 1.6,
    };
    let size_2 = Drive {
        rotor_inertia_kg_m2: 0.22,
        torque_constant_nm_per_a: 10.763,
        coulomb_nm: 3.6,
        viscous_nm_s: 3.2,
        gear_stiffness_nm_rad: 1.1e4,
        velocity_limit_rad_s: 3.1,
        acceleration_limit_rad_s2: 18.0,
        torque_limit_nm: 56.0,
        torque_rate_limit_nm_s: 8.0e3,
        torque_noise_nm: 0.32,
        ..size_4
    };
    Robot {
        name: "ur10e".into(),
        mdh: vec![
            row(FRAC_PI_2, 0.0, 0.1807),
            row(0.0, -0.6127, 0.0),
            row(0.0, -0.57155, 0.0),
            row(FRAC_PI_2, 0.0, 0.17415),
            row(-FRAC_PI_2, 0.0, 0.11985),
            row(0.0, 0.0, 0.11655),
        ],
        gravity_m_s2: [0.0, 0.0, -9.81],
        links: bodies(&[
            [7.369, 0.021, -0.027, 0.0, 0.0341, 0.0043, 0.0, 0.0216, -0.0001, 0.0353],
            [13.051, -0.2327, 0.0, 0.158, 0.0281, 0.0001, -0.0156, 0.7707, 0.0, 0.7694],
            [3.989, -0.33155, 0.0, 0.068, 0.0101, 0.0001, 0.0092, 0.3093, 0.0, 0.3065],
            [2.1, 0.0, -0.018, 0.007, 0.003, 0.0, 0.0, 0.0026, 0.0002, 0.0022],
            [1.98, 0.0, 0.018, -0.007, 0.003, 0.0, 0.0, 0.0026, 0.0002, 0.0022],
            [0.615, 0.0, 0.0, -0.026, 0.0004, 0.0, 0.0, 0.0004, 0.0, 0.0003],
        ]),
        drives: vec![
            size_4,
            Drive { coulomb_nm: 14.0, viscous_nm_s: 13.0, home_rad: -1.55, torque_noise_nm: 1.9, ..size_4 },
            Drive {
                rotor_inertia_kg_m2: 0.7,
                torque_constant_nm_per_a: 9.839,
                coulomb_nm: 8.5,
                viscous_nm_s: 8.5,
                position_limit_rad: [-3.0, 3.0],
                velocity_limit_rad_s: 3.1,
                torque_limit_nm: 150.0,
                torque_rate_limit_nm_s: 1.5e4,
                home_rad: 0.5,
                torque_noise_nm: 1.1,
                ..size_4
            },
            Drive { home_rad: -1.5, ..size_2 },
            Drive { coulomb_nm: 4.1, viscous_nm_s: 3.4, home_rad: 0.3, ..size_2 },
            Drive { coulomb_nm: 3.1, viscous_nm_s: 2.6, ..size_2 },
        ],
        unit: MeasurementUnit::Ampere,
    }
}
