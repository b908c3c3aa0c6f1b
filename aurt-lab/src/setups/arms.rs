//! Arms that nobody has built: random geometry, bodies and drives.

use std::f64::consts::FRAC_PI_2;

use aurt_rbd::{JointKind, LinkBody, MdhRow};
use aurt_simulation::{Drive, Random, Robot};
use aurt_traits::MeasurementUnit;

const GRAVITY_M_S2: f64 = 9.81;

/// An arm of four to seven joints, 0.3 to 1.2 m links, and drives that carry it.
pub fn arm(random: &mut Random) -> Robot {
    let joints = 4 + random.index(4);
    let size_m = random.between_logs(0.3, 1.2);
    let mdh: Vec<MdhRow> = (0..joints).map(|j| row(j, size_m, random)).collect();
    let mut mass_kg = random.between_logs(2.0, 15.0);
    let lighter = random.between(0.6, 0.85);
    let links: Vec<LinkBody> = mdh
        .iter()
        .map(|row| {
            mass_kg *= lighter;
            body(mass_kg, row, size_m, random)
        })
        .collect();
    let rub = random.between(0.04, 0.12);
    let drives = (0..joints).map(|j| drive(carried_nm(&links, &mdh, j), rub, random)).collect();
    Robot {
        name: "arm".into(),
        mdh,
        gravity_m_s2: [0.0, 0.0, -GRAVITY_M_S2],
        links,
        drives,
        unit: MeasurementUnit::NewtonMetre,
    }
}

fn row(joint: usize, size_m: f64, random: &mut Random) -> MdhRow {
    // A first joint that stands, then every second one parallel to its neighbour.
    let alpha_rad = if joint == 0 || random.chance(0.5) { random.sign() * FRAC_PI_2 } else { 0.0 };
    let reaches = random.chance(0.5);
    let mut length = |present: bool, most: f64| {
        let length = random.between(0.05, most) * size_m;
        if present { length } else { 0.0 }
    };
    let (a_m, d_m) = (length(reaches, 0.4), length(!reaches || joint == 0, 0.35));
    MdhRow { kind: JointKind::Revolute, alpha_rad, a_m, d_m, theta_offset_rad: 0.0, sign: 1.0 }
}

/// A box about half the way to the next joint.
fn body(mass_kg: f64, row: &MdhRow, size_m: f64, random: &mut Random) -> LinkBody {
    let mut beside = || random.between(-0.05, 0.05) * size_m;
    let com_m = [0.5 * row.a_m + beside(), beside(), 0.3 * row.d_m + beside()];
    let edges = [row.a_m.abs() + 0.1 * size_m, 0.12 * size_m, row.d_m.abs() + 0.1 * size_m];
    let [a, b, c] = edges.map(|edge| mass_kg * edge * edge / 12.0);
    LinkBody { mass_kg, com_m, inertia_at_com_kg_m2: [b + c, 0.0, 0.0, a + c, 0.0, a + b] }
}

fn carried_nm(links: &[LinkBody], mdh: &[MdhRow], joint: usize) -> f64 {
    let mut reach_m = 0.03;
    let mut torque_nm = 0.0;
    for (link, row) in links.iter().zip(mdh).skip(joint) {
        reach_m += 0.4 * (row.a_m.abs() + row.d_m.abs());
        torque_nm += link.mass_kg * GRAVITY_M_S2 * reach_m;
    }
    torque_nm
}

fn drive(carried_nm: f64, rub: f64, random: &mut Random) -> Drive {
    let half_rad = random.between(1.8, 3.0);
    let velocity_limit_rad_s = random.between(1.5, 3.0);
    Drive {
        gear_ratio: [50.0, 100.0, 101.0, 120.0][random.index(4)],
        rotor_inertia_kg_m2: 0.01 * carried_nm * random.between(0.5, 1.5),
        torque_constant_nm_per_a: random.between(5.0, 15.0),
        coulomb_nm: rub * carried_nm * random.between(0.7, 1.4),
        viscous_nm_s: rub * carried_nm * random.between(0.5, 1.5),
        load_coefficient: 0.0,
        gear_stiffness_nm_rad: 1e5,
        position_limit_rad: [-half_rad, half_rad],
        velocity_limit_rad_s,
        acceleration_limit_rad_s2: random.between(4.0, 12.0),
        torque_limit_nm: 20.0 + 8.0 * carried_nm,
        torque_rate_limit_nm_s: 1e3 * (20.0 + 8.0 * carried_nm),
        home_rad: random.between(-0.6, 0.6),
        encoder_resolution_rad: 6e-6,
        encoder_noise_rad: 2e-6,
        torque_noise_nm: 0.02 + 0.01 * carried_nm,
    }
}
