//! Mistakes inside recordings: whole recordings are looked at joint by joint, and where one is hardly explained, the usual
//! mistakes of that recording and of stretches of it are tried.
//!
//! The others predict a recording without what is wrong with it. With fixed predictions p of rows y, a mistake of measurements
//! (a sign, an order) changes the squared errors row by row, and the neighbouring rows that gain most by undoing it are the
//! stretch that has it: no grid of times is tried. The tests are those of every other mistake.

use crate::workbench::failure::Failure;

use super::explained::{Poor, heaviest};
use super::folds::folds;
use super::found::{Found, Step};
use super::mistake::{Columns, Mistake, Reading, exchanged, pairs};
use super::search::{Search, is_explained};
use super::setup::{Extent, Part, Setup, Subject};
use super::trial::{Bench, Fit, FittedRows};

/// Mistakes inside recordings that are told at most.
const MOST: usize = 4;
/// An end of a recording belongs to a stretch if the rows in between take less than this share of the gain away.
const END: f64 = 0.02;

/// Adds the mistakes inside recordings to what was found of a setup; returns what stays hardly explained. After a calibration, what
/// the calibrated model hardly explains is looked at, and if that is nothing, nothing is.
pub fn search_recordings(
    subject: &Subject,
    bench: &Bench,
    brief: &Setup,
    found: &mut Found,
    calibrated: Option<&[Poor]>,
) -> Result<Vec<Poor>, Failure> {
    if calibrated.is_some_and(<[Poor]>::is_empty) {
        return Ok(Vec::new());
    }
    let whole = Setup::of(subject, Extent::Whole)?;
    let undone =
        |setup: &Setup, steps: &[Step]| steps.iter().fold(setup.clone(), |s, step| step.mistake.undone(&s));
    let now = undone(&whole, &found.steps);
    let mut poor = hardly_explained(subject, bench, &now);
    if found.steps.is_empty() {
        let of_model = calibrated.unwrap_or_default().iter();
        let is_new = |p: &&Poor| !poor.iter().any(|own| (own.file, own.joint) == (p.file, p.joint));
        poor.extend(of_model.filter(is_new).cloned().collect::<Vec<_>>());
    }
    let mut search = Search { subject, bench, whole: &whole, found: std::mem::take(found) };
    let (steps, left) = search.in_recordings(now, poor);
    *found = search.found;
    if !steps.is_empty() {
        found.steps.extend(steps);
        found.after = bench.score(&undone(brief, &found.steps)).or(found.after.take());
    }
    // After a calibration the sentence on the calibrated model says it.
    let left = if calibrated.is_some() { Vec::new() } else { left };
    Ok(left.into_iter().filter(Poor::says_enough).collect())
}

/// The joints that rigid bodies with plain friction, fitted to all recordings for calibration, hardly explain in a recording or in a
/// stretch of one.
pub fn hardly_explained(subject: &Subject, bench: &Bench, whole: &Setup) -> Vec<Poor> {
    let is_fitted = |file: usize| whole.parts.iter().any(|p| p.file == file && p.fitted);
    let mut setup = bench.modelled(whole);
    let fitted: Vec<bool> = setup.parts.iter().map(|p| is_fitted(p.file)).collect();
    setup.parts.iter_mut().zip(fitted).for_each(|(part, fitted)| part.fitted = fitted);
    let Some(fit) = bench.fit(&setup) else { return Vec::new() };
    let of_file = |file: &usize| {
        let rows = rows_of(bench, &setup, &fit, *file);
        let recording = &subject.recordings[*file].loaded.source.label;
        let poor = |joint: usize| {
            let (explained, span_s, rows) = rows.as_ref()?.hardly_explained(joint)?;
            Some(Poor { joint, explained, file: *file, recording: recording.clone(), span_s, rows })
        };
        (0..setup.moving_joints()).filter_map(poor).collect::<Vec<_>>()
    };
    setup.files().iter().flat_map(of_file).collect()
}

fn rows_of(bench: &Bench, setup: &Setup, fit: &Fit, file: usize) -> Option<FittedRows> {
    let mut all = FittedRows { time_s: Vec::new(), joints: vec![Vec::new(); setup.moving_joints()] };
    for part in setup.parts.iter().filter(|p| p.file == file) {
        let rows = bench.rows(part, fit)?;
        all.time_s.extend(rows.time_s);
        all.joints.iter_mut().zip(rows.joints).for_each(|(all, own)| all.extend(own));
    }
    Some(all)
}

impl Search<'_> {
    /// The mistakes inside recordings that are told, one after the other, the clearest first.
    pub(super) fn in_recordings(&mut self, mut now: Setup, mut poor: Vec<Poor>) -> (Vec<Step>, Vec<Poor>) {
        let mut steps: Vec<Step> = Vec::new();
        let files = now.files();
        while steps.len() < MOST && !poor.is_empty() {
            let joints_of = |file: usize| -> Vec<usize> {
                poor.iter().filter(|p| p.file == file).map(|p| p.joint).collect()
            };
            let places = files.iter().map(|file| (*file, joints_of(*file))).filter(|(_, j)| !j.is_empty());
            let places: Vec<(usize, Vec<usize>)> = places.collect();
            let told = places.iter().filter_map(|(file, joints)| self.in_recording(&now, *file, joints));
            let Some((_, step)) = told.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            now = step.mistake.undone(&now);
            steps.push(step);
            poor = hardly_explained(self.subject, self.bench, &now);
        }
        (steps, poor)
    }

    /// A mistake of a recording, or of a stretch of it, that has to do with some joints, and its gain.
    fn in_recording(&mut self, now: &Setup, file: usize, joints: &[usize]) -> Option<(f64, Step)> {
        let bench = self.bench;
        let fold =
            folds(now).into_iter().find(|(own, _)| *own == file).map(|(_, fold)| bench.modelled(&fold));
        let (before, tried) = if let Some(fold) = &fold {
            let fit = bench.fit(fold)?;
            let mut mistakes = of_stretches(&rows_of(bench, fold, &fit, file)?, joints, file);
            mistakes.extend(of_recording(now.moving_joints(), joints, file));
            let tried = self.tried(fold, &mistakes, &[], |other| bench.judge(other, &fit));
            (bench.judge(fold, &fit)?, tried)
        } else {
            // A recording by itself is predicted from its ends: a mistake that begins or stops leaves one of them right.
            let mut mistakes = Vec::new();
            for end in ends(now, file) {
                let end = bench.modelled(&end);
                let Some(fit) = bench.fit(&end) else { continue };
                let rows = rows_of(bench, &end, &fit, file)?;
                mistakes.extend(of_stretches(&rows, joints, file));
            }
            let tried = self.tried(now, &mistakes, &[], |other| bench.score(other));
            (bench.score(now)?, tried)
        };
        let setup = fold.as_ref().unwrap_or(now);
        let told = self.told(setup, Some(&before), &tried).filter(|one| is_explained(one.score.total))?;
        let mistake = told.last()?.clone();
        let after = bench.score(&mistake.undone(now))?;
        let own = Some([before.total, told.score.total]);
        Some((before.logarithm() - told.score.logarithm(), Step { own, ..Step::new(mistake, after) }))
    }
}

/// Setups in which the first and the last stretch of a recording are fitted.
fn ends(setup: &Setup, file: usize) -> Vec<Setup> {
    let stretches = setup.stretches(file);
    let last = stretches.len().saturating_sub(1);
    let alone = |end: usize| {
        let mut setup = stretches.get(end)?.clone();
        setup.parts.iter_mut().enumerate().for_each(|(k, part): (usize, &mut Part)| part.fitted = k == end);
        Some(setup)
    };
    [0, last].into_iter().filter_map(alone).collect()
}

fn of_recording(count: usize, joints: &[usize], file: usize) -> Vec<Mistake> {
    let mut readings = vec![Reading::Degrees, Reading::Turns];
    readings.extend(joints.iter().map(|j| Reading::PositionSign(*j)));
    for of in [Columns::Position, Columns::Both] {
        readings.extend(exchanges(count, joints).into_iter().map(|order| Reading::Order { of, order }));
    }
    readings.into_iter().map(|what| Mistake::Reading { what, file: Some(file) }).collect()
}

/// Orders with two columns exchanged, one of them that of one of the joints.
fn exchanges(count: usize, joints: &[usize]) -> Vec<Vec<usize>> {
    let order: Vec<usize> = (0..count).collect();
    let concerned = pairs(count).filter(|pair| pair.iter().any(|j| joints.contains(j)));
    concerned.map(|pair| exchanged(&order, pair)).collect()
}

/// Mistakes of measurements that have to do with some joints, each of the stretch that gains most by undoing it.
fn of_stretches(rows: &FittedRows, joints: &[usize], file: usize) -> Vec<Mistake> {
    let count = rows.joints.len();
    let mut readings: Vec<Reading> = joints.iter().map(|j| Reading::MeasurementSign(*j)).collect();
    if joints.len() > 1 {
        readings.push(Reading::AllMeasurementSigns);
    }
    let of = Columns::Measurement;
    readings.extend(exchanges(count, joints).into_iter().map(|order| Reading::Order { of, order }));
    let reading = |what: Reading| {
        let what = match rows.span_s(&what)? {
            [None, None] => what,
            span_s => Reading::During { what: Box::new(what), span_s },
        };
        Some(Mistake::Reading { what, file: Some(file) })
    };
    readings.into_iter().filter_map(reading).collect()
}

impl FittedRows {
    /// From when to when undoing a mistake of measurements gains most.
    fn span_s(&self, what: &Reading) -> Option<[Option<f64>; 2]> {
        let squares: Vec<f64> = self
            .joints
            .iter()
            .map(|rows| rows.iter().flatten().map(|[_, y]| y * y).sum::<f64>().max(f64::MIN_POSITIVE))
            .collect();
        let gain = |row: usize| -> f64 {
            let of_joint = |joint: usize| {
                let [error, measured] = self.joints[joint][row]?;
                let (of, factor) = what.measured_as(joint);
                let [_, other] = self.joints[of][row]?;
                let after = factor * other - (measured - error);
                Some((error * error - after * after) / squares[joint])
            };
            (0..self.joints.len()).filter_map(of_joint).sum()
        };
        let gains: Vec<f64> = (0..self.time_s.len()).map(gain).collect();
        let (range, most) = heaviest(gains.iter().copied())?;
        let is_end = |rows: &[f64]| rows.iter().sum::<f64>() > -END * most;
        let between = |row: usize| Some(0.5 * (self.time_s[row - 1] + self.time_s[row]));
        let from_s = if is_end(&gains[..range.start]) { None } else { between(range.start) };
        let to_s = if is_end(&gains[range.end..]) { None } else { between(range.end) };
        Some([from_s, to_s])
    }
}
