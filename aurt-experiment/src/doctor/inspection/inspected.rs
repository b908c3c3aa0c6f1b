//! One recording, looked at.

use crate::workbench::failure::Failure;
use aurt::data::{Instrument, Loaded, Pipeline, Preprocessing, Purpose, Source};
use aurt_calibration::NamedRecording;
use aurt_diagnosis::RecordingFaults;
use aurt_recording::{Preprocessed, RecordedAs, Segment, StampUnit, TimeUnit};
use aurt_report::rendering::style::{Emphasis, Style};
use aurt_report::rendering::table::Table;
use aurt_report::rendering::text::wrapped;
use aurt_traits::{ModelError, Motion, RobotNames};
use serde_json::{Value, json};

use super::joints::{JointReport, tables};
use super::judged::Judged;
use crate::doctor::mistakes::oddities;

/// A recording in the unit that its stamps are in.
#[derive(Debug, Clone)]
pub struct Reading {
    pub loaded: Loaded,
    /// That unit, where another was said.
    pub stamps: Option<StampUnit>,
}

impl Reading {
    /// Reads a recording, and reads it again where its stamps show that they are in another unit.
    pub fn of<E>(source: Source, read: impl Fn(Source) -> Result<Loaded, E>) -> Result<Self, E> {
        let loaded = read(source.clone())?;
        let read_in = source.recorded.time.unwrap_or(TimeUnit::Second);
        let Some(stamps) = loaded.recording.stamp_unit(read_in) else {
            return Ok(Self { loaded, stamps: None });
        };
        let recorded = RecordedAs { time: Some(stamps.unit), ..source.recorded };
        // A unit that the names of columns contradict is none.
        match read(Source { recorded, ..source }) {
            Ok(again) => Ok(Self { loaded: again, stamps: Some(stamps) }),
            Err(_) => Ok(Self { loaded, stamps: None }),
        }
    }
}

/// A recording with what can be said of it by itself.
pub struct Inspected {
    pub loaded: Loaded,
    pub prepared: Preprocessed,
    pub joints: Vec<JointReport>,
    /// The unit of its stamps, where that is another than was said; the recording is read in it.
    pub stamps: Option<StampUnit>,
    /// Parameters that its motion determines by itself, where the geometry is known.
    pub judged: Option<Judged>,
}

impl Inspected {
    pub fn new(reading: Reading, preprocessing: &Preprocessing) -> Result<Self, Failure> {
        let Reading { loaded, stamps } = reading;
        let instrument = Instrument::default();
        let pipeline =
            Pipeline { joints: loaded.recording.robot_joints(), preprocessing, instrument: &instrument };
        let prepared = pipeline.preprocess(&loaded, Purpose::Calibration)?.data;
        let joints = JointReport::of(&loaded.recording, &prepared, preprocessing.rest_velocity_rad_s);
        Ok(Self { loaded, prepared, joints, stamps, judged: None })
    }

    pub fn label(&self) -> &str {
        &self.loaded.source.label
    }

    pub fn suitable_f_dyn_hz(&self) -> Option<f64> {
        aurt_recording::suitable_f_dyn_hz([&self.prepared])
    }

    /// What was found while it was read and put on its grid.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = self.loaded.recording.report.notes();
        notes.extend(self.prepared.report.notes());
        notes
    }

    pub fn names(&self) -> RobotNames<'_> {
        RobotNames::of_joints(self.loaded.recording.joints.names())
    }

    /// What should be heeded of the file and its sensors, in sentences.
    pub fn faults(&self) -> Vec<String> {
        let name = self.loaded.source.file.file_name().unwrap_or_default().to_string_lossy();
        let mut findings: Vec<String> =
            self.stamps.iter().map(|stamps| format!("{name}: {stamps}")).collect();
        let faults = RecordingFaults::find(&name, &self.loaded.recording).faults;
        findings.extend(faults.into_iter().map(|f| f.sentence));
        findings.extend(oddities(&name, &self.loaded.recording));
        // Rows that were left out and gaps that split the recording are cared for: notes say so.
        findings.extend(self.loaded.recording.report.irregularities.iter().cloned());
        let names = self.names();
        for (joint, scale) in self.prepared.report.velocity_scale.iter().enumerate() {
            if let Some(scale) = scale.filter(|s| (s - 1.0).abs() > 0.05) {
                findings.push(format!(
                    "the logged velocity of {} is {scale:.2} times the derivative of its position",
                    names.joint(joint)
                ));
            }
        }
        findings
    }

    /// Sentences to be heeded if it is calibrated on alone.
    pub fn findings(&self) -> Vec<String> {
        let mut findings = self.faults();
        let moves: Vec<bool> = self.joints.iter().map(|joint| joint.moves()).collect();
        findings.extend(rest(&moves, self.names()));
        findings.extend(self.judged.iter().flat_map(Judged::findings));
        findings
    }

    /// The recording as a calibration takes it, cut to the motion, with joints that rest exactly at rest: the noise of a
    /// sensor excites nothing.
    pub fn still(&self, preprocessing: &Preprocessing) -> Result<NamedRecording, Failure> {
        let preprocessing = Preprocessing { trim_rest: true, ..preprocessing.clone() };
        let pipeline = Pipeline {
            joints: self.loaded.recording.robot_joints(),
            preprocessing: &preprocessing,
            instrument: &Instrument::default(),
        };
        // Where nothing moves there is nothing to cut to.
        let cut = pipeline.preprocess(&self.loaded, Purpose::Calibration);
        let data = cut.map_or_else(|_| self.prepared.clone(), |cut| cut.data);
        let segments: Result<Vec<Segment>, ModelError> =
            data.segments.iter().map(|s| without_resting_joints(s, &self.joints)).collect();
        let segments = segments?;
        let data = Preprocessed { segments, ..data };
        Ok(NamedRecording { name: self.label().to_owned(), data })
    }

    pub fn to_text(&self, style: Style) -> String {
        let recording = &self.loaded.recording;
        let unit = recording.unit;
        let title = |text: &str| style.emphasise(Emphasis::Title, text);
        let mut text = format!(
            "{}\n  {} samples over {:.2} s, {} joints, {}\n",
            title(&self.loaded.source.file.display().to_string()),
            recording.samples(),
            recording.duration_s(),
            self.joints.len(),
            if recording.measurement.is_some() {
                format!("{} in {}", unit.quantity(), unit.symbol())
            } else {
                "without measurement".into()
            }
        );
        text.extend(self.notes().iter().map(|n| wrapped(n)));
        let left = usize::from(!self.names().joints.is_empty());
        let tables = tables(&self.joints, unit, self.names());
        for (what, (headings, rows)) in ["motion", "sensors: steps and white noise"].into_iter().zip(tables) {
            let mut table = Table::new(headings).left(left);
            rows.into_iter().for_each(|row| table.row(row));
            text.push_str(&format!("\n{}\n{}", title(what), table.render()));
        }
        if let Some(judged) = &self.judged {
            text.push_str(&format!("\n{}\n{}", title("excitation"), judged.to_text()));
        }
        text
    }

    pub fn to_json(&self) -> Value {
        let recording = &self.loaded.recording;
        json!({
            "file": self.loaded.source.file,
            "samples": recording.samples(),
            "duration_s": recording.duration_s(),
            "unit": recording.measurement.as_ref().map(|_| recording.unit.symbol()),
            "reading": recording.report,
            "preprocessing": self.prepared.report,
            "joints": self.joints,
            "suitable_f_dyn_hz": self.suitable_f_dyn_hz(),
            "excitation": self.judged.as_ref().map(Judged::to_json),
            "findings": self.findings(),
        })
    }
}

/// What should be heeded of which joints move, in one recording or in any of several.
pub fn rest(moves: &[bool], names: RobotNames<'_>) -> Option<String> {
    let joints = |wanted: bool| -> Vec<usize> { (0..moves.len()).filter(|j| moves[*j] == wanted).collect() };
    let (moving, resting) = (joints(true), joints(false));
    if moving.is_empty() {
        return Some("no joint moves: nothing can be calibrated on it".into());
    }
    let verb = if moving.len() == 1 { "moves" } else { "move" };
    (!resting.is_empty()).then(|| {
        format!(
            "only {} {verb}; the friction of {} is out of reach, and so are inertial parameters that need {} motion",
            names.joint_list(&moving),
            names.joint_list(&resting),
            if resting.len() == 1 { "its" } else { "their" }
        )
    })
}

fn without_resting_joints(segment: &Segment, reports: &[JointReport]) -> Result<Segment, ModelError> {
    let view = segment.motion.view();
    let samples = view.samples();
    let mut series = [Vec::new(), Vec::new(), Vec::new()];
    for (joint, report) in reports.iter().enumerate() {
        let all = [view.position_rad(joint), view.velocity_rad_s(joint), view.acceleration_rad_s2(joint)];
        if report.moves() {
            series.iter_mut().zip(all).for_each(|(s, a)| s.extend_from_slice(a));
        } else {
            let middle = all[0].iter().sum::<f64>() / samples.max(1) as f64;
            series.iter_mut().zip([middle, 0.0, 0.0]).for_each(|(s, v)| s.resize(s.len() + samples, v));
        }
    }
    let [position, velocity, acceleration] = series;
    let motion = Motion::new(reports.len(), view.time_s().to_vec(), position, velocity, acceleration)?;
    Ok(Segment { motion, ..segment.clone() })
}
