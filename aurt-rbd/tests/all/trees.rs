//! Trees: what holds of them beside the identities of all robots.

use crate::robots;

use aurt_rbd::{ChainDynamics, Dispatch, INERTIAL_PARAMETERS, Joint, Parent, Placement, SerialChain};
use aurt_traits::{Motion, MotionView, RegressorTile, RigidBodyRegressor};
use proptest::prelude::*;

/// The joints that carry a link as a chain of their own.
fn chain_to(tree: &SerialChain, link: usize) -> SerialChain {
    let alone = |joint: &usize| Joint { parent: Parent::Previous, ..tree.joints()[*joint] };
    SerialChain::new(tree.path(link).iter().map(alone).collect(), tree.gravity_m_s2()).unwrap()
}

fn motion_of(joints: &[usize], samples: usize, seed: u64) -> Motion {
    let series = |reach: f64, kind: u64| -> Vec<f64> {
        let value = |joint: usize, k: usize| {
            let number = (joint * 1000 + k) as u64 ^ seed.wrapping_mul(kind);
            let mixed = number
                .wrapping_mul(0x9E37_79B9_7F4A_7C15)
                .rotate_left(31)
                .wrapping_mul(0xD129_9C5D_6E1F_3A4B);
            reach * ((mixed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
        };
        joints.iter().flat_map(|joint| (0..samples).map(move |k| value(*joint, k))).collect()
    };
    Motion::new(joints.len(), vec![0.0; samples], series(4.0, 1), series(3.0, 3), series(10.0, 7)).unwrap()
}

/// The whole regressor on an instruction set: `[joint · 10 N + parameter]`, a column each.
fn columns(level: Dispatch, tree: &SerialChain, motion: MotionView<'_>) -> Vec<Vec<u64>> {
    let (joints, samples) = (tree.joints().len(), motion.samples());
    let entries = joints * joints * INERTIAL_PARAMETERS;
    let destination: Vec<u32> = (0..entries as u32).collect();
    let mut data = vec![0.0; entries * samples];
    let parameters = joints * INERTIAL_PARAMETERS;
    tree.evaluate_on(
        level,
        motion,
        &mut RegressorTile::new(&destination, parameters, samples, samples, &mut data),
    );
    data.chunks(samples).map(|column| column.iter().map(|v| v.to_bits()).collect()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// A link's columns have the bits that they have in the chain of the joints that carry it, and no other joint feels it.
    #[test]
    fn links_load_the_joints_that_carry_them(
        tree in robots::any_tree(),
        samples in 1_usize..40,
        seed in any::<u64>(),
    ) {
        let joints = tree.joints().len();
        let all: Vec<usize> = (0..joints).collect();
        let motion = motion_of(&all, samples, seed);
        for level in Dispatch::available() {
            let ours = columns(level, &tree, motion.view());
            for link in 0..joints {
                let (path, chain) = (tree.path(link), chain_to(&tree, link));
                let alone = columns(level, &chain, motion_of(path, samples, seed).view());
                for joint in 0..joints {
                    let place = path.iter().position(|carrier| *carrier == joint);
                    for entry in 0..INERTIAL_PARAMETERS {
                        let parameter = link * INERTIAL_PARAMETERS + entry;
                        let column = &ours[joint * joints * INERTIAL_PARAMETERS + parameter];
                        let Some(place) = place else {
                            prop_assert!(!tree.loads(parameter, joint));
                            prop_assert!(column.iter().all(|bits| *bits == 0));
                            continue;
                        };
                        let last = (path.len() - 1) * INERTIAL_PARAMETERS + entry;
                        prop_assert_eq!(tree.loads(parameter, joint), chain.loads(last, place));
                        prop_assert_eq!(column, &alone[place * path.len() * INERTIAL_PARAMETERS + last]);
                    }
                }
            }
        }
    }

    /// The torque kernel on every instruction set is Newton–Euler.
    #[test]
    fn torques_are_those_of_newton_euler((tree, standard, _) in robots::any_robot(), samples in 1_usize..40) {
        let joints = tree.joints().len();
        let all: Vec<usize> = (0..joints).collect();
        let motion = motion_of(&all, samples, 5);
        let view = motion.view();
        let mut dynamics = ChainDynamics::new(tree.clone(), &standard).unwrap();
        for level in Dispatch::available() {
            let mut torque = vec![f64::NAN; joints * samples];
            tree.torque_on(level, view, &standard, &mut torque, samples);
            for k in 0..samples {
                let at = |of: &dyn Fn(usize) -> f64| all.iter().map(|j| of(*j)).collect::<Vec<_>>();
                let mut expected = vec![0.0; joints];
                dynamics.inverse_dynamics(
                    &at(&|j| view.position_rad(j)[k]),
                    &at(&|j| view.velocity_rad_s(j)[k]),
                    &at(&|j| view.acceleration_rad_s2(j)[k]),
                    &mut expected,
                );
                let size = expected.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
                for (j, expected) in expected.iter().enumerate() {
                    let found = torque[j * samples + k];
                    prop_assert!((found - expected).abs() <= 1e-12 * size, "{level}: {found} {expected}");
                }
            }
        }
    }

    /// Robots that stand side by side on the base do not feel each other: their results have the bits that each has alone.
    #[test]
    fn branches_on_the_base_are_independent(
        (left, left_bodies, [ql, qdl, qddl]) in robots::any_robot(),
        (right, right_bodies, [qr, qdr, qddr]) in robots::any_robot(),
    ) {
        let (n, m) = (left.joints().len(), left.joints().len() + right.joints().len());
        let behind = |(j, joint): (usize, &Joint)| {
            let parent = joint.parent.of(j).map_or(Parent::Base, |link| Parent::Link(n + link));
            Joint { parent, ..*joint }
        };
        let right = right.under_gravity(left.gravity_m_s2());
        let joints = left.joints().iter().copied().chain(right.joints().iter().enumerate().map(behind));
        let tree = SerialChain::new(joints.collect(), left.gravity_m_s2()).unwrap();
        let (q, qd, qdd) = ([&ql[..], &qr].concat(), [&qdl[..], &qdr].concat(), [&qddl[..], &qddr].concat());
        let mut both = ChainDynamics::new(tree, &[&left_bodies[..], &right_bodies].concat()).unwrap();
        let parts = [(left, left_bodies, ql, qdl, qddl), (right, right_bodies, qr, qdr, qddr)];
        let (mut torque, mut acceleration, mut mass) = (vec![0.0; m], vec![0.0; m], vec![1.0; m * m]);
        both.inverse_dynamics(&q, &qd, &qdd, &mut torque);
        both.forward_dynamics(&q, &qd, &qdd, &mut acceleration);
        both.mass_matrix(&q, &mut mass);
        let mut first = 0;
        for (chain, bodies, q, qd, qdd) in &parts {
            let k = q.len();
            let mut alone = ChainDynamics::new(chain.clone(), bodies).unwrap();
            let (mut out, mut own) = (vec![0.0; k], vec![0.0; k * k]);
            alone.inverse_dynamics(q, qd, qdd, &mut out);
            prop_assert_eq!(&out, &torque[first..first + k]);
            alone.forward_dynamics(q, qd, qdd, &mut out);
            prop_assert_eq!(&out, &acceleration[first..first + k]);
            alone.mass_matrix(q, &mut own);
            for (row, own) in own.chunks(k).enumerate() {
                let row = &mass[(first + row) * m..(first + row + 1) * m];
                prop_assert_eq!(own, &row[first..first + k]);
                prop_assert!(row[..first].iter().chain(&row[first + k..]).all(|v| *v == 0.0));
            }
            first += k;
        }
    }
}

#[test]
fn a_chain_written_as_a_tree_is_that_chain_and_a_tree_is_saved_with_its_parents() {
    let at = |x: f64| Joint::revolute(Placement::from_roll_pitch_yaw([x, 0.1, 0.2], [0.3, x, 0.0]));
    let on = |parent: Parent, x: f64| Joint { parent, ..at(x) };
    let gravity = [0.0, 0.0, -9.81];
    let chain = SerialChain::new(vec![at(0.1), at(0.2), at(0.3)], gravity).unwrap();
    let named = [on(Parent::Base, 0.1), on(Parent::Link(0), 0.2), on(Parent::Link(1), 0.3)];
    assert_eq!(SerialChain::new(named.to_vec(), gravity).unwrap(), chain);
    assert!(chain.is_serial() && !serde_json::to_string(&chain).unwrap().contains("parent"));

    let joints = vec![at(0.1), at(0.2), on(Parent::Link(0), 0.3), on(Parent::Base, 0.4)];
    let tree = SerialChain::new(joints, gravity).unwrap();
    let parents: Vec<Option<usize>> = (0..4).map(|joint| tree.parent(joint)).collect();
    assert_eq!(parents, [None, Some(0), Some(0), None]);
    assert_eq!([tree.path(1), tree.path(2), tree.path(3)], [&[0, 1][..], &[0, 2], &[3]]);
    let text = serde_json::to_string(&tree).unwrap();
    assert!(text.contains(r#""parent":{"link":0}"#) && text.contains(r#""parent":"base""#), "{text}");
    assert_eq!(serde_json::from_str::<SerialChain>(&text).unwrap(), tree);
    let error = SerialChain::new(vec![at(0.1), on(Parent::Link(1), 0.2)], gravity).unwrap_err().to_string();
    assert_eq!(
        error,
        "joint 1: parent must be a link before it, is link 1; list the joints from the base on"
    );
}
