//! Whole diagnoses at twice and at half of what the trials found.

use aurt_simulation::inject::Kind;
use serde::Serialize;

use super::probe::Probe;
use super::search::{Row, Status, shape};
use super::trials::Trials;
use crate::workbench::failure::Failure;

/// What whole diagnoses say of an effect on a joint, in the shape of the first draw.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    pub effect: String,
    /// The joint; none for effects of the whole arm.
    pub joint: Option<usize>,
    /// Size from which on the trials name that shape in the recordings' own noise.
    pub named_from: f64,
    pub unit: String,
    /// Whether a whole diagnosis names it at twice that size.
    pub named_at_double: bool,
    pub named_at_half: bool,
}

/// Checks at most `most` rows, spread evenly over those that have a limit in the recordings' own noise.
pub fn check(
    trials: &Trials<'_>,
    rows: &[Row],
    joints: &[usize],
    (seed, most): (u64, usize),
    done: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Check>, Failure> {
    let known = |r: &&Row| r.status == Status::Named && r.draws.first().copied().flatten().is_some();
    let all: Vec<&Row> = rows.iter().filter(known).collect();
    let count = most.min(all.len());
    let chosen = (0..count).map(|k| all[(2 * k + 1) * all.len() / (2 * count)]);
    let mut checks = Vec::new();
    for row in chosen {
        checks.extend(one(trials, row, joints, seed)?);
        done(&row.effect);
    }
    Ok(checks)
}

fn one(trials: &Trials<'_>, row: &Row, joints: &[usize], seed: u64) -> Result<Option<Check>, Failure> {
    let kind = Kind::named(&row.effect)?;
    let Some(joint) = row.joint.or_else(|| joints.first().copied()) else { return Ok(None) };
    let Some(shape) = shape(trials, &kind, joint, seed, 0) else { return Ok(None) };
    let Some(mut probe) = Probe::new(trials, kind, shape, 0.0)? else { return Ok(None) };
    let Some(level) = probe.named(None)? else { return Ok(None) };
    let named = |times: f64| -> Result<bool, Failure> {
        let claims = trials.whole(&probe.of_limit(level, times)?)?;
        Ok(claims.names(kind.identifier, row.joint))
    };
    Ok(Some(Check {
        effect: row.effect.clone(),
        joint: row.joint,
        named_from: probe.limit(level)?.size,
        unit: row.unit.clone(),
        named_at_double: named(2.0)?,
        named_at_half: named(0.5)?,
    }))
}
