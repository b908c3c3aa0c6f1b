//! Chains of URDF files: what is read, and what is refused and how.

use aurt_rbd::robots::{self, DescribedRobot, Part, RobotErrors, tips};
use aurt_rbd::{ChainDynamics, JointKind, RobotDescription, SerialChain, base_parameters};
use aurt_traits::{Motion, RigidBodyRegressor};
use serde::Deserialize;

use crate::parse;

const GANTRY: &str = include_str!("reference/gantry.urdf");

fn gantry(base: Option<&str>, tip: Option<&str>) -> Result<DescribedRobot, RobotErrors> {
    parse(GANTRY, "gantry.urdf", base, tip)
}

fn refused(text: &str, tip: Option<&str>) -> String {
    parse(text, "arm.urdf", None, tip).unwrap_err().to_string()
}

#[derive(Deserialize)]
struct Reference {
    base_parameters: usize,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    torque: Vec<f64>,
    mass_matrix: Vec<f64>,
}

#[test]
fn torques_mass_matrices_and_base_parameters_are_those_of_pinocchio() {
    let reference: Reference = serde_json::from_str(include_str!("reference/reference.json")).unwrap();
    let robot = gantry(None, Some("wrist")).unwrap();
    let chain = robot.chain([0.0, 0.0, -9.81]).unwrap();
    assert_eq!(base_parameters(&chain, 0).unwrap().len(), reference.base_parameters);
    let standard = robot.standard_parameters.unwrap();
    let mut dynamics = ChainDynamics::new(chain, &standard).unwrap();
    let (mut torque, mut mass) = ([0.0; 4], [0.0; 16]);
    for state in &reference.states {
        dynamics.inverse_dynamics(&state.q, &state.qd, &state.qdd, &mut torque);
        for (ours, theirs) in torque.iter().zip(&state.torque) {
            assert!((ours - theirs).abs() < 1e-11, "{torque:?} and {:?}", state.torque);
        }
        dynamics.mass_matrix(&state.q, &mut mass);
        for row in 0..4 {
            for column in row..4 {
                let (ours, theirs) = (mass[4 * row + column], state.mass_matrix[4 * row + column]);
                assert!((ours - theirs).abs() < 1e-12, "{row}, {column}: {ours} and {theirs}");
            }
        }
    }
}

#[test]
fn joints_limits_friction_and_notes_are_kept() {
    let robot = gantry(None, Some("wrist")).unwrap();
    assert_eq!((robot.name.as_str(), robot.base.as_str(), robot.tip.as_str()), ("gantry", "world", "wrist"));
    assert_eq!(robot.joint_names, ["slide", "shoulder", "elbow", "extension"]);
    use JointKind::{Prismatic, Revolute};
    assert_eq!(robot.kinds(), [Prismatic, Revolute, Revolute, Prismatic]);
    assert_eq!(robot.limits[0].position_rad, Some([-0.8, 1.2]));
    assert_eq!((robot.limits[1].velocity_rad_s, robot.limits[1].torque_nm), (Some(3.0), Some(120.0)));
    assert_eq!(robot.limits[2].position_rad, None);
    assert_eq!((robot.friction[0].viscous_nm_s_rad, robot.friction[0].coulomb_nm), (12.0, 30.0));
    assert_eq!(robot.notes.len(), 1, "{:?}", robot.notes);
    assert!(robot.notes[0].contains("fixed at zero"), "{:?}", robot.notes);
    assert!(robot.notes[0].ends_with("finger_left, finger_right"), "{:?}", robot.notes);
    // Two fingers are carried: 2 · 0.08 kg on the wrist of 0.9 kg.
    let mass = robot.standard_parameters.unwrap()[39];
    assert!((mass - 1.06).abs() < 1e-15, "{mass}");
}

#[test]
fn a_chain_is_chosen_by_itself_only_if_there_is_one() {
    assert_eq!(tips(GANTRY, "gantry.urdf", None).unwrap(), ["left", "wrist"]);
    let plain: String = GANTRY.replace("<mimic joint=\"finger_left\"/>", "");
    assert_eq!(tips(&plain, "gantry.urdf", None).unwrap(), ["left", "right"]);
    let one = "<robot name='r'><link name='a'/><link name='b'/><link name='label'/>\
               <joint name='j' type='revolute'><parent link='a'/><child link='b'/></joint>\
               <joint name='f' type='fixed'><parent link='a'/><child link='label'/></joint></robot>";
    assert_eq!(parse(one, "one.urdf", None, None).unwrap().tip, "b");
    let below = gantry(Some("upper_arm"), Some("wrist")).unwrap();
    assert_eq!(below.joint_names, ["elbow", "extension"]);
    assert!(
        below.notes.iter().any(|n| n.contains("`upper_arm` is taken to be at rest")),
        "{:?}",
        below.notes
    );
}

#[test]
fn a_tree_has_all_joints_or_those_that_are_named() {
    let part = |part: &Part| robots::parse(GANTRY, "gantry.urdf", None, part, None);
    let named = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<String>>();
    let all = part(&Part::All).unwrap();
    assert_eq!(all.joint_names, ["slide", "shoulder", "elbow", "extension", "finger_left"]);
    assert_eq!((all.joints.len(), all.tip.as_str(), all.branches.len()), (6, "", 0));
    let tree = SerialChain::new(all.joints.clone(), [0.0; 3]).unwrap();
    assert_eq!((tree.parent(4), tree.parent(5)), (Some(3), Some(3)), "both fingers are on the wrist");
    // A chain by its tip, by tips and by its joints is one robot; a file of one chain needs none of them.
    let chain = gantry(None, Some("left")).unwrap();
    for same in [Part::Tips(named(&["left", "wrist"])), Part::Joints(chain.joint_names.clone())] {
        let same = part(&same).unwrap();
        let follower = usize::from(!same.couplings.is_empty());
        assert_eq!(same.joint_names, chain.joint_names);
        assert_eq!(same.joints[..5], chain.joints[..5]);
        assert_eq!(same.joints.len() - follower, chain.joints.len());
    }
    // Branches come in the order in which they are named, behind what carries them.
    let mirrored = GANTRY.replace("<mimic joint=\"finger_left\"/>", "");
    for (tips, last) in [
        (["left", "right"], ["finger_left", "finger_right"]),
        (["right", "left"], ["finger_right", "finger_left"]),
    ] {
        for chosen in [Part::Tips(named(&tips)), Part::Joints(named(&[last[0], last[1], "elbow"]))] {
            let tree = robots::parse(&mirrored, "gantry.urdf", None, &chosen, None).unwrap();
            assert_eq!(tree.joint_names[tree.joint_names.len() - 2..], last, "{chosen:?}");
        }
    }
    // What is left out on the way is at rest, and its motion concerns all joints.
    let outer = part(&Part::Joints(named(&["shoulder", "extension"]))).unwrap();
    assert_eq!(outer.joint_names, ["shoulder", "extension"]);
    let upstream: Vec<(&str, &[usize])> =
        outer.branches.iter().map(|b| (b.joint.as_str(), b.upstream.as_slice())).collect();
    assert_eq!(upstream, [("slide", &[0, 1][..]), ("elbow", &[0, 1]), ("finger_left", &[0, 1])]);
    let (whole, held) = (all.chain([0.0; 3]), outer.chain([0.0, 0.0, -9.81]).unwrap());
    assert!(whole.unwrap_err().to_string().contains("1 of the chain's 6 joints follow another"));
    let of_all = all.rigid_body([0.0, 0.0, -9.81]).unwrap();
    let torque = |body: &dyn RigidBodyRegressor, standard: &[f64], q: &[f64]| {
        let zero = vec![0.0; q.len()];
        let motion = Motion::new(q.len(), vec![0.0], q.to_vec(), zero.clone(), zero).unwrap();
        let mut torque = vec![0.0; q.len()];
        body.torque(motion.view(), standard, &mut torque, 1);
        torque
    };
    let (mass_all, mass_held) = (all.standard_parameters.unwrap(), outer.standard_parameters.unwrap());
    let whole = torque(&*of_all, &mass_all, &[0.0, 0.4, 0.0, 0.3, 0.0]);
    let held = torque(&held, &mass_held, &[0.4, 0.3]);
    assert!((whole[1] - held[0]).abs() < 1e-12 && (whole[3] - held[1]).abs() < 1e-12, "{whole:?} {held:?}");
    for (wrong, said) in [
        (Part::Joints(named(&["elbov"])), "there is no joint `elbov` for `joints`, did you mean `elbow`?"),
        (Part::Tips(named(&["wirst"])), "there is no link `wirst` for the tip, did you mean `wrist`?"),
        (
            Part::Joints(named(&["finger_right"])),
            "follows the joint finger_left (mimic), which is beside the chain",
        ),
    ] {
        let error = part(&wrong).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    let flying = "<robot name='r'><link name='world'/><link name='trunk'/><link name='a'/><link name='b'/>\
                  <joint name='base' type='floating'><parent link='world'/><child link='trunk'/></joint>\
                  <joint name='l' type='revolute'><parent link='trunk'/><child link='a'/></joint>\
                  <joint name='r' type='revolute'><parent link='trunk'/><child link='b'/></joint></robot>";
    let error = robots::parse(flying, "dog.urdf", None, &Part::All, None).unwrap_err().to_string();
    assert!(
        error.contains("joint base: is floating") && error.contains("choose a base behind it: `trunk`"),
        "{error}"
    );
    assert_eq!(
        robots::parse(flying, "dog.urdf", Some("trunk"), &Part::All, None).unwrap().joint_names,
        ["l", "r"]
    );
}

const COUPLED: &str = include_str!("reference/coupled.urdf");

#[test]
fn joints_that_follow_another_are_moved_by_it() {
    let robot = parse(COUPLED, "coupled.urdf", None, None).unwrap();
    assert_eq!(robot.tip, "end");
    assert_eq!((robot.joints(), robot.joints.len()), (4, 8));
    assert_eq!(robot.joint_names, ["turn", "shoulder", "extension", "finger"]);
    let follows: Vec<(usize, f64)> = robot.couplings.iter().map(|c| (c.coordinate, c.multiplier)).collect();
    assert_eq!(follows, [(0, 1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, 1.0), (3, 1.0), (3, 1.1), (3, 0.55)]);
    // The end follows the middle, which follows the knuckle: 0.5 (1.1 q + 0.05) + 0.1.
    let steps = COUPLED.replace(
        "<mimic joint=\"finger\" multiplier=\"0.55\" offset=\"0.125\"/>",
        "<mimic joint=\"finger_2\" multiplier=\"0.5\" offset=\"0.1\"/>",
    );
    assert_ne!(steps, COUPLED);
    assert_eq!(parse(&steps, "coupled.urdf", None, None).unwrap().couplings, robot.couplings);
    // −1.2 ≤ 0.2 − q ≤ 2 leaves −1.5 … 1.4; what turns at the same speed rubs as well.
    let limits = &robot.limits[1];
    let [low, high] = limits.position_rad.unwrap();
    assert!(low == -1.5 && (high - 1.4).abs() < 1e-15, "{limits:?}");
    assert_eq!((limits.velocity_rad_s, limits.torque_nm), (Some(1.5), Some(400.0)));
    assert_eq!((robot.friction[1].viscous_nm_s_rad, robot.friction[1].coulomb_nm), (3.5, 10.0));
    assert!(robot.notes.iter().any(|n| n.contains("level = -1 shoulder + 0.2")), "{:?}", robot.notes);
    let body = robot.rigid_body([0.0, 0.0, -9.81]).unwrap();
    assert_eq!((body.joints(), body.standard_parameters().len()), (4, 80));
    let error = robot.chain([0.0, 0.0, -9.81]).unwrap_err().to_string();
    assert!(error.contains("4 of the chain's 8 joints follow another (mimic)"), "{error}");
}

#[test]
fn a_joint_that_follows_what_does_not_move_the_chain_is_refused() {
    for (to, part) in [
        ("<mimic joint='extention'/>", "follows the joint extention (mimic), which is not there"),
        ("<mimic joint='extension_2'/>", "follows this one in turn"),
        ("<mimic joint='extension' multiplier='0'/>", "with the multiplier 0"),
    ] {
        let text = COUPLED.replace("<mimic joint=\"extension\"/>", to);
        let error = parse(&text, "coupled.urdf", None, Some("end")).unwrap_err().to_string();
        assert!(error.contains("joint extension_2:") && error.contains(part), "{part}\n---\n{error}");
        // By itself the chain ends before it.
        assert_eq!(parse(&text, "coupled.urdf", None, None).unwrap().tip, "tube");
    }
}

#[test]
fn names_that_are_no_links_and_chains_that_are_none() {
    for (base, tip, part) in [
        (None, Some("wirst"), "there is no link `wirst` for the tip, did you mean `wrist`?"),
        (Some("floor"), None, "there is no link `floor` for the base; links: world, rail, carriage"),
        (Some("forearm"), Some("carriage"), "the tip `carriage` does not hang on the base `forearm`"),
        (None, Some("rail"), "between `world` and `rail` there is no joint that moves"),
        (Some("right"), None, "no joint that moves hangs on the base `right`"),
        (None, Some("right"), "gantry.urdf:100: joint finger_right: follows the joint finger_left (mimic)"),
    ] {
        let error = gantry(base, tip).unwrap_err().to_string();
        assert!(error.contains(part), "{part}\n---\n{error}");
    }
}

/// A robot of two links with this joint between them, on line 4.
fn two_links(joint: &str) -> String {
    format!("<robot name='r'>\n<link name='a'/>\n<link name='b'/>\n{joint}\n</robot>\n")
}

#[test]
fn every_fault_has_its_place_and_remedy() {
    let ends = "<parent link='a'/><child link='b'/>";
    let joint = |kind: &str, inside: &str| {
        two_links(&format!("<joint name='j' type='{kind}'>{ends}{inside}</joint>"))
    };
    let bomb = "<!DOCTYPE robot [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]><robot name='&b;'/>";
    let outside = "<!DOCTYPE robot [<!ENTITY a SYSTEM \"file:///etc/passwd\">]>\n<robot name='r'>&a;</robot>";
    for (text, part) in [
        (bomb.to_owned(), "arm.urdf:1: the file declares a document type"),
        (outside.to_owned(), "arm.urdf:1: the file declares a document type"),
        (String::new(), "is no well-formed XML"),
        ("<robot name='r'>".to_owned(), "is no well-formed XML"),
        ("alpha,a,d\n0,0,0\n".to_owned(), "is no well-formed XML"),
        ("<sdf/>".to_owned(), "the outermost element is <sdf>"),
        (
            "<robot xmlns:xacro='http://ros.org/wiki/xacro'>\n<xacro:include filename='a'/></robot>"
                .to_owned(),
            "arm.urdf:2: `<xacro:include>` is xacro",
        ),
        ("<robot>\n<xacro:arm/></robot>".to_owned(), "expand it with `xacro arm.urdf > robot.urdf`"),
        ("<robot name='r'/>".to_owned(), "there are no links"),
        (two_links(""), "several links hang on no joint; choose one as the base: a, b"),
        (
            two_links(&format!("<joint type='fixed'>{ends}</joint>")),
            "arm.urdf:4: <joint>: lacks the attribute `name`",
        ),
        (
            joint("hinge", ""),
            "arm.urdf:4: joint j: the type `hinge` is not known; known are revolute, continuous, prismatic",
        ),
        (
            two_links("<joint name='j' type='fixed'><parent link='a'/><child link='c'/></joint>"),
            "joint j, <child>: there is no link `c`",
        ),
        (two_links("<joint name='j' type='fixed'><child link='b'/></joint>"), "joint j: lacks <parent link="),
        (joint("revolute", "<axis xyz='0 0 0'/>"), "joint j, <axis>: the axis has no direction"),
        (
            joint("revolute", "<axis xyz='0 1'/>"),
            "`xyz` must be 3 finite numbers with spaces between, is `0 1`",
        ),
        (
            joint("revolute", "<origin rpy='0 nan 0'/>"),
            "`rpy` must be 3 finite numbers with spaces between, is `0 nan 0`",
        ),
        (joint("revolute", "<limit effort='much'/>"), "`effort` must be a finite number, is `much`"),
        (
            joint("floating", ""),
            "joint j: is floating, and models have joints of one degree of freedom on a fixed base (one that moves would need its pose \
             and the forces of its contacts); choose a base behind it: `b`",
        ),
        (
            joint("fixed", &format!("</joint><joint name='j' type='fixed'>{ends}")),
            "joint j: the name is taken by line 4",
        ),
        (
            joint("fixed", &format!("</joint><joint name='k' type='fixed'>{ends}")),
            "joint k: its child `b` hangs on the joint j as well; closed loops cannot be read",
        ),
        (
            two_links(
                "<joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint>\
                 <joint name='k' type='fixed'><parent link='b'/><child link='a'/></joint>",
            ),
            "the joints of these links form a loop without a base: a, b",
        ),
        (
            "<robot name='r'><link name='a'><inertial><mass value='1'/></inertial></link></robot>".to_owned(),
            "link a, <inertial>: lacks <inertia",
        ),
        (
            "<robot name='r'><link name='a'><inertial><inertia ixx='1'/></inertial></link></robot>"
                .to_owned(),
            "link a, <inertial>: lacks <mass",
        ),
    ] {
        let error = refused(&text, None);
        assert!(error.contains(part), "{part}\n---\n{error}");
        assert!(error.contains("arm.urdf"), "{error}");
    }
    // Independent faults are reported together.
    let several = two_links(
        "<joint name='j' type='fixed'><parent link='x'/><child link='b'/></joint>\n\
         <joint name='k' type='hinge'><parent link='a'/><child link='b'/></joint>",
    );
    assert_eq!(parse(&several, "arm.urdf", None, None).unwrap_err().0.len(), 2);
}

#[test]
fn rounded_angles_and_missing_inertia_are_noted() {
    let text = GANTRY
        .replace("rpy=\"1.5707963267948966 0 0\"", "rpy=\"1.5708 0 0\"")
        .replace("<link name=\"world\"/>", "<link name=\"world\"><visual/></link>");
    let robot = parse(&text, "gantry.urdf", None, Some("wrist")).unwrap();
    let all = robot.notes.join("\n");
    assert!(all.contains("joint elbow: roll = 1.5708 is 3.7e-6 rad off 2*pi/4"), "{all}");
    assert!(all.contains("no inertia is stated, and so none is assumed, for: world"), "{all}");
    let heavy = GANTRY.replace("<mass value=\"4.2\"/>", "<mass value=\"-4.2\"/>");
    let notes = parse(&heavy, "gantry.urdf", None, Some("wrist")).unwrap().notes.join("\n");
    assert!(notes.contains("link 1: the mass is -4.2 kg"), "{notes}");
}

#[test]
fn files_that_are_no_text_or_too_large_are_refused() {
    let folder = std::env::temp_dir().join(format!("aurt-rbd-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("robot.urdf");
    std::fs::write(&path, b"<robot name=\"\xff\"/>").unwrap();
    let error = robots::read(&path, None, &Part::All, None).unwrap_err().to_string();
    assert!(error.contains("is no UTF-8 text (line 1)"), "{error}");
    // A sparse file takes no room.
    std::fs::File::create(&path).unwrap().set_len(robots::MOST_BYTES + 1).unwrap();
    let error = robots::read(&path, None, &Part::All, None).unwrap_err().to_string();
    assert!(error.contains("larger than 64 MB"), "{error}");
    std::fs::remove_dir_all(&folder).unwrap();
    let error = robots::read("no/such.urdf", None, &Part::All, None).unwrap_err().to_string();
    assert!(error.starts_with("no/such.urdf: cannot be read"), "{error}");
}

/// A URDF file of one joint that moves and of more joints, each with its child, its parent and what it says.
fn with_many(joints: impl Iterator<Item = [String; 4]>) -> String {
    let end = "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>\n";
    let mut text = format!(
        "<robot name='r'>\n<link name='a'/>\n<link name='b'/>\n<joint name='first' type='revolute'>\
         <parent link='a'/><child link='b'/><axis xyz='0 0 1'/>{end}"
    );
    for [kind, parent, child, more] in joints {
        text += &format!(
            "<link name='{child}'/>\n<joint name='to {child}' type='{kind}'><parent link='{parent}'/>\
             <child link='{child}'/><axis xyz='0 0 1'/>{more}{end}"
        );
    }
    text + "</robot>"
}

/// Reading takes time in proportion to the file: what grows with its square would take minutes.
#[test]
fn files_of_many_links_are_read_at_once() {
    const MANY: usize = 40_000;
    let begin = std::time::Instant::now();
    let many = |kind: &str, parent: fn(usize) -> String, more: fn(usize) -> String| {
        with_many((0..MANY).map(|k| [kind.to_owned(), parent(k), format!("l{k}"), more(k)]))
    };
    let on_b = |_: usize| "b".to_owned();
    let none = |_: usize| String::new();
    fn above(k: usize) -> String {
        if k == 0 { "b".to_owned() } else { format!("l{}", k - 1) }
    }
    let comb = |k: usize| if k.is_multiple_of(2) { above(k.saturating_sub(1)) } else { above(k) };
    let follows_before = |k: usize| {
        let joint = if k == 0 { "first".to_owned() } else { format!("to l{}", k - 1) };
        format!("<mimic joint='{joint}'/>")
    };
    let follows_after = |k: usize| format!("<mimic joint='to l{}'/>", k + 1);
    for (what, text, tip) in [
        ("a star", many("fixed", on_b, none), "l0"),
        ("a chain", many("fixed", above, none), "l39999"),
        ("a comb", many("fixed", comb, none), "l1"),
        ("a chain that follows", many("revolute", above, follows_before), "l39999"),
        ("joints that follow the next", many("revolute", above, follows_after), "b"),
    ] {
        assert_eq!(tips(&text, "many.urdf", None).unwrap()[0], tip, "{what}");
        let read = parse(&text, "many.urdf", None, None);
        if what == "a chain that follows" {
            let error = read.unwrap_err().to_string();
            assert!(error.contains("many.urdf: 40001 joints move, of at most 128"), "{error}");
            continue;
        }
        assert_eq!(read.unwrap().joint_names, ["first"], "{what}");
    }
    let star = many("revolute", on_b, none);
    let error = robots::parse(&star, "many.urdf", None, &Part::All, None).unwrap_err().to_string();
    assert!(error.contains("40001 joints move, of at most 128; choose a part"), "{error}");
    let twice = star.replace("<axis xyz='0 0 1'/>", "<axis xyz='0 0 0'/>");
    assert_eq!(parse(&twice, "many.urdf", None, None).unwrap_err().0.len(), MANY + 1);
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

/// What a parser needs the square of, or memory for before it looks.
#[test]
fn more_of_something_than_a_robot_has_is_refused_before_it_is_parsed() {
    let begin = std::time::Instant::now();
    let attributes: String = (0..300_000).map(|k| format!(" a{k}='='")).collect();
    let error = refused(&format!("<robot>\n<link name='a'{attributes}/></robot>"), None);
    assert!(error.contains("arm.urdf:2: ") && error.contains("300001 attributes"), "{error}");
    let nested = |n: usize| format!("{}{}", "<g>".repeat(n), "</g>".repeat(n));
    let error = refused(&format!("<robot name='r'>\n{}</robot>", nested(100_000)), None);
    assert!(error.contains("arm.urdf:2: ") && error.contains("nested"), "{error}");
    let spaces: String = (0..2000).map(|k| format!("<link name='l{k}' xmlns:a{k}='b'/>")).collect();
    let error = refused(&format!("<robot>{spaces}</robot>"), None);
    assert!(error.contains("namespaces"), "{error}");
    let error = refused(&format!("<robot>{}</robot>", "<a/>".repeat(1_100_000)), None);
    assert!(error.contains("more than 1048576 elements"), "{error}");
    // Comments, quoted text and elements beside each other are none of it.
    let quiet = format!(
        "<?xml version='1.0'?><!-- <a {} -->\n<!-- {} -->{}<![CDATA[<{}]]><h a='>{}'/>",
        "= ".repeat(1000),
        "<a>".repeat(1000),
        "<g></g>".repeat(1000),
        "= ".repeat(1000),
        "= ".repeat(1000)
    );
    let (declaration, inside) = quiet.split_at("<?xml version='1.0'?>".len());
    let text = GANTRY.split_once("<robot").unwrap().1;
    let (head, rest) = text.split_once('>').unwrap();
    let text = format!("{declaration}<robot{head}>{inside}{}{rest}", nested(200));
    assert_eq!(parse(&text, "a.urdf", None, Some("wrist")).unwrap().tip, "wrist");
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

#[test]
fn geometry_that_no_arm_has_is_refused_with_its_place() {
    let arm = |name: &str, x: &str| {
        format!(
            "<robot name='r'><link name='a'/><link name='b'/>\n<joint name='{name}' type='revolute'><parent link='a'/>\
             <child link='b'/><origin xyz='{x} 0 0'/><axis xyz='0 0 1'/></joint></robot>"
        )
    };
    let error = refused(&arm("elbow", "1e300"), None);
    assert!(error.contains("arm.urdf:2: joint elbow: ") && error.contains("metres"), "{error}");
    let error = refused(&arm("", "1"), None);
    assert!(error.contains("arm.urdf: ") && error.contains("name"), "{error}");
}
