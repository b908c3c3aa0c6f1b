//! Exports against what the model itself predicts, run by the programs that they are made for.
#![expect(clippy::unwrap_used, reason = "a test that panics has failed")]

mod corrected;
mod crates;
mod models;
mod units;

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::LazyLock;

use aurt_export::{Export, ExportError, Provenance, Source, c, fmu, is_export, mjcf, rust, sdf, urdf};
use aurt_friction::arm_terms::joint_selection::JointSelection;
use aurt_friction::arm_terms::torque_ripple::TorqueRipple;
use aurt_rbd::robots::{KNOWN_ROBOTS, Part};
use aurt_rbd::{ChainDynamics, RobotDescription};
use aurt_traits::{ArmTerm, LoadTorque, MeasurementUnit, RobotModel};

use roxmltree::{Document, Node};

use models::{Case, arm, case, case_with_memory, checks, checks_along_a_path, gantry, two_arms};

static PROVENANCE: LazyLock<Provenance> = LazyLock::new(|| Provenance {
    file: "rd_\"calibrated\".json".into(),
    schema: 1,
    blake3: "0123".into(),
    aurt_version: Some("0.1.0".into()),
    // What would end comments and elements, if it were written as it is.
    recordings: ["monday/*.csv", "a -- b??/", "a & b <c>.csv"].map(str::to_owned).to_vec(),
});

fn source(case: &Case) -> Source<'_> {
    Source {
        name: "machine",
        model: &case.model,
        coefficients: &case.coefficients,
        load: &case.load,
        unit: MeasurementUnit::NewtonMetre,
        standard: Some(&case.standard),
        provenance: &PROVENANCE,
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

const STRICT: [&str; 5] = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"];

/// Compiles C strictly; nothing where there is no such compiler.
fn compile(compiler: &str, folder: &Path, sources: &[impl AsRef<OsStr>], more: &[&str]) -> Option<Output> {
    let mut command = Command::new(compiler);
    command.args(STRICT).args(sources).args(more).current_dir(folder);
    command.output().inspect_err(|_| println!("skipped: there is no C compiler `{compiler}`")).ok()
}

/// A program of C sources, `check` in their folder, with sanitizers where their libraries are installed; nothing where there
/// is no C compiler.
fn compiled(folder: &Path, sources: &[impl AsRef<OsStr>]) -> Option<Command> {
    let output = ["-O1", "-o", "check", "-lm"];
    let sanitizers = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    let mut compiled = compile("cc", folder, sources, &[&output[..], &sanitizers].concat())?;
    if !compiled.status.success() {
        println!("without sanitizers");
        compiled = compile("cc", folder, sources, &output)?;
    }
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    Some(Command::new(folder.join("check")))
}

/// Compiles and runs an export; nothing where there is no C compiler.
fn compiled_and_run(export: &Export) -> Option<Output> {
    let folder = tempfile::tempdir().unwrap();
    write(export, folder.path());
    let sources = ["machine.c", "main.c"];
    if let Some(other) = compile("clang", folder.path(), &sources, &["-O1", "-o", "check", "-lm"]) {
        assert!(other.status.success(), "clang: {}", String::from_utf8_lossy(&other.stderr));
    }
    Some(compiled(folder.path(), &sources)?.output().unwrap())
}

#[test]
fn the_c_of_an_arm_and_of_a_gantry_predicts_what_their_models_do() {
    for (case, name) in
        [(case(arm(), true), "arm"), (case(gantry(), false), "gantry"), (case(two_arms(), true), "two arms")]
    {
        let stored = checks(&case, 32);
        let export = c::export(&source(&case), &stored).unwrap();
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
    let case = named_by_other_people();
    let source = source(&case);
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
    let document = Document::parse(xml).unwrap();
    let elements = document.descendants().filter(|node| node.has_tag_name(tag));
    elements.filter_map(|node| node.attribute("name").map(str::to_owned)).collect()
}

#[test]
fn the_c_of_friction_with_memory_predicts_what_the_models_do() {
    for (chain, name) in [(arm(), "arm"), (gantry(), "gantry")] {
        let case = case_with_memory(chain);
        let stored = checks_along_a_path(&case, 400);
        let export = c::export(&source(&case), &stored).unwrap();
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
        let export = c::export(&source(&case), &turned).unwrap();
        let Some(run) = compiled_and_run(&export) else { return };
        assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stdout));
    }
}

#[test]
fn the_check_of_the_c_fails_where_values_differ() {
    let case = case(gantry(), true);
    let mut stored = checks(&case, 8);
    stored[3].torque_nm[2] *= 1.0 + 1e-9;
    let export = c::export(&source(&case), &stored).unwrap();
    let Some(run) = compiled_and_run(&export) else { return };
    assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stdout));
    assert!(String::from_utf8_lossy(&run.stdout).contains("torque[2]: differs"));
}

/// The output of a script of these tests about a MuJoCo file and its further arguments, run by the Python with MuJoCo that the
/// environment names; none without it.
fn in_mujoco(script: &str, file: &Path, arguments: &[impl AsRef<OsStr>]) -> Option<String> {
    let Some(python) = std::env::var_os("AURT_PYTHON") else {
        println!("skipped: AURT_PYTHON names no Python with MuJoCo");
        return None;
    };
    if !Command::new(&python).args(["-c", "import mujoco"]).status().is_ok_and(|s| s.success()) {
        println!("skipped: {} has no MuJoCo", python.display());
        return None;
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(script);
    let run = Command::new(&python).arg(script).arg(file).args(arguments).output().unwrap();
    let text = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{text}\n{}", String::from_utf8_lossy(&run.stderr));
    Some(text.into_owned())
}

/// The largest difference of torques of bodies and rotors in MuJoCo, relative to the largest of the joint.
fn difference_in_mujoco(file: &Path, case: &Case, joints: &[&str]) -> Option<f64> {
    let bodies = ChainDynamics::new(case.chain.clone(), &case.standard).unwrap();
    let states = states(case, &mut bodies.with_rotor_inertia(&rotors(case)).unwrap());
    let states_file = file.with_file_name("states.json");
    std::fs::write(&states_file, serde_json::to_vec(&states).unwrap()).unwrap();
    let arguments: Vec<_> =
        std::iter::once(states_file.as_os_str()).chain(joints.iter().map(OsStr::new)).collect();
    let worst = in_mujoco("mujoco_inverse.py", file, &arguments)?.trim().parse().unwrap();
    println!("largest difference of mj_inverse {worst:e}, relative to the largest torque of the joint");
    Some(worst)
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
    let gravity_m_s2 = [0.0, 0.0, -9.81];
    let known =
        KNOWN_ROBOTS.iter().map(|robot| (robot.description().chain(gravity_m_s2).unwrap(), &*robot.name));
    for (chain, name) in
        [(arm(), "arm"), (gantry(), "gantry"), (two_arms(), "two arms")].into_iter().chain(known)
    {
        let case = case(chain, true);
        let export = mjcf::export(&source(&case)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        write(&export, folder.path());
        let Some(worst) = difference_in_mujoco(&folder.path().join("machine.xml"), &case, &[]) else {
            return;
        };
        assert!(worst <= 1e-9, "{name}: {worst:e}");
    }
}

#[test]
fn friction_of_a_mujoco_file_holds_what_it_bears() {
    let case = case(arm(), true);
    let folder = tempfile::tempdir().unwrap();
    write(&mjcf::export(&source(&case)).unwrap(), folder.path());
    let no_more: [&str; 0] = [];
    let Some(text) = in_mujoco("mujoco_creep.py", &folder.path().join("machine.xml"), &no_more) else {
        return;
    };
    let fastest: Vec<f64> =
        text.lines().map(|line| line.split(' ').next_back().unwrap().parse().unwrap()).collect();
    println!("creep, rad/s, with MuJoCo's settings and with those of the file: {fastest:?}");
    assert!(fastest[1] < 1e-4 * fastest[0], "{fastest:?}");
}

#[test]
fn the_bodies_of_a_urdf_or_mujoco_file_need_the_torques_of_the_model() {
    for (chain, name) in [(arm(), "arm"), (gantry(), "gantry"), (two_arms(), "two arms")] {
        let case = case(chain, true);
        let source = source(&case);
        for (export, wanted) in [
            (urdf::export(&source).unwrap(), "machine.urdf"),
            (mjcf::export(&source).unwrap(), "machine.xml"),
        ] {
            let (file, text) = &export.files[0];
            assert_eq!(file, wanted);
            let read = aurt_rbd::robots::parse(text, file, None, &Part::All, None).unwrap();
            let worst = case.difference(&read);
            println!("{name}, {file}: largest difference {worst:e} of the largest torque");
            assert!(worst <= 1e-12, "{name}, {file}: {worst:e}");
            let damped = read.friction.iter().filter(|f| f.viscous_nm_s_rad > 0.0).count();
            assert!(damped >= 2, "{:?}", read.friction);
            let lost = export.lost.iter().any(|l| l.starts_with("rotor inertia of joint 1"));
            assert_eq!(lost, file == "machine.urdf", "{:?}", export.lost);
        }
    }
}

fn inside<'a>(node: Node<'a, 'a>, path: &str) -> Node<'a, 'a> {
    path.split('/').fold(node, |at, step| {
        at.children().find(|c| c.has_tag_name(step)).unwrap_or_else(|| panic!("{path}"))
    })
}

fn named<'a>(root: Node<'a, 'a>, kind: &str, name: &str) -> Node<'a, 'a> {
    let found = root.children().find(|n| n.has_tag_name(kind) && n.attribute("name") == Some(name));
    found.unwrap_or_else(|| panic!("no {kind} {name}"))
}

#[test]
fn an_sdf_file_has_the_numbers_of_the_urdf_file() {
    for (chain, name) in [(arm(), "arm"), (gantry(), "gantry"), (two_arms(), "two arms")] {
        let case = case(chain, true);
        let source = source(&case);
        let (sdf, urdf) = (sdf::export(&source).unwrap(), urdf::export(&source).unwrap());
        let (sdf_text, urdf_text) = (&sdf.files[0].1, &urdf.files[0].1);
        let (ours, theirs) = (Document::parse(sdf_text).unwrap(), Document::parse(urdf_text).unwrap());
        let model = inside(ours.root_element(), "model");
        let robot = theirs.root_element();
        let child = |node, path: &str| inside(node, path).text().unwrap().to_owned();
        let attribute = |node, path: &str, name: &str| inside(node, path).attribute(name).unwrap().to_owned();
        for j in 0..case.model.joints() {
            let (joint, link) = (format!("joint_{j}"), format!("machine_link_{j}"));
            let s = named(model, "joint", &joint);
            let u = named(robot, "joint", &joint);
            let pose = format!("{} {}", attribute(u, "origin", "xyz"), attribute(u, "origin", "rpy"));
            assert_eq!(child(s, "pose"), pose, "{name}");
            assert_eq!(child(s, "parent"), attribute(u, "parent", "link"));
            assert_eq!(attribute(s, "pose", "relative_to"), child(s, "parent"));
            assert_eq!(child(s, "child"), link);
            assert_eq!(child(s, "axis/xyz"), attribute(u, "axis", "xyz"));
            assert_eq!(child(s, "axis/dynamics/damping"), attribute(u, "dynamics", "damping"));
            assert_eq!(child(s, "axis/dynamics/friction"), attribute(u, "dynamics", "friction"));
            assert_eq!(s.attribute("type") == Some("prismatic"), u.attribute("type") == Some("prismatic"));
            let s = named(model, "link", &link);
            let u = named(robot, "link", &link);
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
    let case = case(arm(), true);
    let source = source(&case);
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
    let case = case(gantry(), true);
    let good = source(&case);
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
