use std::f64::consts::FRAC_PI_2;

use aurt_traits::MeasurementUnit;

use super::{Drive, Robot, bodies, row};

/// A Franka Emika Panda, upright; seven joints, little friction, joint torques from its logger.
///
/// Geometry: the maker's (modified) DH parameters. Bodies: Gaz, Cognetti, Oliva, Robuffo Giordano and De Luca,
/// *Dynamic identification of the Franka Emika Panda robot with retrieval of feasible parameters* (RA-L 2019),
/// as collected in the `franka_description` package. Friction: the range of the same paper, 0.15–0.65 Nm on the
/// link side. Rotor inertia: order of magnitude of its motors behind a ratio of 100. Limits: data sheet.
#[must_use]
pub fn panda() -> Robot {
    let arm = Drive {
        gear_ratio: 100.0,
        rotor_inertia_kg_m2: 0.6,
        torque_constant_nm_per_a: 7.0,
        coulomb_nm: 0.55,
        viscous_nm_s: 0.6,
        load_coefficient: 0.0,
        gear_stiffness_nm_rad: 1.4e4,
        position_limit_rad: [-2.8, 2.8],
        velocity_limit_rad_s: 2.17,
        acceleration_limit_rad_s2: 7.5,
        torque_limit_nm: 87.0,
        torque_rate_limit_nm_s: 1.0e4,
        home_rad: 0.0,
        encoder_resolution_rad: 3.8e-6,
        encoder_noise_rad: 1.5e-6,
        torque_noise_nm: 0.15,
    };
    let wrist = Drive {
        rotor_inertia_kg_m2: 0.2,
        torque_constant_nm_per_a: 3.5,
        gear_stiffness_nm_rad: 9.0e3,
        velocity_limit_rad_s: 2.6,
        acceleration_limit_rad_s2: 10.0,
        torque_limit_nm: 12.0,
        torque_rate_limit_nm_s: 4.0e3,
        torque_noise_nm: 0.06,
        ..arm
    };
    Robot {
        name: "panda".into(),
        mdh: vec![
            row(-FRAC_PI_2, 0.0, 0.333),
            row(FRAC_PI_2, 0.0, 0.0),
            row(FRAC_PI_2, 0.0825, 0.316),
            row(-FRAC_PI_2, -0.0825, 0.0),
            row(FRAC_PI_2, 0.0, 0.384),
            row(FRAC_PI_2, 0.088, 0.0),
            row(0.0, 0.0, 0.107),
        ],
        gravity_m_s2: [0.0, 0.0, -9.81],
        links: bodies(&[
            [
                4.970684, 0.003875, 0.002081, -0.04762, 0.70337, -0.000139, 0.006772, 0.70661, 0.019169,
                0.009117,
            ],
            [
                0.646926, -0.003141, -0.02872, 0.003495, 0.007962, -0.003925, 0.010254, 0.02811, 0.000704,
                0.025995,
            ],
            [
                3.228604, 0.027518, 0.039252, -0.066502, 0.037242, -0.004761, -0.011396, 0.036155, -0.012805,
                0.01083,
            ],
            [
                3.587895, -0.05317, 0.104419, 0.027454, 0.025853, 0.007796, -0.001332, 0.019552, 0.008641,
                0.028323,
            ],
            [
                1.225946, -0.011953, 0.041065, -0.038437, 0.035549, -0.002117, -0.004037, 0.029474, 0.000229,
                0.008627,
            ],
            [
                1.666555, 0.060149, -0.014117, -0.010517, 0.001964, 0.000109, -0.001158, 0.004354, 0.000341,
                0.005433,
            ],
            [
                0.735522, 0.010517, -0.004252, 0.061597, 0.012516, -0.000428, -0.001196, 0.010027, -0.000741,
                0.004815,
            ],
        ]),
        drives: vec![
            arm,
            Drive { position_limit_rad: [-1.7, 1.7], home_rad: -0.4, torque_noise_nm: 0.2, ..arm },
            Drive {
                coulomb_nm: 0.4,
                viscous_nm_s: 0.45,
                rotor_inertia_kg_m2: 0.45,
                torque_noise_nm: 0.15,
                ..arm
            },
            Drive {
                coulomb_nm: 0.5,
                viscous_nm_s: 0.5,
                rotor_inertia_kg_m2: 0.45,
                position_limit_rad: [-3.0, -0.1],
                home_rad: -1.7,
                torque_noise_nm: 0.15,
                ..arm
            },
            Drive { coulomb_nm: 0.32, viscous_nm_s: 0.3, ..wrist },
            Drive {
                coulomb_nm: 0.25,
                viscous_nm_s: 0.22,
                position_limit_rad: [0.0, 3.7],
                home_rad: 1.7,
                ..wrist
            },
            Drive {
                coulomb_nm: 0.3,
                viscous_nm_s: 0.25,
                rotor_inertia_kg_m2: 0.15,
                home_rad: 0.6,
                torque_noise_nm: 0.035,
                ..wrist
            },
        ],
        unit: MeasurementUnit::NewtonMetre,
    }
}
