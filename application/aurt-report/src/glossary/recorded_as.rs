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
        name: "clock_offset_s",
        title: "clock_offset_s",
        text: "In the table of a file under joined: what is added to its stamps so that they are of the clock of the file it is \
            joined to. A file whose clock is 0.02 s behind has 0.02.",
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
        name: "joined",
        title: "joined",
        text: "In the table of a file: the files that hold its measurements or velocities, where positions are here and \
            currents there; names, or tables with file, unit, columns, take, clock_offset_s and the keys that say how a file \
            was recorded. Rows are those of the common time. Where stamps are equal they go together as they are; otherwise \
            the stamps of the slower file hold, and the other is interpolated linearly.",
    },
    Term {
        name: "joint_names",
        title: "joint_names",
        text: "The names of the robot's joints, base first; recordings that name joints (joint states in MCAP) are matched by \
            them. Robots of a URDF or MJCF file and those known by name have them. Under [recordings] and in the table of a \
            file: what the recording calls these joints, where that differs.",
    },
    Term {
        name: "rate_hz",
        title: "rate_hz",
        text: "Rows per second of a file that has no time stamps. Stamps that there are, are then not read.",
    },
    Term {
        name: "take",
        title: "take",
        text: "In the table of a file: what is read of it, of \"position\", \"velocity\" and \"measurement\". Needed where two \
            joined files both have one of them.",
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
