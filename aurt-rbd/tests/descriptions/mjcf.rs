//! Chains of MJCF files: what is read, against MuJoCo, and what is refused and how.

use std::collections::BTreeMap;

use aurt_rbd::robots::{Format, Part, PlacedBody, is_mjcf, placed_links, tips};
use aurt_rbd::{ChainDynamics, JointKind, LinkBody, RobotDescription};
use serde::Deserialize;

use crate::parse;

const ARM: &str = include_str!("reference/arm.xml");

/// The torques that MuJoCo computes for the same file (`aurt-lab/mujoco/mjcf/compare.py --reference`).
#[derive(Deserialize)]
struct Reference {
    joints: Vec<String>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    qd: Vec<f64>,
    qdd: Vec<f64>,
    torque: Vec<f64>,
}

#[test]
fn torques_are_those_of_mujoco() {
    let reference: Reference = serde_json::from_str(include_str!("reference/arm_mujoco.json")).unwrap();
    let robot = parse(ARM, "arm.xml", None, Some("tool")).unwrap();
    assert_eq!(robot.joint_names, reference.joints);
    let standard = robot.standard_parameters.clone().unwrap();
    let mut dynamics = ChainDynamics::new(robot.chain([0.0, 0.0, -9.81]).unwrap(), &standard).unwrap();
    let mut torque = [0.0; 5];
    for State { q, qd, qdd, torque: theirs } in &reference.states {
        dynamics.inverse_dynamics(q, qd, qdd, &mut torque);
        let largest = theirs.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        for (ours, theirs) in torque.iter().zip(theirs) {
            assert!((ours - theirs).abs() < 1e-12 * largest, "{torque:?} and {theirs}");
        }
    }
}

#[test]
fn classes_limits_rotors_and_friction_are_kept() {
    let robot = parse(ARM, "arm.xml", None, Some("tool")).unwrap();
    assert_eq!((robot.name.as_str(), robot.base.as_str(), robot.tip.as_str()), ("arm", "world", "tool"));
    let mut kinds = vec![JointKind::Revolute; 5];
    kinds[0] = JointKind::Prismatic;
    assert_eq!(robot.kinds(), kinds);
    assert_eq!(robot.armature_kg_m2, [0.05, 0.7, 0.7, 0.05, 0.01]);
    let of = |value: fn(&aurt_rbd::robots::JointFriction) -> f64| {
        robot.friction.iter().map(value).collect::<Vec<_>>()
    };
    assert_eq!(of(|f| f.viscous_nm_s_rad), [12.0, 1.5, 1.5, 1.5, 1.5]);
    assert_eq!(of(|f| f.coulomb_nm), [3.0; 5]);
    let ranges: Vec<_> = robot.limits.iter().map(|l| l.position_rad).collect();
    let pan = [-90_f64, 120.0].map(f64::to_radians);
    assert_eq!(ranges[0], Some([-0.4, 0.9]));
    assert!(ranges[1].unwrap().iter().zip(pan).all(|(a, b)| (a - b).abs() < 1e-15));
    assert_eq!(ranges[2..], [None; 3]);
    assert_eq!(robot.limits[1].torque_nm, Some(80.0));
    assert!(robot.notes.iter().any(|n| n.contains("carried as fixed at zero") && n.contains("shutter")));
}

#[test]
fn chains_are_chosen_as_in_urdf_files() {
    assert!(is_mjcf(ARM) && !is_mjcf("<robot/>") && !is_mjcf("no XML"));
    assert_eq!(tips(ARM, "arm.xml", None).unwrap(), ["tool", "sensor"]);
    let upper = parse(ARM, "arm.xml", Some("elbow"), Some("tool")).unwrap();
    assert_eq!(upper.joint_names, ["wrist"]);
    let unknown = parse(ARM, "arm.xml", None, Some("tol")).unwrap_err().to_string();
    assert!(unknown.contains("did you mean `tool`?"), "{unknown}");
}

/// The message of a file that is refused; `body` is what hangs on the world.
#[track_caller]
fn refused(head: &str, body: &str) -> String {
    let text = format!("<mujoco>\n{head}\n<worldbody>\n{body}\n</worldbody></mujoco>");
    parse(&text, "bad.xml", None, None).unwrap_err().to_string()
}

const INERTIAL: &str = "<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";

#[test]
fn what_is_not_read_is_refused_with_its_place_and_a_remedy() {
    let body = |inside: &str| format!("<body name='b'><joint name='j'/>{INERTIAL}{inside}</body>");
    let whole = |inside: &str| format!("<body name='b'>{inside}</body>");
    for (head, bodies, parts) in [
        ("<compiler angle='grad'/>", body(""), &["`angle` is `grad`", "degree and radian"][..]),
        ("<compiler eulerseq='xyw'/>", body(""), &["`eulerseq` is `xyw`"]),
        ("<compiler settotalmass='3'/>", body(""), &["`settotalmass` changes"]),
        ("<include file='other.xml'/>", body(""), &["bad.xml:2: <include>", "mj_saveLastXML"]),
        ("", body("<replicate count='3'/>"), &["<replicate>"]),
        (
            "",
            whole("<joint/><geom type='mesh' mesh='m'/>"),
            &[
                "bad.xml:4: body b, <geom>: its mass is that of a shape of the type `mesh`",
                "<inertial>",
                "saveinertial=\"true\"",
                "mj_saveLastXML",
            ],
        ),
        ("", whole("<joint/><geom shellinertia='true' size='1'/>"), &["is that of a shell"]),
        ("", whole("<joint/><geom type='box' mesh='m'/>"), &["fitted to a mesh"]),
        ("", whole("<joint/><geom type='capsule' size='1'/>"), &["`size`"]),
        ("", whole("<joint/><geom size='-1'/>"), &["a sphere needs 1 `size`s above 0"]),
        ("", whole("<joint/><geom size='1' density='-1'/>"), &["must not be negative"]),
        ("", whole("<joint/><geom size='1' class='none'/>"), &["there is no class `none`"]),
        ("", whole("<joint/><inertial pos='0 0 0' mass='1'/>"), &["lacks `diaginertia`"]),
        ("", whole("<joint/><inertial pos='0 0 0' diaginertia='1 1 1'/>"), &["lacks the attribute `mass`"]),
        ("", whole(&format!("<joint axis='0 0 0'/>{INERTIAL}")), &["axis has no direction"]),
        ("", whole(&format!("<joint type='screw'/>{INERTIAL}")), &["type `screw` is not known"]),
        ("", whole(&format!("<joint damping='much'/>{INERTIAL}")), &["`damping`", "`much`"]),
        (
            "",
            whole(&format!("<freejoint/>{INERTIAL}")),
            &["is a free joint, and models have joints of one degree of freedom"],
        ),
        ("", whole(&format!("<joint class='none'/>{INERTIAL}")), &["there is no class `none`"]),
        ("", body("<body name='b'/>"), &["the name `b` is taken"]),
        ("", body("<body quat='0 0 0 0'/>"), &["`quat` is zero"]),
        ("", body("<body quat='1 0 0 0' euler='0 0 0'/>"), &["`quat` and `euler` are two orientations"]),
        ("", String::new(), &["there is no <body>"]),
    ] {
        let message = refused(head, &bodies);
        for part in parts {
            assert!(message.contains(part), "{part}\n---\n{message}");
        }
    }
    let typed = parse("<!DOCTYPE m []><mujoco/>", "bad.xml", None, None).unwrap_err().to_string();
    assert!(typed.contains("document type"), "{typed}");
    // Whoever starts the chain behind a free joint has one.
    let text = format!(
        "<mujoco><worldbody><body name='a'><freejoint/>{INERTIAL}{}</body></worldbody></mujoco>",
        body("")
    );
    assert!(
        parse(&text, "a.xml", None, Some("b"))
            .unwrap_err()
            .to_string()
            .contains("choose a base behind it: `a`")
    );
    assert_eq!(parse(&text, "a.xml", Some("a"), Some("b")).unwrap().joints.len(), 1);
}

#[test]
fn what_acts_on_joints_beside_is_noted() {
    let text = format!(
        "<mujoco><compiler inertiafromgeom='false'/><worldbody><body name='a' gravcomp='1'><joint name='j' \
         stiffness='3'/>{INERTIAL}<body name='c'><joint name='k'/><geom size='1'/></body></body></worldbody>\
         <tendon><fixed><joint joint='j' coef='1'/></fixed></tendon><option density='1.2' wind='5 0 0' \
         gravity='3 0 -9'><flag damper='disable'/></option></mujoco>"
    );
    let notes = parse(&text, "a.xml", None, None).unwrap().notes.join("\n");
    for part in [
        "<tendon>",
        "springs are not read",
        "they are in: j",
        "`gravcomp` is not read; it is in: a",
        "assumed, for: c",
        "(`density` and `wind` of <option>)",
        "gravity of the file is 3 0 -9",
        "turns `damping` off",
    ] {
        assert!(notes.contains(part), "{part}\n---\n{notes}");
    }
}

#[test]
fn joints_follow_others_and_other_ties_are_refused() {
    let text = |equality: &str| {
        let joint = |name: &str, more: &str, inner: &str| {
            format!("<body name='b{name}'><joint name='{name}' {more}/>{INERTIAL}{inner}</body>")
        };
        let (k, l) = (joint("k", "ref='90'", ""), joint("l", "", ""));
        format!(
            "<mujoco><worldbody>{}</worldbody>\n<equality>{equality}</equality>\
             <tendon><fixed name='t'><joint joint='j' coef='1'/></fixed></tendon></mujoco>",
            joint("j", "", &format!("{k}{l}"))
        )
    };
    let read = |equality: &str, tip: &str| parse(&text(equality), "a.xml", None, Some(tip));
    let tied = "<joint joint1='k' joint2='j' polycoef='0.1 -2'/>";
    let robot = read(tied, "bk").unwrap();
    let coupling = robot.couplings[1];
    assert_eq!((coupling.coordinate, coupling.multiplier), (0, -2.0));
    assert!((coupling.offset - (std::f64::consts::FRAC_PI_2 + 0.1)).abs() < 1e-12, "{coupling:?}");
    assert_eq!(read("<joint joint1='k' joint2='j' active='false'/>", "bk").unwrap().joints.len(), 2);
    for (equality, expected) in [
        (
            "<joint joint1='k' joint2='j' polycoef='0 1 2 0 0'/>",
            "<joint>: lets a joint follow another by a polynomial",
        ),
        ("<joint joint1='k'/>", "holds a joint"),
        ("<joint joint1='k' joint2='x'/>", "there is no joint `x`"),
        ("<weld body1='bk' body2='bl'/>", "a.xml:2: <equality>, <weld>: closes a loop of bodies"),
        ("<connect body1='bk' anchor='0 0 0'/>", "leave out the joint `k`"),
        ("<tendon tendon1='t'/>", "ties tendons"),
    ] {
        let error = read(equality, "bk").unwrap_err().to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
    // What is tied beside the chain does not matter.
    assert_eq!(read("<weld body1='bk' body2='bj'/>", "bl").unwrap().joints.len(), 2);
}

/// Reading takes time in proportion to the file: what grows with its square would take minutes.
#[test]
fn files_of_many_bodies_are_read_at_once() {
    let body = |k: usize, hinge: &str| {
        format!("<body name='b{k}'>{hinge}<inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body>\n")
    };
    let hinge = "<joint axis='0 0 1'/>";
    let siblings: String = (0..40_000).map(|k| body(k, "")).collect();
    let moving: String = (0..40_000).map(|k| body(k, hinge)).collect();
    let begin = std::time::Instant::now();
    let of = |bodies: &str| {
        format!("<mujoco><worldbody><body name='arm'>{hinge}{bodies}</body></worldbody></mujoco>")
    };
    let arm = parse(&of(&siblings), "many.xml", None, None).unwrap();
    assert_eq!(arm.standard_parameters.unwrap()[9], 40_000.0);
    let error = parse(&of(&moving), "many.xml", None, None).unwrap_err().to_string();
    assert!(error.contains("40001 joints move, of at most 128"), "{error}");
    assert!(begin.elapsed().as_secs() < 60, "{:?}", begin.elapsed());
}

/// Classes inherit: copies of what they inherit would take gigabytes here.
#[test]
fn classes_within_classes_take_no_more_than_they_state() {
    let begin = std::time::Instant::now();
    let of = |class: usize, inside: &str| {
        let stated: String = (0..100).map(|k| format!(" c{class}_{k}='1'")).collect();
        format!("<default class='c{class}'><joint{stated}/><geom{stated}/>{inside}</default>")
    };
    let leaves: String = (0..20_000).map(|k| format!("<default class='l{k}'/>")).collect();
    let classes = (1..200).rev().fold(leaves, |inside, class| of(class, &inside));
    let classes = format!("<default><joint armature='0.5'/>{classes}</default>");
    let body = "<worldbody><body name='a'><joint name='j' class='l7'/>\
                <inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/></body></worldbody>";
    let arm = parse(&format!("<mujoco>{classes}{body}</mujoco>"), "deep.xml", None, None).unwrap();
    assert_eq!(arm.armature_kg_m2, [0.5]);
    assert!(begin.elapsed().as_secs() < 20, "{:?}", begin.elapsed());
}

const SHAPES: &str = include_str!("reference/shapes.xml");

/// What MuJoCo computes of a body's shapes (`tests/reference/make_shapes.py`), in the frame of the body.
#[derive(Deserialize)]
struct Weighed {
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
}

/// Mass, centre of mass and inertia {xx yy zz xy xz yz} of a body in its own frame.
fn weighed(body: &PlacedBody) -> [f64; 10] {
    let LinkBody { mass_kg, com_m, inertia_at_com_kg_m2: [xx, xy, xz, yy, yz, zz] } =
        LinkBody::from_standard_parameters(&body.standard).unwrap();
    let (r, link) = (body.rotation, [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]);
    let com = |k: usize| (0..3).map(|i| r[i][k] * (com_m[i] - body.origin_m[i])).sum::<f64>();
    let inertia = |a: usize, b: usize| -> f64 {
        (0..3).map(|i| (0..3).map(|k| r[i][a] * link[i][k] * r[k][b]).sum::<f64>()).sum()
    };
    let own = [inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)];
    let [a, b, c, d, e, f] = own;
    [mass_kg, com(0), com(1), com(2), a, b, c, d, e, f]
}

#[test]
fn masses_of_shapes_are_those_of_mujoco() {
    let mut reference: serde_json::Value =
        serde_json::from_str(include_str!("reference/shapes_mujoco.json")).unwrap();
    for choice in ["auto", "true"] {
        let theirs: BTreeMap<String, Weighed> = serde_json::from_value(reference[choice].take()).unwrap();
        let text = SHAPES.replace("<compiler ", &format!("<compiler inertiafromgeom=\"{choice}\" "));
        let (robot, links) = placed_links(&text, "shapes.xml", Format::Mjcf, None, &Part::All).unwrap();
        let bodies: Vec<&PlacedBody> =
            links.iter().flat_map(|link| link.body.iter().chain(&link.carried)).collect();
        assert_eq!(bodies.len(), theirs.len());
        for body in bodies {
            let Weighed { mass, com: [x, y, z], inertia: [a, b, c, d, e, f] } = theirs[&body.name];
            let (found, wanted) = (weighed(body), [mass, x, y, z, a, b, c, d, e, f]);
            for (k, (found, wanted)) in found.iter().zip(wanted).enumerate() {
                let size = [mass, 0.1, a.max(b).max(c)][usize::from(k > 0) + usize::from(k > 3)];
                assert!((found - wanted).abs() < 1e-12 * size, "{choice}, {}: {found} {wanted}", body.name);
            }
        }
        let note =
            "computed from shapes and their density, as MuJoCo does, of: ball, tubes, sticks, palm, finger";
        let notes = robot.notes.join("\n");
        assert!(notes.contains(note), "{notes}");
        assert_eq!(notes.contains("finger, tip"), choice == "true", "{notes}");
    }
}

#[test]
fn actuators_of_positions_are_read_with_the_defaults_of_their_class_and_others_are_refused() {
    let file = |actuators: &str| {
        format!(
            "<mujoco><default><default class='servo'><position kp='17.8' kv='0.2' forcerange='-3.35 3.35'/></default></default>\
             <actuator>{actuators}</actuator></mujoco>"
        )
    };
    let read = |actuators: &str| aurt_rbd::robots::position_actuators(&file(actuators), "servo.xml");
    let found = read(
        "<position class='servo' joint='a' forcerange='-2 2'/>\
         <general joint='b' gainprm='10' biastype='affine' biasprm='0.5 -10 -0.3' delay='0.02'/>",
    )
    .unwrap();
    let [a, b] = &found[..] else { panic!("{found:?}") };
    assert_eq!(
        (a.gain_nm_per_rad, a.braking_nm_s_per_rad, a.limit_nm, a.bias_nm),
        (17.8, 0.2, Some(2.0), 0.0)
    );
    assert_eq!((b.gain_nm_per_rad, b.braking_nm_s_per_rad, b.bias_nm, b.delay_s), (10.0, 0.3, 0.5, 0.02));
    for (actuator, said) in [
        ("<motor joint='a'/>", "no actuator of a position"),
        ("<general joint='a' gainprm='10' biastype='affine' biasprm='0 -9 0'/>", "is not the stiffness 9"),
        ("<general joint='a' gainprm='10'/>", "follows no position"),
        ("<position joint='a' kp='5' dampratio='1'/>", "`dampratio` is not read"),
    ] {
        let refused = read(actuator).unwrap_err().to_string();
        assert!(refused.contains(said) && refused.contains("servo.xml:1"), "{refused}");
    }
}
