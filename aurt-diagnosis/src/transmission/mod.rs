//! Gears that give way or have play: links that move against their motors.
//!
//! A gear shows above the filters of calibration, where noise, servos and friction show as well. So what rings or strikes
//! is no evidence; what is *predicted* is. The link of a joint is simulated, driven by the measured motion of its motor
//! (`link`); the torque that this asks of all drives is set against what model and claims leave at the recording's own
//! rate, on rows that are white (`whiten`, `rows`), beside what the noise of the encoders and the rigid model explain
//! (`against`); and it counts by what it gains on held-out blocks of time (`claim`).
//!
//! Joints that rest, or have just reversed, started or stopped, are left out: the sign of dry friction jumps there.

mod against;
mod claim;
mod link;
mod pieces;
mod rows;
mod series;
mod shape;
#[cfg(test)]
mod tests;
mod undo;
mod whiten;

pub use crate::noise::pose::PoseColumns;
pub use series::FullRate;
pub(crate) use undo::undone;

use aurt_calibration::with_deviation;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::effects::{backlash, joint_elasticity};
use crate::error::DiagnosisError;
use crate::recordings::rows::{Fit, Role};
use crate::request::Question;
use crate::vocabulary::Effect;
pub(crate) use claim::AMPLITUDE;
use claim::{Among, Found, JointRows, LEAST_GAIN, Level, Visible};
use pieces::{KindRows, pieces};
use rows::Kind;
use shape::{Inertia, Shape};

/// A gear that gives way or has play.
#[derive(Debug, Clone, PartialEq)]
pub struct Shaking {
    /// Identifier: `backlash` or `joint_elasticity`.
    pub effect: &'static Effect,
    /// The joint whose link moves against its motor.
    pub joint: usize,
    /// Whether the calibration recordings show it, and whether the targets do.
    pub present: [bool; 2],
    /// Gain in log-likelihood on held-out rows, nats.
    pub score: f64,
    /// The probability that chance makes such a gain in one of all gears that are looked for.
    pub p: f64,
    /// Stiffness of the gear or of its flanks and its standard deviation, Nm/rad (A/rad of a current).
    pub stiffness_nm_rad: [f64; 2],
    /// Damping and its standard deviation, Nm s/rad.
    pub damping_nm_s: [f64; 2],
    /// Half the play and its standard deviation, rad; 0 of a gear without.
    pub gap_rad: [f64; 2],
    /// Frequency of the link on the gear, Hz.
    pub frequency_hz: f64,
    /// Measured torque over the predicted one, and its standard deviation; 1 where the fitted inertias are the link's own.
    pub amplitude: [f64; 2],
    /// Whether it passes all tests; what does not is no more than an indication.
    pub confirmed: bool,
    /// The tests that it fails, in words.
    pub fails: Vec<String>,
    /// Shape and inertia that it was simulated with.
    simulated: (Shape, Inertia),
}

/// The gear of a joint that recordings would show.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct VisibleGear {
    pub joint: usize,
    /// A gear softer than this would show, Nm/rad; absent where no gear of a robot would.
    pub below_nm_rad: Option<f64>,
    /// A play wider than ± this would show, rad; absent where none that was tried would.
    pub beyond_rad: Option<f64>,
}

/// What was looked for in the gears of all joints.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Gears {
    /// What was found, the clearest first.
    pub found: Vec<Shaking>,
    /// The gears that would have been found, joint by joint.
    pub visible: Vec<VisibleGear>,
}

/// Least samples per second. With fewer the rows end below [`PLAY_TOP_HZ`]: differences are derivatives up to a fifth of the rate.
pub(crate) const LEAST_RATE_HZ: f64 = PLAY_TOP_HZ / rows::OF_RATE;

/// Gears are looked for one after another, each beside those found before. More than this many are the arm's way of moving.
const MOST_GEARS: usize = 3;

/// Rows for elasticity end here, Hz: 0.8 of the position filter's cut-off at the usual `f_dyn_hz` of 10, the band in which false
/// claims were counted. Where positions are known beyond, more of it are made.
const ELASTIC_TOP_HZ: f64 = 40.0;

/// Rows for play end here, Hz: when a flank is struck depends on the cube root of the gap, how the link bounces on
/// too much else. The missing torque and the impact as a whole lie below, the bouncing above.
const PLAY_TOP_HZ: f64 = 12.0;

/// Play is another gear than an elastic one if it gains this much more, nats: the price of a further shape.
const PLAY_PRICE: f64 = 5.0;

/// A gear would show if, fitted, it gained this much on all rows, nats: twice what is asked of the half that judges, twice since
/// whitening and a wrong shape cost about as much.
const VISIBLE_GAIN: f64 = 4.0 * LEAST_GAIN;

/// Looks for gears that give way or have play in all recordings that are not for validation and have enough samples per
/// second.
///
/// # Errors
/// What the model and the filters report.
pub fn find_gears(
    question: &Question<'_>,
    fit: &Fit<'_>,
    inertial: &[(usize, f64)],
) -> Result<Gears, DiagnosisError> {
    let effects = [&joint_elasticity::EFFECT, &backlash::EFFECT].map(|e| question.considers(e));
    if !effects.contains(&true) {
        return Ok(Gears::default());
    }
    let mut pieces = pieces(question, fit, inertial, |role| role != Role::Validation)?;
    if pieces.is_empty() {
        return Ok(Gears::default());
    }
    let mut gears = Gears::default();
    let kinds = [false, true].map(|target| pieces.iter().any(|p| p.target == target));
    let ways = [effects, kinds].map(|of| of.iter().filter(|is| **is).count() as f64);
    let level = Level {
        level: question.selection.level,
        trials: question.model.joints() as f64 * ways.iter().product::<f64>(),
    };
    loop {
        let rows = [KindRows::new(&pieces, Kind::Elastic)?, KindRows::new(&pieces, Kind::Play)?];
        let open: Vec<usize> = (0..question.model.joints())
            .filter(|j| gears.found.iter().all(|g| !g.confirmed || g.joint != *j))
            .collect();
        let of_joints = open
            .par_iter()
            .map(|joint| of_joint(&rows, *joint, effects, level))
            .collect::<Result<Vec<_>, DiagnosisError>>()?;
        gears.found.retain(|g| g.confirmed);
        let mut round: Vec<Shaking> = of_joints.iter().flat_map(|o| o.found.iter().cloned()).collect();
        round.sort_by(|a, b| b.confirmed.cmp(&a.confirmed).then(b.score.total_cmp(&a.score)));
        if gears.found.is_empty() {
            gears.visible = visible(&open, &of_joints);
        }
        let clearest = round.iter().find(|g| g.confirmed && gears.found.len() < MOST_GEARS).cloned();
        let Some(clearest) = clearest else {
            round.retain(|g| !g.confirmed);
            gears.found.extend(round);
            return Ok(gears);
        };
        for piece in pieces.iter_mut().filter(|p| clearest.present[usize::from(p.target)]) {
            let torque = undo::torque(&clearest, &piece.full, &piece.gradients);
            undo::take_off(&torque, &mut piece.full.residual);
        }
        gears.found.push(clearest);
    }
}

/// Tests confirmed gears anew in what a model leaves that was fitted without their torque, each from the shape that it had. The
/// probability of chance stays that of the search, which tried all shapes.
pub(crate) fn gears_anew(
    question: &Question<'_>,
    fit: &Fit<'_>,
    inertial: &[(usize, f64)],
    gears: &[Shaking],
) -> Result<Vec<Shaking>, DiagnosisError> {
    let pieces = pieces(question, fit, inertial, |role| role != Role::Validation)?;
    let kinds = [false, true].map(|target| pieces.iter().any(|p| p.target == target));
    let level = Level { level: question.selection.level, trials: 1.0 };
    let anew = |gear: &Shaking| -> Result<Shaking, DiagnosisError> {
        let others = || gears.iter().filter(|g| g.confirmed && g.joint != gear.joint);
        let mut pieces = pieces.clone();
        for piece in &mut pieces {
            for other in others().filter(|g| g.present[usize::from(piece.target)]) {
                let torque = undo::torque(other, &piece.full, &piece.gradients);
                undo::take_off(&torque, &mut piece.full.residual);
            }
        }
        let rows = KindRows::new(&pieces, Kind::of(gear.gap_rad[0]))?;
        let among = if gear.present[0] { Among::All } else { Among::Targets };
        let rows = JointRows::new(&rows, gear.joint)?;
        let found = rows.map_or(Ok(None), |rows| rows.anew(gear.simulated.0, among, level))?;
        Ok(found.map_or_else(|| gear.clone(), |found| Shaking { p: gear.p, ..Shaking::new(found, kinds) }))
    };
    gears.iter().map(|gear| if gear.confirmed { anew(gear) } else { Ok(gear.clone()) }).collect()
}

/// What one joint shows.
#[derive(Default)]
struct OfJoint {
    found: Option<Shaking>,
    visible: Visible,
}

fn of_joint(
    [elastic_rows, play_rows]: &[KindRows<'_>; 2],
    joint: usize,
    effects: [bool; 2],
    level: Level,
) -> Result<OfJoint, DiagnosisError> {
    let kinds = elastic_rows.kinds();
    let search = |rows: &JointRows<'_>, starts: &[Shape]| -> Result<Option<Found>, DiagnosisError> {
        let scan = rows.scan(starts);
        let found = rows.search(&scan, Among::All, level)?;
        let found = if kinds == [true; 2] {
            changed(rows, found, rows.search(&scan, Among::Targets, level)?)
        } else {
            found
        };
        // A torque of the right shape and a tenth of the size is none of a gear, and no indication of one.
        Ok(found.filter(|f| f.gain >= LEAST_GAIN && f.is_possible()))
    };
    let shows =
        |rows: &JointRows<'_>, of: &[Shape]| of.iter().all(|shape| rows.visible(*shape) >= VISIBLE_GAIN);
    let mut of_joint = OfJoint::default();
    let (mut elastic, mut play) = (None, None);
    if let Some(rows) = JointRows::new(elastic_rows, joint)?.filter(|_| effects[0]) {
        let [starts, _] = rows.starts();
        elastic = search(&rows, &starts)?;
        // What a stiff gear gains is a small difference of large noises: each softer one has to show as well.
        let stiffer = starts.chunk_by(|a, b| a.hz == b.hz).take_while(|of| shows(&rows, of));
        of_joint.visible.hz = stiffer.last().map(|of| of[0].hz);
        of_joint.visible.inertia = Some(rows.inertia());
    }
    if let Some(rows) = JointRows::new(play_rows, joint)?.filter(|_| effects[1]) {
        let [_, starts] = rows.starts();
        play = search(&rows, &starts)?;
        let narrower = starts.chunk_by(|a, b| a.half_gap_rad == b.half_gap_rad).rev();
        let narrower = narrower.take_while(|of| shows(&rows, of));
        of_joint.visible.half_gap_rad = narrower.last().map(|of| of[0].half_gap_rad);
    }
    let found = match (elastic, play) {
        (Some(e), Some(p)) if e.confirmed() == p.confirmed() => {
            Some(if p.gain > e.gain + PLAY_PRICE { p } else { e })
        }
        (Some(e), Some(p)) => Some(if p.confirmed() { p } else { e }),
        (e, p) => e.or(p),
    };
    of_joint.found = found.map(|f| Shaking::new(f, kinds));
    Ok(of_joint)
}

/// Of a gear among all recordings and one among the targets alone, the one that the recordings speak for. Targets whose motion shows more
/// of a gear do not change it: that of the targets is in the calibration recordings where these have its torque as well.
fn changed(rows: &JointRows<'_>, all: Option<Found>, targets: Option<Found>) -> Option<Found> {
    let shows = |gain: f64| gain >= LEAST_GAIN / 2.0;
    let in_reference = all.as_ref().is_some_and(|a| a.confirmed() && shows(a.gains[0]));
    match (all, targets) {
        (Some(all), _) if in_reference => Some(all),
        (_, Some(mut targets)) if targets.confirmed() => {
            let gain = rows.gain_in_calibration(targets.shape);
            targets.gains[0] = if shows(gain) { gain } else { 0.0 };
            Some(targets)
        }
        (all, targets) => all.filter(Found::confirmed).or(targets),
    }
}

impl Shaking {
    /// Withdraws an elastic gear whose compliance is within two deviations of none, as it is done with the size of other effects.
    pub(crate) fn require_size(&mut self) {
        let [stiffness, std] = self.stiffness_nm_rad;
        if self.confirmed && self.gap_rad[0] == 0.0 && 2.0 * std > stiffness {
            self.confirmed = false;
            let size = with_deviation(stiffness, std);
            self.fails
                .push(format!("its stiffness, {size} Nm/rad, is within two standard deviations of none"));
        }
    }

    fn new(found: Found, kinds: [bool; 2]) -> Self {
        let play = found.shape.half_gap_rad > 0.0;
        let (amplitude, std) = (found.amplitude, found.amplitude_std);
        let gear = found.shape.gear(found.inertia);
        let [hz, ratio, _, gap] = found.shape_std;
        // The shape has the rotor's share, so the amplitude of a true gear is one. By as much as it differs the arm does not swing as
        // one link on one gear does (other gears give way as well), and its stiffness and play are in doubt.
        let relative = std.hypot(1.0 - amplitude);
        let stiffness = gear.stiffness_nm_rad;
        let damping = gear.damping_nm_s;
        let shown = |kind: usize| kinds[kind] && found.gains[kind] > 0.0;
        Self {
            effect: if play { &backlash::EFFECT } else { &joint_elasticity::EFFECT },
            joint: found.joint,
            present: [shown(0), shown(1)],
            score: found.gain,
            p: found.p,
            stiffness_nm_rad: [stiffness, stiffness * (2.0 * hz).hypot(relative)],
            damping_nm_s: [damping, damping * hz.hypot(ratio).hypot(relative)],
            gap_rad: [gear.half_gap_rad, if play { gear.half_gap_rad * gap.hypot(relative) } else { 0.0 }],
            frequency_hz: found.shape.hz,
            amplitude: [amplitude, std],
            confirmed: found.confirmed(),
            fails: found.fails,
            simulated: (found.shape, found.inertia),
        }
    }
}

/// From which stiffness and which play on the gears of `joints` would have been found.
fn visible(joints: &[usize], of_joints: &[OfJoint]) -> Vec<VisibleGear> {
    let of_joint = |(joint, OfJoint { visible, .. }): (&usize, &OfJoint)| VisibleGear {
        joint: *joint,
        below_nm_rad: visible.hz.zip(visible.inertia).map(|(hz, inertia)| {
            let omega = std::f64::consts::TAU * hz;
            inertia.mean_kg_m2 * omega * omega
        }),
        beyond_rad: visible.half_gap_rad,
    };
    joints.iter().zip(of_joints).map(of_joint).collect()
}
