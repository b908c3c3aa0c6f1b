//! Robots known by name.

use aurt_rbd::robots::{KNOWN_ROBOTS, known_robot, probably_meant};
use aurt_rbd::{LinkFrame, MdhRows, MdhTable, RobotDescription, SerialChain, base_parameters};

const DOWN: [f64; 3] = [0.0, 0.0, -9.81];

fn frames(chain: &SerialChain, q: &[f64]) -> Vec<LinkFrame> {
    let mut frames = Vec::new();
    chain.link_frames(q, &mut frames);
    frames
}

#[test]
fn names_are_sorted_found_and_guessed() {
    let names: Vec<&str> = KNOWN_ROBOTS.iter().map(|robot| &*robot.name).collect();
    assert!(names.is_sorted(), "{names:?}");
    assert_eq!(known_robot("UR10e").unwrap().name, "ur10e");
    assert!(known_robot("ur11e").is_none());
    assert_eq!(probably_meant("ur-10e"), Some("ur10e"));
    assert_eq!(probably_meant("atlas"), None);
}

/// Makers' tables written twice, here as tables of modified Denavit–Hartenberg parameters: same chains.
#[test]
fn chains_are_those_of_the_makers_tables() {
    let previous = "alpha,a,d\n";
    for (name, table) in [
        ("ur10e", "0,0,0.1807\npi/2,0,0\n0,-0.6127,0\n0,-0.57155,0.17415\npi/2,0,0.11985\n-pi/2,0,0.11655\n"),
        ("ur5e", "0,0,0.1625\npi/2,0,0\n0,-0.425,0\n0,-0.3922,0.1333\npi/2,0,0.0997\n-pi/2,0,0.0996\n"),
        (
            "panda",
            "0,0,0.333\n-pi/2,0,0\npi/2,0,0.316\npi/2,0.0825,0\n-pi/2,-0.0825,0.384\npi/2,0,0\npi/2,0.088,0\n",
        ),
        // KUKA's axes in Craig's convention; the frames differ from the file's only by shifts along the axes.
        ("iiwa14", "0,0,0.36\n-pi/2,0,0\npi/2,0,0.42\npi/2,0,0\n-pi/2,0,0.4\n-pi/2,0,0\npi/2,0,0.081\n"),
    ] {
        let known = known_robot(name).unwrap().description().chain(DOWN).unwrap();
        let table = MdhTable::parse(&format!("{previous}{table}"), name, MdhRows::Previous).unwrap();
        let by_table = SerialChain::from_mdh(&table, DOWN).unwrap();
        let q: Vec<f64> = (0..known.joints().len()).map(|j| 0.3 + 0.4 * j as f64).collect();
        let (ours, theirs) = (frames(&known, &q), frames(&by_table, &q));
        let (ours, theirs) = (ours.last().unwrap(), theirs.last().unwrap());
        for r in 0..3 {
            assert!((ours.origin_m[r] - theirs.origin_m[r]).abs() < 1e-14, "{name}: {ours:?} {theirs:?}");
            for c in 0..3 {
                let difference = ours.rotation[r][c] - theirs.rotation[r][c];
                assert!(difference.abs() < 1e-14, "{name}: {ours:?} {theirs:?}");
            }
        }
    }
}

#[test]
fn every_robot_has_as_many_base_parameters_as_its_geometry_gives() {
    for (name, count) in [
        ("fr3", 43),
        ("gen3", 43),
        ("iiwa14", 43),
        ("irb120", 36),
        ("kr6_r700", 36),
        ("panda", 43),
        ("tx2_60", 36),
        ("ur10e", 36),
        ("ur16e", 36),
        ("ur3e", 36),
        ("ur5e", 36),
        ("xarm6", 36),
        ("xarm7", 43),
    ] {
        let known = known_robot(name).unwrap();
        let robot = known.description();
        assert_eq!(
            (robot.limits.len(), known.joint_names().len()),
            (known.joints(), known.joints()),
            "{name}"
        );
        assert_eq!(base_parameters(&robot.chain(DOWN).unwrap(), 0).unwrap().len(), count, "{name}");
        for limits in &robot.limits {
            assert!(limits.position_rad.is_none_or(|[low, high]| low < high && high - low < 15.0), "{name}");
            assert!(limits.velocity_rad_s.is_some_and(|v| (0.5..30.0).contains(&v)), "{name}");
        }
    }
    assert_eq!(KNOWN_ROBOTS.len(), 13);
}
