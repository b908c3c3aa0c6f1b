use std::f64::consts::FRAC_PI_2;

use aurt_traits::MeasurementUnit;

use super::{Drive, Robot, bodies, row};

/// A Universal Robots UR5e on a slanted base (gravity 0, 6.937, −6.937 m/s² as in the AURT paper); its logger
/// writes motor currents.
///
/// Geometry: the maker's DH parameters. Masses, centres of mass and inertia: the maker's article
/// *DH parameters for calculations of kinematics and dynamics* and the tensors of its ROS description, turned
/// from the distal frames given there into the frames used here. Friction, rotor inertia and torque
/// constants: half to two thirds of the UR10's, which Madsen et al. (2022) and Raviola et al. (2021) report
/// for the smaller arm; shoulder and elbow rub more under load. Limits: data sheet.
#[must_use]
pub fn ur5e() -> Robot {
    let size_3 = Drive {
        gear_ratio: 101.0,
        rotor_inertia_kg_m2: 0.75,
        torque_constant_nm_per_a: 11.3,
        coulomb_nm: 6.2,
        viscous_nm_s: 7.6,
        load_coefficient: 0.0,
        gear_stiffness_nm_rad: 2.6e4,
        position_limit_rad: [-6.25, 6.25],
        velocity_limit_rad_s: 3.1,
        acceleration_limit_rad_s2: 14.0,
        torque_limit_nm: 150.0,
        torque_rate_limit_nm_s: 1.5e4,
        home_rad: 0.0,
        encoder_resolution_rad: 6.0e-6,
        encoder_noise_rad: 2.0e-6,
        torque_noise_nm: 0.9,
    };
    let size_1 = Drive {
        rotor_inertia_kg_m2: 0.12,
        torque_constant_nm_per_a: 9.2,
        coulomb_nm: 1.6,
        viscous_nm_s: 1.7,
        gear_stiffness_nm_rad: 6.5e3,
        acceleration_limit_rad_s2: 20.0,
        torque_limit_nm: 28.0,
        torque_rate_limit_nm_s: 4.0e3,
        torque_noise_nm: 0.19,
        ..size_3
    };
    Robot {
        name: "ur5e".into(),
        mdh: vec![
            row(FRAC_PI_2, 0.0, 0.1625),
            row(0.0, -0.425, 0.0),
            row(0.0, -0.3922, 0.0),
            row(FRAC_PI_2, 0.0, 0.1333),
            row(-FRAC_PI_2, 0.0, 0.0997),
            row(0.0, 0.0, 0.0996),
        ],
        gravity_m_s2: [0.0, 6.937, -6.937],
        links: bodies(&[
            [
                3.761,
                0.0,
                -0.00193,
                -0.02561,
                0.0070021,
                1.053e-5,
                7.3e-7,
                0.00657286,
                -0.00049994,
                0.00648091,
            ],
            [8.058, -0.2125, 0.0, 0.11336, 0.0150589, -5.4e-5, 5.63e-6, 0.333881, -1.81e-6, 0.332472],
            [2.846, -0.2422, 0.0, 0.0265, 0.00399632, -1.365e-5, 0.00137272, 0.0787925, -6.6e-6, 0.0784851],
            [
                1.37,
                0.0,
                -0.01634,
                -0.0018,
                0.00165491,
                4.38e-6,
                -2.82e-6,
                0.00126279,
                -0.00010157,
                0.00135962,
            ],
            [1.3, 0.0, 0.01634, -0.0018, 0.00135617, 4.44e-6, 2.74e-6, 0.00096614, 5.048e-5, 0.00127827],
            [0.365, 0.0, 0.0, -0.001159, 0.00018694, 6.0e-8, -1.7e-7, 0.00018908, -9.2e-7, 0.00025756],
        ]),
        drives: vec![
            size_3,
            Drive {
                coulomb_nm: 7.1,
                viscous_nm_s: 7.9,
                load_coefficient: 0.08,
                home_rad: -1.5,
                torque_noise_nm: 1.0,
                ..size_3
            },
            Drive {
                rotor_inertia_kg_m2: 0.6,
                coulomb_nm: 4.9,
                viscous_nm_s: 5.4,
                load_coefficient: 0.07,
                position_limit_rad: [-3.0, 3.0],
                home_rad: 0.7,
                torque_noise_nm: 0.8,
                ..size_3
            },
            Drive { home_rad: -1.2, ..size_1 },
            Drive { coulomb_nm: 1.9, viscous_nm_s: 1.9, home_rad: 0.4, ..size_1 },
            Drive { coulomb_nm: 1.4, viscous_nm_s: 1.5, ..size_1 },
        ],
        unit: MeasurementUnit::Ampere,
    }
}
