//! `predicted_<recording>.csv`: a prediction at the time stamps of the file that it was made for.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::{Path, PathBuf};

use aurt_calibration::Prediction;
use aurt_traits::MeasurementUnit;

/// A prediction at the given stamps, one row each; as [`at_stamps`].
pub fn to_csv(stamps_s: &[f64], predictions: &[Prediction], unit: MeasurementUnit) -> Vec<u8> {
    let joints = predictions.first().map_or(0, |p| p.predicted.len());
    let mut csv = String::from("timestamp");
    for joint in 0..joints {
        let _ = write!(csv, ",predicted_{}_{joint}", unit.quantity());
    }
    csv.push('\n');
    for stamp in stamps_s {
        let _ = write!(csv, "{stamp}");
        let place = Place::of(*stamp, predictions);
        for joint in 0..joints {
            let _ = write!(csv, ",{}", place.map_or(f64::NAN, |p| p.value(predictions, joint)));
        }
        csv.push('\n');
    }
    csv.into_bytes()
}

/// A prediction at the given stamps, as `[joint][stamp]`.
///
/// Predictions live on the uniform grid of preprocessing. Between two points of the grid they are interpolated
/// linearly; before, after and between segments the nearest point of the grid counts.
pub fn at_stamps(stamps_s: &[f64], predictions: &[Prediction]) -> Vec<Vec<f64>> {
    let joints = predictions.first().map_or(0, |p| p.predicted.len());
    let places: Vec<Option<Place>> = stamps_s.iter().map(|stamp| Place::of(*stamp, predictions)).collect();
    let value = |place: &Option<Place>, joint| place.map_or(f64::NAN, |p| p.value(predictions, joint));
    (0..joints).map(|joint| places.iter().map(|place| value(place, joint)).collect()).collect()
}

/// A point of a segment's grid and how far the stamp is on the way to the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    segment: usize,
    sample: usize,
    share: f64,
}

impl Place {
    /// The place of a stamp; none if there are no predictions.
    fn of(stamp_s: f64, predictions: &[Prediction]) -> Option<Self> {
        let mut nearest: Option<(f64, Self)> = None;
        for (segment, prediction) in predictions.iter().enumerate() {
            let (Some(first), Some(last)) = (prediction.time_s.first(), prediction.time_s.last()) else {
                continue;
            };
            if *first <= stamp_s && stamp_s <= *last {
                let next = prediction.time_s.partition_point(|t| *t <= stamp_s);
                let sample = next - 1;
                let share = prediction.time_s.get(next).map_or(0.0, |after| {
                    (stamp_s - prediction.time_s[sample]) / (after - prediction.time_s[sample])
                });
                return Some(Self { segment, sample, share });
            }
            let (distance, sample) = if stamp_s < *first {
                (first - stamp_s, 0)
            } else {
                (stamp_s - last, prediction.time_s.len() - 1)
            };
            if nearest.is_none_or(|(d, _)| distance < d) {
                nearest = Some((distance, Self { segment, sample, share: 0.0 }));
            }
        }
        nearest.map(|(_, place)| place)
    }

    fn value(self, predictions: &[Prediction], joint: usize) -> f64 {
        let series = &predictions[self.segment].predicted[joint];
        let here = series[self.sample];
        if self.share == 0.0 { here } else { here + self.share * (series[self.sample + 1] - here) }
    }
}

/// File names of predictions: recordings of one name in different folders get different ones.
#[derive(Debug, Default)]
pub struct PredictionNames {
    taken: BTreeSet<String>,
    named: Vec<(PathBuf, String)>,
}

impl PredictionNames {
    /// The name for a recording, and whether it is new. A file that occurs twice has one prediction.
    pub fn name(&mut self, recording: &Path) -> (String, bool) {
        let identity = std::fs::canonicalize(recording).unwrap_or_else(|_| recording.to_owned());
        if let Some((_, name)) = self.named.iter().find(|(path, _)| *path == identity) {
            return (name.clone(), false);
        }
        let name = format!("predicted_{}.csv", self.stem(recording));
        self.named.push((identity, name.clone()));
        (name, true)
    }

    /// A new stem for a recording: that of its file, with a number if it is taken.
    pub fn stem(&mut self, recording: &Path) -> String {
        let stem = recording.file_stem().map_or_else(|| "recording".into(), |s| s.to_string_lossy());
        let mut name = stem.clone().into_owned();
        let mut number = 2;
        while !self.taken.insert(name.to_lowercase()) {
            name = format!("{stem}_{number}");
            number += 1;
        }
        name
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_stamp_gets_a_row_wherever_it_lies() {
        let predictions = [
            Prediction { time_s: vec![1.0, 2.0], predicted: vec![vec![10.0, 20.0]] },
            Prediction { time_s: vec![5.0, 6.0], predicted: vec![vec![50.0, 60.0]] },
        ];
        let stamps = [0.0, 1.0, 1.25, 2.0, 2.0, 3.0, 4.5, 5.5, 7.0];
        let csv = String::from_utf8(to_csv(&stamps, &predictions, MeasurementUnit::Ampere)).unwrap();
        let expected =
            "timestamp,predicted_current_0\n0,10\n1,10\n1.25,12.5\n2,20\n2,20\n3,20\n4.5,50\n5.5,55\n7,60\n";
        assert_eq!(csv, expected);
    }

    #[test]
    fn recordings_of_one_name_do_not_overwrite_each_other() {
        let mut names = PredictionNames::default();
        let mut name = |path: &str| names.name(Path::new(path));
        assert_eq!(name("monday/run.csv"), ("predicted_run.csv".into(), true));
        assert_eq!(name("tuesday/run.csv"), ("predicted_run_2.csv".into(), true));
        assert_eq!(name("monday/run.csv"), ("predicted_run.csv".into(), false));
        assert_eq!(name("run_2.csv"), ("predicted_run_2_2.csv".into(), true));
        assert_eq!(name("Run.txt"), ("predicted_Run_3.csv".into(), true));
    }
}
