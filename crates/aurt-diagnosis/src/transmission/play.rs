//! Play between the teeth: bursts where the transmitted torque changes its sign.
//!
//! For each joint j the energy D_j along M e_j ([`Along`]) of the high-passed residual is compared between the
//! samples near a change of sign of the load of joint j and those beside it. For a χ² variable whose scale differs
//! between the two, the gain in log-likelihood is ½ [N ln m − N₁ ln m₁ − N₂ ln m₂] with the means m, m₁, m₂. Of several
//! joints that show it, the one with the largest gain over all other samples is named first.

use aurt_recording::ZeroPhase;

use super::{Piece, Shaking, pattern::Along, windows};
use crate::error::DiagnosisError;

/// Least gain in log-likelihood over all recordings of a kind, set between rigid and playing gears of tuning cases.
const LEAST_GAIN: f64 = 45.0;
/// Least ratio of the energies near changes of sign and beside them.
const LEAST_RATIO: f64 = 1.5;
/// Where the model leaves more than this beside the changes of sign, in units of the noise, something else shakes the arm,
/// and it need not do so evenly: on a Panda whose friction was left out it was 3000, and twice that at changes of sign.
const QUIET: f64 = 5.0;
/// Least ratio there.
const LEAST_RATIO_IN_NOISE: f64 = 5.0;
/// Play is a defect of single gears: where more than this share of the joints show impacts, it is the arm's way of
/// moving, and not named.
const MOST_JOINTS: f64 = 0.34;
/// Changes of sign are known to this time, s: the load is that of a fitted model.
const REACH_S: f64 = 0.08;
/// A load presses a flank from this share of its root mean square on.
const WELL: f64 = 0.1;
/// Changes of sign that are too many to be told from everything else: share of the samples near one.
const MOST_COVERED: f64 = 0.65;
/// Least number of changes of sign.
const FEWEST: usize = 6;
/// What is elsewhere is taken from this far away, s: hum and rattle go with the speed, which is much the same there.
const BESIDE_S: [f64; 2] = [0.12, 0.5];
/// Changes of sign nearer to each other than this are one, s: a load about zero.
const ONE_S: f64 = 0.1;
/// Impacts ring on for this time, s.
const RINGS_S: f64 = 0.3;

/// What the samples of one kind of recording say of one joint.
#[derive(Debug, Clone, Copy, Default)]
struct Evidence {
    /// Sum of D_j and number of samples near changes of sign, …
    near: [f64; 2],
    /// … anywhere else, …
    away: [f64; 2],
    /// … and in what lies beside them.
    beside: [f64; 2],
    /// Changes of sign.
    crossings: usize,
}

impl Evidence {
    /// Gain in log-likelihood of a scale of its own near changes of sign, against the samples `other`.
    fn gain_over(&self, [other, n2]: [f64; 2]) -> f64 {
        let [near, n1] = self.near;
        if n1 < 1.0 || n2 < 1.0 || n1 > MOST_COVERED * (n1 + self.away[1]) {
            return 0.0;
        }
        let log = |sum: f64, n: f64| (sum / n).max(f64::MIN_POSITIVE).ln();
        0.5 * ((n1 + n2) * log(near + other, n1 + n2) - n1 * log(near, n1) - n2 * log(other, n2))
    }

    fn gain(&self) -> f64 {
        self.gain_over(self.away)
    }

    /// Mean energy beside changes of sign; below the noise there is nothing to compare with.
    fn background(&self) -> f64 {
        (self.beside[0] / self.beside[1].max(1.0)).max(1.0)
    }

    fn ratio(&self) -> f64 {
        self.near[0] / self.near[1].max(1.0) / self.background()
    }

    fn shows(&self) -> bool {
        let least = if self.background() > QUIET { LEAST_RATIO_IN_NOISE } else { LEAST_RATIO };
        self.crossings >= FEWEST && self.gain_over(self.beside) >= LEAST_GAIN && self.ratio() >= least
    }
}

/// Joints with play, the clearest first. Samples after the changes of sign of a joint that was found are calm no
/// longer: what rings there is explained.
pub(super) fn find(pieces: &mut [Piece], f_dyn_hz: f64) -> Result<Vec<Shaking>, DiagnosisError> {
    let joints = pieces.first().map_or(0, |p| p.full.joints());
    let high: Vec<Vec<Vec<f64>>> = pieces.iter().map(|p| high_pass(p, f_dyn_hz)).collect::<Result<_, _>>()?;
    let mut found: Vec<Shaking> = Vec::new();
    while found.len() < joints {
        let evidence: Vec<[Evidence; 2]> = (0..joints)
            .map(|j| {
                let mut kinds = [Evidence::default(); 2];
                for (piece, band) in pieces.iter().zip(&high) {
                    add(&mut kinds[usize::from(piece.target)], piece, band, f_dyn_hz, j);
                }
                kinds
            })
            .collect();
        let clearest = (0..joints)
            .filter(|j| found.iter().all(|f| f.joint != *j) && evidence[*j].iter().any(Evidence::shows))
            .max_by(|a, b| {
                let sum = |j: usize| evidence[j].iter().map(Evidence::gain).sum::<f64>();
                sum(*a).total_cmp(&sum(*b))
            });
        let Some(joint) = clearest else { break };
        let shown: Vec<&Evidence> = evidence[joint].iter().filter(|e| e.shows()).collect();
        let mut windows_s = Vec::new();
        for piece in pieces.iter_mut().filter(|p| evidence[joint][usize::from(p.target)].shows()) {
            let crossings = sign_changes(piece, joint);
            windows_s.extend(windows(piece, crossings.iter().copied(), REACH_S));
            let (before, after) = (samples(piece, REACH_S), samples(piece, RINGS_S));
            for calm in &mut piece.full.calm {
                for k in &crossings {
                    let end = (k + after).min(calm.len());
                    calm[k.saturating_sub(before)..end].fill(false);
                }
            }
        }
        found.push(Shaking {
            effect: "backlash",
            joint,
            present: [evidence[joint][0].shows(), evidence[joint][1].shows()],
            score: shown.iter().map(|e| e.gain()).sum(),
            contrast: shown.iter().map(|e| e.ratio()).fold(0.0, f64::max),
            frequency_hz: None,
            stiffness_nm_rad: None,
            crossings: Some(shown.iter().map(|e| e.crossings).sum()),
            windows_s,
        });
    }
    if found.len() as f64 > (MOST_JOINTS * joints as f64).max(1.0) {
        found.clear();
    }
    Ok(found)
}

fn samples(piece: &Piece, seconds: f64) -> usize {
    (seconds * piece.full.rate_hz).ceil() as usize
}

/// The residual without what lies below `f_dyn_hz`, where other physics is.
fn high_pass(piece: &Piece, f_dyn_hz: f64) -> Result<Vec<Vec<f64>>, DiagnosisError> {
    let residual = &piece.full.residual;
    let slow = ZeroPhase::butterworth(4, f_dyn_hz, piece.full.rate_hz)?.filter_all(residual)?;
    Ok(residual.iter().zip(&slow).map(|(e, s)| e.iter().zip(s).map(|(a, b)| a - b).collect()).collect())
}

/// Samples at which the load of a joint has just changed its sign. It counts where the load goes from well below zero to
/// well above or back: one that hovers about zero, as on a vertical axis at constant speed, does not press a flank.
fn sign_changes(piece: &Piece, joint: usize) -> Vec<usize> {
    flank_changes(&piece.full.load[joint])
}

fn flank_changes(load: &[f64]) -> Vec<usize> {
    let rms = (load.iter().map(|l| l * l).sum::<f64>() / load.len().max(1) as f64).sqrt();
    let mut changes = Vec::new();
    let (mut side, mut crossed) = (0.0, None);
    for (k, value) in load.iter().enumerate() {
        if k > 0 && value * load[k - 1] < 0.0 {
            crossed = Some(k);
        }
        if value.abs() > WELL * rms {
            if value.signum() != side && side != 0.0 {
                changes.extend(crossed);
            }
            side = value.signum();
        }
    }
    changes
}

fn add(evidence: &mut Evidence, piece: &Piece, band: &[Vec<f64>], f_dyn_hz: f64, joint: usize) {
    let passed = (1.0 - 2.0 * f_dyn_hz / piece.full.rate_hz).max(0.0).sqrt();
    let noise: Vec<f64> = piece.full.noise.iter().map(|s| s * passed).collect();
    let changes = sign_changes(piece, joint);
    // A load about zero changes its sign many times at once.
    let apart = samples(piece, ONE_S);
    let mut crossings: Vec<usize> = Vec::new();
    for k in &changes {
        if crossings.last().is_none_or(|last| k - last > apart) {
            crossings.push(*k);
        }
    }
    let length = piece.full.time_s.len();
    let mut near = vec![false; length];
    for k in &changes {
        let reach = samples(piece, REACH_S);
        near[k.saturating_sub(reach)..(k + reach).min(length)].fill(true);
    }
    let mut energy = vec![f64::NAN; length];
    for (k, d, _) in &Along::new(&piece.full, band, &noise, joint).samples {
        energy[*k] = *d;
        let sum = if near[*k] { &mut evidence.near } else { &mut evidence.away };
        sum[0] += d;
        sum[1] += 1.0;
    }
    let [from, to] = BESIDE_S.map(|s| samples(piece, s));
    for k in crossings {
        let mut own = 0.0;
        let mut beside = [0.0; 2];
        for (at, d) in energy[..(k + to).min(length)].iter().enumerate().skip(k.saturating_sub(to)) {
            if !d.is_finite() {
                continue;
            }
            match (at.abs_diff(k) < from, near[at]) {
                (true, true) => own += 1.0,
                (false, false) => {
                    beside[0] += d;
                    beside[1] += 1.0;
                }
                _ => {}
            }
        }
        if own >= 1.0 && beside[1] >= 1.0 {
            evidence.crossings += 1;
            evidence.beside[0] += beside[0];
            evidence.beside[1] += beside[1];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::flank_changes;

    #[test]
    fn a_load_that_goes_through_zero_changes_the_flank_once() {
        assert_eq!(flank_changes(&[1.0, 0.5, -0.5, -1.0, -0.5, 0.5, 1.0]), [2, 5]);
    }

    #[test]
    fn a_load_that_hovers_about_zero_stays_on_its_flank() {
        let mut load = vec![1.0, 1.0];
        load.extend([0.01, -0.01, 0.01, -0.01]);
        load.extend([1.0, 1.0]);
        assert!(flank_changes(&load).is_empty());
        load.extend([0.01, -0.01, 0.01, -0.01, -1.0]);
        assert_eq!(flank_changes(&load), [11], "the last change before the other flank is pressed");
    }

    #[test]
    fn no_load_changes_no_flank() {
        assert!(flank_changes(&[]).is_empty());
        assert!(flank_changes(&[0.0; 5]).is_empty());
    }
}
