//! Gears, and the fit of the model without what they do to the measurement.

use std::sync::Arc;

use aurt_calibration::for_each_tile;
use aurt_recording::Segment;

use crate::effects::joint_elasticity;
use crate::error::DiagnosisError;
use crate::evidence::baseline::{Baseline, extended_load, partition};
use crate::evidence::judged::Judged;
use crate::investigation::{Fitted, Investigation};
use crate::recordings::rows::{Fit, RecordingRows, Role};
use crate::request::{Question, QuestionedRecording};
use crate::transmission::{AMPLITUDE, Gears, Shaking, find_gears, gears_anew, undone};

/// A model fitted without what gears do, and what it left with it.
pub(super) struct WithoutGears {
    pub judged: Judged,
    pub gears: Gears,
    /// The recordings without the torque of confirmed gears, if there are any.
    pub recordings: Option<Vec<QuestionedRecording>>,
    pub before: Option<BeforeGears>,
}

/// What the model in question left of the measurement while the gears' torque was in it, root mean square, joint by joint.
#[derive(Debug, Clone, PartialEq)]
pub struct BeforeGears {
    /// Of the recordings that are not for validation.
    pub baseline_rms: Vec<f64>,
    /// Of the rows that take no part in fits.
    pub held_out_rms: Vec<f64>,
}

/// A gear that the model lacks biases the fit, and the fit the gear: so often they take turns. The amplitude's error falls to a fifth
/// or less with each (0.77, 0.91, 0.938, 0.940 in the slowest case of `clean`, seed 90001), and is below its deviation after the third.
const TURNS: usize = 4;

/// A joint is predicted worse if its held-out error (root mean square) grows by this share; less is within what two
/// stretches of time differ by.
pub(crate) const WORSE: f64 = 0.05;

/// Looks for gears of some joints in what a model leaves, and fits the model again without their torque; `of_all` says whether it is
/// to be fitted to all recordings.
pub(super) fn without_gears(
    question: &Question<'_>,
    original: Judged,
    of_all: bool,
    joints: &[usize],
) -> Result<WithoutGears, DiagnosisError> {
    let mut gears = Gears::default();
    let mut freed: Option<(Vec<QuestionedRecording>, Judged)> = None;
    let turns = if joints.is_empty() { 0 } else { TURNS };
    for turn in 0..turns {
        let Judged { baseline, .. } = freed.as_ref().map_or(&original, |(_, refitted)| refitted);
        let fit = Fit { model: question.model, load: &baseline.load, coefficients: &baseline.coefficients };
        let columns = question.model.base().columns.iter().copied();
        let inertial: Vec<(usize, f64)> = columns.zip(baseline.coefficients.iter().copied()).collect();
        let mut found = if turn == 0 {
            find_gears(question, &fit, &inertial, joints)?
        } else {
            Gears { found: gears_anew(question, &fit, &inertial, &gears.found)?, ..gears.clone() }
        };
        let is_asked = |gear: &Shaking| joints.contains(&gear.joint);
        found.found.iter_mut().filter(|g| g.confirmed && !is_asked(g)).for_each(Shaking::made_superfluous);
        let is_last = turn + 1 == turns;
        if is_last {
            found.found.iter_mut().for_each(Shaking::require_size);
        }
        let confirmed = found.found.iter().any(|g| g.confirmed);
        if turn == 0 || is_last || confirmed {
            gears = found;
        }
        if !confirmed {
            // Those of the turn before stay if their size is known.
            gears.found.iter_mut().for_each(Shaking::require_size);
            freed = freed.filter(|_| !is_last && gears.found.iter().any(|g| g.confirmed));
            break;
        }
        freed = refitted(question, &original, (&fit, &inertial), &mut gears.found, of_all)?;
        if freed.is_none() {
            break;
        }
    }
    Ok(match freed {
        Some((recordings, judged)) => {
            let before = Some(left(question, &original));
            WithoutGears { judged, gears, recordings: Some(recordings), before }
        }
        None => WithoutGears { judged: original, gears, recordings: None, before: None },
    })
}

/// Joints whose gears are confirmed.
pub(super) fn confirmed_joints(gears: &Gears) -> Vec<usize> {
    gears.found.iter().filter(|g| g.confirmed).map(|g| g.joint).collect()
}

/// The gears that show in what the model and all claims leave.
pub(super) fn gears_beside(question: &Question<'_>, found: &Investigation) -> Result<Gears, DiagnosisError> {
    let fitted = Fitted::new(found, found.switches());
    let own = fitted.own(&found.baseline.coefficients, &found.base_switches);
    let recordings = without_claims(question, found, &fitted)?;
    let question = &Question { recordings: &recordings, ..*question };
    let fit = Fit { model: question.model, load: &found.baseline.load, coefficients: &own };
    let columns = question.model.base().columns.iter().copied();
    let inertial: Vec<(usize, f64)> = columns.zip(own.iter().copied()).collect();
    find_gears(question, &fit, &inertial, &(0..question.model.joints()).collect::<Vec<_>>())
}

/// The recordings without the torque of what was found, unfiltered; that of gears that give way stays, since the link that is simulated
/// hangs on them.
fn without_claims(
    question: &Question<'_>,
    found: &Investigation,
    fitted: &Fitted,
) -> Result<Vec<QuestionedRecording>, DiagnosisError> {
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

/// The recordings without the torque of the confirmed gears, and the model fitted to them; none where no gear stays confirmed.
///
/// The torque c that the gears take from the measurement, freed of what the model absorbs, is r₀ − r₁: the residual of the model
/// fitted with their torque in it (`original`), less that of the model fitted without. If a gear is there, r₀ follows c with an
/// amplitude of one. An amplitude below what physics allows by [`AWAY_STD`] deviations shows that another effect was fitted, and so
/// do held-out rows that the model predicts worse: the gear is not confirmed.
fn refitted(
    question: &Question<'_>,
    original: &Judged,
    (fit, inertial): (&Fit<'_>, &[(usize, f64)]),
    gears: &mut [Shaking],
    of_all: bool,
) -> Result<Option<(Vec<QuestionedRecording>, Judged)>, DiagnosisError> {
    while gears.iter().any(|g| g.confirmed) {
        let freed = undone(question, fit, inertial, gears)?;
        let corrected = Question { recordings: &freed, ..*question };
        let baseline = if of_all { Baseline::of_all(&corrected)? } else { Baseline::new(&corrected)? };
        let after = Judged::new(&corrected, baseline)?;
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
        if !contradicted {
            return Ok(Some((freed, after)));
        }
    }
    Ok(None)
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
