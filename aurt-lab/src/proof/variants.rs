//! Cases written differently: variants in which the robot is the same.

use std::fs;
use std::path::Path;

use toml_edit::{Array, DocumentMut, Item, TableLike, TomlError, Value, table, value};

use crate::product::Failure;

words! {
    /// A case in which the robot, and what is concealed in it, are the same.
    Variant {
        /// Half the band that the diagnosis took, asked for by `[diagnosis] f_dyn_hz`.
        FDynHalved = "f_dyn_halved",
        /// Twice that band.
        FDynDoubled = "f_dyn_doubled",
        /// The recordings of each role are listed in the opposite order.
        OtherOrder = "other_order",
        /// Every second row of the recordings.
        HalfRate = "half_rate",
        Degrees = "degrees",
        /// Every second recording outside the targets, from the first; no targets.
        FirstHalf = "first_half",
        SecondHalf = "second_half",
    }
}

const EXPERIMENT: &str = "experiment.toml";
const ROLES: [&str; 3] = ["calibration", "target", "validation"];
/// `f_dyn_hz` without the key.
const F_DYN_HZ: f64 = 10.0;
/// The least rate over `f_dyn_hz`: default cut-offs stay below half the rate.
const LEAST_RATE: f64 = 10.5;
const ANGLES: [&str; 6] = ["q", "qd", "actual_q", "actual_qd", "position", "velocity"];

type NamedFiles = Vec<(String, Vec<u8>)>;

/// The reason for which a case does not have a variant.
type Unfit = &'static str;

impl Variant {
    /// Whether it is a part of the case, to be compared with the other part.
    pub const fn is_half(self) -> bool {
        matches!(self, Self::FirstHalf | Self::SecondHalf)
    }

    /// The files of a case whose verdict was given in a band, if it states one.
    pub fn files(self, case: &Path, band_hz: Option<f64>) -> Result<Result<NamedFiles, Unfit>, Failure> {
        let mut files = read(case)?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let Some(experiment) = files.iter_mut().find(|(name, _)| name == EXPERIMENT) else {
            return Ok(Err("it has no experiment"));
        };
        let mut document: DocumentMut = text(&experiment.1).parse().map_err(|e: TomlError| {
            Failure::unfit(case.join(EXPERIMENT), e.message(), "make the case again")
        })?;
        let rates =
            files.iter().filter(|(name, _)| is_recording(name)).map(|(_, bytes)| rate_hz(&text(bytes)));
        let rate_hz = rates.fold(f64::INFINITY, f64::min);
        if let Err(reason) = self.edit(&mut document, rate_hz, band_hz) {
            return Ok(Err(reason));
        }
        for (name, bytes) in &mut files {
            match self {
                _ if name == EXPERIMENT => *bytes = document.to_string().into_bytes(),
                Self::HalfRate if is_recording(name) => *bytes = every_second_row(&text(bytes)).into_bytes(),
                Self::Degrees if is_recording(name) => *bytes = in_degrees(&text(bytes)).into_bytes(),
                _ => {}
            }
        }
        Ok(Ok(files))
    }

    /// Edits a case's experiment, whose recordings have at least `rate_hz` rows per second.
    fn edit(self, document: &mut DocumentMut, rate_hz: f64, band_hz: Option<f64>) -> Result<(), Unfit> {
        let has_drive = document.contains_key("drive");
        let Some(recordings) = document.get_mut("recordings").and_then(Item::as_table_like_mut) else {
            return Err("its experiment lists no recordings");
        };
        match self {
            Self::OtherOrder => return reverse(recordings),
            Self::FirstHalf => return halve(recordings, 0),
            Self::SecondHalf => return halve(recordings, 1),
            _ if has_drive => return Err("commands to drives are held from row to row, in any band"),
            Self::Degrees => {
                recordings.insert("angle", value("deg"));
                return Ok(());
            }
            Self::FDynHalved | Self::FDynDoubled | Self::HalfRate => {}
        }
        let few = "its rows are too few a second";
        if self == Self::HalfRate {
            let key = document.get("preprocess").and_then(|preprocess| preprocess.get("f_dyn_hz"));
            let whole = key.and_then(Item::as_integer).map(|whole| whole as f64);
            let f_dyn_hz = key.and_then(Item::as_float).or(whole).unwrap_or(F_DYN_HZ);
            return if 0.5 * rate_hz < LEAST_RATE * f_dyn_hz { Err(few) } else { Ok(()) };
        }
        let asked_hz =
            band_hz.ok_or("its verdict states no band")? * if self == Self::FDynHalved { 0.5 } else { 2.0 };
        if rate_hz < LEAST_RATE * asked_hz {
            return Err(few);
        }
        document.entry("diagnosis").or_insert_with(table)["f_dyn_hz"] = value(asked_hz);
        Ok(())
    }
}

fn read(folder: &Path) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let fail = |source| Failure::write(folder.to_owned(), source);
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        files.push((name, fs::read(&path).map_err(fail)?));
    }
    files.sort();
    Ok(files)
}

fn is_recording(name: &str) -> bool {
    name.starts_with("recording") && name.ends_with(".csv")
}

/// Rows per second of a recording whose first column is stamps in s.
fn rate_hz(csv: &str) -> f64 {
    let stamp = |line: &str| line.split(',').next().and_then(|cell| cell.trim().parse::<f64>().ok());
    let stamps: Vec<f64> = csv.lines().filter_map(stamp).collect();
    match stamps[..] {
        [first, .., last] => (stamps.len() - 1) as f64 / (last - first),
        _ => 0.0,
    }
}

fn every_second_row(csv: &str) -> String {
    let mut lines = csv.lines();
    let head = lines.next().into_iter();
    head.chain(lines.step_by(2)).flat_map(|line| [line, "\n"]).collect()
}

fn in_degrees(csv: &str) -> String {
    let mut lines = csv.lines();
    let Some(head) = lines.next() else { return String::new() };
    let is_angle = |name: &str| {
        let quantity = name.trim().trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_');
        ANGLES.contains(&quantity)
    };
    let angles: Vec<bool> = head.split(',').map(is_angle).collect();
    let mut text = format!("{head}\n");
    for line in lines {
        for (k, cell) in line.split(',').enumerate() {
            if k > 0 {
                text.push(',');
            }
            match cell.trim().parse::<f64>() {
                Ok(angle) if angles.get(k) == Some(&true) => text.push_str(&angle.to_degrees().to_string()),
                _ => text.push_str(cell),
            }
        }
        text.push('\n');
    }
    text
}

fn list<'a>(recordings: &'a mut dyn TableLike, role: &str) -> Option<&'a mut Array> {
    recordings.get_mut(role).and_then(Item::as_array_mut)
}

fn reverse(recordings: &mut dyn TableLike) -> Result<(), Unfit> {
    let mut has_two = false;
    for role in ROLES {
        if let Some(list) = list(recordings, role) {
            has_two |= list.len() > 1;
            let mut entries: Vec<Value> = list.iter().cloned().collect();
            entries.reverse();
            *list = entries.into_iter().collect();
        }
    }
    if has_two { Ok(()) } else { Err("no role has two recordings") }
}

/// Leaves every second recording outside the targets. What is held out beside targets is of the changed robot.
fn halve(recordings: &mut dyn TableLike, half: usize) -> Result<(), Unfit> {
    if recordings.remove("target").is_some() {
        recordings.remove("validation");
    }
    let mut place = 0;
    let mut halves = Vec::new();
    for role in ["calibration", "validation"] {
        let Some(list) = list(recordings, role) else { continue };
        let mut kept = Array::new();
        for entry in list.iter() {
            if place % 2 == half {
                let mut entry = entry.clone();
                entry.decor_mut().clear();
                kept.push(entry);
            }
            place += 1;
        }
        recordings.remove(role);
        halves.push((role, kept));
    }
    if place < 2 {
        return Err("one recording is outside the targets");
    }
    halves.retain(|(_, kept)| !kept.is_empty());
    // A half without a recording to calibrate on calibrates on what is held out.
    if let [(role, _)] = &mut halves[..] {
        *role = "calibration";
    }
    for (role, kept) in halves {
        recordings.insert(role, value(kept));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use aurt_experiment::Experiment;
    use aurt_files::output::write_folder;
    use aurt_plugins::{Node, Registry};
    use aurt_recording::{ReadOptions, Recording, read_recording};

    use super::*;
    use crate::case::{Plan, World};

    /// The band that is asked for, and the recordings of each role as an experiment reads them.
    fn read_case(folder: &Path) -> (Option<f64>, [Vec<Recording>; 3]) {
        let mut registry = Registry::linked().unwrap();
        let experiment = Experiment::read(folder.join(EXPERIMENT), &mut registry).unwrap();
        let parts = experiment.recordings;
        let lists = [parts.calibration, parts.target, parts.validation].map(|list| {
            let options = |recorded| ReadOptions { recorded, ..ReadOptions::default() };
            list.into_iter().map(|r| read_recording(&r.file, &options(r.recorded)).unwrap()).collect()
        });
        let asked = experiment.diagnosis.iter().flat_map(Node::entries).find(|entry| entry.key == "f_dyn_hz");
        (asked.and_then(|entry| entry.value.as_number()), lists)
    }

    /// Whether two lists have the same motions and measurements, row for row of every `step`.
    fn assert_same(lists: &[Vec<Recording>; 3], whole: &[Vec<Recording>; 3], step: usize) {
        for (a, b) in lists.iter().zip(whole) {
            assert_eq!(a.len(), b.len());
            for (a, b) in a.iter().zip(b) {
                let thinned = |series: &Vec<f64>| series.iter().copied().step_by(step).collect::<Vec<f64>>();
                assert_eq!(a.time_s, thinned(&b.time_s));
                assert_eq!(a.measurement, b.measurement.as_ref().map(|m| m.iter().map(thinned).collect()));
                for (a, b) in a.position_rad.iter().zip(&b.position_rad) {
                    assert!(a.iter().zip(thinned(b)).all(|(a, b)| (a - b).abs() < 1e-12));
                }
                let velocities = a.velocity_rad_s.iter().flatten().zip(b.velocity_rad_s.iter().flatten());
                for (a, b) in velocities {
                    assert!(a.iter().zip(thinned(b)).all(|(a, b)| (a - b).abs() < 1e-12));
                }
            }
        }
    }

    fn turned(lists: &[Vec<Recording>; 3]) -> [Vec<Recording>; 3] {
        lists.clone().map(|list| list.into_iter().rev().collect())
    }

    #[test]
    fn variants_are_valid_and_hold_the_same_motion() {
        let plan =
            "[recordings]\nduration_s = 5.0\nrate_hz = 250.0\n[nulls]\nrobots = ['two_link']\ncount = 1";
        let made = Plan::parse(plan, "plan.toml").unwrap().make(World::Clean, 3, 0).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let case = folder.path().join("case");
        write_folder(&case, &made.files).unwrap();
        let band_hz = Some(4.0);
        let (_, whole) = read_case(&case);
        assert_eq!(whole.each_ref().map(Vec::len), [3, 0, 2]);
        for variant in Variant::ALL {
            let files = variant.files(&case, band_hz).unwrap().unwrap();
            let own = folder.path().join(variant.name());
            write_folder(&own, &files).unwrap();
            let (asked_hz, lists) = read_case(&own);
            let expected_hz = match variant {
                Variant::FDynHalved => Some(2.0),
                Variant::FDynDoubled => Some(8.0),
                _ => None,
            };
            assert_eq!(asked_hz, expected_hz, "{variant:?}");
            match variant {
                Variant::FDynHalved | Variant::FDynDoubled | Variant::Degrees => {
                    assert_same(&lists, &whole, 1)
                }
                Variant::HalfRate => assert_same(&lists, &whole, 2),
                Variant::OtherOrder => assert_same(&turned(&lists), &whole, 1),
                Variant::FirstHalf | Variant::SecondHalf => {
                    let [calibration, _, validation] = &whole;
                    let kept = if variant == Variant::FirstHalf { [0, 2] } else { [1, 1] };
                    let kept = calibration[kept[0]..=kept[1]].iter().step_by(2).cloned().collect();
                    let held_out = usize::from(variant == Variant::FirstHalf);
                    assert_same(&lists, &[kept, Vec::new(), vec![validation[held_out].clone()]], 1);
                }
            }
        }
        // 25 Hz are a tenth of the rate.
        let is_fit = |variant: Variant, band_hz| variant.files(&case, band_hz).unwrap().is_ok();
        assert!(is_fit(Variant::FDynHalved, Some(20.0)) && !is_fit(Variant::FDynDoubled, Some(20.0)));
        assert!(!is_fit(Variant::FDynHalved, None));
        let text = fs::read_to_string(case.join(EXPERIMENT)).unwrap();
        fs::write(case.join(EXPERIMENT), text.replace("f_dyn_hz = 10.0", "f_dyn_hz = 20")).unwrap();
        assert!(!is_fit(Variant::HalfRate, band_hz));
    }

    #[test]
    fn halves_of_a_reference_have_no_targets_and_something_to_calibrate_on() {
        let halves = |text: &str| {
            [0, 1].map(|half| {
                let mut document: DocumentMut = text.parse().unwrap();
                halve(document.as_table_mut(), half).map(|()| document.to_string())
            })
        };
        let changed = halves("calibration = [\"a\", \"b\"]\ntarget = [\"c\"]\nvalidation = [\"d\"]\n");
        assert_eq!(changed.map(Result::unwrap), ["calibration = [\"a\"]\n", "calibration = [\"b\"]\n"]);
        let missing = halves("calibration = [\"a\"]\nvalidation = [\"b\"]\n").map(Result::unwrap);
        assert_eq!(missing, ["calibration = [\"a\"]\n", "calibration = [\"b\"]\n"]);
        assert!(halves("calibration = [\"a\"]\ntarget = [\"b\"]\n").iter().all(Result::is_err));
    }
}
