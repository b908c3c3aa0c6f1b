//! From which sizes on the effects are named and noticed, over several draws.

use aurt_simulation::Random;
use aurt_simulation::effects::Presence as Habit;
use aurt_simulation::inject::{Added, Kind, Presence};
use rayon::prelude::*;
use serde::Serialize;

use super::ladder::Limit;
use super::probe::Probe;
use super::trials::{Route, Trials};
use crate::workbench::failure::Failure;

/// Draws of each effect on each joint: a shape, and noise.
pub const DRAWS: usize = 5;
/// Draws in which an effect has to be named: 80 %.
pub const NAMED_IN: usize = 4;

/// What became of an effect on a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It would have been named from a size on.
    Named,
    /// Not even the strongest was named in enough draws.
    NotNamed,
    AlreadyClaimed,
    /// The experiment's structure or the machine's limits leave nothing of it to be seen.
    Absorbed,
    /// The joint or the recordings cannot have it, or the diagnosis does not look for it in them.
    NotPossible,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    pub effect: String,
    /// The joint; none for effects of the whole arm.
    pub joint: Option<usize>,
    pub status: Status,
    pub quantity: String,
    pub unit: String,
    /// From which size on it is named, in four of five draws.
    pub named_from: Option<Limit>,
    /// From which size on something new is claimed at the joint, in the recordings' own noise; no larger than `named_from`.
    pub noticed_from: Option<Limit>,
    /// From which size on it is named in each draw; the first is the recordings' own noise.
    pub draws: Vec<Option<f64>>,
}

#[derive(Debug, Clone)]
struct Found {
    shape: Added,
    /// Nothing where the experiment's structure or the machine's limits leave nothing of it.
    limits: Option<Limits>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Limits {
    named: Option<Limit>,
    noticed: Option<Limit>,
}

pub fn search(
    trials: &Trials<'_>,
    effects: &[Kind],
    joints: &[usize],
    seed: u64,
    done: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Row>, Failure> {
    let asked: Vec<(Kind, usize)> =
        effects.iter().flat_map(|kind| on(kind, joints).into_iter().map(|j| (*kind, j))).collect();
    asked
        .par_iter()
        .with_max_len(1)
        .map(|(kind, joint)| {
            let row = one(trials, kind, *joint, seed);
            done(kind.identifier);
            row
        })
        .collect()
}

/// How many effects on joints [`search`] reports as done.
pub fn tasks(effects: &[Kind], joints: &[usize]) -> usize {
    effects.iter().map(|kind| on(kind, joints).len()).sum()
}

/// Joints that an effect is put on, one at a time.
fn on(kind: &Kind, joints: &[usize]) -> Vec<usize> {
    if kind.whole_arm { joints.first().copied().into_iter().collect() } else { joints.to_vec() }
}

/// The shape of a draw, if the recordings can have the effect in the roles that they have and the diagnosis looks for it.
pub(super) fn shape(trials: &Trials<'_>, kind: &Kind, joint: usize, seed: u64, draw: usize) -> Option<Added> {
    let subject = trials.subject;
    let needs_change = kind.presence == Habit::Later && subject.split.presence == Presence::All;
    let mut not_examined = trials.prepared.verdict().not_examined.iter().flat_map(|n| &n.effects);
    if needs_change || not_examined.any(|effect| effect == kind.identifier) {
        return None;
    }
    let label = format!("{} on {joint}, draw {draw}", kind.identifier);
    subject.injection.shaped(kind, joint, &mut Random::labelled(seed, &label))
}

/// How many draws an effect has: whole diagnoses are long.
pub(super) fn draws(kind: &Kind) -> usize {
    if Route::of(kind) == Route::Whole { 1 } else { DRAWS }
}

fn one(trials: &Trials<'_>, kind: &Kind, joint: usize, seed: u64) -> Result<Row, Failure> {
    let place = (!kind.whole_arm).then_some(joint);
    // What is claimed already cannot be told from what is added.
    let known = trials.reference.lists(kind.identifier, place);
    let mut found: Vec<Found> = Vec::new();
    let mut guess: Option<usize> = None;
    for draw in 0..draws(kind) {
        let Some(shape) = shape(trials, kind, joint, seed, draw) else { break };
        if known {
            found.push(Found { shape, limits: None });
            break;
        }
        let turn = draw as f64 / DRAWS as f64;
        let Some(mut probe) = Probe::new(trials, *kind, shape.clone(), turn)? else {
            found.push(Found { shape, limits: None });
            continue;
        };
        let named = probe.named(guess)?;
        guess = named.or(guess);
        let noticed = if draw == 0 { probe.noticed(named)? } else { None };
        let limit = |level: Option<usize>| level.map(|level| probe.limit(level)).transpose();
        let limits = Limits { named: limit(named)?, noticed: limit(noticed)? };
        found.push(Found { shape, limits: Some(limits) });
    }
    Ok(row(trials, kind, place, known, &found))
}

/// The limit that all but one of five draws reach, or all of fewer.
fn in_most(limits: impl Iterator<Item = Option<Limit>>) -> Option<Limit> {
    let all: Vec<Option<Limit>> = limits.collect();
    let needed = (all.len() * NAMED_IN).div_ceil(DRAWS);
    let mut known: Vec<Limit> = all.into_iter().flatten().collect();
    known.sort_by(|a, b| a.size.total_cmp(&b.size));
    needed.checked_sub(1).and_then(|place| known.get(place)).copied()
}

fn row(trials: &Trials<'_>, kind: &Kind, joint: Option<usize>, known: bool, found: &[Found]) -> Row {
    let named_from = in_most(found.iter().map(|f| f.limits.and_then(|l| l.named)));
    let noticed = found.first().and_then(|f| f.limits?.noticed);
    let noticed_from = match (noticed, named_from) {
        (Some(noticed), Some(named)) if noticed.size > named.size => Some(named),
        (noticed, named) => noticed.or(named),
    };
    let status = if found.is_empty() {
        Status::NotPossible
    } else if known {
        Status::AlreadyClaimed
    } else if named_from.is_some() {
        Status::Named
    } else if found.iter().all(|f| f.limits.is_none()) {
        Status::Absorbed
    } else {
        Status::NotNamed
    };
    let name = found.first().map(|f| f.shape.size_name(trials.subject.injection.real().unit));
    Row {
        effect: kind.identifier.to_owned(),
        joint,
        status,
        quantity: name.map_or_else(String::new, |n| n.name.to_owned()),
        unit: name.map_or_else(String::new, |n| n.unit.to_owned()),
        named_from,
        noticed_from,
        draws: found.iter().map(|f| f.limits.and_then(|l| l.named).map(|l| l.size)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_of_five_draws_decide_and_all_of_fewer() {
        let limit = |size: f64| Some(Limit { size, strength: size });
        let most = |sizes: &[Option<Limit>]| in_most(sizes.iter().copied()).map(|l| l.size);
        assert_eq!(most(&[limit(2.0), limit(9.0), limit(1.0), limit(4.0), limit(3.0)]), Some(4.0));
        assert_eq!(most(&[limit(2.0), None, limit(1.0), limit(4.0), limit(3.0)]), Some(4.0));
        assert_eq!(most(&[limit(2.0), None, None, limit(4.0), limit(3.0)]), None);
        assert_eq!((most(&[limit(2.0)]), most(&[None]), most(&[])), (Some(2.0), None, None));
    }
}
