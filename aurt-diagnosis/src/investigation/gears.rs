//! Gears beside all claims, and what is claimed beside gears.
//!
//! A gear that the model lacks biases the fit, and with it the claims; what claims lack biases the gear. So they take turns: gears
//! are sought in what the model and all claims leave, their torque is taken out of the measurement, and the recordings are
//! examined without it.

use std::sync::Arc;

use aurt_calibration::for_each_tile;
use aurt_plugins::Registry;
use aurt_recording::Segment;
use aurt_traits::LoadTorque;

use crate::effects::joint_elasticity;
use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, extended_load, partition};
use crate::evidence::judged::Judged;
use crate::investigation::{Examination, Fitted, Investigation, earn, examine};
use crate::recordings::rows::{Fit, RecordingRows, Role};
use crate::request::{Question, QuestionedRecording};
use crate::transmission::{AMPLITUDE, Gears, Shaking, find_gears, gears_anew, undone};

/// Gears whose torque is taken out of the measurement, and the model that bears their links.
pub(super) struct Elastic {
    /// All that were looked for; the torque of the confirmed ones is taken out.
    pub gears: Gears,
    /// Errors of the model before.
    pub before: BeforeGears,
    bearing: Bearing,
}

/// The model's own coefficients beside all claims.
struct Bearing {
    load: LoadTorque,
    coefficients: Vec<f64>,
    /// Those of the rigid bodies: column and value.
    inertial: Vec<(usize, f64)>,
}

/// What the model in question left of the measurement while the gears' torque was in it, root mean square, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub struct BeforeGears {
    /// Of the recordings that are not for validation.
    pub baseline_rms: Vec<f64>,
    /// Of the rows that take no part in fits.
    pub held_out_rms: Vec<f64>,
}

/// Turns after which a gear that still moves is taken as it is: of four soft ones (3 to 8 Hz) the slowest settles in the third.
const TURNS: usize = 3;

/// A gear is settled when its stiffness moves by less than this share of its deviation, which adds 2 % to it (√(1 + 0.2²)).
const SETTLED: f64 = 0.2;

/// A joint is predicted worse if its held-out error (root mean square) grows by this share; less is within what two
/// stretches of time differ by.
pub(crate) const WORSE: f64 = 0.05;

/// Looks for gears in what a rigid examination's claims leave, and examines the recordings without their torque until neither
/// claims nor gears change; the rigid examination where no gear stays confirmed.
pub(super) fn beside_gears(
    question: &Question<'_>,
    registry: &Registry,
    rigid: Examination,
    progress: &mut impl FnMut(&str),
) -> Result<Examination, DiagnosisError> {
    progress("simulating links on their gears");
    let repaired = &Question { recordings: &rigid.recordings, ..*question };
    let fitted = Bearing::new(&rigid.investigation);
    let recordings = without_claims(repaired, &rigid.investigation)?;
    let mut gears = find_gears(
        &Question { recordings: &recordings, ..*question },
        &fitted.fit(question),
        &fitted.inertial,
    )?;
    let of_all = rigid.investigation.undetermined;
    let mut original = None;
    let mut elastic: Option<Examination> = None;
    for turn in 1.. {
        let joints = confirmed_joints(&gears);
        if joints.is_empty() {
            break;
        }
        let original = match &original {
            Some(original) => original,
            None => original.insert(judged(repaired, of_all)?),
        };
        let latest = elastic.as_ref().map_or(&rigid.investigation, |e| &e.investigation);
        let bearing = Bearing::new(latest);
        if contradict(repaired, original, (&bearing, of_all), &mut gears.found)? {
            continue;
        }
        progress("examining without the torque of gears");
        let before = left(repaired, original);
        let mut next = examine(question, registry, Some(&Elastic { gears, before, bearing }), progress)?;
        earn(&Question { recordings: &next.recordings, ..*question }, &mut next.investigation)?;
        let Investigation { shaking, gears_visible, .. } = &next.investigation;
        let bearing = Bearing::new(&next.investigation);
        let recordings = without_claims(repaired, &next.investigation)?;
        let beside = Question { recordings: &recordings, ..*question };
        let mut anew = gears_anew(&beside, &bearing.fit(question), &bearing.inertial, shaking)?;
        let moves = |(old, new): (&Shaking, &Shaking)| {
            let [[from, _], [to, std]] = [old, new].map(|gear| gear.stiffness_nm_rad);
            new.confirmed && (to - from).abs() > SETTLED * std
        };
        let is_last = turn >= TURNS || !shaking.iter().zip(&anew).any(moves);
        if is_last {
            anew.iter_mut().for_each(Shaking::require_size);
        }
        gears = Gears { found: anew, visible: gears_visible.clone() };
        let stays = confirmed_joints(&gears) == joints;
        elastic = Some(next);
        if is_last && stays {
            break;
        }
    }
    let mut examination = elastic.filter(|_| !confirmed_joints(&gears).is_empty()).unwrap_or(rigid);
    let Investigation { shaking, gears_visible, .. } = &mut examination.investigation;
    (*shaking, *gears_visible) = (gears.found, gears.visible);
    Ok(examination)
}

/// Joints whose gears are confirmed.
fn confirmed_joints(gears: &Gears) -> Vec<usize> {
    gears.found.iter().filter(|g| g.confirmed).map(|g| g.joint).collect()
}

/// The model in question, fitted to all recordings or to those of the calibration.
fn judged(question: &Question<'_>, of_all: bool) -> Result<Judged, DiagnosisError> {
    let baseline = if of_all { Baseline::of_all(question)? } else { Baseline::new(question)? };
    Judged::new(question, baseline)
}

impl Bearing {
    fn new(found: &Investigation) -> Self {
        let fitted = Fitted::new(found, found.switches());
        let coefficients = fitted.own(&found.baseline.coefficients, &found.base_switches);
        let columns = found.model.base().columns.iter().copied();
        let inertial = columns.zip(coefficients.iter().copied()).collect();
        Self { load: found.baseline.load.clone(), coefficients, inertial }
    }

    fn fit<'a>(&'a self, question: &Question<'a>) -> Fit<'a> {
        Fit { model: question.model, load: &self.load, coefficients: &self.coefficients }
    }
}

impl Elastic {
    /// Recordings without the torque of the confirmed gears.
    pub(super) fn undone(&self, question: &Question<'_>) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
        undone(question, &self.bearing.fit(question), &self.bearing.inertial, &self.gears.found)
    }
}

/// The recordings without the torque of what was found, unfiltered; that of gears that give way stays, since the link that is simulated
/// hangs on them.
fn without_claims(
    question: &Question<'_>,
    found: &Investigation,
) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
    let fitted = Fitted::new(found, found.switches());
    let (model, load) = (&found.model, extended_load(&found.baseline, question.model, &found.model));
    let chosen = found.selection.chosen.iter().map(|c| &found.groups[c.group]);
    let others = chosen.filter(|g| g.effect != &joint_elasticity::EFFECT);
    let columns: Vec<usize> = others.flat_map(|g| &found.candidates[g.candidate].columns).copied().collect();
    let mut recordings = question.recordings.to_vec();
    for recording in &mut recordings {
        let in_targets = recording.role != Role::Calibration;
        let coefficient = |column: usize| -> f64 {
            let both = [Some(false), in_targets.then_some(true)].into_iter().flatten();
            let places = both.filter_map(|target_only| fitted.place(column, target_only));
            if columns.contains(&column) { places.map(|k| fitted.fit.coefficients[k]).sum() } else { 0.0 }
        };
        let coefficients: Vec<f64> = (0..model.parameters().len()).map(coefficient).collect();
        if coefficients.iter().all(|c| *c == 0.0) {
            continue;
        }
        for segment in &mut Arc::make_mut(&mut recording.data).data.segments {
            let Segment { raw_measurement: Some(raw), .. } = segment else { continue };
            let mut left = std::mem::take(raw);
            for_each_tile(model, segment, &load, |start, tile| {
                for (joint, left) in left.iter_mut().enumerate() {
                    for (slot, column) in model.row_slots(joint).zip(model.row_columns(joint)) {
                        let coefficient = coefficients[*column];
                        if coefficient != 0.0 {
                            let values = left[start..].iter_mut().zip(tile.slot(slot));
                            values.for_each(|(y, value)| *y -= coefficient * value);
                        }
                    }
                }
            })?;
            segment.raw_measurement = Some(left);
        }
    }
    Ok(recordings)
}

/// Withdraws gears that the model in question contradicts, fitted to the recordings without their torque; whether there are any.
///
/// The torque c that the gears take from the measurement, freed of what the model absorbs, is r₀ − r₁: the residual of the model
/// fitted with their torque in it (`original`), less that of the model fitted without. If a gear is there, r₀ follows c with an
/// amplitude of one. An amplitude below what physics allows by [`AWAY_STD`] deviations shows that another effect was fitted, and so
/// do held-out rows that the model predicts worse.
fn contradict(
    question: &Question<'_>,
    original: &Judged,
    (bearing, of_all): (&Bearing, bool),
    gears: &mut [Shaking],
) -> Result<bool, DiagnosisError> {
    let freed = undone(question, &bearing.fit(question), &bearing.inertial, gears)?;
    let corrected = Question { recordings: &freed, ..*question };
    let after = judged(&corrected, of_all)?;
    let held_out = [original, &after].map(|judged| left(question, judged).held_out_rms);
    let mut contradicted = false;
    for gear in gears.iter_mut().filter(|g| g.confirmed) {
        let [without, with] = held_out.each_ref().map(|rms| rms[gear.joint]);
        if without > 0.0 && with > (1.0 + WORSE) * without {
            let joint = question.names().joint(gear.joint);
            gear.confirmed = false;
            gear.fails.push(format!("held-out data are predicted better without it on {joint}"));
            contradicted = true;
            continue;
        }
        let [amplitude, std] = amplitude(question, [original, &after], gear);
        if amplitude + AWAY_STD * std < AMPLITUDE[0] {
            gear.confirmed = false;
            gear.fails.push(format!(
                "on the rows of the model its torque is {amplitude:.2} ± {std:.2} times the value that the link's inertia implies"
            ));
            contradicted = true;
        }
    }
    Ok(contradicted)
}

/// Standard deviations by which a gear's amplitude has to be below the least possible one: one in forty of gears that are there.
const AWAY_STD: f64 = 2.0;

/// Length of the pieces of time whose errors are taken for independent, s: long against the filters' memory, as in the search for
/// gears.
const PIECE_S: f64 = 1.0;

/// The amplitude of a gear's torque c on the rows of its joint, ⟨r₀, c⟩ / ⟨c, c⟩, and its standard deviation over pieces of time,
/// √(G/(G − 1) Σ_b (s_b − a i_b)²) / Σ_b i_b with s_b = ⟨r₀, c⟩ and i_b = ⟨c, c⟩ of G pieces.
fn amplitude(question: &Question<'_>, judged: [&Judged; 2], gear: &Shaking) -> [f64; 2] {
    let columns = question.model.row_columns(gear.joint);
    let residual = |judged: &Judged, rows: &RecordingRows| {
        let value = |c: &usize| if judged.baseline.frozen { 0.0 } else { judged.baseline.coefficients[*c] };
        rows.joints[gear.joint].residual(columns.iter().map(value))
    };
    let mut pieces: Vec<[f64; 2]> = Vec::new();
    for (before, after) in judged[0].own_rows.iter().zip(&judged[1].own_rows) {
        let shows = before.role != Role::Validation && gear.present[usize::from(before.role == Role::Target)];
        if !shows || before.rows() != after.rows() {
            continue;
        }
        let (with, without) = (residual(judged[0], before), residual(judged[1], after));
        let length = ((PIECE_S * before.rate_hz) as usize).max(1);
        for (with, without) in with.chunks(length).zip(without.chunks(length)) {
            let products = with.iter().zip(without).map(|(r, s)| [r * (r - s), (r - s).powi(2)]);
            pieces.push(products.fold([0.0; 2], |[s, i], [p, q]| [s + p, i + q]));
        }
    }
    let [along, square] = pieces.iter().fold([0.0; 2], |[s, i], [p, q]| [s + p, i + q]);
    let (amplitude, count) = (along / square, pieces.len() as f64);
    if square <= 0.0 || count < 2.0 {
        return [1.0, f64::INFINITY];
    }
    let spread: f64 = pieces.iter().map(|[s, i]| (s - amplitude * i).powi(2)).sum();
    [amplitude, (count / (count - 1.0) * spread).sqrt() / square]
}

/// What a model leaves of its own rows.
fn left(question: &Question<'_>, judged: &Judged) -> BeforeGears {
    let partition = partition(question, &judged.own_rows);
    let asked = |r: &RecordingRows| r.role != Role::Validation;
    let fitted: Vec<_> = (0..judged.own_rows.len())
        .filter(|r| asked(&judged.own_rows[*r]))
        .map(|r| (r, 0, judged.own_rows[r].rows()))
        .collect();
    let rms = |parts: &[(usize, usize, usize)]| -> Vec<f64> {
        (0..question.model.joints())
            .map(|j| {
                let columns = question.model.row_columns(j);
                let value =
                    |c: &usize| if judged.baseline.frozen { 0.0 } else { judged.baseline.coefficients[*c] };
                let (power, count) = parts.iter().fold((0.0, 0.0), |(power, count), (r, start, end)| {
                    let joint = &judged.own_rows[*r].joints[j];
                    let residual = joint.residual(columns.iter().map(value));
                    let sum: f64 = residual[*start..*end].iter().map(|e| e * e).sum();
                    (power + sum, count + joint.counted(*start, *end))
                });
                (power / f64::max(count, 1.0)).sqrt()
            })
            .collect()
    };
    BeforeGears { baseline_rms: rms(&fitted), held_out_rms: rms(&partition.held_out) }
}
