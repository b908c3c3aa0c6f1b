use std::collections::BTreeMap;
use std::ops::Range;

use aurt_calibration::drives::{DrivenJoint, Floor, Mechanics, Selection};
use aurt_plugins::{Node, NodeKind};
use aurt_traits::{CommandSignal, DriveModel, DriveParameter};
use serde_json::json;

use super::section::Section;

/// `[drive]`: the drives of all joints, what else of the joints a simulation needs, and which numbers are estimated.
#[derive(Debug, Clone)]
pub struct Drive {
    pub span: Range<usize>,
    pub joints: Vec<DrivenJoint>,
    /// `command`: the commands between two rows.
    pub command: CommandSignal,
    /// `[drive.floor]`: what the last link can touch.
    pub floor: Option<Floor>,
    /// `estimate`, `shared` and `[drive.deviations]`.
    pub selection: Selection,
    /// `position_deviation_rad`: what the model is expected to miss.
    pub position_deviation_rad: Option<f64>,
    /// `piece_s`: length of the pieces of multiple shooting; whole recordings without.
    pub piece_s: Option<f64>,
}

/// Keys that had another name, by drive: the former one, that of today, and its meaning.
const RENAMED: [(&str, &str, &str, &str); 1] = [(
    "position_servo",
    "damping_nm_s_per_rad",
    "back_emf_nm_s_per_rad",
    "it is K_e, the braking by the back-EMF outside the saturation; K_d is `firmware_damping_nm_s_per_rad`",
)];

impl Drive {
    /// Reads `[drive]`. Every number is one for all joints or a list of one for each.
    pub(super) fn read(mut section: Section<'_, '_>, joints: Option<usize>) -> Option<Self> {
        let model =
            section.require("model", "model = \"position_servo\"").and_then(|node| model(&section, node));
        // Without a model none of its keys is known, and all of them would be complained about.
        let model = model?;
        let renamed = RENAMED.iter().filter(|r| r.0 == model.name());
        for (_, key, today, meaning) in renamed {
            section.renamed(key, today, meaning);
        }
        let mechanics = Mechanics::default().numbers();
        let of_drive = model.parameters();
        // Of a robot that cannot be read, the keys are known all the same.
        let numbers = of_drive.iter().chain(&mechanics);
        let count = joints.unwrap_or(1);
        let by_key: Vec<Vec<f64>> = numbers.map(|p| numbers_of(&mut section, p, count)).collect();
        let signals = [("hold", CommandSignal::Hold), ("linear", CommandSignal::Linear)];
        let command = section.choice("command", &signals).unwrap_or_else(|| model.usual_signal());
        let floor = section.section("floor").map(read_floor);
        let mut known: Vec<String> =
            of_drive.iter().chain(&mechanics).map(|p| p.parameter.name.clone()).collect();
        known.extend(Floor::default().numbers().into_iter().map(|p| format!("floor_{}", p.parameter.name)));
        let estimate = keys(&mut section, "estimate", &known);
        let shared = keys(&mut section, "shared", &known);
        let deviations =
            section.section("deviations").map_or_else(Vec::new, |below| deviations(below, &known));
        let position_deviation_rad = section.positive("position_deviation_rad");
        let piece_s = section.positive("piece_s");
        let span = section.span().clone();
        section.finish();
        let joints = (0..joints?).map(|j| {
            let values: Vec<f64> = by_key.iter().map(|values| values[j]).collect();
            let (own, rest) = values.split_at(of_drive.len());
            let mut joint = DrivenJoint { drive: model.clone(), mechanics: Mechanics::default() };
            joint.drive.set_parameters(own);
            joint.mechanics.set_numbers(rest);
            joint
        });
        let selection = Selection { estimate, shared, deviations };
        let joints = joints.collect();
        Some(Self { span, joints, command, floor, selection, position_deviation_rad, piece_s })
    }
}

fn model(section: &Section<'_, '_>, node: &Node) -> Option<Box<dyn DriveModel>> {
    let name = section.text_of("model", node)?;
    let built = serde_json::from_value::<Box<dyn DriveModel>>(json!({ "model": name }));
    built.map_err(|error| section.complain("model", node, &format!("names no drive: {error}"), None)).ok()
}

fn numbers_of(section: &mut Section<'_, '_>, number: &DriveParameter, joints: usize) -> Vec<f64> {
    let key = &number.parameter.name;
    let default = vec![number.value; joints];
    let Some(node) = section.take(key) else { return default };
    let values = if matches!(node.kind, NodeKind::Array(_)) {
        let values = section.numbers_of(key, node).unwrap_or_default();
        section.one_per_joint(key, node, values.len());
        values
    } else {
        section.number_of(key, node).map_or_else(Vec::new, |value| vec![value; joints])
    };
    let [least, greatest] = number.bounds;
    if let Some(value) = values.iter().find(|v| **v < least || **v > greatest) {
        section.complain(key, node, &format!("must lie within {least} and {greatest}, is {value}"), None);
    }
    if values.len() == joints { values } else { default }
}

fn read_floor(mut section: Section<'_, '_>) -> Floor {
    let mut floor = Floor::default();
    let values: Vec<f64> =
        floor.numbers().iter().map(|number| numbers_of(&mut section, number, 1).swap_remove(0)).collect();
    floor.set_numbers(&values);
    section.finish();
    floor
}

/// A list of keys, each with or without a joint behind it.
fn keys(section: &mut Section<'_, '_>, key: &str, known: &[String]) -> Vec<String> {
    let Some(node) = section.take(key) else { return Vec::new() };
    let NodeKind::Array(items) = &node.kind else {
        section.expected(key, node, "a list of keys");
        return Vec::new();
    };
    items.iter().filter_map(|item| is_known(section, key, item, section.text_of(key, item)?, known)).collect()
}

fn is_known(section: &Section<'_, '_>, key: &str, at: &Node, name: &str, known: &[String]) -> Option<String> {
    let (stem, joint) = name.rsplit_once('_').map_or((name, ""), |(stem, joint)| (stem, joint));
    let stem = if joint.parse::<usize>().is_ok() { stem } else { name };
    if known.iter().any(|k| k == stem) {
        return Some(name.to_owned());
    }
    let today = RENAMED.iter().find(|r| r.1 == stem && known.iter().any(|k| k == r.2));
    let help = match today {
        Some((.., today, meaning)) => format!("it is called `{today}` today; {meaning}"),
        None => aurt_plugins::suggestion::help(stem, "numbers", known.iter().map(String::as_str)),
    };
    section.complain(key, at, &format!("names \"{name}\", which this drive does not have"), Some(help));
    None
}

fn deviations(mut section: Section<'_, '_>, known: &[String]) -> Vec<(String, f64)> {
    let mut found: BTreeMap<String, f64> = BTreeMap::new();
    for (_, key, today, meaning) in &RENAMED {
        if !known.iter().any(|k| k == key) && known.iter().any(|k| k == today) {
            section.renamed(key, today, meaning);
        }
    }
    for key in known {
        if let Some(value) = section.positive(key) {
            found.insert(key.clone(), value);
        }
    }
    section.finish();
    found.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use aurt_plugins::Registry;
    use aurt_traits::CommandSignal;

    use crate::Experiment;

    fn read(drive: &str, calibration: &str) -> Result<Experiment, String> {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("mdh.csv", "alpha,a,d\n0,0,0\n0,1,0\n"), ("a.csv", "")] {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let text = format!(
            "schema = 1\n[robot]\nmdh = \"mdh.csv\"\ngravity_m_s2 = [0.0, -9.81, 0.0]\n[recordings]\n\
             calibration = [\"a.csv\"]\n[drive]\n{drive}\n{calibration}"
        );
        let path = folder.path().join("experiment.toml");
        Experiment::parse(&text, Path::new(&path), &mut Registry::linked().unwrap())
            .map_err(|e| e.to_string())
    }

    #[test]
    fn a_drive_is_read_and_brings_its_estimator() {
        let experiment = read(
            "model = \"position_servo\"\nestimate = [\"delay_s\", \"coulomb_nm_1\"]\nshared = [\"delay_s\"]\n\
             gain_nm_per_rad = [7.0, 8]\ncoulomb_nm = 0.2\n[drive.floor]\nheight_m = -0.1\n[drive.deviations]\ndelay_s = 0.01",
            "",
        )
        .unwrap();
        let drive = experiment.drive.unwrap();
        assert_eq!(drive.joints[1].drive.parameters()[0].value, 8.0);
        assert_eq!(drive.joints[0].mechanics.coulomb_nm, 0.2);
        assert_eq!(drive.command, CommandSignal::Hold);
        assert_eq!(drive.floor.unwrap().height_m, -0.1);
        assert_eq!(drive.selection.deviations, [("delay_s".to_owned(), 0.01)]);
    }

    #[test]
    fn mistakes_are_detected_with_the_fix() {
        for (drive, calibration, expected) in [
            ("model = \"servo\"", "", "unknown variant `servo`, expected"),
            ("model = \"pd_law\"\ndelays = 1", "", "has no key `delays`"),
            ("model = \"pd_law\"\ndelay_s = -1", "", "must lie within 0 and 0.5, is -1"),
            ("model = \"pd_law\"\ndelay_s = [0.1]", "", "delay_s"),
            ("model = \"pd_law\"\nestimate = [\"dead_band_rad\"]", "", "which this drive does not have"),
            ("model = \"pd_law\"\ncommand = \"held\"", "", "did you mean `hold`"),
            (
                "model = \"position_servo\"\ndamping_nm_s_per_rad = 0.3",
                "",
                "is called `back_emf_nm_s_per_rad` today",
            ),
            (
                "model = \"position_servo\"\nestimate = [\"damping_nm_s_per_rad\"]",
                "",
                "K_d is `firmware_damping_nm_s_per_rad`",
            ),
            (
                "model = \"position_servo\"\n[drive.deviations]\ndamping_nm_s_per_rad = 0.3",
                "",
                "K_d is `firmware_damping_nm_s_per_rad`",
            ),
            ("model = \"pd_law\"", "[calibration]\nestimator = \"wls\"", "fits torques"),
            (
                "model = \"pd_law\"",
                "[joint_dynamics]\nviscous = { model = \"polynomial\" }",
                "stands in [drive]",
            ),
        ] {
            let error = read(drive, calibration).unwrap_err();
            assert!(error.contains(expected), "{expected}: {error}");
        }
    }
}
