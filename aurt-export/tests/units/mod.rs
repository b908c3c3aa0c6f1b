//! Functional mock-up units: what is in the archive, and what the model in it does.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::path::Path;
use std::process::{Output, Stdio};

use aurt_export::fmu::{Fmu, Kind, export};
use aurt_export::{Check, ExportError, Source};
use aurt_simulation::model::{ModelDrive, MovingModel};
use aurt_traits::{MeasurementUnit, Motion};

use super::models::{
    Case, Load, arm, case, case_with_load, case_with_memory, checks_along_a_path, checks_along_a_swing,
    gantry, half_of_gravity, two_arms,
};
use super::{compile, compiled, named_by_other_people, source};

pub fn files(fmu: &Fmu) -> BTreeMap<String, Vec<u8>> {
    let mut archive = zip::ZipArchive::new(Cursor::new(&fmu.bytes)).unwrap();
    (0..archive.len())
        .map(|k| {
            let mut file = archive.by_index(k).unwrap();
            let mut contents = Vec::new();
            file.read_to_end(&mut contents).unwrap();
            (file.name().unwrap().into_owned(), contents)
        })
        .collect()
}

pub fn text(files: &BTreeMap<String, Vec<u8>>, name: &str) -> String {
    String::from_utf8(files[name].clone()).unwrap()
}

#[test]
fn the_archive_holds_what_the_standard_asks_for_and_is_the_same_every_time() {
    let case = case(gantry(), true);
    for kind in [Kind::Inverse, Kind::Forward] {
        let fmu = export(&source(&case), kind).unwrap();
        assert_eq!(fmu, export(&source(&case), kind).unwrap());
        assert_eq!(fmu.file, "machine.fmu");
        let files = files(&fmu);
        let xml = text(&files, "modelDescription.xml");
        let document = roxmltree::Document::parse(&xml).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("fmiVersion"), Some("2.0"));
        let token = root.attribute("guid").unwrap();
        assert!(text(&files, "sources/model.h").contains(&format!("#define MODEL_TOKEN \"{token}\"")));
        assert!(root.attribute("description").unwrap().contains("rd_\"calibrated\".json (schema 1"));
        let named = document.descendants().filter(|n| n.has_tag_name("File"));
        let mut listed: Vec<String> = named.map(|n| n.attribute("name").unwrap().to_owned()).collect();
        listed.sort();
        let in_archive: Vec<String> = files
            .keys()
            .filter_map(|f| f.strip_prefix("sources/").filter(|f| f.ends_with(".c")).map(str::to_owned))
            .collect();
        assert_eq!(listed, in_archive);
        let made = fmu.notes.iter().any(|n| n.contains("binaries/linux64/machine.so was made"));
        assert_eq!(made, files.contains_key("binaries/linux64/machine.so"), "{:?}", fmu.notes);
        compiles_strictly(&files);
        assert!(made || fmu.notes.iter().any(|n| n.contains("holds sources only")), "{:?}", fmu.notes);
    }
}

/// Writes the sources of a unit to a folder; the names of those to be compiled.
fn write_sources(files: &BTreeMap<String, Vec<u8>>, folder: &Path) -> Vec<String> {
    let sources = files.iter().filter_map(|(name, text)| Some((name.strip_prefix("sources/")?, text)));
    let written = sources.inspect(|(name, text)| std::fs::write(folder.join(name), text).unwrap());
    written.map(|(name, _)| name.to_owned()).filter(|name| name.ends_with(".c")).collect()
}

/// Whether the C of a unit passes a strict look; nothing where there is no C compiler.
fn compiles_strictly(files: &BTreeMap<String, Vec<u8>>) {
    let folder = tempfile::tempdir().unwrap();
    let sources = write_sources(files, folder.path());
    if let Some(look) = compile("cc", folder.path(), &sources, &["-fsyntax-only"]) {
        assert!(look.status.success(), "{}", String::from_utf8_lossy(&look.stderr));
    }
}

#[test]
fn variables_have_names_units_and_start_values() {
    let case = case(gantry(), true);
    let fmu = export(&source(&case), Kind::Forward).unwrap();
    let xml = text(&files(&fmu), "modelDescription.xml");
    let document = roxmltree::Document::parse(&xml).unwrap();
    let find = |name: &str, key: &str| {
        let mut named = document.descendants().filter(|n| n.has_tag_name("ScalarVariable"));
        let variable = named.find(|n| n.attribute("name") == Some(name)).unwrap();
        variable.attribute(key).or_else(|| variable.first_element_child()?.attribute(key)).map(str::to_owned)
    };
    assert_eq!(find("q[0]", "unit").as_deref(), Some("m"), "the first joint slides");
    assert_eq!(find("q[1]", "unit").as_deref(), Some("rad"));
    assert_eq!(find("tau[1]", "causality").as_deref(), Some("input"));
    assert_eq!(find("gravity_m_s2", "start").as_deref(), Some("9.81"));
    assert_eq!(find("q_start[3]", "variability").as_deref(), Some("fixed"));
    assert_eq!(find("payload_mass_kg", "variability").as_deref(), Some("tunable"));
    for (parameter, value) in
        case.model.parameters().iter().zip(&case.coefficients).skip(case.model.base().len())
    {
        let start: f64 = find(&parameter.name, "start").unwrap().parse().unwrap();
        assert_eq!(start, *value, "{}", parameter.name);
    }
    let outputs = document.descendants().find(|n| n.has_tag_name("Outputs")).unwrap();
    let outputs = outputs.children().filter(|n| n.has_tag_name("Unknown")).count();
    assert_eq!(outputs, 3 * case.model.joints());
}

#[test]
fn what_cannot_be_a_unit_is_refused_by_name() {
    let case = case(gantry(), true);
    let good = source(&case);
    let refusal = |source: &Source<'_>, kind| export(source, kind).unwrap_err();
    for name in ["my robot", "component", "double"] {
        assert!(
            matches!(refusal(&Source { name, ..good }, Kind::Inverse), ExportError::Name { .. }),
            "{name}"
        );
    }
    let mut coefficients = case.coefficients.clone();
    for value in &mut coefficients[..case.model.base().len()] {
        *value = -*value;
    }
    let impossible = Source { coefficients: &coefficients, ..good };
    let error = refusal(&impossible, Kind::Forward);
    assert!(matches!(error, ExportError::MassMatrix { .. }), "{error}");
    assert!(error.to_string().contains("not positive definite at q = "), "{error}");
    assert!(export(&impossible, Kind::Inverse).is_ok(), "a torque it has all the same");
    // Currents need no constants: what goes in and comes out is what was measured.
    let amperes = Source { unit: MeasurementUnit::Ampere, ..good };
    let xml = text(&files(&export(&amperes, Kind::Inverse).unwrap()), "modelDescription.xml");
    assert!(xml.contains("name=\"current[0]\"") && !xml.contains("payload_mass_kg"), "{xml}");
    assert!(xml.contains("in A s/rad") && !xml.contains("Nm s/rad"), "{xml}");
}

/// Compiles the sources of a unit strictly, with the program that drives it, and drives it; nothing where there is no C
/// compiler.
fn driven(fmu: &Fmu, arguments: &[String], lines: &str) -> Option<Output> {
    let folder = tempfile::tempdir().unwrap();
    let mut sources = write_sources(&files(fmu), folder.path());
    let drive = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/units/drive.c");
    std::fs::copy(drive, folder.path().join("drive.c")).unwrap();
    sources.push("drive.c".into());
    let mut run = compiled(folder.path(), &sources)?
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    run.stdin.take().unwrap().write_all(lines.as_bytes()).unwrap();
    Some(run.wait_with_output().unwrap())
}

fn rows(output: &Output) -> Vec<Vec<f64>> {
    let (text, error) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{error}");
    text.lines().map(|line| line.split(' ').map(|v| v.parse().unwrap()).collect()).collect()
}

fn line(groups: &[&[f64]]) -> String {
    let words: Vec<String> = groups.iter().flat_map(|g| g.iter().map(|v| format!("{v:?}"))).collect();
    words.join(" ") + "\n"
}

fn largest(a: impl Iterator<Item = f64>) -> f64 {
    a.fold(0.0, |m, x| if x.abs() > m || x.is_nan() { x.abs() } else { m })
}

/// The largest difference of torques, relative to the largest.
fn apart(found: &[Vec<f64>], stored: &[Check]) -> f64 {
    assert_eq!(found.len(), stored.len());
    let pairs = found.iter().zip(stored).flat_map(|(f, c)| f.iter().zip(&c.torque_nm));
    let size = largest(stored.iter().flat_map(|c| c.torque_nm.clone()));
    largest(pairs.map(|(f, s)| f - s)) / size
}

fn states(stored: &[Check]) -> String {
    stored.iter().map(|c| line(&[&c.q_rad, &c.qd_rad_s, &c.qdd_rad_s2])).collect()
}

#[test]
fn an_inverse_unit_gives_the_torques_of_the_model() {
    let cases = [(case(arm(), true), "arm"), (case_with_memory(arm()), "arm with memory")];
    for (case, name) in cases.into_iter().chain([(named_by_other_people(), "arm with names of other people")])
    {
        let stored = checks_along_a_path(&case, 300);
        let fmu = export(&source(&case), Kind::Inverse).unwrap();
        let Some(run) = driven(&fmu, &["0.01".into()], &states(&stored)) else { return };
        let worst = apart(&rows(&run), &stored);
        println!("{name}: largest difference of the torque {worst:e}, relative to the largest");
        assert!(worst <= 1e-12, "{name}: {worst:e}");
    }
}

/// A reference of a variable with its value, as the program that drives takes it.
fn set(fmu: &Fmu, name: &str, value: f64) -> String {
    let xml = text(&files(fmu), "modelDescription.xml");
    let document = roxmltree::Document::parse(&xml).unwrap();
    let variable = document.descendants().find(|n| n.attribute("name") == Some(name)).unwrap();
    format!("{}={value:?}", variable.attribute("valueReference").unwrap())
}

#[test]
fn gravity_and_a_load_that_are_changed_act_as_in_a_model_that_has_them() {
    let (lighter, loaded) = (half_of_gravity(arm()), Load { mass_kg: 1.7, at_m: [0.03, -0.02, 0.11] });
    let nothing = Load { mass_kg: 0.0, ..loaded };
    let mut coefficient = case(arm(), true);
    let place = coefficient.model.base().len() + 2;
    let name = coefficient.model.parameters()[place].name.clone();
    let unit = export(&source(&coefficient), Kind::Inverse).unwrap();
    let changed = set(&unit, &name, 7.5);
    coefficient.coefficients[place] = 7.5;
    let [x, y, z] = loaded.at_m;
    let of_load = |unit: &Fmu| -> Vec<String> {
        [("payload_mass_kg", loaded.mass_kg), ("payload_x_m", x), ("payload_y_m", y), ("payload_z_m", z)]
            .map(|(name, value)| set(unit, name, value))
            .to_vec()
    };
    let heavy = export(&source(&case(arm(), true)), Kind::Inverse).unwrap();
    let empty = export(&source(&case_with_load(arm(), nothing)), Kind::Inverse).unwrap();
    let half = set(&heavy, "gravity_m_s2", 0.5 * (9.81_f64.powi(2) + 0.09).sqrt());
    for (what, unit, arguments, other) in [
        ("a coefficient", &unit, vec![changed], coefficient),
        ("gravity", &heavy, vec![half], case(lighter, true)),
        ("a load", &empty, of_load(&empty), case_with_load(arm(), loaded)),
    ] {
        let stored = checks_along_a_path(&other, 60);
        let arguments: Vec<String> = std::iter::once("0.01".to_owned()).chain(arguments).collect();
        let Some(run) = driven(unit, &arguments, &states(&stored)) else { return };
        let worst = apart(&rows(&run), &stored);
        assert!(worst <= 1e-12, "{what}: {worst:e}");
    }
}

/// The same torques drive the unit and the solver of `aurt simulate`; the largest differences of their positions and
/// velocities.
fn distance(case: &Case, stored: &[Check], step_s: f64) -> Option<[f64; 2]> {
    let joints = case.model.joints();
    let series = |of: fn(&Check) -> &Vec<f64>| -> Vec<f64> {
        (0..joints).flat_map(|j| stored.iter().map(move |c| of(c)[j])).collect()
    };
    let times = stored.iter().map(|c| c.time_s).collect();
    let (q, v, a) = (series(|c| &c.q_rad), series(|c| &c.qd_rad_s), series(|c| &c.qdd_rad_s2));
    let motion = Motion::new(joints, times, q, v, a).unwrap();
    let torque = (0..joints).map(|j| stored.iter().map(|c| c.torque_nm[j]).collect()).collect();
    let moving = MovingModel { model: &case.model, coefficients: &case.coefficients, load: &case.load };
    let moved = moving.run(&ModelDrive::Torques { motion, torque }, &mut |_| {});
    let moved = moved.unwrap_or_else(|error| panic!("{error}"));
    println!("{} evaluations of the model in {} s", moved.evaluations, moved.time_s[moved.time_s.len() - 1]);

    let fmu = export(&source(case), Kind::Forward).unwrap();
    let lines: String = stored
        .windows(2)
        .map(|pair| {
            let rate: Vec<f64> =
                pair[1].torque_nm.iter().zip(&pair[0].torque_nm).map(|(b, a)| (b - a) / step_s).collect();
            line(&[&pair[0].torque_nm, &rate])
        })
        .collect();
    let mut arguments = vec![format!("{step_s}")];
    arguments
        .extend(stored[0].q_rad.iter().enumerate().map(|(j, q)| format!("{}={q:?}", 1 + 5 * joints + j)));
    arguments
        .extend(stored[0].qd_rad_s.iter().enumerate().map(|(j, v)| format!("{}={v:?}", 1 + 6 * joints + j)));
    let found = rows(&driven(&fmu, &arguments, &lines)?);
    assert_eq!(found.len(), stored.len() - 1);

    let away = |first: usize, series: &[Vec<f64>]| {
        let of_row = |(n, row): (usize, &Vec<f64>)| -> Vec<f64> {
            (0..joints).map(|j| row[first + j] - series[j][n + 1]).collect()
        };
        largest(found.iter().enumerate().flat_map(of_row))
    };
    let way = largest(moved.position_rad.iter().flatten().copied());
    assert!(way > 0.1, "the model has to move: {way}");
    Some([away(0, &moved.position_rad), away(joints, &moved.velocity_rad_s)])
}

#[test]
fn a_forward_unit_moves_as_the_simulation_does() {
    for (mut case, name) in [
        (case(arm(), true), "arm"),
        (case(gantry(), true), "gantry"),
        (case(two_arms(), true), "two arms"),
        (case_with_memory(arm()), "arm with memory"),
        (case_with_memory(gantry()), "gantry with memory"),
        (named_by_other_people(), "arm with names of other people"),
    ] {
        // Friction that grows faster than its load would lock the joints.
        let base = case.model.base().len();
        for (parameter, value) in case.model.parameters().iter().zip(&mut case.coefficients).skip(base) {
            *value *= if parameter.unit == "1/Nm" { 1e-4 } else { 0.05 };
        }
        let stored = checks_along_a_swing(&case, 101, 0.01);
        let Some([position, velocity]) = distance(&case, &stored, 0.01) else { return };
        println!("{name}: largest differences {position:e} rad or m, {velocity:e} rad/s or m/s");
        assert!(position <= 1e-10 && velocity <= 1e-9, "{name}: {position:e} {velocity:e}");
    }
}

#[test]
fn an_arm_that_is_let_go_falls_and_one_whose_friction_bears_its_weight_rests() {
    let heavy = || case_with_load(arm(), Load { mass_kg: 5.0, at_m: [0.1, 0.0, 0.0] });
    for (mut case, share, falls) in [
        (heavy(), 0.05, true),
        (case_with_memory(arm()), 0.05, true),
        (case_with_memory(arm()), 200.0, false),
    ] {
        let base = case.model.base().len();
        let parameters: Vec<_> =
            case.model.parameters().iter().map(|p| (p.name.clone(), p.unit.clone())).collect();
        for ((name, unit), value) in parameters.iter().zip(&mut case.coefficients).skip(base) {
            // Friction without load bears the weight or not; what grows with the load is left out.
            if unit == "1" || unit == "1/Nm" {
                *value = 0.0;
            } else if !name.starts_with("payload.") {
                *value *= share;
            }
        }
        let fmu = export(&source(&case), Kind::Forward).unwrap();
        let joints = case.model.joints();
        let lines = line(&[&vec![0.0; 2 * joints]]).repeat(60);
        let Some(run) = driven(&fmu, &["0.005".into()], &lines) else { return };
        let found = rows(&run);
        let way = largest(found[59][..joints].iter().copied());
        println!("share {share}: {way:e} rad in 0.3 s");
        assert!(if falls { way > 0.05 } else { way < 0.02 }, "share {share}: {way:e}");
    }
}
