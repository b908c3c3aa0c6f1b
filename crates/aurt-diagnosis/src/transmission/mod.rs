//! What the filters of calibration hide: impacts and ringing, above the cut-off and unpredictable from the motion.
//!
//! Calibration sees nothing above 2 f_dyn, and no column of a regressor predicts when a tooth strikes or how a gear
//! rings. Both are found in what the fitted model leaves of the measurement at the recording's own rate, by three
//! marks that noise and rigid physics do not have:
//!
//! - *where in the arm*: a link j that moves against its motor with the acceleration x asks M(q) e_j x of the
//!   drives, the column of the inertia matrix ([`InertiaColumns`]);
//! - *when*: play makes itself felt where the transmitted torque changes its sign ([`play`]), and not elsewhere;
//! - *how*: a spring rings at a frequency of its own, in bursts ([`ring`]), where a disturbance from outside hums.
//!
//! Joints that rest, or have just reversed, started or stopped, are left out: the sign of dry friction jumps there.

mod pattern;
mod play;
mod ring;
mod series;

pub use crate::noise::inertia::InertiaColumns;
pub use series::FullRate;

use crate::error::DiagnosisError;
use crate::recordings::rows::{Fit, Role};
use crate::request::Question;

/// Play or ringing that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaking {
    /// Identifier: `backlash` or `joint_elasticity`.
    pub effect: &'static str,
    /// The joint whose link moves against its motor.
    pub joint: usize,
    /// Whether the calibration recordings (or the only ones) show it, and whether the targets do.
    pub present: [bool; 2],
    /// Evidence in nats.
    pub score: f64,
    /// Energy where the mark is, over that elsewhere.
    pub contrast: f64,
    /// Frequency of the ringing, Hz.
    pub frequency_hz: Option<f64>,
    /// Stiffness that goes with the frequency, M_jj ω², Nm/rad.
    pub stiffness_nm_rad: Option<f64>,
    /// How often the load changed its sign.
    pub crossings: Option<usize>,
    /// When it shakes: recording and window, s as in the recording's stamps.
    pub windows_s: Vec<(usize, [f64; 2])>,
}

/// A segment at full rate, with the recording that it belongs to.
pub(crate) struct Piece {
    pub recording: usize,
    pub target: bool,
    pub full: FullRate,
}

/// A stretch between gaps that is shorter than this says nothing of rare bursts, and filters may not fit into it, s.
const SHORTEST_S: f64 = 2.0;

/// Recordings of fewer samples per second do not resolve impacts: what is high in them is the upper end of the motion.
pub(crate) const LEAST_RATE_HZ: f64 = 200.0;

/// Looks for play and ringing in all recordings that are not for validation and have at least 200 samples per second.
///
/// # Errors
/// What the model and the filters report.
pub fn find_shaking(
    question: &Question<'_>,
    fit: &Fit<'_>,
    inertial: &[(usize, f64)],
) -> Result<Vec<Shaking>, DiagnosisError> {
    let mut pieces = Vec::new();
    for (recording, questioned) in question.recordings.iter().enumerate() {
        // Another simulator's prediction is no torque of this model.
        if questioned.role == Role::Validation || questioned.simulated.is_some() {
            continue;
        }
        for segment in questioned.data.data.segments.iter().filter(|s| s.rate_hz >= LEAST_RATE_HZ) {
            if (segment.motion.samples() as f64) < SHORTEST_S * segment.rate_hz {
                continue;
            }
            if let Some(full) = FullRate::evaluate(segment, fit, inertial)? {
                pieces.push(Piece { recording, target: questioned.role == Role::Target, full });
            }
        }
    }
    if pieces.is_empty() {
        return Ok(Vec::new());
    }
    let mut found = play::find(&mut pieces, question.f_dyn_hz)?;
    let rings = ring::find(&pieces, question.f_dyn_hz)?;
    // A gear that rings is set off by changes of the load, too; flanks that strike each other ring, but not at one
    // frequency above all others.
    found.retain(|play| !rings.iter().any(|ring| ring.joint == play.joint && ring.contrast > PURE));
    let plays: Vec<usize> = found.iter().map(|f| f.joint).collect();
    found.extend(rings.into_iter().filter(|f| !plays.contains(&f.joint)));
    Ok(found)
}

/// A peak that stands out by more than this is a spring's: of playing gears of tuning cases, the purest reached 4.7.
const PURE: f64 = 6.0;

/// Windows shorter than this apart are one, s.
const JOIN_S: f64 = 0.1;

/// The windows of marked samples of a piece.
fn windows(piece: &Piece, marked: impl Iterator<Item = usize>, reach_s: f64) -> Vec<(usize, [f64; 2])> {
    let mut windows: Vec<(usize, [f64; 2])> = Vec::new();
    for k in marked {
        let (from, to) = (piece.full.time_s[k] - reach_s, piece.full.time_s[k] + reach_s);
        match windows.last_mut() {
            Some((_, last)) if from <= last[1] + JOIN_S => last[1] = to,
            _ => windows.push((piece.recording, [from, to])),
        }
    }
    windows
}
