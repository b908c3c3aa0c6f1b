//! The next motion to record: the one that decides what a diagnosis leaves open.
//!
//! The motion is composed of pieces drawn at random within the limits: multi-sines, constant speeds, slow triangles, poses held.
//! Second moments add, so that a piece is evaluated once. V. V. Fedorov's exchange (*Theory of Optimal Experiments*, 1972)
//! finds those that together settle most: that maximise the expected number of settled doubts.

mod drives;
mod exchange;
mod keep_out;
mod limits;
mod text;
mod torques;

pub use keep_out::KeepOut;

use aurt::Progress;
use aurt_diagnosis::DiagnosisError;
use aurt_diagnosis::discrimination::{
    DeviationGoal, Discrimination, Discriminator, Doubt, Interval, Outlook, Subject,
};
use aurt_plugins::Registry;
use aurt_rbd::RobotDescription;
use aurt_recording::Recording;
use aurt_simulation::trajectory::{ExcitationOptions, MultiSineOptions, excite};
use aurt_simulation::{Motion, MotionLimits, Random, Robot, Trajectory};
use aurt_traits::{MeasurementUnit, RigidBodyRegressor};
use rayon::prelude::*;

use crate::Experiment;
use crate::workbench::diagnosing::{DiagnosisOptions, diagnoser};
use crate::workbench::failure::Failure;
use exchange::Exchange;
use keep_out::KeepOutCheck;

#[derive(Debug, Clone)]
pub struct NextOptions {
    pub diagnosis: DiagnosisOptions,
    /// Limits of the joints; by default what the recordings show: where the arm has been, and how fast.
    pub limits: Option<Vec<MotionLimits>>,
    /// Boxes that the arm stays out of.
    pub keep_out: Vec<KeepOut>,
    /// Deviations that parameters shall have at most.
    pub wanted: Vec<DeviationGoal>,
    /// Longest duration in s.
    pub duration_s: f64,
    pub draws: usize,
    pub seed: u64,
}

/// The next motion, and what it would do.
#[derive(Debug, Clone)]
pub struct Next {
    /// The motion; none where it would settle nothing.
    pub motion: Option<Plan>,
    /// What is open, with the outlook of the motion (where there is one) and of others.
    pub open: Vec<Open>,
    /// What no motion within the limits settles.
    pub never: Vec<(Doubt, Outlook)>,
    /// Parameters of what is claimed, now and after the motion.
    pub intervals: Vec<(Subject, Vec<Interval>)>,
    pub joint_names: Vec<String>,
    /// The expected logarithm of the ratio of likelihoods that settles a doubt with the probability `SURE`.
    sure_nats: f64,
    pub rate_hz: f64,
    /// True of a motion of commands that drives follow.
    pub is_of_drives: bool,
    pub notes: Vec<String>,
}

#[derive(Debug, Clone)]
pub struct Plan {
    pub trajectory: Trajectory,
    pub pieces: Vec<String>,
    /// The largest torque of each joint that the model predicts, and the largest that was recorded; of drives the distances of
    /// position and command, rad.
    pub largest: Vec<[f64; 2]>,
}

/// A doubt, and what recordings would do about it.
#[derive(Debug, Clone)]
pub struct Open {
    pub doubt: Doubt,
    pub planned: Outlook,
    /// With the motions of the present recordings for as long.
    pub again: Outlook,
    /// With the multi-sine of the longest duration that has the smallest condition number.
    pub generic: Outlook,
}

/// Most pieces of a motion: doubts of different kinds need motions of different kinds.
const PIECES: usize = 8;
/// Pieces are drawn as long as for a motion of one piece, of two, … and of so many.
const FULL_PIECES: usize = 4;
/// The most that a way between two pieces is expected to take, over the time of a piece and its way.
const WAY_PART: f64 = 0.25;
/// The weight of the logarithm of evidence beside a probability: it decides where probabilities are 1 to six digits.
const NO_DOUBT: f64 = 1e-6;
/// Shortest time of a piece, s: a stroke or two, of which the ends are at rest.
const SHORTEST_S: f64 = 2.0;
/// Multi-sines that are tried for the one with the smallest condition number, as `aurt excite` does by default.
const SINES_TRIED: usize = 100;
/// Words for the multi-sine that is planned without knowing what is open.
const GENERIC: &str = "a multi-sine as of `aurt excite`";
/// The probability of which the time is told that a doubt would take.
const SURE: f64 = 0.9;
/// Share of the limits that is used at most: tracking overshoots.
const SHARE: f64 = 0.8;
/// The greatest speed and acceleration of a way between two pieces of commands, rad/s and rad/s²: servos follow it.
const WAY_LIMITS: [f64; 2] = [1.0, 10.0];
/// The share of the largest recorded distance of position and command that a step of the command has at most: an arm hangs
/// below its command before it.
const STEP: f64 = 0.9;
/// A doubt that all pieces together do not settle with the first probability is beyond motions like these; with the second where
/// no doubt reaches the first, since a motion that helps is better than none.
const EVER: [f64; 2] = [0.5, 0.05];

pub fn plan_next(
    experiment: &Experiment,
    registry: &Registry,
    options: &NextOptions,
    progress: &Progress,
) -> Result<Next, Failure> {
    let check = keep_out_check(experiment, &options.keep_out)?;
    if experiment.drive.is_some() {
        return drives::plan(experiment, options, check.as_ref(), progress);
    }
    diagnoser(experiment, registry, &options.diagnosis, progress)?.ask(
        progress,
        |question, investigation, registry| {
            let doubts = Discrimination::new(question, investigation, registry, &options.wanted);
            let arm = torques::planned_arm(question, options)?;
            Planner { discrimination: &doubts, options, check: check.as_ref(), arm }.plan(progress)
        },
    )
}

fn keep_out_check(experiment: &Experiment, boxes: &[KeepOut]) -> Result<Option<KeepOutCheck>, Failure> {
    if boxes.is_empty() {
        return Ok(None);
    }
    let robot = &experiment.robot;
    let chain = robot.geometry.chain(robot.gravity_m_s2)?;
    let refuse =
        |reason: &str| Err(Failure::argument("--keep-out", reason, "keep the arm away with --limits"));
    if chain.joints().len() != robot.robot_joints().count {
        return refuse(
            "joints of this robot follow others (mimic), and their motions are not compared with boxes",
        );
    }
    let check = KeepOutCheck { chain, boxes: boxes.to_vec() };
    if !check.has_lines() {
        return refuse("a robot with one joint that turns has no line between the origins of two links");
    }
    Ok(Some(check))
}

/// What is known of an arm and its recordings.
struct PlannedArm<'a> {
    joint_names: Vec<String>,
    limits: Vec<MotionLimits>,
    rate_hz: f64,
    /// The largest torque of each joint that was recorded; of drives the largest distance of position and command, rad.
    recorded: Vec<f64>,
    bodies: &'a dyn RigidBodyRegressor,
    unit: MeasurementUnit,
    is_of_drives: bool,
    notes: Vec<String>,
}

fn rate_hz(time_s: &[f64]) -> f64 {
    let span_s = time_s.last().unwrap_or(&0.0) - time_s.first().unwrap_or(&0.0);
    if span_s > 0.0 { (time_s.len() - 1) as f64 / span_s } else { 1.0 }
}

struct Planner<'a, D: Discriminator> {
    discrimination: &'a D,
    options: &'a NextOptions,
    check: Option<&'a KeepOutCheck>,
    arm: PlannedArm<'a>,
}

struct Piece<M> {
    trajectory: Trajectory,
    words: String,
    planned: M,
}

/// Limits of steps of a command, about the middle of others: within a row and a half it has moved by a width.
fn step_limits(limits: &MotionLimits, most_rad: f64, rate_hz: f64) -> MotionLimits {
    let [low, high] = limits.position_rad;
    let (middle, width, step_s) = (0.5 * (low + high), most_rad.min(high - low), 1.5 / rate_hz);
    MotionLimits {
        position_rad: [middle - 0.5 * width, middle + 0.5 * width],
        // The smooth step of a motion is at most 2.19 and 7.52 times as fast as its mean.
        velocity_rad_s: 2.2 * width / step_s,
        acceleration_rad_s2: 7.6 * width / (step_s * step_s),
    }
}

impl<D: Discriminator> Planner<'_, D> {
    /// The arm with the limits of ways between pieces.
    fn on_ways(&self) -> Robot {
        let mut limits = self.arm.limits.clone();
        for own in limits.iter_mut().filter(|_| self.arm.is_of_drives) {
            own.velocity_rad_s = own.velocity_rad_s.min(WAY_LIMITS[0]);
            own.acceleration_rad_s2 = own.acceleration_rad_s2.min(WAY_LIMITS[1]);
        }
        Robot::of_limits("arm", &limits)
    }

    fn plan(self, progress: &Progress) -> Result<Next, Failure> {
        let doubts = self.discrimination.doubts();
        let PlannedArm { joint_names, rate_hz, is_of_drives, notes, .. } = &self.arm;
        let mut next = Next {
            motion: None,
            open: Vec::new(),
            never: Vec::new(),
            intervals: Vec::new(),
            joint_names: joint_names.clone(),
            sure_nats: self.discrimination.nats_to_decide(SURE),
            rate_hz: *rate_hz,
            is_of_drives: *is_of_drives,
            notes: notes.clone(),
        };
        if doubts.is_empty() {
            return Ok(next);
        }
        let generic = self.generic()?;
        let pieces = self.pieces(&generic, progress)?;
        let all = self
            .together(pieces.iter())
            .ok_or(DiagnosisError::NothingToDiagnose)
            .map_err(aurt::Error::from)?;
        let mut ever = self.discrimination.outlook(&all);
        if *is_of_drives {
            // A test of blocks loses by blocks that say nothing: a piece may decide what all together do not.
            let again = self.discrimination.recorded_again(&pieces[0].planned).map_err(aurt::Error::from)?;
            for motion in pieces.iter().map(|piece| &piece.planned).chain([&again]) {
                let own = self.discrimination.outlook(motion);
                let better = ever.iter_mut().zip(own).filter(|(ever, own)| own.settled > ever.settled);
                better.for_each(|(ever, own)| *ever = own);
            }
        }
        let least = EVER[usize::from(ever.iter().all(|outlook| outlook.settled < EVER[0]))];
        let open: Vec<usize> = (0..doubts.len()).filter(|k| ever[*k].settled >= least).collect();
        let hopeless = (0..doubts.len()).filter(|k| !open.contains(k));
        next.never = hopeless.map(|k| (doubts[k].clone(), ever[k].clone())).collect();
        if open.is_empty() {
            return Ok(next);
        }
        progress.step("exchanging pieces");
        let robot = self.on_ways();
        let exchange = Exchange { planner: &self, pieces: &pieces, open: &open, robot };
        let generic = self.moments(&generic)?;
        let (chosen, trajectory, planned) = exchange.motion(&generic)?;
        let again = self.discrimination.recorded_again(&planned).map_err(aurt::Error::from)?;
        let [planned_outlook, generic, again] =
            [&planned, &generic, &again].map(|motion| self.discrimination.outlook(motion));
        next.open = open
            .iter()
            .map(|k| Open {
                doubt: doubts[*k].clone(),
                planned: planned_outlook[*k].clone(),
                again: again[*k].clone(),
                generic: generic[*k].clone(),
            })
            .collect();
        next.intervals = self.discrimination.intervals(&planned);
        let largest = self.discrimination.largest(&planned).iter().zip(&self.arm.recorded);
        let largest = largest.map(|(planned, recorded)| [*planned, *recorded]).collect();
        let words = chosen.iter().map(|k| pieces[*k].words.clone()).collect();
        next.motion = Some(Plan { trajectory, pieces: words, largest });
        Ok(next)
    }

    /// Draws pieces whose torques were seen before; a multi-sine made without knowing what is open is the first of them.
    fn pieces(&self, generic: &Trajectory, progress: &Progress) -> Result<Vec<Piece<D::Planned>>, Failure> {
        let robot = self.on_ways();
        let ends = |k: usize| self.arm.limits.iter().map(|l| l.position_rad[k]).collect::<Vec<f64>>();
        let way_s = robot.travel_s(SHARE, &ends(0), &ends(1), 0.0);
        // So long that a number of them and the ways between them fill the motion.
        let piece_s = |count: usize| {
            let share_s = self.options.duration_s / count as f64;
            (share_s - if count > 1 { way_s.min(WAY_PART * share_s) } else { 0.0 }).max(SHORTEST_S)
        };
        let mut random = Random::labelled(self.options.seed, "next");
        let mut drawn = vec![(generic.clone(), GENERIC.to_owned())];
        // Some draws do not fit into the limits.
        for attempt in 0..4 * self.options.draws {
            if drawn.len() > self.options.draws {
                break;
            }
            drawn.extend(self.drawn(attempt, piece_s(1 + attempt / 4 % FULL_PIECES), &mut random));
        }
        let mut refusal =
            ("--duration-s", "fits into the limits", "give more time, or wider limits with --limits");
        if !drawn.is_empty() && self.check.is_some() {
            drawn.retain(|(motion, _)| self.is_allowed(motion));
            refusal = (
                "--keep-out",
                "that was tried stays out of the boxes",
                "give smaller boxes, or try more with --tries",
            );
        }
        if drawn.is_empty() {
            let (option, what, remedy) = refusal;
            return Err(Failure::argument(
                option,
                format!("no motion of up to {:.1} s {what}", self.options.duration_s),
                remedy,
            ));
        }
        progress.step(format!("evaluating {} motions", drawn.len()));
        let evaluated = drawn.into_par_iter().map(|(trajectory, words)| {
            let motion = self.recorded_motion(&trajectory)?;
            let planned = self.discrimination.planned(&motion);
            progress.advance();
            // Of some motions nothing is left: no joint is faster than the rest velocity.
            Ok(planned.ok().map(|planned| Piece { trajectory, words, planned }))
        });
        let pieces = evaluated.collect::<Result<Vec<_>, Failure>>()?.into_iter().flatten();
        let is_safe = |piece: &Piece<D::Planned>| {
            let mut largest = self.discrimination.largest(&piece.planned).iter().zip(&self.arm.recorded);
            self.options.limits.is_some() || largest.all(|(planned, most)| planned <= most)
        };
        let safe: Vec<Piece<D::Planned>> = pieces.filter(is_safe).collect();
        if safe.is_empty() {
            return Err(Failure::argument(
                "--limits",
                if self.arm.is_of_drives {
                    "in no motion that was tried the joints are as near to their commands as in the recordings"
                } else {
                    "no motion that was tried needs torques as small as the recorded ones"
                },
                "state the limits of the arm in a table, or try more with --tries",
            ));
        }
        Ok(safe)
    }

    fn is_allowed(&self, motion: &Trajectory) -> bool {
        self.check.is_none_or(|check| check.allow(motion).unwrap_or(false))
    }

    /// A piece of one kind: the arm in a part of its range, or in all of it.
    fn drawn(&self, attempt: usize, piece_s: f64, random: &mut Random) -> Option<(Trajectory, String)> {
        let part = *random.choose(&[1.0, 1.0, 0.6, 0.3])?;
        let within = |limits: &MotionLimits, random: &mut Random| {
            let [low, high] = limits.position_rad;
            let width = part * (high - low);
            let from = random.between(low, high - width);
            MotionLimits { position_rad: [from, from + width], ..*limits }
        };
        let mut limits: Vec<MotionLimits> = self.arm.limits.iter().map(|l| within(l, random)).collect();
        let PlannedArm { is_of_drives, recorded, rate_hz, .. } = &self.arm;
        let most = if *is_of_drives { 2.0 * WAY_LIMITS[0] } else { f64::INFINITY };
        let slowest = limits.iter().map(|l| l.velocity_rad_s).fold(most, f64::min);
        let widest = limits.iter().map(|l| l.position_rad[1] - l.position_rad[0]).fold(0.0, f64::max);
        // Commands jump as their rows do, and what drives can follow is far slower.
        let mut share =
            if *is_of_drives { random.between_logs(0.02, 1.0) } else { random.between(0.3, SHARE) };
        let kinds = if *is_of_drives && self.options.limits.is_none() { 5 } else { 4 };
        let is_steps = attempt % kinds == 4;
        if is_steps {
            let steps = limits.iter().zip(recorded).map(|(l, most)| step_limits(l, STEP * most, *rate_hz));
            (limits, share) = (steps.collect(), 1.0);
        }
        let motion = match attempt % kinds {
            0 => Motion::MultiSine {
                duration_s: piece_s,
                harmonics: 3 + random.index(6),
                top_hz: random.between_logs(0.3, 2.0),
                share,
            },
            1 => Motion::Sweeps { duration_s: piece_s, share },
            2 => Motion::Triangles {
                duration_s: piece_s,
                speed_rad_s: random.between_logs(0.02, 0.5) * slowest,
                amplitude_rad: random.between(0.2, 0.5) * widest,
            },
            _ => Motion::PointToPoint { duration_s: piece_s, share, rest_s: random.between(0.1, 1.5) },
        };
        let words = match &motion {
            Motion::MultiSine { top_hz, .. } => format!("sines up to {top_hz:.2} Hz"),
            Motion::Sweeps { .. } => "constant speeds, to and fro".to_owned(),
            Motion::Triangles { speed_rad_s, .. } => format!("triangles at {speed_rad_s:.3} rad/s"),
            _ => if is_steps { "steps" } else { "poses held" }.to_owned(),
        };
        let trajectory = motion.plan(&Robot::of_limits("arm", &limits), random.bits()).ok()?;
        Some((
            trajectory,
            if part < 1.0 && !is_steps {
                format!("{words}, in {:.0} % of the range", 100.0 * part)
            } else {
                words
            },
        ))
    }

    /// The motion as a recording would have it, its positions with the encoders' noise. The measurement is not known; zeros
    /// stand in its place.
    fn recorded_motion(&self, trajectory: &Trajectory) -> Result<Recording, Failure> {
        let joints = trajectory.joints();
        let mut random = Random::labelled(self.options.seed, "encoders");
        let (mut time_s, mut position_rad) = (Vec::new(), vec![Vec::new(); joints]);
        let encoders = self.discrimination.encoders();
        trajectory.rows(self.arm.rate_hz, |t, q, _, _| {
            time_s.push(t);
            for (joint, (series, q)) in position_rad.iter_mut().zip(q).enumerate() {
                let [step, white] = encoders.get(joint).copied().unwrap_or_default();
                let noisy = q + white * random.normal();
                series.push(if step > 0.0 { step * (noisy / step).round() } else { noisy });
            }
        })?;
        let unknown = vec![vec![0.0; time_s.len()]; joints];
        let recording = Recording::from_arrays(time_s, position_rad)?.named("the planned motion");
        Ok(recording.with_measurement(unknown, self.arm.unit)?)
    }

    fn moments(&self, trajectory: &Trajectory) -> Result<D::Planned, Failure> {
        Ok(self.discrimination.planned(&self.recorded_motion(trajectory)?).map_err(aurt::Error::from)?)
    }

    /// The multi-sine that `aurt excite` plans without knowing what is open; any where no motion tells the bodies apart.
    fn generic(&self) -> Result<Trajectory, Failure> {
        let (duration_s, harmonics, top_hz, share) = (self.options.duration_s, 6, 0.6, SHARE);
        let sines = MultiSineOptions { duration_s, harmonics, top_hz, share };
        let options = ExcitationOptions { sines, tries: SINES_TRIED, torque_limits: false };
        let robot = Robot::of_limits("arm", &self.arm.limits);
        let found = excite(&robot, Some(self.arm.bodies), &options, self.options.seed, &mut |_, _| ());
        let any = Motion::MultiSine { duration_s, harmonics, top_hz, share };
        Ok(found.map(|found| found.trajectory).or_else(|_| any.plan(&robot, self.options.seed))?)
    }

    fn together<'p>(&self, mut pieces: impl Iterator<Item = &'p Piece<D::Planned>>) -> Option<D::Planned>
    where
        D::Planned: 'p,
    {
        let first = pieces.next()?.planned.clone();
        Some(pieces.fold(first, |sum, piece| self.discrimination.and(sum, &piece.planned)))
    }
}
