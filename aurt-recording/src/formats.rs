//! The formats that recordings are read from: a line in [`FORMATS`] each.

use std::path::Path;

#[cfg(feature = "mcap")]
use crate::bag::{BAG, BagFolder, described};
use crate::csv::CSV;
use crate::error::RecordingError;
use crate::format::{Reading, RecordingFormat, RecordingInput, refuse_foreign};
#[cfg(feature = "lerobot")]
use crate::lerobot::{DataSet, folder_of};
#[cfg(feature = "matlab")]
use crate::matlab::MATLAB;
#[cfg(feature = "numpy")]
use crate::numpy::NUMPY;
#[cfg(feature = "parquet")]
use crate::parquet::PARQUET;
use crate::read_options::ReadOptions;
use crate::recording::Recording;

/// Every format, in the order in which they are tried.
pub const FORMATS: &[RecordingFormat] = &[
    #[cfg(feature = "numpy")]
    NUMPY,
    #[cfg(feature = "matlab")]
    MATLAB,
    #[cfg(feature = "mcap")]
    BAG,
    #[cfg(feature = "parquet")]
    PARQUET,
    CSV,
];

pub(crate) fn format_of(input: &RecordingInput<'_>) -> &'static RecordingFormat {
    let ending = input.path.extension().map(|e| e.to_string_lossy().to_lowercase());
    let by_content = FORMATS.iter().find(|format| (format.recognises)(&input.beginning));
    let by_name = || FORMATS.iter().find(|f| ending.as_deref().is_some_and(|e| f.endings.contains(&e)));
    by_content.or_else(by_name).unwrap_or(&CSV)
}

/// Whether a path names a recording of several files: the folder of a bag of ROS 2 or of a LeRobot data set, or the
/// `metadata.yaml` or `meta/info.json` that describes it.
pub fn is_recording_folder(path: &Path) -> bool {
    #[cfg(feature = "mcap")]
    if described(path).is_some() {
        return true;
    }
    #[cfg(feature = "lerobot")]
    if folder_of(path).is_some() {
        return true;
    }
    let _ = path;
    false
}

pub(crate) fn read_whole(path: &Path, options: &ReadOptions) -> Result<Recording, RecordingError> {
    read_in_pieces(path, Reading { options, piece_rows: usize::MAX, visit: &mut |_| Ok(()) })
}

pub(crate) fn read_in_pieces(path: &Path, reading: Reading<'_>) -> Result<Recording, RecordingError> {
    reading.options.validate()?;
    #[cfg(feature = "lerobot")]
    if let Some(data_set) = DataSet::named(path)? {
        return data_set.read(reading);
    }
    #[cfg(feature = "mcap")]
    if let Some(bag) = BagFolder::named(path)? {
        return bag.read(reading);
    }
    let input = RecordingInput::open(path)?;
    refuse_foreign(path, &input.beginning)?;
    (format_of(&input).read)(input, reading)
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn names_and_endings_are_told_apart() {
        let mut endings: Vec<&str> = FORMATS.iter().flat_map(|f| f.endings.iter().copied()).collect();
        let count = endings.len();
        endings.sort_unstable();
        endings.dedup();
        assert_eq!(endings.len(), count, "two formats have one ending");
        assert!(endings.iter().all(|e| e.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())));
    }

    #[test]
    fn a_file_without_mark_or_known_ending_is_text() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.csv", "a.CSV", "a", "a.unknown"] {
            let path = folder.path().join(name);
            std::fs::write(&path, "time,q_0\n0,1\n").unwrap();
            let input = RecordingInput::open(&path).unwrap();
            assert_eq!(format_of(&input).name, "CSV");
            let mut text = String::new();
            input.reader().read_to_string(&mut text).unwrap();
            assert_eq!(text, "time,q_0\n0,1\n");
        }
    }
}
