//! Which files a calibrated model comes from.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::data::Source;
use crate::error::Error;
use crate::likeness::Likeness;
use crate::role::Role;

/// The files of a calibration, with hashes by which they are known again.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Origins {
    /// BLAKE3 of the text of the experiment; none of models that were not calibrated by one.
    #[serde(default)]
    pub experiment_blake3: Option<String>,
    /// The recordings that the model was fitted to.
    #[serde(default)]
    pub calibration: Vec<RecordingOrigin>,
    /// Those that it was judged on.
    #[serde(default)]
    pub validation: Vec<RecordingOrigin>,
}

/// A file of a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordingOrigin {
    /// What it was called.
    pub file: String,
    /// BLAKE3 of its bytes; none of pipes, which are read once, and of files that have gone.
    pub blake3: Option<String>,
    /// The part that was used, s from the first stamp; none for all of it.
    pub window_s: Option<[f64; 2]>,
}

impl Origins {
    /// Those of recordings, and of the text of an experiment that names them.
    pub fn of<'s>(
        experiment: Option<&str>,
        recordings: impl IntoIterator<Item = (&'s Source, Role)>,
    ) -> Self {
        let hash = |text: &str| blake3::hash(text.as_bytes()).to_hex().to_string();
        let experiment_blake3 = experiment.map(hash);
        let mut origins = Self { experiment_blake3, ..Self::default() };
        for (source, role) in recordings {
            let origin = RecordingOrigin {
                file: source.label.clone(),
                blake3: hash_of_file(&source.file),
                window_s: source.window_s,
            };
            match role {
                Role::Calibration => origins.calibration.push(origin),
                Role::Validation => origins.validation.push(origin),
            }
        }
        origins
    }

    /// Refuses held-out and target recordings that the model was calibrated on, whatever their files are called.
    ///
    /// # Errors
    /// [`Error::Repeated`].
    pub fn refuse_copies<'s>(
        &self,
        asked: impl IntoIterator<Item = (&'s Source, aurt_diagnosis::Role)>,
    ) -> Result<(), Error> {
        if self.calibration.iter().all(|origin| origin.blake3.is_none()) {
            return Ok(());
        }
        for (source, role) in asked.into_iter().filter(|(_, role)| *role != aurt_diagnosis::Role::Calibration)
        {
            let Some(hash) = hash_of_file(&source.file) else { continue };
            let is_same = |origin: &&RecordingOrigin| {
                origin.blake3.as_ref() == Some(&hash) && overlap(origin.window_s, source.window_s)
            };
            if let Some(origin) = self.calibration.iter().find(is_same) {
                return Err(Error::Repeated {
                    recording: source.label.clone().into(),
                    role: role.name(),
                    other: origin.file.clone().into(),
                    other_role: "calibration of the given model",
                    likeness: Likeness::Same,
                });
            }
        }
        Ok(())
    }

    /// The hash of the calibration recording of a name, if it has one.
    pub fn blake3(&self, recording: &str) -> Option<&str> {
        self.calibration.iter().find(|r| r.file == recording)?.blake3.as_deref()
    }

    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// Whether two parts of a recording have more than the sample between them in common; none is all of it.
fn overlap(one: Option<[f64; 2]>, other: Option<[f64; 2]>) -> bool {
    let whole = [f64::NEG_INFINITY, f64::INFINITY];
    let ([begin, end], [other_begin, other_end]) = (one.unwrap_or(whole), other.unwrap_or(whole));
    begin.max(other_begin) < end.min(other_end)
}

/// BLAKE3 of the bytes of a regular file; none of others, and of those that cannot be read.
pub fn hash_of_file(path: &Path) -> Option<String> {
    let mut hasher = blake3::Hasher::new();
    let mut add = |piece: &[u8]| {
        hasher.update(piece);
    };
    aurt_files::read_pieces(path, &mut add).ok()?;
    Some(hasher.finalize().to_hex().to_string())
}
