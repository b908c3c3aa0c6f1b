//! Calibration on recordings that are read in stretches, in memory that does not grow with their length.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use crate::Experiment;
use aurt::data::Source;
use aurt::duplicates::Likeness;
use aurt::fitting::{Job, Outcome};
use aurt::origins::{Origins, hash_of_file};
use aurt::{CalibratedModel, Progress, RecordingResult, Role};
use aurt_calibration::{Comparison, calibrate_long, shapes_of, validate_long};
use aurt_recording::{LongPrepared, LongRecording, RecordingError};
use aurt_traits::MeasurementUnit;

use crate::workbench::experiments;
use crate::workbench::failure::Failure;

/// Memory that whole recordings take at most, per byte of their files (`docs/reliability.md`).
const MEMORY_PER_BYTE: u64 = 8;

/// Does what an experiment says with recordings that are read in stretches, as [`fit_experiment`](crate::workbench::experiments::fit_experiment) does
/// with whole ones; predictions for their rows are not made.
pub fn fit_experiment_in_stretches(
    experiment: &Experiment,
    because: TooLarge,
    progress: &Progress,
) -> Result<Outcome, Failure> {
    progress.step("compiling the model");
    let sources = experiment.recordings.fitted_and_held_out();
    let assigned: Vec<(Source, Role)> = sources.map(|(source, role)| (source.clone(), role)).collect();
    let mut outcome = fit_in_stretches(&experiments::job(experiment)?, &assigned, because, progress)?;
    outcome.calibrated.origins.experiment_blake3 =
        Origins::of(Some(&experiment.source_text), []).experiment_blake3;
    Ok(outcome)
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Bytes(pub u64);

impl Bytes {
    const UNITS: [(&str, u64); 4] =
        [("TB", 1_000_000_000_000), ("GB", 1_000_000_000), ("MB", 1_000_000), ("kB", 1000)];

    /// What some files have together; those that cannot be looked at count nothing, reading them says why.
    pub fn of_files<'a>(files: impl IntoIterator<Item = &'a Path>) -> Self {
        Self(files.into_iter().map(|f| std::fs::metadata(f).map_or(0, |m| m.len())).sum())
    }

    fn rounded_up(self) -> Self {
        let unit = Self::UNITS.iter().find(|(_, unit)| self.0 >= *unit).map_or(1, |(_, unit)| *unit);
        Self((self.0 / unit + 1) * unit)
    }
}

impl fmt::Display for Bytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match Self::UNITS.iter().find(|(_, unit)| self.0 >= *unit) {
            Some((name, unit)) if self.0.is_multiple_of(*unit) => write!(f, "{}{name}", self.0 / unit),
            Some((name, unit)) => write!(f, "{:.1}{name}", self.0 as f64 / *unit as f64),
            None => write!(f, "{}B", self.0),
        }
    }
}

impl FromStr for Bytes {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || "expected a number of bytes such as 500MB or 2GB (kB, MB, GB, TB)".to_owned();
        let text = text.trim();
        let digits = text.len() - text.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.').len();
        let (number, unit) = text.split_at(digits);
        let factor = match unit.trim() {
            "" | "B" => 1,
            unit => Self::UNITS.iter().find(|(u, _)| unit.eq_ignore_ascii_case(u)).ok_or_else(expected)?.1,
        };
        let number: f64 = number.parse().map_err(|_| expected())?;
        Ok(Self((number * factor as f64) as u64))
    }
}

/// Why recordings are read in stretches.
#[derive(Debug, Clone, Copy)]
pub struct TooLarge {
    pub together: Bytes,
    /// More than this is read in stretches.
    pub limit: Bytes,
}

impl TooLarge {
    fn refusal(self, path: Option<&Path>, reason: impl fmt::Display, otherwise: &str) -> Failure {
        let Self { together, limit } = self;
        let memory = Bytes(together.0.saturating_mul(MEMORY_PER_BYTE));
        Failure::Stretches {
            path: path.map(Path::to_owned),
            reason: format!(
                "{reason}; the recordings have {together} together, and what has more than {limit} is read in stretches"
            ),
            remedy: format!(
                "`--stream-above {}` reads them whole, which takes some {memory} of memory; or {otherwise}",
                together.rounded_up()
            ),
        }
    }

    /// A failure of reading in stretches, with what whole recordings could do about it.
    fn explained(self, error: RecordingError) -> Failure {
        match error {
            RecordingError::Clock { path, reason, .. } => {
                let reason = format!("{}: {reason}, but stretches need a uniform clock", path.display());
                self.refusal(Some(&path), reason, "put the recording on a uniform grid first")
            }
            other => other.into(),
        }
    }
}

/// As [`Job::fit`]; recordings are judged, but nothing is predicted row by row.
pub fn fit_in_stretches(
    job: &Job,
    assigned: &[(Source, Role)],
    because: TooLarge,
    progress: &Progress,
) -> Result<Outcome, Failure> {
    refuse_what_needs_all(job, assigned, because)?;
    let pipeline = job.pipeline();
    let mut prepared: Vec<LongPrepared> = Vec::new();
    let mut first: Option<(MeasurementUnit, &Path)> = None;
    for (source, role) in assigned {
        progress.step(format!("reading {} in stretches", source.label));
        let options = source.read_options(Some(&pipeline.joints), role.purpose());
        let long = LongRecording::read(&source.file, &options)?;
        let unit = job.instrument.unit(long.unit());
        match first {
            Some((known, file)) if known != unit => {
                return Err(aurt::Error::MixedUnits {
                    first: file.to_owned(),
                    first_unit: known,
                    other: source.file.clone(),
                    other_unit: unit,
                }
                .into());
            }
            _ => first = first.or(Some((unit, &source.file))),
        }
        progress.step(format!("preprocessing {}", source.label));
        let options = pipeline.options(long.unit(), role.purpose());
        prepared.push(long.prepare(&options).map_err(|e| because.explained(e))?);
    }
    progress.step("calibrating");
    let unit = first.map(|(unit, _)| unit).unwrap_or_default();
    // Those for calibration come first.
    let fitted = assigned.iter().take_while(|(_, role)| *role == Role::Calibration).count();
    let f_dyn_hz = job.preprocessing.f_dyn_hz;
    let mut calibration = calibrate_long(&job.model, &prepared[..fitted], unit, f_dyn_hz, &job.options)?;
    let mut recordings = Vec::new();
    for ((source, role), prepared) in assigned.iter().zip(&prepared) {
        progress.step(format!("validating on {}", source.label));
        let mut notes = prepared.recording().report().notes();
        notes.extend(prepared.report().notes());
        let beside = prepared.recording().report().warnings();
        calibration.warnings.extend(beside.map(|w| format!("{}: {w}", source.label)));
        notes.push(
            "read in stretches: measured velocities are not compared with positions, and no rows are shown"
                .into(),
        );
        recordings.push(RecordingResult {
            label: source.label.clone(),
            role: *role,
            window_s: source.window_s,
            validation: validate_long(&job.model, &calibration, prepared)?,
            comparison: Comparison::default(),
            first_stamp_s: prepared.recording().first_stamp_s().unwrap_or(0.0),
            notes,
            prediction: None,
        });
    }
    let calibrated = CalibratedModel {
        model: job.model.clone(),
        calibration,
        preprocessing: job.preprocessing.clone(),
        instrument: job.instrument.clone(),
        origins: Origins::of(None, assigned.iter().map(|(source, role)| (source, *role))),
    };
    Ok(Outcome { calibrated, recordings, predictions: Vec::new() })
}

/// Whether two files have the same bytes; what is read in stretches is not held to be compared row by row.
fn is_copy(a: &Source, b: &Source) -> bool {
    let place = |source: &Source| std::fs::canonicalize(&source.file).ok();
    let length = |source: &Source| std::fs::metadata(&source.file).ok().map(|m| m.len());
    let reads_alike = a.recorded == b.recorded && a.columns == b.columns;
    let same_place = place(a).is_some() && place(a) == place(b);
    let same_bytes =
        || length(a) == length(b) && hash_of_file(&a.file).is_some_and(|h| Some(h) == hash_of_file(&b.file));
    reads_alike && (same_place || same_bytes())
}

/// Refuses what stretches cannot do, and recordings that are listed twice.
fn refuse_what_needs_all(job: &Job, assigned: &[(Source, Role)], because: TooLarge) -> Result<(), Failure> {
    let searched = shapes_of(&job.model);
    if job.options.fit_shapes && !searched.is_empty() {
        let reason = format!(
            "the shape parameters of {} are searched, which passes over the recordings many times",
            searched.join(", ")
        );
        let otherwise = "compile the model with friction models that have none";
        return Err(because.refusal(None, reason, otherwise));
    }
    if let Some((source, _)) = assigned.iter().find(|(source, _)| source.window_s.is_some()) {
        let reason = format!("{}: a part of the recording is asked for", source.file.display());
        return Err(because.refusal(Some(&source.file), reason, "cut the file"));
    }
    let acts_everywhere = |label: &str| !job.scopes.acting(&job.model, label).contains(&false);
    if !assigned.iter().all(|(source, _)| acts_everywhere(&source.label)) {
        let reason = "arm terms act in some recordings alone";
        return Err(because.refusal(None, reason, "leave out their `recordings`"));
    }
    for (k, (source, role)) in assigned.iter().enumerate() {
        if let Some((other, other_role)) = assigned[..k].iter().find(|(other, _)| is_copy(other, source)) {
            return Err(aurt::Error::Repeated {
                recording: source.file.clone(),
                role: role.name(),
                other: other.file.clone(),
                other_role: other_role.name(),
                likeness: Likeness::Same,
            }
            .into());
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_written_as_people_write_them() {
        for (text, bytes) in [
            ("0", 0),
            ("1500", 1500),
            ("500MB", 500_000_000),
            ("1.5 gb", 1_500_000_000),
            ("2kB", 2000),
            ("7 B", 7),
        ] {
            assert_eq!(text.parse(), Ok(Bytes(bytes)), "{text}");
        }
        for text in ["", "MB", "-1", "1XB", "1..5GB", "all"] {
            assert!(text.parse::<Bytes>().unwrap_err().contains("500MB"), "{text}");
        }
        assert_eq!(Bytes(500_000_000).to_string(), "500MB");
        assert_eq!(Bytes(1_234_567_890).to_string(), "1.2GB");
        assert_eq!(Bytes(12).to_string(), "12B");
        assert_eq!(Bytes(1_234_567_890).rounded_up().to_string(), "2GB");
        assert_eq!(Bytes(12).rounded_up(), Bytes(13));
    }
}
