use std::f64::consts::FRAC_PI_2;

use aurt_traits::MeasurementUnit;

use super::{Drive, Robot, bodies, row};

/// A Stäubli TX40: light, fast, stiff gears of low ratio, dominant friction; its logger writes joint torques.
///
/// Geometry: the MDH table of the public figaroh example. Friction and rotor inertia: rounded from the tables
/// of Gautier, Janot and Vandanjon (2013) and Janot et al. (2014). The masses sum to the moving part of the
/// 27 kg arm; link shapes are capsules along the link. Noise: the level
/// of the public recording's torques above 60 Hz. Limits: data sheet, the acceleration that of the
/// published exciting motions.
#[must_use]
pub fn tx40() -> Robot {
    let base = Drive {
        gear_ratio: 32.0,
        rotor_inertia_kg_m2: 0.34,
        torque_constant_nm_per_a: 9.0,
        coulomb_nm: 6.9,
        viscous_nm_s: 8.0,
        load_coefficient: 0.0,
        gear_stiffness_nm_rad: 3.0e4,
        position_limit_rad: [-3.1, 3.1],
        velocity_limit_rad_s: 5.0,
        acceleration_limit_rad_s2: 30.0,
        torque_limit_nm: 160.0,
        torque_rate_limit_nm_s: 4.0e4,
        home_rad: 0.0,
        encoder_resolution_rad: 1.5e-6,
        encoder_noise_rad: 1.5e-6,
        torque_noise_nm: 3.0,
    };
    let wrist = Drive {
        gear_ratio: 45.0,
        rotor_inertia_kg_m2: 0.0435,
        torque_constant_nm_per_a: 4.5,
        coulomb_nm: 2.9,
        viscous_nm_s: 1.85,
        gear_stiffness_nm_rad: 4.0e3,
        velocity_limit_rad_s: 7.0,
        acceleration_limit_rad_s2: 60.0,
        torque_limit_nm: 30.0,
        torque_rate_limit_nm_s: 1.0e4,
        torque_noise_nm: 0.4,
        ..base
    };
    Robot {
        name: "tx40".into(),
        mdh: vec![
            row(-FRAC_PI_2, 0.0, 0.32),
            row(0.0, 0.225, 0.0),
            row(FRAC_PI_2, 0.0, 0.035),
            row(-FRAC_PI_2, 0.0, 0.225),
            row(FRAC_PI_2, 0.0, 0.0),
            row(0.0, 0.0, 0.0),
        ],
        gravity_m_s2: [0.0, 0.0, -9.81],
        links: bodies(&[
            [6.6, 0.01, 0.03, -0.07, 0.040, 0.001, 0.0, 0.038, 0.002, 0.022],
            [5.2, 0.095, 0.0, 0.11, 0.014, 0.0, -0.003, 0.046, 0.0, 0.044],
            [4.4, 0.004, -0.055, 0.012, 0.022, 0.0005, 0.0, 0.012, 0.001, 0.021],
            [2.3, 0.0, 0.004, -0.085, 0.0095, 0.0, 0.0, 0.0094, 0.0003, 0.0026],
            [0.75, 0.0, -0.006, 0.004, 0.0011, 0.0, 0.0, 0.0008, 0.0, 0.0010],
            [0.25, 0.001, 0.0, 0.055, 0.00016, 0.0, 0.0, 0.00016, 0.0, 0.00012],
        ]),
        drives: vec![
            base,
            Drive {
                rotor_inertia_kg_m2: 0.36,
                coulomb_nm: 7.9,
                viscous_nm_s: 5.6,
                position_limit_rad: [-2.1, 2.1],
                home_rad: -0.5,
                torque_noise_nm: 2.6,
                ..base
            },
            Drive {
                rotor_inertia_kg_m2: 0.089,
                coulomb_nm: 6.4,
                viscous_nm_s: 2.0,
                gear_stiffness_nm_rad: 1.5e4,
                position_limit_rad: [-2.4, 2.4],
                home_rad: 1.2,
                torque_limit_nm: 90.0,
                torque_noise_nm: 1.1,
                ..base
            },
            Drive { rotor_inertia_kg_m2: 0.0315, coulomb_nm: 2.4, viscous_nm_s: 1.15, ..wrist },
            Drive { position_limit_rad: [-2.0, 2.3], home_rad: 0.4, ..wrist },
            Drive {
                gear_ratio: 32.0,
                rotor_inertia_kg_m2: 0.0105,
                coulomb_nm: 1.9,
                viscous_nm_s: 0.65,
                gear_stiffness_nm_rad: 2.5e3,
                torque_limit_nm: 15.0,
                torque_noise_nm: 0.25,
                ..wrist
            },
        ],
        unit: MeasurementUnit::NewtonMetre,
    }
}
