//! Gravity that is stated upside down, as positions show it.

use aurt_calibration::drives::{DriveError, DriveRecording, DrivenArm, Options};
use aurt_diagnosis::drives::{Missed, compare};
use aurt_rbd::SerialChain;

/// Largest probability at which one reading of the recordings is said to be theirs.
pub(super) const LEVEL: f64 = 0.01;

/// Says so where the same drives meet the positions better under the opposite gravity. A servo sags the way gravity points: a fit to
/// the wrong way stiffens the drives, and is nearer without being fitted to the right one. One to the right way is not.
pub(super) fn upside_down(
    arm: &DrivenArm,
    recordings: &[DriveRecording],
    options: &Options,
) -> Result<Option<String>, DriveError> {
    let gravity_m_s2 = arm.chain.gravity_m_s2();
    let acts = gravity_m_s2.iter().any(|g| *g != 0.0) && arm.standard_parameters.iter().any(|p| *p != 0.0);
    let opposite_m_s2 = gravity_m_s2.map(|g| if g == 0.0 { 0.0 } else { -g });
    let chain = SerialChain::new(arm.chain.joints().to_vec(), opposite_m_s2);
    let Some(chain) = chain.ok().filter(|_| acts) else { return Ok(None) };
    let other = DrivenArm { chain, ..arm.clone() };
    let now = Missed::of(arm, recordings, options)?;
    // What does not even stay finite meets nothing better.
    let Ok(turned) = Missed::of(&other, recordings, options) else { return Ok(None) };
    let p = compare(&turned, &now, options).probability;
    let is_nearer = turned.rms_all_rad() < now.rms_all_rad() && p <= LEVEL;
    Ok(is_nearer.then(|| {
        format!(
            "gravity seems to be upside down: with `gravity_m_s2` = {opposite_m_s2:?} the same drives meet the positions with an rms \
             of {:.2}e-3 instead of {:.2}e-3 rad or m (p = {p:.1e}); change `gravity_m_s2`, or mount the description as the robot stands",
            1e3 * turned.rms_all_rad(),
            1e3 * now.rms_all_rad()
        )
    }))
}
