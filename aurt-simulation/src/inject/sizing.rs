//! Bringing an effect to strength, in units of what the unaltered model leaves.

use super::gram::mean_square;
use super::injection::{Injection, Recorded};
use super::kinds::Kind;
use super::law::Added;
use super::own_model::Rows;
use super::split::{Presence, Split};
use crate::error::SimulationError;
use crate::random::Random;

/// An effect of the wanted strength.
#[derive(Debug, Clone)]
pub struct Built {
    pub kind: Kind,
    pub added: Added,
    /// Strength on each joint.
    pub achieved: Vec<f64>,
    /// 1 where it is as strong as wanted, less where it is weaker or stronger.
    pub reached: f64,
}

/// Root mean square of an effect on a joint over that of its measurement, at most: what is half of all torque and more is
/// no lack of a model.
const LARGEST_SHARE: f64 = 0.5;
/// Corrections of the size; most laws are linear and need one.
const CORRECTIONS: usize = 8;
impl Injection {
    /// A shape drawn for an effect on a joint; nothing where the joint does not suit it.
    pub fn shaped(&self, kind: &Kind, joint: usize, random: &mut Random) -> Option<Added> {
        (kind.fits(self.real.unit) && self.suits(kind, joint)).then(|| self.draw(kind, joint, random))
    }

    /// An effect brought to `wanted` times what the unaltered model leaves, on the joint of its own where it is largest.
    /// Lost rows have no torque that could be measured.
    ///
    /// # Errors
    /// If a recording cannot be preprocessed with it.
    pub fn sized(
        &self,
        kind: Kind,
        added: Added,
        split: &Split,
        wanted: f64,
    ) -> Result<Built, SimulationError> {
        let largest = self.largest(&added);
        let most = self.most(split);
        let mut added = added;
        let mut built = None;
        for _ in 0..CORRECTIONS {
            let (achieved, whole) = self.strengths(&added, split)?;
            let own = added.own_joints(kind.whole_arm);
            let of_own = achieved.iter().enumerate().filter(|(j, _)| own.is_empty() || own.contains(j));
            let reached = of_own.map(|(_, s)| *s).fold(0.0, f64::max);
            let factor = wanted / reached.max(1e-12);
            let size = added.size;
            // More torque than a machine could have is not made, however little of it the structure leaves.
            let beyond = own.iter().any(|j| whole[*j] > most[*j]);
            let close = if beyond { 0.0 } else { factor.min(1.0 / factor) };
            built = Some(Built { kind, added: added.clone(), achieved, reached: close });
            if (factor - 1.0).abs() < 0.02 || !factor.is_finite() {
                break;
            }
            let next = (size * factor.clamp(0.05, 20.0)).min(largest);
            if next == size {
                break;
            }
            added = added.of_size(next);
        }
        built
            .ok_or_else(|| SimulationError::value(kind.identifier, wanted, "its strength cannot be measured"))
    }

    /// Largest root mean square of an effect's torque that a machine could have, per joint.
    fn most(&self, split: &Split) -> Vec<f64> {
        let recordings: Vec<usize> = split.files().into_iter().map(|(k, _)| k).collect();
        (0..self.figures.len())
            .map(|j| {
                let all: Vec<f64> =
                    recordings.iter().flat_map(|k| self.recorded[*k].rows.measured[j].clone()).collect();
                LARGEST_SHARE * mean_square(&all).sqrt()
            })
            .collect()
    }

    /// Root mean square of an effect after the usual filters over what the unaltered model leaves, per joint: of a
    /// change, all of it, in the target where it is largest; of what is in all recordings, what the experiment's structure
    /// cannot absorb of it. Beside it the root mean square of all of it.
    fn strengths(&self, added: &Added, split: &Split) -> Result<(Vec<f64>, Vec<f64>), SimulationError> {
        let left = self.model.left_rms();
        let rows_of = |k: &usize| {
            let Recorded { recording, scene, .. } = &self.recorded[*k];
            let measured = recording.measurement.as_deref().unwrap_or_default();
            self.filtered(*k, added.torque(scene, measured)?)
        };
        let over_left = |rms: Vec<f64>| rms.iter().zip(left).map(|(r, l)| r / l.max(1e-12)).collect();
        if split.presence == Presence::All {
            let effect = split.calibration.iter().map(rows_of).collect::<Result<Vec<_>, _>>()?;
            let rows: Vec<&Rows> = split.calibration.iter().map(|k| &self.recorded[*k].rows).collect();
            let absorbed = self.model.fitted(&rows, |r, j| &effect[r][j]);
            let whole = |j: usize| effect.iter().flat_map(|e| e[j].iter().copied()).collect::<Vec<f64>>();
            let whole = (0..left.len()).map(|j| mean_square(&whole(j)).sqrt()).collect();
            let rms = (0..left.len())
                .map(|j| {
                    let free: Vec<f64> = rows
                        .iter()
                        .zip(&effect)
                        .flat_map(|(rows, e)| self.model.left_over(rows, &e[j], j, &absorbed))
                        .collect();
                    mean_square(&free).sqrt()
                })
                .collect();
            return Ok((over_left(rms), whole));
        }
        let local = added.is_local();
        let targets = if local { &split.target[..1] } else { &split.target[..] };
        let mut largest = vec![0.0_f64; left.len()];
        for k in targets {
            for (most, series) in largest.iter_mut().zip(rows_of(k)?) {
                // Of what is local in time, the rows that have it: less than a hundredth of the peak is the filter's.
                let peak = series.iter().fold(0.0_f64, |p, v| p.max(v.abs()));
                let there: Vec<f64> =
                    series.into_iter().filter(|v| !local || v.abs() > 0.01 * peak).collect();
                *most = most.max(mean_square(&there).sqrt());
            }
        }
        Ok((over_left(largest.clone()), largest))
    }
}
