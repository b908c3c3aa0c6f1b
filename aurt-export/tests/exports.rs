//! Exports against what the model itself predicts, run by the programs that they are made for.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod corrected;
mod crates;
mod models;
mod units;

use std::{
    ffi::OsString,
    path::Path,
    process::{Command, Output},
};

use aurt_export::{Export, ExportError, Provenance, Source, c, fmu, is_export, mjcf, rust, sdf, urdf};
use aurt_friction::arm_terms::{joint_selection::JointSelection, torque_ripple::TorqueRipple};
use aurt_rbd::robots::{KNOWN_ROBOTS, Part};
use aurt_rbd::{ChainDynamics, RobotDescription, SerialChain};
use aurt_traits::{ArmTerm, LoadTorque, MeasurementUnit, RobotModel};

use models::{Case, arm, case, case_with_memory, checks, checks_along_a_path, gantry, two_arms};

fn provenance() -> Provenance {
    Provenance {
        file: "rd_\"calibrated\".json".into(),
        schema: 1,
        blake3: "0123".into(),
        aurt_version: Some("0.1.0".into()),
        // What would end comments and elements, if it were written as it is.
        recordings: ["monday/*.csv", "a -- b??/", "a & b <c>.csv"].map(str::to_owned).to_vec(),
    }
}

fn source<'a>(case: &'a Case, provenance: &'a Provenance) -> Source<'a> {
    Source {
        name: "machine",
        model: &case.model,
        coefficients: &case.coefficients,
        load: &case.load,
        unit: MeasurementUnit::NewtonMetre,
        standard: Some(&case.standard),
        provenance,
    }
}

fn write(export: &Export, folder: &Path) {
    for (name, text) in &export.files {
        // What a later export may replace.
        assert!(is_export(text), "{name} does not state what wrote it");
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
}

/// Compiles and runs an export; nothing where there is no C compiler.
fn compiled_and_run(export: &Export) -> Option<Output> {
    let folder = tempfile::tempdir().unwrap();
    write(export, folder.path());
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1"];
    let sanitizers = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let compile = |compiler: &str, more: &[&str]| {
        Command::new(compiler)
            .args(strict)
            .args(more)
            .args(["machine.c", "main.c", "-o", "check", "-lm"])
            .current_dir(folder.path())
            .output()
    };
    match compile("clang", &[]) {
        Ok(other) => assert!(other.status.success(), "clang: {}", String::from_utf8_lossy(&other.stderr)),
        Err(_) => println!("skipped: there is no C compiler `clang` beside `cc`"),
    }
    // The libraries of the sanitizers are not installed everywhere.
    let mut compiled = compile("cc", &sanitizers);
    if compiled.as_ref().is_ok_and(|c| !c.status.success()) {
        println!("without sanitizers");
        compiled = compile("cc", &[]);
    }
    let Ok(compiled) = compiled else {
        println!("skipped: there is no C compiler `cc`");
        return None;
    };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    Some(Command::new(folder.path().join("check")).output().unwrap())
}

#[test]
fn the_c_of_an_arm_and_of_a_gantry_predicts_what_their_models_do() {
    let provenance = provenance();
    for (case, name) in
        [(case(arm(), true), "arm"), (case(gantry(), false), "gantry"), (case(two_arms(), true), "two arms")]
    {
        let stored = checks(&case, 32);
        let export = c::export(&source(&case, &provenance), &stored).unwrap();
        println!("{name}: {:#?}", export.notes);
        let Some(run) = compiled_and_run(&export) else { return };
        let text = String::from_utf8_lossy(&run.stdout);
        println!("{text}");
        assert!(run.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&run.stderr));
        assert_eq!(text.matches("passed").count(), 8, "{name}: {text}");
    }
}

/// What would end strings, comments and elements, begin trigraphs, be expanded or name two joints alike, if it were written as it is.
const HOSTILE: [&str; 6] =
    ["a\"*/\n//\u{e9}", "--><x>&amp;", "${HOME}\\", "??/'{}%s", "joint::2", "joint::2 "];

fn named_by_other_people() -> Case {
    case(arm().with_joint_names(HOSTILE.map(str::to_owned).to_vec()).unwrap(), true)
}

#[test]
fn names_of_other_people_stay_names_in_every_target() {
    let (case, provenance) = (named_by_other_people(), provenance());
    let source = source(&case, &provenance);
    let export = c::export(&source, &checks(&case, 2)).unwrap();
    if let Some(run) = compiled_and_run(&export) {
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stdout));
    }
    crates::passes("hostile", &rust::export(&source, &checks(&case, 2)).unwrap(), 7);
    let unit = fmu::export(&source, fmu::Kind::Inverse).unwrap();
    let description = units::text(&units::files(&unit), "modelDescription.xml");
    let own = |name: &str| name.replace(char::is_control, " ");
    let variables = names_of(&description, "ScalarVariable");
    for name in HOSTILE {
        assert!(variables.iter().any(|v| v.contains(&own(name))), "{name:?}: {variables:?}");
    }
    let written =
        [&urdf::export(&source).unwrap(), &mjcf::export(&source).unwrap(), &sdf::export(&source).unwrap()];
    for export in written {
        let joints = names_of(&export.files[0].1, "joint");
        for name in HOSTILE {
            // Double colons divide names of SDF.
            let name =
                if export.files[0].0.ends_with("sdf") { name.replace("::", ":_") } else { name.into() };
            assert!(joints.contains(&own(&name)), "{}: {name:?}: {joints:?}", export.files[0].0);
        }
    }
}

fn names_of(xml: &str, tag: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(xml).unwrap();
    let elements = document.descendants().filter(|node| node.has_tag_name(tag));
    elements.filter_map(|node| node.attribute("name").map(str::to_owned)).collect()
}

#[test]
fn the_c_of_friction_with_memory_predicts_what_the_models_do() {
    let provenance = provenance();
    for (chain, name) in [(arm(), "arm"), (gantry(), "gantry")] {
        let case = case_with_memory(chain);
        let stored = checks_along_a_path(&case, 400);
        let export = c::export(&source(&case, &provenance), &stored).unwrap();
        let Some(run) = compiled_and_run(&export) else { return };
        let text = String::from_utf8_lossy(&run.stdout);
        println!("{name}: {text}");
        assert!(run.status.success(), "{name}: {text}{}", String::from_utf8_lossy(&run.stderr));
        assert_eq!(text.matches("passed").count(), 6, "{name}: {text}");
        let header = &export.files[0].1;
        assert!(!header.contains("machine_torque("), "there is no torque without memory: {header}");
        // The order of the samples matters: the same states in another order have another torque.
        let mut turned = stored;
        turned.swap(120, 121);
        let export = c::export(&source(&case, &provenance), &turned).unwrap();
        let Some(run) = compiled_and_run(&export) else { return };
        assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stdout));
    }
}

#[test]
fn the_check_of_the_c_fails_where_values_differ() {
    let (case, provenance) = (case(gantry(), true), provenance());
    let mut stored = checks(&case, 8);
    stored[3].torque_nm[2] *= 1.0 + 1e-9;
    let export = c::export(&source(&case, &provenance), &stored).unwrap();
    let Some(run) = compiled_and_run(&export) else { return };
    assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stdout));
    assert!(String::from_utf8_lossy(&run.stdout).contains("torque[2]: differs"));
}

/// A Python with MuJoCo, if the environment names one.
fn python_with_mujoco() -> Option<OsString> {
    let Some(python) = std::env::var_os("AURT_PYTHON") else {
        println!("skipped: AURT_PYTHON names no Python with MuJoCo");
        return None;
    };
    if !Command::new(&python).args(["-c", "import mujoco"]).status().is_ok_and(|s| s.success()) {
        println!("skipped: {} has no MuJoCo", python.display());
        return None;
    }
    Some(python)
}

fn rotors(case: &Case) -> Vec<f64> {
    (0..case.model.joints())
        .map(|j| {
            let name = format!("rotor_inertia.I_a_{j}");
            let place = case.model.parameters().iter().position(|p| p.name == name);
            place.map_or(0.0, |k| case.coefficients[k])
        })
        .collect()
}

fn states(case: &Case, bodies: &mut ChainDynamics) -> Vec<[Vec<f64>; 4]> {
    checks(case, 32)
        .into_iter()
        .map(|check| {
            let mut torque = vec![0.0; case.model.joints()];
            bodies.inverse_dynamics(&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &mut torque);
            [check.q_rad, check.qd_rad_s, check.qdd_rad_s2, torque]
        })
        .collect()
}

#[test]
fn the_inverse_dynamics_of_mujoco_are_those_of_the_bodies() {
    let Some(python) = python_with_mujoco() else { return };
    let provenance = provenance();
    let gravity_m_s2 = [0.0, 0.0, -9.81];
    let known =
        KNOWN_ROBOTS.iter().map(|robot| (robot.description().chain(gravity_m_s2).unwrap(), robot.name));
    for (chain, name) in
        [(arm(), "arm"), (gantry(), "gantry"), (two_arms(), "two arms")].into_iter().chain(known)
    {
        let case = case(chain, true);
        let export = mjcf::export(&source(&case, &provenance)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        write(&export, folder.path());
        let mut bodies = ChainDynamics::new(case.chain.clone(), &case.standard)
            .unwrap()
            .with_rotor_inertia(&rotors(&case))
            .unwrap();
        let states = states(&case, &mut bodies);
        std::fs::write(folder.path().join("states.json"), serde_json::to_vec(&states).unwrap()).unwrap();
        let run = Command::new(&python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mujoco_inverse.py"))
            .arg(folder.path().join("machine.xml"))
            .arg(folder.path().join("states.json"))
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success(), "{name}: {text}\n{}", String::from_utf8_lossy(&run.stderr));
        let worst: f64 = text.trim().parse().unwrap();
        println!(
            "{name}: largest difference of mj_inverse {worst:e}, relative to the largest torque of the joint"
        );
        assert!(worst <= 1e-9, "{name}: {worst:e}");
    }
}

#[test]
fn friction_of_a_mujoco_file_holds_what_it_bears() {
    let Some(python) = python_with_mujoco() else { return };
    let (case, provenance) = (case(arm(), true), provenance());
    let folder = tempfile::tempdir().unwrap();
    write(&mjcf::export(&source(&case, &provenance)).unwrap(), folder.path());
    let run = Command::new(&python)
        .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/mujoco_creep.py"))
        .arg(folder.path().join("machine.xml"))
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{text}\n{}", String::from_utf8_lossy(&run.stderr));
    let fastest: Vec<f64> =
        text.lines().map(|line| line.split(' ').next_back().unwrap().parse().unwrap()).collect();
    println!("creep, rad/s, with MuJoCo's settings and with those of the file: {fastest:?}");
    assert!(fastest[1] < 1e-4 * fastest[0], "{fastest:?}");
}

#[test]
fn the_bodies_of_a_urdf_or_mujoco_file_need_the_torques_of_the_model() {
    let provenance = provenance();
    for (chain, name) in [(arm(), "arm"), (gantry(), "gantry"), (two_arms(), "two arms")] {
        let case = case(chain, true);
        let source = source(&case, &provenance);
        for (export, wanted) in [
            (urdf::export(&source).unwrap(), "machine.urdf"),
            (mjcf::export(&source).unwrap(), "machine.xml"),
        ] {
            let (file, text) = &export.files[0];
            assert_eq!(file, wanted);
            let read = aurt_rbd::robots::parse_part(text, file, None, &Part::All).unwrap();
            let known = case.chain.gravity_m_s2();
            let chain = SerialChain::new(read.joints.clone(), known).unwrap();
            let mut described = ChainDynamics::new(chain, &read.standard_parameters.unwrap()).unwrap();
            let mut bodies = ChainDynamics::new(case.chain.clone(), &case.standard).unwrap();
            let (mut found, mut wanted) = (vec![0.0; read.joints.len()], vec![0.0; read.joints.len()]);
            let (mut worst, mut size) = (0.0_f64, 0.0_f64);
            for check in checks(&case, 32) {
                described.inverse_dynamics(&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &mut found);
                bodies.inverse_dynamics(&check.q_rad, &check.qd_rad_s, &check.qdd_rad_s2, &mut wanted);
                for (f, w) in found.iter().zip(&wanted) {
                    worst = worst.max((f - w).abs());
                    size = size.max(w.abs());
                }
            }
            println!("{name}, {file}: largest difference {:e} of the largest torque", worst / size);
            assert!(worst <= 1e-12 * size, "{name}, {file}: {:e}", worst / size);
            let damped = read.friction.iter().filter(|f| f.viscous_nm_s_rad > 0.0).count();
            assert!(damped >= 2, "{:?}", read.friction);
            let lost = export.lost.iter().any(|l| l.starts_with("rotor inertia of joint 1"));
            assert_eq!(lost, file == "machine.urdf", "{:?}", export.lost);
        }
    }
}

#[test]
fn an_sdf_file_has_the_numbers_of_the_urdf_file() {
    let provenance = provenance();
    for (chain, name) in [(arm(), "arm"), (gantry(), "gantry"), (two_arms(), "two arms")] {
        let case = case(chain, true);
        let source = source(&case, &provenance);
        let (sdf, urdf) = (sdf::export(&source).unwrap(), urdf::export(&source).unwrap());
        let (sdf_text, urdf_text) = (&sdf.files[0].1, &urdf.files[0].1);
        let (ours, theirs) =
            (roxmltree::Document::parse(sdf_text).unwrap(), roxmltree::Document::parse(urdf_text).unwrap());
        let model = ours.root_element().children().find(|n| n.has_tag_name("model")).unwrap();
        let robot = theirs.root_element();
        let child = |node: roxmltree::Node<'_, '_>, path: &str| -> String {
            let mut at = node;
            for step in path.split('/') {
                at = at.children().find(|c| c.has_tag_name(step)).unwrap_or_else(|| panic!("{path}"));
            }
            at.text().unwrap().to_owned()
        };
        let attribute = |node: roxmltree::Node<'_, '_>, path: &str, name: &str| -> String {
            let mut at = node;
            for step in path.split('/') {
                at = at.children().find(|c| c.has_tag_name(step)).unwrap_or_else(|| panic!("{path}"));
            }
            at.attribute(name).unwrap().to_owned()
        };
        let named = |root: roxmltree::Node<'_, '_>, kind: &str, name: &str| {
            let found = root.children().find(|n| n.has_tag_name(kind) && n.attribute("name") == Some(name));
            found.unwrap_or_else(|| panic!("no {kind} {name}")).id()
        };
        for j in 0..case.model.joints() {
            let (joint, link) = (format!("joint_{j}"), format!("machine_link_{j}"));
            let s = ours.get_node(named(model, "joint", &joint)).unwrap();
            let u = theirs.get_node(named(robot, "joint", &joint)).unwrap();
            let pose = format!("{} {}", attribute(u, "origin", "xyz"), attribute(u, "origin", "rpy"));
            assert_eq!(child(s, "pose"), pose, "{name}");
            assert_eq!(child(s, "parent"), attribute(u, "parent", "link"));
            assert_eq!(attribute(s, "pose", "relative_to"), child(s, "parent"));
            assert_eq!(child(s, "child"), link);
            assert_eq!(child(s, "axis/xyz"), attribute(u, "axis", "xyz"));
            assert_eq!(child(s, "axis/dynamics/damping"), attribute(u, "dynamics", "damping"));
            assert_eq!(child(s, "axis/dynamics/friction"), attribute(u, "dynamics", "friction"));
            assert_eq!(s.attribute("type") == Some("prismatic"), u.attribute("type") == Some("prismatic"));
            let s = ours.get_node(named(model, "link", &link)).unwrap();
            let u = theirs.get_node(named(robot, "link", &link)).unwrap();
            assert_eq!(attribute(s, "pose", "relative_to"), joint);
            assert_eq!(child(s, "inertial/mass"), attribute(u, "inertial/mass", "value"));
            let at = format!("{} 0 0 0", attribute(u, "inertial/origin", "xyz"));
            assert_eq!(child(s, "inertial/pose"), at);
            for entry in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
                let value = attribute(u, "inertial/inertia", entry);
                assert_eq!(child(s, &format!("inertial/inertia/{entry}")), value, "{name}");
            }
        }
        assert!(sdf_text.contains("<spring_stiffness>"), "{sdf_text}");
        assert!(sdf.lost.iter().any(|l| l.starts_with("rotor inertia of joint 1")), "{:?}", sdf.lost);
        assert!(!sdf.lost.iter().any(|l| l.starts_with("spring")), "{:?}", sdf.lost);
    }
}

#[test]
fn files_state_their_model_and_what_is_lost() {
    let (case, provenance) = (case(arm(), true), provenance());
    let source = source(&case, &provenance);
    let c = c::export(&source, &checks(&case, 2)).unwrap();
    let mjcf = mjcf::export(&source).unwrap();
    let urdf = urdf::export(&source).unwrap();
    for (name, text) in c.files.iter().chain(&mjcf.files).chain(&urdf.files) {
        assert!(text.contains("rd_\"calibrated\".json (schema 1, aurt 0.1.0)"), "{name}");
        assert!(text.contains("BLAKE3 of the model: 0123"), "{name}");
    }
    assert!(c.files[1].1.contains("void machine_torque(const double q[6]"), "{}", c.files[1].1);
    let xml = &mjcf.files[0].1;
    for word in ["armature=", "damping=", "frictionloss=", "stiffness=", "springref="] {
        assert!(xml.contains(word), "`{word}` is missing");
    }
    for word in
        ["joint 1, coulomb friction `absolute`: F_C1 = ", "arm term current_offset", "hysteresis `tanh`"]
    {
        assert!(mjcf.lost.iter().any(|l| l.contains(word)), "`{word}` is missing in {:#?}", mjcf.lost);
    }
}

#[test]
fn what_cannot_be_exported_is_refused_by_name() {
    let (case, provenance) = (case(gantry(), true), provenance());
    let good = source(&case, &provenance);
    let refusal = |source: &Source<'_>| c::export(source, &[]).unwrap_err().to_string();
    assert!(refusal(&Source { unit: MeasurementUnit::Ampere, ..good }).contains("torque_constants_nm_per_a"));
    assert!(refusal(&Source { name: "my robot", ..good }).contains("`my robot` is no identifier"));
    let standard = None;
    let error = mjcf::export(&Source { standard, ..good }).unwrap_err();
    assert!(matches!(error, ExportError::NoBodies), "{error}");
    let mut impossible = case.standard.clone();
    impossible[9] = -1.0;
    let error = mjcf::export(&Source { standard: Some(&impossible), ..good }).unwrap_err().to_string();
    assert!(error.contains("link 0: the mass is -1 kg"), "{error}");
    let mut coefficients = case.coefficients.clone();
    coefficients[1] = f64::NAN;
    assert!(refusal(&Source { coefficients: &coefficients, ..good }).contains("is NaN"));

    let term = TorqueRipple { cycles_per_revolution: 2.0, orders: vec![1], joints: JointSelection::all() };
    let base = case.model.base().clone();
    let (stacks, terms) = (case.model.stacks().to_vec(), vec![Box::new(term) as Box<dyn ArmTerm>]);
    let model = RobotModel::new(case.model.rigid_body().clone(), base, stacks, terms).unwrap();
    let coefficients = vec![1.0; model.parameters().len()];
    let load = LoadTorque::Literal;
    let refused = refusal(&Source { model: &model, coefficients: &coefficients, load: &load, ..good });
    assert!(
        refused.starts_with(
            "arm term: the model `torque_ripple` cannot be exported: its equation is not known to this export"
        ),
        "{refused}"
    );
}
