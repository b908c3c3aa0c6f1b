//! Robots whose geometry is public, as modified Denavit–Hartenberg tables in the `next` reading, and random
//! chains for property tests.

use aurt_rbd::{Joint, JointKind, LinkBody, MdhRows, MdhTable, Parent, Placement, SerialChain};
use proptest::prelude::*;

pub const TWO_LINK: &str = "alpha,a,d\n0,0,0\n0,1,0\n";
pub const UR5E: &str = "alpha,a,d
pi/2,0,0.1625
0,-0.425,0
0,-0.3922,0
pi/2,0,0.1333
-pi/2,0,0.0997
0,0,0.0996
";
pub const UR10E: &str = "alpha,a,d
pi/2,0,0.1807
0,-0.6127,0
0,-0.57155,0
pi/2,0,0.17415
-pi/2,0,0.11985
0,0,0.11655
";
pub const UR3E: &str = "alpha,a,d
pi/2,0,0.15185
0,-0.24335,0
0,-0.2132,0
pi/2,0,0.13105
-pi/2,0,0.08535
0,0,0.0921
";
pub const TX40: &str = "alpha,a,d
-pi/2,0,0.32
0,0.225,0
pi/2,0,0.035
-pi/2,0,0.225
pi/2,0,0
0,0,0
";
pub const PANDA: &str = "alpha,a,d
-pi/2,0,0.333
pi/2,0,0
pi/2,0.0825,0.316
-pi/2,-0.0825,0
pi/2,0,0.384
pi/2,0.088,0
0,0,0.107
";

pub const DOWN: [f64; 3] = [0.0, 0.0, -9.81];
/// Gravity of the UR5e of the AURT paper, whose base is tilted by 45°.
pub const TILTED: [f64; 3] = [0.0, 6.937, -6.937];

pub fn robot(mdh: &str, gravity_m_s2: [f64; 3]) -> SerialChain {
    let table = MdhTable::parse(mdh, "mdh.csv", MdhRows::Next).unwrap();
    SerialChain::from_mdh(&table, gravity_m_s2).unwrap()
}

/// A random rotation about a random axis.
fn rotation(axis: [f64; 3], angle: f64) -> [[f64; 3]; 3] {
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (s, c) = angle.sin_cos();
    let t = 1.0 - c;
    [
        [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
        [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
    ]
}

/// Any placement: a general one, or one of the right angles and zeros that real robots have.
fn placement() -> impl Strategy<Value = Placement> {
    let quarter = (-2_i32..=2).prop_map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2);
    let length = prop_oneof![Just(0.0), -0.8..0.8];
    prop_oneof![
        (prop_oneof![quarter, -3.2..3.2], length.clone(), length.clone())
            .prop_map(|(alpha_rad, a_m, d_m)| Placement::Mdh { alpha_rad, a_m, d_m }),
        ([0.1..1.0, -1.0..1.0, -1.0..1.0], -3.0..3.0, [length.clone(), length.clone(), length]).prop_map(
            |(axis, angle, translation_m)| Placement::Fixed {
                rotation: rotation(axis, angle),
                translation_m
            }
        ),
    ]
}

/// A chain or tree of 1 to 12 joints, every third prismatic, under any gravity.
pub fn any_tree() -> impl Strategy<Value = SerialChain> {
    let kind = prop_oneof![2 => Just(JointKind::Revolute), 1 => Just(JointKind::Prismatic)];
    let joint = (kind, placement(), prop_oneof![Just(0.0), -3.0..3.0], any::<bool>(), 0_usize..36).prop_map(
        |(kind, placement, theta_offset_rad, positive, parent)| {
            let sign = if positive { 1.0 } else { -1.0 };
            (Joint { kind, placement, theta_offset_rad, sign, ..Joint::revolute(placement) }, parent)
        },
    );
    let joints = prop::collection::vec(joint, 1..=12);
    // Most joints sit on the link before; one in three robots is a chain.
    (joints, 0..3, [-10.0..10.0, -10.0..10.0, -10.0..10.0]).prop_map(|(joints, shape, gravity)| {
        let on = |(j, (joint, parent)): (usize, (Joint, usize))| {
            let parent = match parent.checked_sub(12).map(|link| link % (j + 1)) {
                None => Parent::Previous,
                Some(_) if shape == 0 => Parent::Previous,
                Some(0) => Parent::Base,
                Some(link) => Parent::Link(link - 1),
            };
            Joint { parent, ..joint }
        };
        SerialChain::new(joints.into_iter().enumerate().map(on).collect(), gravity).unwrap()
    })
}

/// Standard parameters of a body of positive density: six point masses.
fn body() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((0.05..2.0, [-0.3..0.3, -0.3..0.3, -0.3..0.3]), 6).prop_map(|points| {
        let mut sum = vec![0.0; 10];
        for (mass_kg, com_m) in points {
            let point = LinkBody { mass_kg, com_m, inertia_at_com_kg_m2: [1e-3, 0.0, 0.0, 1e-3, 0.0, 1e-3] };
            for (s, v) in sum.iter_mut().zip(point.standard_parameters()) {
                *s += v;
            }
        }
        sum
    })
}

/// A chain or tree with bodies, and a state: positions, velocities, accelerations.
pub fn any_robot() -> impl Strategy<Value = (SerialChain, Vec<f64>, [Vec<f64>; 3])> {
    any_tree().prop_flat_map(|chain| {
        let n = chain.joints().len();
        let bodies = prop::collection::vec(body(), n).prop_map(|b| b.concat());
        let state = [
            prop::collection::vec(-4.0..4.0, n),
            prop::collection::vec(-3.0..3.0, n),
            prop::collection::vec(-10.0..10.0, n),
        ];
        (Just(chain), bodies, state)
    })
}
