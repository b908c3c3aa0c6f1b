//! One shape of an effect on a joint, at growing strength.

use std::collections::BTreeMap;

use aurt_diagnosis::injection::AddedRows;
use aurt_simulation::SimulationError;
use aurt_simulation::inject::{Added, Kind};

use super::claims::Claims;
use super::ladder::{HALF_STEP, LEVELS, Limit, smallest};
use super::trials::{Route, Trials};
use crate::workbench::failure::Failure;

/// Shares of lost rows that stand for the strengths.
const LOST_PER_STRENGTH: f64 = 0.01;
/// An effect of which less than this share of the wanted strength is left for the largest size is out of reach.
const REACHED: f64 = 0.7;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Said {
    named: bool,
    noticed: bool,
}

#[derive(Debug)]
pub struct Probe<'a> {
    trials: &'a Trials<'a>,
    kind: Kind,
    shape: Added,
    /// By how much what is left of the recordings is turned.
    turn: f64,
    /// Size of strength 1, and its rows, of a law whose torque is in proportion to its size.
    unit: Option<(f64, AddedRows)>,
    top: usize,
    said: BTreeMap<usize, Said>,
}

impl<'a> Probe<'a> {
    /// Nothing where the strongest that the machine can have is weaker than the weakest level.
    pub fn new(trials: &'a Trials<'a>, kind: Kind, shape: Added, turn: f64) -> Result<Option<Self>, Failure> {
        let mut probe =
            Self { trials, kind, shape, turn, unit: None, top: LEVELS.len(), said: BTreeMap::new() };
        if probe.shape.is_loss_of_rows() {
            return Ok(Some(probe));
        }
        let one = probe.sized(1.0)?;
        if one.1 >= REACHED && probe.shape.is_linear() {
            let rows = match Route::of(&kind) {
                Route::Prepared => trials.rows(&one.0)?,
                Route::Faults | Route::Whole => AddedRows::new(),
            };
            probe.unit = Some((one.0.size, rows));
            return Ok(Some(probe));
        }
        let beyond = smallest(LEVELS.len(), LEVELS.len() - 1, |level| {
            Ok::<_, SimulationError>(probe.sized(LEVELS[level])?.1 < REACHED)
        })?;
        probe.top = beyond.unwrap_or(LEVELS.len());
        Ok((probe.top > 0).then_some(probe))
    }

    /// The effect of a strength, and the share of it that was reached.
    fn sized(&self, strength: f64) -> Result<(Added, f64), SimulationError> {
        let subject = self.trials.subject;
        let built = subject.injection.sized(self.kind, self.shape.clone(), &subject.split, strength)?;
        Ok((built.added, built.reached))
    }

    fn at(&self, level: usize) -> Result<Added, SimulationError> {
        Ok(match &self.unit {
            Some((size, _)) => self.shape.of_size(size * LEVELS[level]),
            None if self.shape.is_loss_of_rows() => self.shape.of_size(LOST_PER_STRENGTH * LEVELS[level]),
            None => self.sized(LEVELS[level])?.0,
        })
    }

    /// The joint that it is on; none of the whole arm.
    pub fn place(&self) -> Option<usize> {
        (!self.kind.whole_arm).then_some(self.shape.joint)
    }

    fn trial(&mut self, level: usize) -> Result<Said, Failure> {
        if let Some(known) = self.said.get(&level) {
            return Ok(*known);
        }
        let said = self.said_of(self.claims(level))?;
        self.said.insert(level, said);
        Ok(said)
    }

    fn claims(&self, level: usize) -> Result<Claims, Failure> {
        match (Route::of(&self.kind), &self.unit) {
            (Route::Prepared, Some((_, unit))) => {
                let scaled = |series: &Vec<f64>| series.iter().map(|v| v * LEVELS[level]).collect();
                let rows: AddedRows = unit.iter().map(|joints| joints.iter().map(scaled).collect()).collect();
                self.trials.claims(&self.kind, &rows, self.turn)
            }
            (Route::Prepared, None) => {
                let rows = self.trials.rows(&self.at(level)?)?;
                self.trials.claims(&self.kind, &rows, self.turn)
            }
            (Route::Faults, _) => self.trials.faults(&self.at(level)?),
            (Route::Whole, _) => self.trials.whole(&self.at(level)?),
        }
    }

    fn said_of(&self, claims: Result<Claims, Failure>) -> Result<Said, Failure> {
        match claims {
            Ok(claims) => {
                let named = claims.names(self.kind.identifier, self.place());
                Ok(Said { named, noticed: named || claims.exceeds(&self.trials.reference, self.place()) })
            }
            // Recordings that cannot even be read as they should are noticed, and nothing is named.
            Err(Failure::Library(aurt::Error::Recording(_) | aurt::Error::Diagnosis(_))) => {
                Ok(Said { named: false, noticed: true })
            }
            Err(other) => Err(other),
        }
    }

    /// From which level on it is named, sought from that of another draw.
    pub fn named(&mut self, guess: Option<usize>) -> Result<Option<usize>, Failure> {
        let from = guess.unwrap_or(self.top / 2);
        smallest(self.top, from, |level| Ok::<_, Failure>(self.trial(level)?.named))
    }

    /// From which level on it is noticed: what is named is, and less may be.
    pub fn noticed(&mut self, named: Option<usize>) -> Result<Option<usize>, Failure> {
        let below = named.unwrap_or(self.top);
        let noticed = match below {
            0 => None,
            _ => smallest(below, below.saturating_sub(2), |level| {
                Ok::<_, Failure>(self.trial(level)?.noticed)
            })?,
        };
        Ok(noticed.or(named))
    }

    /// Between the last level that was not enough and the first that was.
    pub fn limit(&self, level: usize) -> Result<Limit, SimulationError> {
        let size = self.at(level)?.size_shown() / HALF_STEP;
        Ok(Limit { size, strength: LEVELS[level] / HALF_STEP })
    }

    /// The effect at a multiple of the size of a limit at a level.
    pub fn of_limit(&self, level: usize, times: f64) -> Result<Added, SimulationError> {
        let added = self.at(level)?;
        Ok(added.of_size(added.size * times / HALF_STEP))
    }
}
