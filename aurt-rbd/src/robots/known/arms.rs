//! Geometry and limits of known robots, with the source of each.
//!
//! Where a source gives limits in rad, they stand here in degrees to its digits.

use super::JointNames::{self, Numbered};
use super::{KnownJoint, KnownRobot};

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];
const MINUS_X: [f64; 3] = [-1.0, 0.0, 0.0];
const MINUS_Z: [f64; 3] = [0.0, 0.0, -1.0];
/// Degrees of a radian, for limits that are published in rad.
const RAD: f64 = 180.0 / std::f64::consts::PI;

/// A joint: origin, quarters of roll, pitch and yaw, axis; limits.
const fn joint(
    origin_m: [f64; 3],
    quarters: [f64; 3],
    axis: [f64; 3],
    (low, high, velocity_deg_s, torque_nm): (f64, f64, f64, Option<f64>),
) -> KnownJoint {
    // Joints that turn without end have no room between their limits.
    let position_deg = if low < high { Some([low, high]) } else { None };
    KnownJoint { origin_m, quarters, axis, position_deg, velocity_deg_s, torque_nm }
}

/// A joint by modified Denavit–Hartenberg parameters: the twist α in quarters of a turn (−1, 0 or 1), a and d in m.
const fn mdh(alpha: f64, a_m: f64, d_m: f64, limits: (f64, f64, f64, Option<f64>)) -> KnownJoint {
    joint([a_m, -d_m * alpha, d_m * (1.0 - alpha * alpha)], [alpha, 0.0, 0.0], Z, limits)
}

/// A joint of a Universal Robots arm: twist, length and offset; speed in °/s and torque in Nm. All turn by ±360°.
const fn ur(alpha: f64, a_m: f64, d_m: f64, velocity: f64, torque: f64) -> KnownJoint {
    mdh(alpha, a_m, d_m, (-360.0, 360.0, velocity, Some(torque)))
}

/// A joint of a Franka arm: twist, length and offset; limits in rad and rad/s, torque in Nm.
const fn franka(alpha: f64, a_m: f64, d_m: f64, [low, high, velocity, torque]: [f64; 4]) -> KnownJoint {
    mdh(alpha, a_m, d_m, (low * RAD, high * RAD, velocity * RAD, Some(torque)))
}

/// A joint of a Gen3: origin, quarters of roll; limit to either side in rad, 0 if it turns without end, and torque in Nm.
const fn gen3(origin_m: [f64; 3], roll: f64, limit: f64, torque: f64) -> KnownJoint {
    joint(origin_m, [roll, 0.0, 0.0], Z, (-limit * RAD, limit * RAD, 0.8727 * RAD, Some(torque)))
}

/// A joint of an xArm: origin, quarters of roll; limits in rad, torque in Nm. All turn at up to 180 °/s.
const fn xarm(origin_m: [f64; 3], roll: f64, [low, high, torque]: [f64; 3]) -> KnownJoint {
    joint(origin_m, [roll, 0.0, 0.0], Z, (low * RAD, high * RAD, 180.0, Some(torque)))
}

const UR_SOURCE: &str = "Universal Robots, DH parameters for calculations of kinematics and dynamics; user manuals, joint \
                         ranges and speeds; Max. joint torques";
/// As the description that the maker publishes names them.
const UR_NAMES: JointNames = JointNames::Each(&[
    "shoulder_pan_joint",
    "shoulder_lift_joint",
    "elbow_joint",
    "wrist_1_joint",
    "wrist_2_joint",
    "wrist_3_joint",
]);
const TURN: f64 = 2.0 * std::f64::consts::PI;

/// All known robots, by name.
pub const KNOWN_ROBOTS: [KnownRobot; 13] = [
    KnownRobot {
        name: "fr3",
        title: "Franka Research 3",
        source: "Franka Robotics, FCI documentation, robot specifications: Denavit-Hartenberg parameters and limits of FR3; \
                 limits as in franka_ros, fr3/joint_limits.yaml",
        joint_names: Numbered("fr3_joint"),
        joints: &[
            franka(0.0, 0.0, 0.333, [-2.3093, 2.3093, 2.0, 87.0]),
            franka(-1.0, 0.0, 0.0, [-1.5133, 1.5133, 1.0, 87.0]),
            franka(1.0, 0.0, 0.316, [-2.4937, 2.4937, 1.5, 87.0]),
            franka(1.0, 0.0825, 0.0, [-2.7478, -0.4461, 1.25, 87.0]),
            franka(-1.0, -0.0825, 0.384, [-2.48, 2.48, 3.0, 12.0]),
            franka(1.0, 0.0, 0.0, [0.8521, 4.2094, 1.5, 12.0]),
            franka(1.0, 0.088, 0.0, [-2.6895, 2.6895, 3.0, 12.0]),
        ],
    },
    KnownRobot {
        name: "gen3",
        title: "Kinova Gen3, 7 joints",
        source: "Kinova, ros_kortex, GEN3_URDF_V12.urdf (frames and limits of the Gen3 user guide)",
        joint_names: Numbered("joint_"),
        joints: &[
            gen3([0.0, 0.0, 0.15643], 2.0, 0.0, 39.0),
            gen3([0.0, 0.005375, -0.12838], 1.0, 2.41, 39.0),
            gen3([0.0, -0.21038, -0.006375], -1.0, 0.0, 39.0),
            gen3([0.0, 0.006375, -0.21038], 1.0, 2.66, 39.0),
            gen3([0.0, -0.20843, -0.006375], -1.0, 0.0, 9.0),
            gen3([0.0, 0.000_175_05, -0.10593], 1.0, 2.23, 9.0),
            gen3([0.0, -0.10593, -0.000_175_05], -1.0, 0.0, 9.0),
        ],
    },
    KnownRobot {
        name: "iiwa14",
        title: "KUKA LBR iiwa 14 R820",
        source: "KUKA, LBR iiwa 7 R800, LBR iiwa 14 R820 specification (axis data); frames as in iiwa_stack, iiwa14.xacro",
        joint_names: Numbered("iiwa_joint_"),
        joints: &[
            joint([0.0, 0.0, 0.1575], [0.0, 0.0, 0.0], Z, (-170.0, 170.0, 85.0, Some(320.0))),
            joint([0.0, 0.0, 0.2025], [1.0, 0.0, 2.0], Z, (-120.0, 120.0, 85.0, Some(320.0))),
            joint([0.0, 0.2045, 0.0], [1.0, 0.0, 2.0], Z, (-170.0, 170.0, 100.0, Some(176.0))),
            joint([0.0, 0.0, 0.2155], [1.0, 0.0, 0.0], Z, (-120.0, 120.0, 75.0, Some(176.0))),
            joint([0.0, 0.1845, 0.0], [-1.0, 2.0, 0.0], Z, (-170.0, 170.0, 130.0, Some(110.0))),
            joint([0.0, 0.0, 0.2155], [1.0, 0.0, 0.0], Z, (-120.0, 120.0, 135.0, Some(40.0))),
            joint([0.0, 0.081, 0.0], [-1.0, 2.0, 0.0], Z, (-175.0, 175.0, 135.0, Some(40.0))),
        ],
    },
    KnownRobot {
        name: "irb120",
        title: "ABB IRB 120-3/0.58",
        source: "ABB, IRB 120 product specification (axis ranges and speeds); frames as in ros-industrial/abb, \
                 irb120_3_58_macro.xacro",
        joint_names: Numbered("joint_"),
        joints: &[
            joint([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], Z, (-165.0, 165.0, 250.0, None)),
            joint([0.0, 0.0, 0.29], [0.0, 0.0, 0.0], Y, (-110.0, 110.0, 250.0, None)),
            joint([0.0, 0.0, 0.27], [0.0, 0.0, 0.0], Y, (-110.0, 70.0, 250.0, None)),
            joint([0.0, 0.0, 0.07], [0.0, 0.0, 0.0], X, (-160.0, 160.0, 320.0, None)),
            joint([0.302, 0.0, 0.0], [0.0, 0.0, 0.0], Y, (-120.0, 120.0, 320.0, None)),
            joint([0.072, 0.0, 0.0], [0.0, 0.0, 0.0], X, (-400.0, 400.0, 420.0, None)),
        ],
    },
    KnownRobot {
        name: "kr6_r700",
        title: "KUKA KR 6 R700 sixx",
        source: "KUKA, KR AGILUS sixx specification (axis data); frames as in ros-industrial/kuka_experimental, \
                 kr6r700sixx_macro.xacro",
        joint_names: Numbered("joint_a"),
        joints: &[
            joint([0.0, 0.0, 0.4], [0.0, 0.0, 0.0], MINUS_Z, (-170.0, 170.0, 360.0, None)),
            joint([0.025, 0.0, 0.0], [0.0, 0.0, 0.0], Y, (-190.0, 45.0, 300.0, None)),
            joint([0.315, 0.0, 0.0], [0.0, 0.0, 0.0], Y, (-120.0, 156.0, 360.0, None)),
            joint([0.0, 0.0, 0.035], [0.0, 0.0, 0.0], MINUS_X, (-185.0, 185.0, 381.0, None)),
            joint([0.365, 0.0, 0.0], [0.0, 0.0, 0.0], Y, (-120.0, 120.0, 388.0, None)),
            joint([0.08, 0.0, 0.0], [0.0, 0.0, 0.0], MINUS_X, (-350.0, 350.0, 615.0, None)),
        ],
    },
    KnownRobot {
        name: "panda",
        title: "Franka Emika Panda",
        source: "Franka Emika, FCI documentation, robot and interface specifications: Denavit-Hartenberg parameters and \
                 limits; limits as in franka_ros, panda/joint_limits.yaml",
        joint_names: Numbered("panda_joint"),
        joints: &[
            franka(0.0, 0.0, 0.333, [-2.8973, 2.8973, 2.175, 87.0]),
            franka(-1.0, 0.0, 0.0, [-1.7628, 1.7628, 2.175, 87.0]),
            franka(1.0, 0.0, 0.316, [-2.8973, 2.8973, 2.175, 87.0]),
            franka(1.0, 0.0825, 0.0, [-3.0718, -0.0698, 2.175, 87.0]),
            franka(-1.0, -0.0825, 0.384, [-2.8973, 2.8973, 2.61, 12.0]),
            franka(1.0, 0.0, 0.0, [-0.0175, 3.7525, 2.61, 12.0]),
            franka(1.0, 0.088, 0.0, [-2.8973, 2.8973, 2.61, 12.0]),
        ],
    },
    KnownRobot {
        name: "tx2_60",
        title: "Stäubli TX2-60",
        source: "Stäubli, TX2-60 instruction manual (amplitude, nominal speed); frames as in \
                 ros-industrial/staubli_experimental, tx2_60_macro.xacro",
        joint_names: Numbered("joint_"),
        joints: &[
            joint([0.0, 0.0, 0.375], [0.0, 0.0, 0.0], Z, (-180.0, 180.0, 435.0, Some(126.0))),
            joint([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], Y, (-127.5, 127.5, 385.0, Some(47.0))),
            joint([0.0, 0.02, 0.29], [0.0, 0.0, 0.0], Y, (-152.5, 152.5, 500.0, Some(32.0))),
            joint([0.0, 0.0, 0.0], [0.0, 0.0, 0.0], Z, (-270.0, 270.0, 995.0, Some(7.0))),
            joint([0.0, 0.0, 0.31], [0.0, 0.0, 0.0], Y, (-121.0, 132.5, 1065.0, Some(8.0))),
            joint([0.0, 0.0, 0.07], [0.0, 0.0, 0.0], Z, (-270.0, 270.0, 1445.0, Some(2.0))),
        ],
    },
    KnownRobot {
        name: "ur10e",
        title: "Universal Robots UR10e",
        source: UR_SOURCE,
        joint_names: UR_NAMES,
        joints: &[
            ur(0.0, 0.0, 0.1807, 120.0, 330.0),
            ur(1.0, 0.0, 0.0, 120.0, 330.0),
            ur(0.0, -0.6127, 0.0, 180.0, 150.0),
            ur(0.0, -0.57155, 0.17415, 180.0, 56.0),
            ur(1.0, 0.0, 0.11985, 180.0, 56.0),
            ur(-1.0, 0.0, 0.11655, 180.0, 56.0),
        ],
    },
    KnownRobot {
        name: "ur16e",
        title: "Universal Robots UR16e",
        source: UR_SOURCE,
        joint_names: UR_NAMES,
        joints: &[
            ur(0.0, 0.0, 0.1807, 120.0, 330.0),
            ur(1.0, 0.0, 0.0, 120.0, 330.0),
            ur(0.0, -0.4784, 0.0, 180.0, 150.0),
            ur(0.0, -0.36, 0.17415, 180.0, 56.0),
            ur(1.0, 0.0, 0.11985, 180.0, 56.0),
            ur(-1.0, 0.0, 0.11655, 180.0, 56.0),
        ],
    },
    KnownRobot {
        name: "ur3e",
        title: "Universal Robots UR3e",
        source: UR_SOURCE,
        joint_names: UR_NAMES,
        joints: &[
            ur(0.0, 0.0, 0.15185, 180.0, 56.0),
            ur(1.0, 0.0, 0.0, 180.0, 56.0),
            ur(0.0, -0.24355, 0.0, 180.0, 28.0),
            ur(0.0, -0.2132, 0.13105, 360.0, 12.0),
            ur(1.0, 0.0, 0.08535, 360.0, 12.0),
            ur(-1.0, 0.0, 0.0921, 360.0, 12.0),
        ],
    },
    KnownRobot {
        name: "ur5e",
        title: "Universal Robots UR5e",
        source: UR_SOURCE,
        joint_names: UR_NAMES,
        joints: &[
            ur(0.0, 0.0, 0.1625, 180.0, 150.0),
            ur(1.0, 0.0, 0.0, 180.0, 150.0),
            ur(0.0, -0.425, 0.0, 180.0, 150.0),
            ur(0.0, -0.3922, 0.1333, 180.0, 28.0),
            ur(1.0, 0.0, 0.0997, 180.0, 28.0),
            ur(-1.0, 0.0, 0.0996, 180.0, 28.0),
        ],
    },
    KnownRobot {
        name: "xarm6",
        title: "UFACTORY xArm 6",
        source: "UFACTORY, xarm_ros, xarm6.urdf.xacro (angles written as multiples of 90°)",
        joint_names: Numbered("joint"),
        joints: &[
            xarm([0.0, 0.0, 0.267], 0.0, [-TURN, TURN, 50.0]),
            xarm([0.0, 0.0, 0.0], -1.0, [-2.059, 2.0944, 50.0]),
            xarm([0.0535, -0.2845, 0.0], 0.0, [-3.927, 0.19198, 32.0]),
            xarm([0.0775, 0.3425, 0.0], -1.0, [-TURN, TURN, 32.0]),
            xarm([0.0, 0.0, 0.0], 1.0, [-1.69297, TURN / 2.0, 32.0]),
            xarm([0.076, 0.097, 0.0], -1.0, [-TURN, TURN, 20.0]),
        ],
    },
    KnownRobot {
        name: "xarm7",
        title: "UFACTORY xArm 7",
        source: "UFACTORY, xarm_ros, xarm7.urdf.xacro (angles written as multiples of 90°)",
        joint_names: Numbered("joint"),
        joints: &[
            xarm([0.0, 0.0, 0.267], 0.0, [-TURN, TURN, 50.0]),
            xarm([0.0, 0.0, 0.0], -1.0, [-2.059, 2.0944, 50.0]),
            xarm([0.0, -0.293, 0.0], 1.0, [-TURN, TURN, 30.0]),
            xarm([0.0525, 0.0, 0.0], 1.0, [-0.19198, 3.927, 30.0]),
            xarm([0.0775, -0.3425, 0.0], 1.0, [-TURN, TURN, 30.0]),
            xarm([0.0, 0.0, 0.0], 1.0, [-1.69297, TURN / 2.0, 20.0]),
            xarm([0.076, 0.097, 0.0], -1.0, [-TURN, TURN, 20.0]),
        ],
    },
];
