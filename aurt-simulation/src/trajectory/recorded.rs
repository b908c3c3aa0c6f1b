use std::path::Path as File;

use aurt_recording::{ReadOptions, Recording, read_recording};

use super::{Path, Trajectory};
use crate::error::SimulationError;

/// The positions of a table, and between them the cubic that has the table's velocities (or, without these, slopes of its
/// neighbours) at both ends.
#[derive(Debug, Clone)]
struct TablePath {
    time_s: Vec<f64>,
    position_rad: Vec<Vec<f64>>,
    velocity_rad_s: Vec<Vec<f64>>,
}

/// Reads a motion, such as one that was planned.
pub(super) fn read(file: &File) -> Result<Trajectory, SimulationError> {
    let options = ReadOptions { needs_measurement: false, accepts_plan: true, ..ReadOptions::default() };
    let recording = read_recording(file, &options)?;
    let Recording { mut time_s, position_rad, velocity_rad_s, .. } = recording;
    let first_s = time_s.first().copied().unwrap_or(0.0);
    time_s.iter_mut().for_each(|t| *t -= first_s);
    let velocity_rad_s = velocity_rad_s
        .unwrap_or_else(|| position_rad.iter().map(|position| slopes(&time_s, position)).collect());
    Ok(Trajectory::new(TablePath { time_s, position_rad, velocity_rad_s }))
}

/// Slopes between the neighbours of each value; rest at both ends.
fn slopes(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let mut slopes = vec![0.0; values.len()];
    for k in 1..values.len().saturating_sub(1) {
        slopes[k] = (values[k + 1] - values[k - 1]) / (time_s[k + 1] - time_s[k - 1]);
    }
    slopes
}

impl Path for TablePath {
    fn joints(&self) -> usize {
        self.position_rad.len()
    }

    fn duration_s(&self) -> f64 {
        self.time_s.last().copied().unwrap_or(0.0)
    }

    fn at(&self, time_s: f64, q_rad: &mut [f64], qd_rad_s: &mut [f64], qdd_rad_s2: &mut [f64]) {
        let after = self.time_s.partition_point(|t| *t <= time_s).clamp(1, self.time_s.len().max(2) - 1);
        let before = after - 1;
        let step_s = self.time_s[after] - self.time_s[before];
        let x = ((time_s - self.time_s[before]) / step_s).clamp(0.0, 1.0);
        for (j, (position, velocity)) in self.position_rad.iter().zip(&self.velocity_rad_s).enumerate() {
            // q = q₀ + v₀ s + (3 Δ − 2 v₀ − v₁) h x² + (v₀ + v₁ − 2 Δ) h x³ with Δ the mean slope, s = h x.
            let slope = (position[after] - position[before]) / step_s;
            let [begin, end] = [velocity[before], velocity[after]];
            let [square, cube] = [3.0 * slope - 2.0 * begin - end, begin + end - 2.0 * slope];
            q_rad[j] = position[before] + step_s * x * (begin + x * (square + x * cube));
            qd_rad_s[j] = begin + x * (2.0 * square + 3.0 * x * cube);
            qdd_rad_s2[j] = (2.0 * square + 6.0 * x * cube) / step_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::read;
    use crate::{Motion, robots};

    #[test]
    fn a_motion_that_was_written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("motion.csv");
        let planned = Motion::PointToPoint { duration_s: 12.0, share: 0.5, rest_s: 0.4 }
            .plan(&robots::ur10e(), 4)
            .unwrap();
        std::fs::write(&file, planned.csv(250.0).unwrap()).unwrap();
        let back = read(&file).unwrap();
        assert!((back.duration_s() - planned.duration_s()).abs() < 1e-9);
        for k in 0..1000 {
            let t = 0.012 * f64::from(k);
            let [mut a, mut b] = [[[0.0; 6]; 3], [[0.0; 6]; 3]];
            for (trajectory, [q, v, acceleration]) in [(&planned, &mut a), (&back, &mut b)] {
                trajectory.at(t, q, v, acceleration);
            }
            for j in 0..6 {
                let error = [0, 1, 2].map(|i| (a[i][j] - b[i][j]).abs());
                assert!(error[0] < 1e-7 && error[1] < 1e-4 && error[2] < 0.1, "{t} {j} {error:?}");
            }
        }
    }
}
