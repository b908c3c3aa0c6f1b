//! Descriptions as tables of modified Denavit–Hartenberg parameters: the same axes at every posture.

use aurt_rbd::robots::{DescribedRobot, KNOWN_ROBOTS};
use aurt_rbd::{LinkFrame, MdhRows, MdhTable, RobotDescription, SerialChain, base_parameters};
use nalgebra::Vector3;

use crate::parse;

fn robots() -> Vec<DescribedRobot> {
    let arm = parse(include_str!("reference/arm.xml"), "arm.xml", None, Some("tool")).unwrap();
    let gantry = parse(include_str!("reference/gantry.urdf"), "gantry.urdf", None, Some("wrist")).unwrap();
    let known = KNOWN_ROBOTS.iter().map(|robot| robot.description());
    [arm, gantry].into_iter().chain(known).collect()
}

fn axes(chain: &SerialChain, q: &[f64]) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let mut frames: Vec<LinkFrame> = Vec::new();
    chain.link_frames(q, &mut frames);
    let z = |f: &LinkFrame| Vector3::new(f.rotation[0][2], f.rotation[1][2], f.rotation[2][2]);
    frames.iter().map(|f| (Vector3::from(f.origin_m), z(f))).collect()
}

/// How two axes lie: their angle's cosine, and their moment, which is their distance times the angle's sine.
fn relation(a: &(Vector3<f64>, Vector3<f64>), b: &(Vector3<f64>, Vector3<f64>)) -> [f64; 2] {
    [a.1.dot(&b.1), (b.0 - a.0).dot(&a.1.cross(&b.1))]
}

#[test]
fn the_axes_lie_alike_at_every_posture_and_gravity_is_the_same() {
    let gravity = [0.4, -0.9, -9.7];
    for robot in robots() {
        let table = robot.as_mdh(gravity).unwrap();
        let ours = MdhTable { rows: table.rows.clone(), reading: MdhRows::Next }.joints();
        let ours = SerialChain::new(ours, table.gravity_m_s2).unwrap();
        let theirs = robot.chain(gravity).unwrap();
        for k in 0..10 {
            let q: Vec<f64> = (0..robot.joints.len()).map(|j| (1.3 * (k * 7 + 3 * j) as f64).sin()).collect();
            let (a, b) = (axes(&ours, &q), axes(&theirs, &q));
            for i in 0..a.len() {
                for j in 0..i {
                    let (x, y) = (relation(&a[i], &a[j]), relation(&b[i], &b[j]));
                    let off = (x[0] - y[0]).abs().max((x[1] - y[1]).abs());
                    assert!(off < 1e-12, "{}: axes {j} and {i} at {q:?}: {x:?} and {y:?}", robot.name);
                }
                let g = |v: [f64; 3], z: &Vector3<f64>| Vector3::from(v).dot(z);
                let (mine, other) = (g(table.gravity_m_s2, &a[i].1), g(gravity, &b[i].1));
                assert!((mine - other).abs() < 1e-12, "{}: gravity along axis {i}", robot.name);
            }
        }
        let base = |chain: &SerialChain| base_parameters(chain, 0).unwrap().len();
        assert_eq!(base(&ours), base(&theirs), "{}", robot.name);
    }
}

#[test]
fn the_table_of_a_ur10e_is_the_makers() {
    let robot = KNOWN_ROBOTS.iter().find(|r| r.name == "ur10e").unwrap().description();
    let rows = robot.as_mdh([0.0, 0.0, -9.81]).unwrap().rows;
    let lengths: Vec<[f64; 2]> = rows.iter().map(|r| [r.a_m.abs(), r.d_m.abs()]).collect();
    for (found, expected) in lengths[1..3].iter().zip([0.6127, 0.57155]) {
        assert!((found[0] - expected).abs() < 1e-9, "{lengths:?}");
    }
}
