//! The segments in which gears are looked for, and their rows.

use std::sync::OnceLock;

use aurt_recording::{PositionNoise, ZeroPhase};
use rayon::prelude::*;

use super::against::{Against, OwnFreed};
use super::rows::{Kind, Rows};
use super::series::{FullRate, Piece};
use super::{LEAST_RATE_HZ, PoseColumns};
use crate::dice::Dice;
use crate::error::DiagnosisError;
use crate::noise::spectrum::stamps_in_use;
use crate::recordings::rows::{Fit, Role};
use crate::request::Question;

/// A stretch between gaps that is shorter than this has too few blocks of time, and filters may not fit into it, s.
const SHORTEST_S: f64 = 2.0;

/// The segments in which gears can be looked for.
pub(super) fn pieces<'a>(
    question: &'a Question<'_>,
    fit: &Fit<'_>,
    inertial: &[(usize, f64)],
    asked: impl Fn(Role) -> bool,
) -> Result<Vec<Piece<'a>>, DiagnosisError> {
    let targets = question.recordings.iter().any(|r| r.role == Role::Target);
    let mut pieces = Vec::new();
    for (recording, questioned) in question.recordings.iter().enumerate() {
        // Another simulator's prediction is no torque of this model.
        if !asked(questioned.role) || questioned.simulated.is_some() {
            continue;
        }
        let position_cutoff_hz = questioned.options.effective_position_cutoff_hz();
        let stamps_s = stamps_in_use(&questioned.raw, &questioned.data.data);
        let noise: Vec<PositionNoise> =
            questioned.raw.position_rad.iter().map(|q| PositionNoise::of(&stamps_s, q)).collect();
        for segment in questioned.data.data.segments.iter().filter(|s| s.rate_hz >= LEAST_RATE_HZ) {
            if (segment.motion.samples() as f64) < SHORTEST_S * segment.rate_hz {
                continue;
            }
            let Some(full) = FullRate::evaluate(segment, fit, inertial)? else { continue };
            let body = &**fit.model.rigid_body();
            let gradients =
                PoseColumns::gravity_gradients(body, inertial, segment.motion.view(), full.inertia.step())?;
            // Validation recordings are of the robot as it is in the targets, where there are any.
            let target = questioned.role == Role::Target || targets && questioned.role == Role::Validation;
            let noise = noise.clone();
            pieces.push(Piece { recording, target, segment, full, gradients, position_cutoff_hz, noise });
        }
    }
    Ok(pieces)
}

/// Rows of all pieces for gears of a kind.
pub(super) struct KindRows<'a> {
    pieces: &'a [Piece<'a>],
    kind: Kind,
    freed: Vec<OwnFreed>,
    /// The same with the positions' noise once more, of either sign; made where it is asked for.
    noisier: OnceLock<[Vec<OwnFreed>; 2]>,
}

impl<'a> KindRows<'a> {
    pub fn new(pieces: &'a [Piece<'a>], kind: Kind) -> Result<Self, DiagnosisError> {
        let freed = |piece: &Piece<'_>| Ok(OwnFreed::new(piece.rows(kind)?, piece.target));
        let freed = pieces.par_iter().map(freed).collect::<Result<Vec<_>, DiagnosisError>>()?;
        Ok(Self { pieces, kind, freed, noisier: OnceLock::new() })
    }

    /// Pieces as they are.
    pub fn freed(&self) -> &[OwnFreed] {
        &self.freed
    }

    /// True for calibration recordings, and for targets, if there are pieces of them.
    pub fn kinds(&self) -> [bool; 2] {
        [false, true].map(|target| self.freed.iter().any(|f| f.target == target))
    }

    /// Against what a gear of a joint is judged where positions have their noise once more, of either sign.
    pub fn noisier(&self, joint: usize) -> Result<[Vec<Against<'_>>; 2], DiagnosisError> {
        if self.noisier.get().is_none() {
            let of_piece = |(k, piece): (usize, &Piece<'_>)| -> Result<[OwnFreed; 2], DiagnosisError> {
                let noise = piece.acceleration_noise(Dice(k as u64 + 1))?;
                let noisier = |sign: f64| {
                    let full = piece.full.beside(&noise, sign);
                    let rows = Rows::new(piece, &full, self.kind, Some(&self.freed[k].rows))?;
                    Ok::<_, DiagnosisError>(OwnFreed::new(rows, piece.target))
                };
                Ok([noisier(1.0)?, noisier(-1.0)?])
            };
            let both = self.pieces.par_iter().enumerate().map(of_piece);
            let both = both.collect::<Result<Vec<_>, DiagnosisError>>()?;
            let (ahead, behind) = both.into_iter().map(|[ahead, behind]| (ahead, behind)).unzip();
            // Another joint may have made them meanwhile; they are the same.
            let _ = self.noisier.set([ahead, behind]);
        }
        let [ahead, behind] = self.noisier.get().map_or([&[][..]; 2], |of| [&of[0][..], &of[1][..]]);
        Ok([against(ahead, joint)?, against(behind, joint)?])
    }
}

/// Against what a gear of a joint is judged, on the rows of all joints.
fn against(freed: &[OwnFreed], joint: usize) -> Result<Vec<Against<'_>>, DiagnosisError> {
    freed.iter().filter_map(|f| Against::new(f, joint, true).transpose()).collect()
}

impl Piece<'_> {
    fn rows(&self, kind: Kind) -> Result<Rows, DiagnosisError> {
        Rows::new(self, &self.full, kind, None)
    }

    /// Noise of accelerations as that of the positions makes it, `[joint][sample]`: as strong as at the end of the rows' band, where
    /// it is strongest, and white before the positions' filter.
    fn acceleration_noise(&self, mut dice: Dice) -> Result<Vec<Vec<f64>>, DiagnosisError> {
        let rate_hz = self.full.rate_hz;
        let samples = self.full.time_s.len();
        let order = self.segment.parallel_filter.order();
        let filter = ZeroPhase::butterworth(order, self.position_cutoff_hz, rate_hz)?;
        let of_joint = |noise: &PositionNoise| -> Result<Vec<f64>, DiagnosisError> {
            let top_hz = (self.position_cutoff_hz).min(0.5 * noise.rate_hz);
            let std_rad = (noise.psd(top_hz) * 0.5 * rate_hz).sqrt();
            let white: Vec<f64> = (0..samples).map(|_| std_rad * dice.normal()).collect();
            let position = filter.filter(&white)?;
            let at = |k: usize| position[k.min(samples - 1)];
            let second = |k: usize| (at(k + 1) - 2.0 * at(k) + at(k.saturating_sub(1))) * rate_hz * rate_hz;
            Ok((0..samples).map(second).collect())
        };
        self.noise.iter().map(of_joint).collect()
    }
}
