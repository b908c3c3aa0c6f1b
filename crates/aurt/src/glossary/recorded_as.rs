//! Keys that say how a file was recorded, where it does not tell itself.

use super::Term;

/// The terms.
pub const TERMS: &[Term] = &[
    Term {
        name: "angle",
        title: "angle",
        text: "Under [recordings] for all files, or in the table of a file: the unit of positions, \"rad\" (the default) or \
            \"deg\". Velocities are in the same unit per second.",
    },
    Term {
        name: "counts_per_revolution",
        title: "counts_per_revolution",
        text: "Positions are counts of encoders: this many are a turn. One number for all joints or a list with one for each; \
            velocities are in counts per second. Where encoders sit on the motors' shafts, gear_ratio belongs to it.",
    },
    Term {
        name: "current",
        title: "current",
        text: "Under [recordings] for all files, or in the table of a file: the unit of motor currents, \"A\" (the default) or \
            \"mA\". Torques are in Nm and not touched.",
    },
    Term {
        name: "gear_ratio",
        title: "gear_ratio",
        text: "Positions and velocities are those of the motors' shafts: turns of the motor per turn of the joint, one number for \
            all joints or a list with one for each. A negative ratio turns the sign. Measurements stay as they are: torques \
            of motors become those of joints with gains under [instrument], currents with torque_constants_nm_per_a.",
    },
    Term {
        name: "joint_names",
        title: "joint_names",
        text: "The names of the robot's joints in the order of its chain, for files that name joints (joint states in MCAP). \
            Robots of a URDF file have them; without any, the order of the first message is taken.",
    },
    Term {
        name: "rate_hz",
        title: "rate_hz",
        text: "Rows per second of a file that has no time stamps. Stamps that there are, are then not read.",
    },
    Term {
        name: "time",
        title: "time",
        text: "Under [recordings] for all files, or in the table of a file: the unit of time stamps, \"s\" (the default), \
            \"ms\", \"us\" or \"ns\". Under columns: the column of the stamps.",
    },
    Term {
        name: "topic",
        title: "topic",
        text: "The topic of an MCAP file that is read, if several publish sensor_msgs/msg/JointState.",
    },
];
