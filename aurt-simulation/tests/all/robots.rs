//! The simulated robots against Pinocchio, and whether they could be built.
//!
//! `reference/make_reference.py` wrote `reference/reference.json` and says how.

use std::collections::BTreeMap;

use aurt_rbd::ChainDynamics;
use aurt_simulation::{Robot, Rotors};
use serde::Deserialize;

#[derive(Deserialize)]
struct Document {
    robots: BTreeMap<String, Reference>,
}

#[derive(Deserialize)]
struct Reference {
    mdh: Vec<[f64; 3]>,
    gravity_m_s2: [f64; 3],
    rotor_inertia_kg_m2: Vec<f64>,
    standard_parameters: Vec<f64>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q_rad: Vec<f64>,
    qd_rad_s: Vec<f64>,
    qdd_rad_s2: Vec<f64>,
    torque_nm: Vec<f64>,
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
fn inertial_parameters_and_torques_are_pinocchios() {
    let document: Document = serde_json::from_str(include_str!("../reference/reference.json")).unwrap();
    assert_eq!(document.robots.len(), Robot::all().len());
    for robot in Robot::all() {
        let reference = &document.robots[&robot.name];
        let rows: Vec<f64> = robot.mdh.iter().flat_map(|r| [r.alpha_rad, r.a_m, r.d_m]).collect();
        assert_close(&format!("{}: geometry", robot.name), &rows, &reference.mdh.concat(), 1e-14);
        assert_eq!(robot.gravity_m_s2, reference.gravity_m_s2);
        let rotors: Vec<f64> = robot.drives.iter().map(|d| d.rotor_inertia_kg_m2).collect();
        assert_eq!(rotors, reference.rotor_inertia_kg_m2);
        let standard = robot.standard_parameters();
        assert_close(
            &format!("{}: parameters", robot.name),
            &standard,
            &reference.standard_parameters,
            1e-13,
        );
        let mut dynamics = ChainDynamics::new(robot.chain().unwrap(), &standard)
            .unwrap()
            .with_rotor_inertia(&rotors)
            .unwrap();
        for state in &reference.states {
            let mut torque = vec![0.0; robot.joints()];
            dynamics.inverse_dynamics(&state.q_rad, &state.qd_rad_s, &state.qdd_rad_s2, &mut torque);
            assert_close(&format!("{}: torque", robot.name), &torque, &state.torque_nm, 1e-12);
        }
    }
}

/// Positive masses, and inertia tensors about the centre of mass whose principal moments are those of a mass
/// distribution: positive, and none larger than the sum of the others.
#[test]
fn every_link_could_be_built() {
    for robot in Robot::all() {
        for built in [robot.clone(), robot.clone().with_rotors(Rotors::InLinks)] {
            for (k, link) in built.links.iter().enumerate() {
                assert!(link.mass_kg > 0.0, "{} link {k}", robot.name);
                let [xx, xy, xz, yy, yz, zz] = link.inertia_at_com_kg_m2;
                let tensor = nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
                let moments = tensor.symmetric_eigenvalues();
                let sum = moments.sum();
                for moment in &moments {
                    assert!(*moment > 0.0, "{} link {k}: {moments}", robot.name);
                    assert!(*moment <= sum - moment + 1e-12, "{} link {k}: {moments}", robot.name);
                }
            }
        }
    }
}
