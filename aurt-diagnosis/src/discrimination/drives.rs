//! The doubts of drives: which models of them a motion of commands tells apart.
//!
//! Models that predict the held-out positions as well as one another are rolled out over the commands of a motion. If A is true,
//! the numbers of B are estimated again with the motion among the recordings: with the derivatives J_B of its positions in units
//! of σ, the weights W of the loss, and H_B the information of the present recordings and of what was known beforehand, B moves by
//!
//! δ = (J_BᵀWJ_B + H_B)⁻¹ J_BᵀW (q_A − q_B)/σ
//!
//! towards A, as in the T-criterion of torques, min_δ ½ {‖(q_A − q_B)/σ − J_B δ‖² + δᵀ H_B δ}. What it leaves,
//! q_B + σ J_B δ − q_A, is a difference in the motion recorded once more and held out, of which [`Foresight`] has the
//! probability that the test of the diagnosis decides on it; the present recordings the rival then misses by δᵀH_B δ more. So a
//! motion is recorded twice, to be fitted and to be held out.
//! Rollouts are whole, also where numbers are estimated by pieces.

use std::sync::Arc;

use aurt_calibration::drives::{
    DriveError, DriveRecording, EstimatedNumber, Options, OutputErrorFit, loss, slopes, stem,
};
use aurt_recording::Recording;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde_json::json;
use statrs::distribution::{ContinuousCDF, Normal};

use super::{DeviationGoal, Discriminator, Doubt, Interval, Outlook, Subject};
use crate::drives::{
    Answer, BlockApart, ContestedStructure, Diagnosis, Foresight, JudgedFit, Missed, Objection, STRUCTURES,
    Search, Structure, seconds,
};
use crate::error::DiagnosisError;

/// Samples of a block at which rollouts are compared: a tenth of a second apart in a block of 2 s, a third of the time constant of a servo of
/// 0.5 Hz, the slowest that follows a motion.
const SAMPLES: f64 = 20.0;
/// Time in which the arm comes to rest at the first command, s: three time constants of a servo of 0.5 Hz, after which 4 % is left.
const SETTLES_S: f64 = 1.0;

/// The doubts of a diagnosis of drives, and what a motion would do about them.
#[derive(Debug)]
pub struct DriveDiscrimination<'a> {
    diagnosis: &'a Diagnosis,
    fitted: &'a [DriveRecording],
    options: Options,
    /// The improved model, then its rivals.
    models: Vec<JudgedFit>,
    /// True of models of which derivatives are needed.
    moves: Vec<bool>,
    /// True models with their rivals.
    ways: Vec<[usize; 2]>,
    contests: Vec<ModelContest>,
    doubts: Vec<Doubt>,
}

/// The models, or the number, that a doubt is about.
#[derive(Debug)]
enum ModelContest {
    /// Places of true models with their rivals, the level of the test, and a structure that may be there: what it must bring.
    Models(Vec<usize>, f64, Option<Demanded>),
    /// A number of the improved model.
    Number(usize, f64),
}

/// A structure that may be there; a small one, whose numbers must be larger, with the model that has it.
type Demanded = (Structure, Option<usize>);

/// Rollouts of all models over motions of commands.
#[derive(Debug, Clone, Default)]
pub struct DriveMoments {
    parts: Vec<Arc<MotionRollouts>>,
    largest_rad: Vec<f64>,
    seconds: f64,
}

/// Rollouts over one motion.
#[derive(Debug)]
struct MotionRollouts {
    /// Samples of each block, and the columns that are kept of it.
    blocks: Vec<(f64, std::ops::Range<usize>)>,
    /// By model: derivatives, and JᵀJ of all samples.
    slopes: Vec<Option<(DMatrix<f64>, DMatrix<f64>)>>,
    /// By way: q_A − q_B in units of σ, JᵀWJ, and JᵀW (q_A − q_B)/σ.
    ways: Vec<(DVector<f64>, DMatrix<f64>, DVector<f64>)>,
}

impl<'a> DriveDiscrimination<'a> {
    /// The doubts that a diagnosis leaves, numbers that are `wanted` narrower, for a motion of so many seconds.
    ///
    /// # Errors
    /// As [`diagnose`](crate::drives::diagnose).
    pub fn new(
        diagnosis: &'a Diagnosis,
        [fitted, held_out]: [&'a [DriveRecording]; 2],
        wanted: &[DeviationGoal],
        motion_s: f64,
    ) -> Result<Self, DriveError> {
        let given = &diagnosis.options;
        let block_s = crate::drives::block_s(seconds(held_out) + motion_s, held_out.len() + 1, given);
        let options = Options { block_s, ..given.clone() };
        let search = Search { fitted, held_out, options: &options, demands: &diagnosis.demands };
        let mut own = Self {
            diagnosis,
            fitted,
            options: options.clone(),
            models: vec![diagnosis.model.clone()],
            moves: vec![true],
            ways: Vec::new(),
            contests: Vec::new(),
            doubts: Vec::new(),
        };
        for finding in &diagnosis.findings {
            let others = STRUCTURES.iter().filter(|s| finding.alternatives.contains(&s.id));
            for other in others {
                let without = search.without(&finding.structure, &diagnosis.model)?;
                let Some(rival) = search.with(other, &without) else { continue };
                let rival = own.add(rival, true);
                let ways = [[0, rival], [rival, 0]].map(|way| own.way(way)).to_vec();
                let [claimed, rival] = [finding.structure.id, other.id].map(whole_arm);
                let contest = ModelContest::Models(ways, diagnosis.demands.level, None);
                own.push(contest, Doubt::Rivals { claimed, rival });
            }
        }
        for ContestedStructure { structure, objection, rival, is_absent, level } in &diagnosis.contested {
            let is_small = *objection == Objection::Size;
            let other = own.add(rival.clone(), is_small || !is_absent);
            let way = if *is_absent { [other, 0] } else { [0, other] };
            let demanded = Some((*structure, is_small.then_some(way[0])));
            let contest = ModelContest::Models(vec![own.way(way)], *level, demanded);
            own.push(contest, Doubt::Indicated(whole_arm(structure.id)));
        }
        own.add_numbers(wanted);
        own.models.par_iter_mut().try_for_each(|model| -> Result<(), DriveError> {
            model.missed = Missed::of(&model.fit.arm, held_out, &options)?;
            Ok(())
        })?;
        Ok(own)
    }

    fn add(&mut self, model: JudgedFit, moves: bool) -> usize {
        self.models.push(model);
        self.moves.push(moves);
        self.models.len() - 1
    }

    fn way(&mut self, way: [usize; 2]) -> usize {
        self.ways.push(way);
        self.ways.len() - 1
    }

    fn push(&mut self, contest: ModelContest, doubt: Doubt) {
        self.contests.push(contest);
        self.doubts.push(doubt);
    }

    fn add_numbers(&mut self, wanted: &[DeviationGoal]) {
        let fit = &self.diagnosis.improved;
        for goal in wanted {
            let is_meant = |name: &str| name == goal.parameter || stem(name) == goal.parameter;
            for (k, number) in fit.numbers.iter().enumerate().filter(|(_, n)| is_meant(&n.name)) {
                let goal = DeviationGoal { parameter: stem(&number.name).to_owned(), std: goal.std };
                self.push(ModelContest::Number(k, goal.std), Doubt::Wide(subject_of(&number.name), goal));
            }
        }
    }

    /// Rollouts of all models over the commands of a recording, from where it starts.
    fn rolled(&self, recording: &DriveRecording) -> Result<DriveMoments, DriveError> {
        let sigma = self.options.deviation_rad;
        let (first, joints) = (recording.first, recording.command.len());
        let time_s = &recording.time_s[first..];
        let seconds = time_s[time_s.len() - 1] - time_s[0];
        let of_block = self.options.block_s / seconds * time_s.len() as f64;
        let stride = ((of_block / SAMPLES) as usize).max(1);
        let kept: Vec<usize> = (0..time_s.len()).step_by(stride).collect();
        let block = |k: &usize| ((time_s[*k] - time_s[0]) / self.options.block_s) as usize;
        let column = kept.len() * joints;
        let columns = |samples: &[usize]| {
            let place = |k: usize| k / stride * joints;
            let (first, last) = (samples[0], samples[samples.len() - 1]);
            ((samples.len() * stride) as f64, place(first)..place(last) + joints)
        };
        let blocks = kept.chunk_by(|a, b| block(a) == block(b)).map(columns).collect();
        let rollouts: Result<Vec<Vec<Vec<f64>>>, DriveError> =
            self.models.iter().map(|model| model.fit.arm.rollout(recording)).collect();
        let rollouts = rollouts?;
        let mut slopes_of = Vec::new();
        for (model, moves) in self.models.iter().zip(&self.moves) {
            let of = || slopes(&model.fit.arm, &model.selection, recording, &self.options, stride);
            let own = moves.then(of).transpose()?;
            slopes_of.push(own.map(|j| (j.clone(), &j * j.transpose() * stride as f64)));
        }
        let at = |model: usize, column: usize| rollouts[model][column % joints][column / joints * stride];
        let way = |[a, b]: &[usize; 2]| {
            let apart = DVector::from_fn(column, |c, _| (at(*a, c) - at(*b, c)) / sigma);
            let Some((j, _)) = &slopes_of[*b] else {
                return (apart, DMatrix::zeros(0, 0), DVector::zeros(0));
            };
            let weighted = DMatrix::from_fn(j.nrows(), column, |r, c| j[(r, c)] * loss(apart[c]).1);
            let (information, pull) = (&weighted * j.transpose(), &weighted * &apart);
            (apart, information * stride as f64, pull * stride as f64)
        };
        let ways = self.ways.iter().map(way).collect();
        let distance = |(q, command): (&Vec<f64>, &Vec<f64>)| {
            q.iter().zip(&command[first..]).fold(0.0_f64, |most, (q, c)| most.max((q - c).abs()))
        };
        Ok(DriveMoments {
            parts: vec![Arc::new(MotionRollouts { blocks, slopes: slopes_of, ways })],
            largest_rad: rollouts[0].iter().zip(&recording.command).map(distance).collect(),
            seconds,
        })
    }

    /// The test of the true model of a way against its rival, the numbers of which are estimated again, and the root mean square of
    /// what these leave, in units of σ.
    fn foreseen(&self, way: usize, level: f64, planned: &DriveMoments) -> (Foresight, f64) {
        let [truth, rival] = self.ways[way].map(|k| &self.models[k]);
        let fit = &rival.fit;
        let mut curvature = known(fit);
        let mut pull = DVector::zeros(fit.numbers.len());
        for part in &planned.parts {
            let (_, information, own) = &part.ways[way];
            curvature += information;
            pull += own;
        }
        let step = solved(curvature, &pull, fit);
        let (mut motion, mut squares, mut count) = (Vec::new(), 0.0, 0_usize);
        for part in &planned.parts {
            let Some((j, _)) = &part.slopes[self.ways[way][1]] else { continue };
            let left = j.tr_mul(&step) - &part.ways[way].0;
            squares += left.norm_squared();
            count += left.len();
            motion.extend(part.blocks.iter().map(|(samples, columns)| BlockApart {
                samples: *samples,
                apart_rad: columns.clone().map(|c| self.options.deviation_rad * left[c]).collect(),
            }));
        }
        let samples: usize = self.fitted.iter().map(|r| (r.time_s.len() - r.first) * r.command.len()).sum();
        let excess = step.dot(&(&fit.information * &step)) / samples as f64;
        let missed = [&truth.missed, &rival.missed];
        let foresight = Foresight::of(missed, &motion, excess, level, &self.options);
        (foresight, (squares / count.max(1) as f64).sqrt())
    }

    /// The deviations of a model's numbers with a motion recorded: what numbers that are given may be off stays.
    fn narrowed(&self, model: usize, planned: &DriveMoments) -> Vec<[f64; 2]> {
        let fit = &self.models[model].fit;
        let [now, then] = [&[][..], &planned.parts].map(|parts| {
            let mut information = known(fit);
            let grams = parts.iter().filter_map(|part| part.slopes[model].as_ref());
            grams.for_each(|(_, gram)| information += gram);
            let inverse = information.cholesky().map(|c| c.inverse().diagonal());
            inverse.unwrap_or_else(|| DVector::from_element(fit.numbers.len(), 1.0))
        });
        let wide = if model == 0 { &self.diagnosis.improved.numbers } else { &fit.numbers };
        let of = |(k, number): (usize, &EstimatedNumber)| {
            let given = (wide[k].deviation.powi(2) - number.deviation.powi(2)).max(0.0).sqrt();
            [wide[k].deviation, given.hypot(number.deviation * (then[k] / now[k]).sqrt())]
        };
        fit.numbers.iter().enumerate().map(of).collect()
    }

    /// A number of the improved model, with its deviation now and after.
    fn interval(&self, k: usize, [now, after]: [f64; 2]) -> Interval {
        let number = &self.diagnosis.improved.numbers[k];
        Interval { parameter: number.name.clone(), value: json!(number.value), now, after }
    }

    fn of_models(
        &self,
        ways: &[usize],
        level: f64,
        demanded: Option<&Demanded>,
        planned: &DriveMoments,
    ) -> Outlook {
        let all: Vec<(Foresight, f64)> = ways.iter().map(|way| self.foreseen(*way, level, planned)).collect();
        let least = |of: fn(&(Foresight, f64)) -> f64| all.iter().map(of).fold(f64::INFINITY, f64::min);
        let is_enough = demanded.is_none() || least(|f| f.0.reduction) >= self.diagnosis.demands.reduction;
        let mut settled = if is_enough { least(|f| f.0.rightly) } else { 0.0 };
        // A number of a structure must lie two deviations from nothing.
        if let Some((structure, Some(model))) = demanded {
            let numbers = self.models[*model].fit.numbers.iter().zip(self.narrowed(*model, planned));
            let own = numbers.filter(|(n, _)| structure.has(&n.name));
            let from = |start: f64| structure.neutral().unwrap_or(start);
            let far = own.map(|(n, [_, std])| (n.value - from(n.start)).abs() / std.max(f64::MIN_POSITIVE));
            settled = settled.min(Normal::standard().cdf(far.fold(0.0, f64::max) - 2.0));
        }
        let wrongly = all.iter().map(|f| f.0.wrongly).fold(0.0, f64::max);
        let evidence = least(|f| f.0.deviations.max(0.0)).powi(2);
        Outlook { nats: None, settled, wrongly, evidence, free: least(|f| f.1), interval: None }
    }
}

/// The information of the present recordings and of what was known beforehand.
fn known(fit: &OutputErrorFit) -> DMatrix<f64> {
    &fit.information + DMatrix::identity(fit.numbers.len(), fit.numbers.len())
}

/// The solution of normal equations in which numbers at a bound stay.
fn solved(mut matrix: DMatrix<f64>, right: &DVector<f64>, fit: &OutputErrorFit) -> DVector<f64> {
    let mut right = right.clone();
    for (k, _) in fit.numbers.iter().enumerate().filter(|(_, n)| n.at_bound) {
        matrix.row_mut(k).fill(0.0);
        matrix.column_mut(k).fill(0.0);
        (matrix[(k, k)], right[k]) = (1.0, 0.0);
    }
    let zero = right.clone() * 0.0;
    matrix.cholesky().map_or(zero, |c| c.solve(&right))
}

fn whole_arm(id: &'static str) -> Subject {
    Subject { id, is_whole_arm: true, ..Subject::default() }
}

/// The structure that a number is of, with its joint.
fn subject_of(number: &str) -> Subject {
    let of_arm = whole_arm(STRUCTURES.iter().find(|s| s.has(number)).map_or("drive", |s| s.id));
    match number[stem(number).len()..].trim_start_matches('_').parse() {
        Ok(joint) => Subject { joints: vec![joint], is_whole_arm: false, ..of_arm },
        Err(_) => of_arm,
    }
}

impl Discriminator for DriveDiscrimination<'_> {
    type Planned = DriveMoments;

    fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }

    fn planned(&self, motion: &Recording) -> Result<DriveMoments, DiagnosisError> {
        let command = motion.position_rad.clone();
        let still: Vec<Vec<f64>> = command.iter().map(|c| vec![c[0]; motion.time_s.len()]).collect();
        let mut recording = DriveRecording {
            time_s: motion.time_s.clone(),
            position_rad: still.clone(),
            command: still,
            ..DriveRecording::default()
        };
        let settles = recording.time_s.partition_point(|t| *t < recording.time_s[0] + SETTLES_S).max(3);
        let rested = self.models[0].fit.arm.rollout(&recording.part(0..settles))?;
        recording.command = command;
        for (position, rested) in recording.position_rad.iter_mut().zip(&rested) {
            position.fill(rested[rested.len() - 1]);
        }
        Ok(self.rolled(&recording)?)
    }

    fn and(&self, mut one: DriveMoments, other: &DriveMoments) -> DriveMoments {
        one.parts.extend(other.parts.iter().cloned());
        one.largest_rad.iter_mut().zip(&other.largest_rad).for_each(|(most, other)| *most = most.max(*other));
        one.seconds += other.seconds;
        one
    }

    fn recorded_again(&self, other: &DriveMoments) -> Result<DriveMoments, DiagnosisError> {
        let share = (other.seconds / seconds(self.fitted)).min(1.0);
        let mut all = DriveMoments {
            largest_rad: vec![0.0; self.models[0].arm.joints.len()],
            ..DriveMoments::default()
        };
        for recording in self.fitted {
            let last = recording.first + (share * (recording.time_s.len() - recording.first) as f64) as usize;
            if last >= recording.first + 3 {
                all = self.and(all, &self.rolled(&recording.part(recording.first..last))?);
            }
        }
        Ok(all)
    }

    fn outlook_of(&self, doubts: &[usize], planned: &DriveMoments) -> Vec<Outlook> {
        let of = |k: &usize| match &self.contests[*k] {
            ModelContest::Models(ways, level, demanded) => {
                self.of_models(ways, *level, demanded.as_ref(), planned)
            }
            ModelContest::Number(k, wanted) => {
                Outlook::of_width(Some(self.interval(*k, self.narrowed(0, planned)[*k])), *wanted)
            }
        };
        doubts.iter().map(of).collect()
    }

    fn intervals(&self, planned: &DriveMoments) -> Vec<(Subject, Vec<Interval>)> {
        let Diagnosis { findings, improved, .. } = self.diagnosis;
        let claims = findings.iter().filter(|f| matches!(f.answer, Answer::Missing | Answer::Wrong));
        let narrowed = self.narrowed(0, planned);
        let of = |structure: &Structure| {
            let own = (0..narrowed.len()).filter(|k| structure.has(&improved.numbers[*k].name));
            own.map(|k| self.interval(k, narrowed[k])).collect()
        };
        claims.map(|f| (whole_arm(f.structure.id), of(&f.structure))).collect()
    }

    fn largest<'m>(&self, planned: &'m DriveMoments) -> &'m [f64] {
        &planned.largest_rad
    }
}
