//! The smallest strength that is found, by bisection over a ladder of strengths.

use aurt_simulation::{
    Random, SimulationError,
    effects::Presence as Habit,
    inject::{Added, Kind, Presence},
};
use rayon::prelude::*;
use serde::Serialize;

use super::{Subject, subject::Claims};
use crate::failure::Failure;

/// Strengths that are tried, in units of what the model leaves: steps of two, so that a limit between two of them is
/// known to a factor of √2 either way.
pub const LEVELS: [f64; 6] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Shapes that are drawn of each effect. Found in all three means found in 80 % at least as well as three can tell: with a
/// true share of a half, three of three happen once in eight.
pub const DRAWS: usize = 3;
/// Shares of lost rows that stand for the strengths.
const LOST_PER_STRENGTH: f64 = 0.01;
/// An effect of which less than this share of the wanted strength is left for the largest size is out of reach.
const REACHED: f64 = 0.7;

/// What became of an effect on a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It would have been named from a size on.
    Named,
    /// Not even the strongest was named in every draw.
    NotNamed,
    /// The diagnosis claims it of the recordings as they are.
    AlreadyClaimed,
    /// The experiment's structure or the machine's limits leave nothing of it to be seen.
    Absorbed,
    /// The joint or the recordings cannot have it.
    NotPossible,
}

/// A size from which on something happens.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limit {
    /// The size, in the row's unit.
    pub size: f64,
    /// The same in units of what the model leaves.
    pub strength: f64,
}

/// An effect on a joint.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Identifier of the effect.
    pub effect: String,
    /// The joint; none for effects of the whole arm.
    pub joint: Option<usize>,
    /// What became of it.
    pub status: Status,
    /// What the size is.
    pub quantity: String,
    /// Unit of the size.
    pub unit: String,
    /// From which size on it is named, in every draw.
    pub named_from: Option<Limit>,
    /// From which size on something new is claimed at the joint, in every draw; no larger than `named_from`.
    pub noticed_from: Option<Limit>,
}

/// One shape on one joint while its limit is searched: the smallest level known to be named or noticed, and the largest
/// that is known not to be named; levels count from 0.
struct Probe {
    joint: usize,
    shape: Added,
    /// Size of strength 1 of a law whose torque is in proportion to its size.
    unit_size: Option<f64>,
    not_named: Option<usize>,
    named: usize,
    noticed: usize,
    /// Levels that the machine can have.
    top: usize,
}

/// What a draw found on a joint.
#[derive(Debug, Clone)]
struct Found {
    joint: usize,
    shape: Added,
    possible: bool,
    named: Option<Limit>,
    noticed: Option<Limit>,
}

/// The limits of effects on joints. Effects of single joints are added to every other joint at once, so that no two
/// neighbours have one.
///
/// # Errors
/// What the diagnosis of the unaltered recordings reports.
pub fn search(
    subject: &Subject<'_>,
    effects: &[Kind],
    joints: &[usize],
    seed: u64,
    done: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Row>, Failure> {
    let reference = subject.claims(&[])?;
    done("the recordings as they are");
    let mut tasks = Vec::new();
    for kind in effects {
        for group in groups(kind, joints) {
            tasks.extend((0..DRAWS).map(|draw| (*kind, group.clone(), draw)));
        }
    }
    let found = tasks
        .par_iter()
        .map(|(kind, group, draw)| {
            let found = one_draw(subject, &reference, *kind, group, seed, *draw);
            done(kind.identifier);
            found.map(|found| (*kind, found))
        })
        .collect::<Result<Vec<_>, Failure>>()?;
    let mut rows = Vec::new();
    for kind in effects {
        for joint in groups(kind, joints).concat() {
            let draws: Vec<&Found> = found
                .iter()
                .filter(|(k, _)| k == kind)
                .flat_map(|(_, f)| f.iter().filter(|f| f.joint == joint))
                .collect();
            rows.push(row(subject, &reference, kind, joint, &draws));
        }
    }
    Ok(rows)
}

/// How many tasks [`search`] reports as done.
pub fn tasks(effects: &[Kind], joints: &[usize]) -> usize {
    1 + effects.iter().map(|kind| groups(kind, joints).len() * DRAWS).sum::<usize>()
}

/// Joints that have an effect at the same time.
fn groups(kind: &Kind, joints: &[usize]) -> Vec<Vec<usize>> {
    if kind.whole_arm {
        return joints.first().map(|j| vec![vec![*j]]).unwrap_or_default();
    }
    if kind.identifier == "joint_coupling_friction" {
        return joints.iter().map(|j| vec![*j]).collect();
    }
    let every_other = |rest: usize| joints.iter().copied().filter(move |j| j % 2 == rest);
    [every_other(0).collect::<Vec<_>>(), every_other(1).collect()]
        .into_iter()
        .filter(|g| !g.is_empty())
        .collect()
}

fn one_draw(
    subject: &Subject<'_>,
    reference: &Claims,
    kind: Kind,
    group: &[usize],
    seed: u64,
    draw: usize,
) -> Result<Vec<Found>, Failure> {
    let mut found = Vec::new();
    let mut probes = Vec::new();
    for joint in group {
        let label = format!("{} on {joint}, draw {draw}", kind.identifier);
        let Some(shape) = possible(subject, &kind, *joint, &mut Random::labelled(seed, &label)) else {
            continue;
        };
        // What is claimed already cannot be told from what is added.
        let place = (!kind.whole_arm).then_some(*joint);
        match Probe::new(subject, kind, shape)? {
            Some(probe) if !reference.lists(kind.identifier, place) => probes.push(probe),
            Some(probe) => found.push(Found::nothing(*joint, probe.shape, true)),
            None => {
                let shape = subject.injection.shaped(&kind, *joint, &mut Random::labelled(seed, &label));
                found.extend(shape.map(|shape| Found::nothing(*joint, shape, false)));
            }
        }
    }
    while let Some(level) = probes.iter().find_map(Probe::next) {
        let sized = probes.iter().map(|p| p.at(subject, kind, level)).collect::<Result<Vec<_>, _>>()?;
        let effects: Vec<&Added> = sized.iter().collect();
        let claims = match subject.claims(&effects) {
            Ok(claims) => Some(claims),
            // Recordings that cannot even be read as they should are noticed, and nothing is named.
            Err(Failure::Recording(_) | Failure::Diagnosis(_)) => None,
            Err(other) => return Err(other),
        };
        for probe in &mut probes {
            let place = (!kind.whole_arm).then_some(probe.joint);
            let named = claims.as_ref().is_some_and(|c| c.names(kind.identifier, place));
            let noticed = claims.as_ref().is_none_or(|c| named || c.exceeds(reference, place));
            probe.answer(level, named, noticed);
        }
    }
    for probe in probes {
        found.push(probe.found(subject, kind)?);
    }
    Ok(found)
}

/// A shape, if the recordings can have the effect in the roles that they have.
fn possible(subject: &Subject<'_>, kind: &Kind, joint: usize, random: &mut Random) -> Option<Added> {
    let needs_change = kind.presence == Habit::Later && subject.split.presence == Presence::All;
    if needs_change { None } else { subject.injection.shaped(kind, joint, random) }
}

impl Probe {
    /// Nothing where the strongest that the machine can have is weaker than the weakest level.
    fn new(subject: &Subject<'_>, kind: Kind, shape: Added) -> Result<Option<Self>, SimulationError> {
        let joint = shape.joint;
        let all = LEVELS.len();
        let fresh = |unit_size, top| {
            Some(Self {
                joint,
                shape: shape.clone(),
                unit_size,
                not_named: None,
                named: top,
                noticed: top,
                top,
            })
        };
        if shape.is_loss_of_rows() {
            return Ok(fresh(Some(LOST_PER_STRENGTH), all));
        }
        let one = subject.injection.sized(kind, shape.clone(), &subject.split, 1.0)?;
        if one.reached >= REACHED && shape.is_linear() {
            return Ok(fresh(Some(one.added.size), all));
        }
        let mut top = 0;
        for (level, strength) in LEVELS.iter().enumerate() {
            let built = subject.injection.sized(kind, shape.clone(), &subject.split, *strength)?;
            if built.reached < REACHED {
                break;
            }
            top = level + 1;
        }
        Ok(if top == 0 { None } else { fresh(None, top) })
    }

    /// The level that halves what is open.
    fn next(&self) -> Option<usize> {
        let low = self.not_named.map_or(0, |n| n + 1);
        (low < self.named).then(|| (low + self.named) / 2)
    }

    fn at(&self, subject: &Subject<'_>, kind: Kind, level: usize) -> Result<Added, Failure> {
        let level = level.min(self.top.saturating_sub(1));
        match self.unit_size {
            Some(size) => Ok(self.shape.of_size(size * LEVELS[level])),
            None => {
                Ok(subject.injection.sized(kind, self.shape.clone(), &subject.split, LEVELS[level])?.added)
            }
        }
    }

    fn answer(&mut self, level: usize, named: bool, noticed: bool) {
        if level >= self.top {
            return;
        }
        if named {
            self.named = self.named.min(level);
        } else if level < self.named {
            self.not_named = Some(self.not_named.map_or(level, |n| n.max(level)));
        }
        if noticed {
            self.noticed = self.noticed.min(level);
        }
    }

    fn found(self, subject: &Subject<'_>, kind: Kind) -> Result<Found, Failure> {
        // Between the last level that was not enough and the first that was.
        let limit = |level: usize| -> Result<Option<Limit>, Failure> {
            if level >= self.top {
                return Ok(None);
            }
            let added = self.at(subject, kind, level)?;
            let half_step = std::f64::consts::SQRT_2;
            let shown = added.size_shown() / half_step;
            Ok(Some(Limit { size: shown, strength: LEVELS[level] / half_step }))
        };
        let (named, noticed) = (limit(self.named)?, limit(self.noticed.min(self.named))?);
        Ok(Found { joint: self.joint, shape: self.shape, possible: true, named, noticed })
    }
}

impl Found {
    const fn nothing(joint: usize, shape: Added, possible: bool) -> Self {
        Self { joint, shape, possible, named: None, noticed: None }
    }
}

fn row(subject: &Subject<'_>, reference: &Claims, kind: &Kind, joint: usize, draws: &[&Found]) -> Row {
    let place = (!kind.whole_arm).then_some(joint);
    // The draw that needs most decides: found in every draw.
    let most = |of: fn(&Found) -> Option<Limit>| -> Option<Limit> {
        let all = draws.iter().map(|f| of(f)).collect::<Option<Vec<Limit>>>()?;
        all.into_iter().max_by(|a, b| a.size.total_cmp(&b.size))
    };
    let (named_from, noticed_from) = (most(|f| f.named), most(|f| f.noticed));
    let status = if draws.is_empty() {
        Status::NotPossible
    } else if reference.lists(kind.identifier, place) {
        Status::AlreadyClaimed
    } else if !draws.iter().all(|f| f.possible) {
        Status::Absorbed
    } else if named_from.is_some() {
        Status::Named
    } else {
        Status::NotNamed
    };
    let name = draws.first().map(|f| f.shape.size_name(subject.injection.real().unit));
    Row {
        effect: kind.identifier.to_owned(),
        joint: place,
        status,
        quantity: name.map_or_else(String::new, |n| n.name.to_owned()),
        unit: name.map_or_else(String::new, |n| n.unit.to_owned()),
        named_from,
        noticed_from,
    }
}
