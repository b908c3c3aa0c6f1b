//! Tables of modified Denavit–Hartenberg parameters: what reads, and how the rest is refused.

use crate::robots;

use std::f64::consts::{FRAC_PI_2, PI};

use aurt_rbd::{JointKind, MdhError, MdhRows, MdhTable, Placement, SerialChain};

fn errors(text: &str) -> Vec<MdhError> {
    MdhTable::parse(text, "robot/mdh.csv", MdhRows::Next).unwrap_err().0
}

fn messages(text: &str) -> String {
    MdhTable::parse(text, "robot/mdh.csv", MdhRows::Next).unwrap_err().to_string()
}

#[test]
fn any_separator_order_and_line_end() {
    let expected = MdhTable::parse("alpha,a,d\npi/2,0.1,0.2\n0,-0.3,0\n", "", MdhRows::Next).unwrap();
    for text in [
        "alpha;a;d\npi/2;0.1;0.2\n0;-0.3;0\n",
        "alpha\ta\td\npi/2\t0.1\t0.2\n0\t-0.3\t0",
        "alpha a   d\npi/2   0.1 0.2\n0 -0.3 0\n",
        "\u{feff}d, alpha, a\r\n0.2, pi/2, 0.1\r\n\r\n0, 0, -0.3\r\n",
        "# made by hand\n\nAlpha,A,D # names\npi/2,0.1,0.2 # first\n   \n0,-0.3,0\n# end",
        "\"alpha\",\"a\",\"d\"\n\"pi/2\",\"0.1\",\"0.2\"\n\"0\",\"-0.3\",\"0\"\n",
        "a,theta,d,sign,alpha\n0.1,0,0.2,1,pi / 2\n-0.3,0,0,+1,0*pi\n",
    ] {
        assert_eq!(MdhTable::parse(text, "", MdhRows::Next).unwrap(), expected, "{text}");
    }
    let optional = MdhTable::parse("alpha,a,d,theta,sign\n0,0,0,-pi/2,-1\n", "", MdhRows::Next).unwrap();
    assert_eq!((optional.rows[0].theta_offset_rad, optional.rows[0].sign), (-FRAC_PI_2, -1.0));
}

#[test]
fn both_readings_describe_the_same_arm() {
    let next = "alpha,a,d,theta,sign\npi/2,0.1,1,0.5,1\n-pi/2,0.2,2,0,-1\n1,9,3,0,1\n";
    let previous = "alpha,a,d,theta,sign\n0,0,1,0.5,1\npi/2,0.1,2,0,-1\n-pi/2,0.2,3,0,1\n";
    let joints = |text, reading| MdhTable::parse(text, "", reading).unwrap().joints();
    let of_next = joints(next, MdhRows::Next);
    assert_eq!(of_next, joints(previous, MdhRows::Previous));
    assert_eq!(of_next[1].placement, Placement::Mdh { alpha_rad: FRAC_PI_2, a_m: 0.1, d_m: 2.0 });
}

#[test]
fn frames_of_a_known_arm() {
    // UR5e stretched out: the flange is at a2 + a3 along −x and d4 + d6 along −y, a height of d1 − d5.
    let chain = robots::robot(robots::UR5E, robots::DOWN);
    let mut frames = Vec::new();
    chain.link_frames(&[0.0; 6], &mut frames);
    let expected = [-0.425 - 0.3922, -0.1333 - 0.0996, 0.1625 - 0.0997];
    for (ours, theirs) in frames[5].origin_m.iter().zip(expected) {
        assert!((ours - theirs).abs() < 1e-15, "{:?}", frames[5]);
    }
    // Sign and offset: q' = sign · q + offset gives the same frames.
    let text = "alpha,a,d,theta,sign\npi/2,0.1,1,0.5,-1\n0,0,0,0,1\n";
    let chain = SerialChain::from_mdh(&MdhTable::parse(text, "", MdhRows::Next).unwrap(), [0.0; 3]).unwrap();
    let plain = robots::robot("alpha,a,d\npi/2,0.1,1\n0,0,0\n", [0.0; 3]);
    let (mut ours, mut theirs) = (Vec::new(), Vec::new());
    chain.link_frames(&[0.3, 1.0], &mut ours);
    plain.link_frames(&[0.5 - 0.3, 1.0], &mut theirs);
    assert_eq!(ours, theirs);
}

/// A SCARA: two vertical axes, a spindle that slides down along −z at a distance of 0.3 m and 0.2 m.
#[test]
fn joints_may_slide() {
    let text = "alpha,a,d,type,theta,sign\n0,0,0.4,Revolute,0,1\n0,0.3,0,revolute,0,1\npi,0.2,0.1,prismatic,pi/2,-1\n";
    let table = MdhTable::parse(text, "scara.csv", MdhRows::Previous).unwrap();
    let kinds: Vec<JointKind> = table.rows.iter().map(|row| row.kind).collect();
    assert_eq!(kinds, [JointKind::Revolute, JointKind::Revolute, JointKind::Prismatic]);
    let chain = SerialChain::from_mdh(&table, robots::DOWN).unwrap();
    let mut frames = Vec::new();
    chain.link_frames(&[0.0, FRAC_PI_2, 0.25], &mut frames);
    // The spindle's axis points down, so that the sense −1 lifts it.
    let expected = [0.3, 0.2, 0.4 - 0.1 + 0.25];
    for (ours, theirs) in frames[2].origin_m.iter().zip(expected) {
        assert!((ours - theirs).abs() < 1e-15, "{:?}", frames[2]);
    }
    let all = messages("alpha,a,d,type\n0,0,0,revolute\n0,0,0,sliding\n0,0,0,\n");
    for part in [
        "robot/mdh.csv:3: `sliding` in column 4 (type) is no type of joint; write revolute or prismatic",
        "robot/mdh.csv:4: `` in column 4 (type) is no type of joint",
    ] {
        assert!(all.contains(part), "{part}\n---\n{all}");
    }
    assert!(messages("alpha,a,d,kind\n0,0,0,revolute\n").contains("did you mean `type`?"));
}

#[test]
fn a_missing_file_is_named() {
    let error = MdhTable::from_path("no/such/mdh.csv", MdhRows::Next).unwrap_err();
    assert!(error.to_string().starts_with("no/such/mdh.csv: cannot be read"), "{error}");
}

#[test]
fn every_fault_is_reported_with_its_place() {
    let text = "alpha,a,d,sign\npi/x,0,0,1\n0,0,nan,1\n0,0,0\n0,,0,0.5\n";
    let found: Vec<_> = errors(text).iter().map(MdhError::line).collect();
    assert_eq!(found, [Some(2), Some(3), Some(4), Some(5), Some(5)]);
    let all = messages(text);
    for part in [
        "robot/mdh.csv:2: `pi/x` in column 1 (alpha) cannot be read from `x` on",
        "robot/mdh.csv:3: `nan` in column 3 (d) is not finite",
        "robot/mdh.csv:4: the row has 3 cells, the header has 4; row: `0,0,0`",
        "robot/mdh.csv:5: `` in column 2 (a) is empty",
        "robot/mdh.csv:5: `0.5` in column 4 (sign) is no sense of rotation; write 1 or -1",
    ] {
        assert!(all.contains(part), "{part}\n---\n{all}");
    }
}

#[test]
fn headers_are_explained() {
    for (text, part) in [
        ("", "the table is empty"),
        ("# nothing\n\n", "the table is empty"),
        ("alpha,a,d\n", "there are no rows"),
        ("0,0,0.1\n0,0.4,0\n", "the first line is `0,0,0.1`, but it must name the columns"),
        ("alpha,a\n0,0\n", "there is no column `d` (found: `alpha`, `a`)"),
        ("alhpa,a,d\n0,0,0\n", "column 1 is called `alhpa`, did you mean `alpha`?"),
        ("alpha_rad,a,d\n0,0,0\n", "did you mean `alpha`?"),
        ("alpha,a,d,offset\n0,0,0,0\n", "did you mean `d`?"),
        (
            "alpha,a,d,colour\n0,0,0,0\n",
            "column 4 is called `colour`; known are alpha, a, d, theta, sign, type",
        ),
        ("alpha,a,d,a\n0,0,0,0\n", "column 4 is called `a` as an earlier one"),
        ("alpha;a;d\n0;0,1;0\n", "write the decimal point as `.`"),
        ("alpha,a,d\n90deg,0,0\n", "90 degrees is pi/2"),
    ] {
        let all = messages(text);
        assert!(all.contains(part), "{text:?}: {all}");
        assert!(all.contains("robot/mdh.csv"), "{all}");
    }
    // An unknown name that was probably meant is reported once, not as a missing column as well.
    assert_eq!(errors("alhpa,a,d\n0,0,0\n").len(), 1);
}

#[test]
fn one_joint_is_an_arm() {
    let chain = robots::robot("alpha,a,d\npi,1,2\n", robots::DOWN);
    assert_eq!(chain.joints().len(), 1);
    let table = MdhTable::parse("alpha,a,d\npi,1,2\n", "", MdhRows::Previous).unwrap();
    assert_eq!(table.rows[0].alpha_rad, PI);
}
