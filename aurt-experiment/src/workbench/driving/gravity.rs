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

#[cfg(test)]
mod tests {
    use aurt_calibration::drives::{DrivenJoint, Mechanics};
    use aurt_friction::drives::PositionServo;
    use aurt_rbd::{Joint, LinkBody, Placement};
    use aurt_traits::CommandSignal;

    use super::*;

    /// A servo that carries a rod about a level axis.
    fn arm(gravity_m_s2: [f64; 3]) -> DrivenArm {
        let level = Placement::from_roll_pitch_yaw([0.0; 3], [std::f64::consts::FRAC_PI_2, 0.0, 0.0]);
        let rod = LinkBody {
            mass_kg: 0.4,
            com_m: [0.1, 0.0, 0.0],
            inertia_at_com_kg_m2: [1e-5, 0.0, 0.0, 1e-3, 0.0, 1e-3],
        };
        let servo =
            PositionServo { gain_nm_per_rad: 6.0, back_emf_nm_s_per_rad: 0.4, ..PositionServo::default() };
        let mechanics = Mechanics { rotor_inertia_kg_m2: 0.01, ..Mechanics::default() };
        DrivenArm {
            chain: SerialChain::new(vec![Joint::revolute(level)], gravity_m_s2).unwrap(),
            standard_parameters: rod.standard_parameters().to_vec(),
            joints: vec![DrivenJoint { drive: Box::new(servo), mechanics }],
            floor: None,
            command: CommandSignal::Linear,
        }
    }

    #[test]
    fn gravity_upside_down_is_told_and_the_right_one_is_not() {
        let [down, up] = [-9.81, 9.81].map(|z| [0.0, 0.0, z]);
        let time_s: Vec<f64> = (0..3000).map(|k| 0.02 * f64::from(k)).collect();
        let command: Vec<f64> =
            time_s.iter().map(|t| 0.6 * (0.9 * t).sin() + 0.2 * (2.3 * t).sin()).collect();
        let mut recording = DriveRecording {
            position_rad: vec![command.clone()],
            command: vec![command],
            time_s,
            ..DriveRecording::default()
        };
        recording.position_rad = arm(down).rollout(&recording).unwrap();
        let said = |g| upside_down(&arm(g), std::slice::from_ref(&recording), &Options::default()).unwrap();
        assert_eq!(said(down), None);
        let told = said(up).unwrap();
        assert!(told.contains("upside down") && told.contains("-9.81"), "{told}");
    }
}
