//! Torques, regressors, mass matrices, accelerations, energies and Jacobians against Pinocchio 4.1.
//!
//! `reference/make_reference.py` wrote `reference/reference.json` and says how the robots are built there.

use aurt_rbd::{ChainDynamics, Dispatch, JointKind, MdhRow, MdhRows, MdhTable, SerialChain};
use aurt_traits::{Motion, RegressorTile};
use serde::Deserialize;

#[derive(Deserialize)]
struct Document {
    robots: std::collections::BTreeMap<String, Robot>,
}

#[derive(Deserialize)]
struct Robot {
    mdh: Vec<[f64; 3]>,
    gravity_m_s2: [f64; 3],
    standard_parameters: Vec<f64>,
    rotor_inertia_kg_m2: Vec<f64>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q_rad: Vec<f64>,
    qd_rad_s: Vec<f64>,
    qdd_rad_s2: Vec<f64>,
    torque_nm: Vec<f64>,
    regressor: Vec<f64>,
    applied_torque_nm: Vec<f64>,
    mass_matrix_kg_m2: Vec<f64>,
    bias_torque_nm: Vec<f64>,
    forward_dynamics_rad_s2: Vec<f64>,
    kinetic_energy_j: f64,
    potential_energy_j: f64,
    point_m: [f64; 3],
    point_in_base_m: [f64; 3],
    jacobian: Vec<f64>,
}

fn robots() -> Vec<(String, Robot, SerialChain)> {
    let document: Document = serde_json::from_str(include_str!("../reference/reference.json")).unwrap();
    let with_chain = |(name, robot): (String, Robot)| {
        let row = |&[alpha_rad, a_m, d_m]: &[f64; 3]| MdhRow {
            kind: JointKind::Revolute,
            alpha_rad,
            a_m,
            d_m,
            theta_offset_rad: 0.0,
            sign: 1.0,
        };
        let table = MdhTable { rows: robot.mdh.iter().map(row).collect(), reading: MdhRows::Next };
        let chain = SerialChain::from_mdh(&table, robot.gravity_m_s2).unwrap();
        (name, robot, chain)
    };
    document.robots.into_iter().map(with_chain).collect()
}

/// Agreement to `tolerance` relative to the largest entry.
fn assert_close(what: &str, ours: &[f64], theirs: &[f64], tolerance: f64) {
    assert_eq!(ours.len(), theirs.len(), "{what}");
    let size = theirs.iter().fold(1e-3, |m: f64, v| m.max(v.abs()));
    for (i, (a, b)) in ours.iter().zip(theirs).enumerate() {
        assert!((a - b).abs() <= tolerance * size, "{what}, entry {i}: {a} and {b}");
    }
}

#[test]
fn there_are_all_robots() {
    let names: Vec<String> = robots().into_iter().map(|(name, ..)| name).collect();
    assert_eq!(names, ["panda", "two_link", "tx40", "ur10e", "ur5e"]);
}

#[test]
fn dynamics() {
    for (name, robot, chain) in robots() {
        let n = robot.mdh.len();
        let mut plain = ChainDynamics::new(chain.clone(), &robot.standard_parameters).unwrap();
        let mut with_rotors = plain.clone().with_rotor_inertia(&robot.rotor_inertia_kg_m2).unwrap();
        for state in &robot.states {
            let State { q_rad: q, qd_rad_s: qd, .. } = state;
            let mut out = vec![0.0; n];
            plain.inverse_dynamics(q, qd, &state.qdd_rad_s2, &mut out);
            assert_close(&format!("{name}: torque"), &out, &state.torque_nm, 1e-12);
            with_rotors.bias_torque(q, qd, &mut out);
            assert_close(&format!("{name}: bias torque"), &out, &state.bias_torque_nm, 1e-12);
            with_rotors.forward_dynamics(q, qd, &state.applied_torque_nm, &mut out);
            assert_close(&format!("{name}: acceleration"), &out, &state.forward_dynamics_rad_s2, 1e-11);
            let mut mass = vec![0.0; n * n];
            with_rotors.mass_matrix(q, &mut mass);
            assert_close(&format!("{name}: mass matrix"), &mass, &state.mass_matrix_kg_m2, 1e-12);
            let energy = with_rotors.energy(q, qd);
            assert_close(&format!("{name}: kinetic"), &[energy.kinetic_j], &[state.kinetic_energy_j], 1e-12);
            let potential = [energy.potential_j];
            assert_close(&format!("{name}: potential"), &potential, &[state.potential_energy_j], 1e-12);

            let mut frames = Vec::new();
            chain.link_frames(q, &mut frames);
            let point = frames[n - 1].point_m(state.point_m);
            assert_close(&format!("{name}: point"), &point, &state.point_in_base_m, 1e-12);
            let mut jacobian = vec![0.0; 6 * n];
            chain.jacobian(&frames, n - 1, state.point_m, &mut jacobian);
            assert_close(&format!("{name}: Jacobian"), &jacobian, &state.jacobian, 1e-12);
        }
    }
}

#[test]
fn regressor_at_every_dispatch_level() {
    for (name, robot, chain) in robots() {
        let n = robot.mdh.len();
        let by_joint = |series: fn(&State) -> &[f64]| -> Vec<f64> {
            (0..n).flat_map(|j| robot.states.iter().map(move |s| series(s)[j])).collect()
        };
        let samples = robot.states.len();
        let motion = Motion::new(
            n,
            vec![0.0; samples],
            by_joint(|s| &s.q_rad),
            by_joint(|s| &s.qd_rad_s),
            by_joint(|s| &s.qdd_rad_s2),
        )
        .unwrap();
        let entries = n * 10 * n;
        let destination: Vec<u32> = (0..entries as u32).collect();
        for level in Dispatch::available() {
            let mut data = vec![0.0; entries * samples];
            let mut tile = RegressorTile::new(&destination, 10 * n, samples, samples, &mut data);
            chain.evaluate_on(level, motion.view(), &mut tile);
            for (s, state) in robot.states.iter().enumerate() {
                let ours: Vec<f64> = (0..entries).map(|entry| data[entry * samples + s]).collect();
                assert_close(&format!("{name}: regressor on {level}"), &ours, &state.regressor, 1e-12);
            }
        }
    }
}
