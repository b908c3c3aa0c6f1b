//! What is claimed of the recordings with an effect: by the part of a diagnosis that the effect concerns.

use aurt_diagnosis::Prepared;
use aurt_diagnosis::effects::{self, time_delay};
use aurt_diagnosis::injection::AddedRows;
use aurt_diagnosis::vocabulary::Means;
use aurt_plugins::Registry;
use aurt_simulation::inject::{Added, Kind};

use super::Subject;
use super::claims::Claims;
use crate::workbench::failure::Failure;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Route {
    /// Everything but the columns, the noise and the null, which the recordings as they are give.
    Prepared,
    Faults,
    /// The whole diagnosis: gears are simulated at the recordings' own rate.
    Whole,
}

impl Route {
    pub fn of(kind: &Kind) -> Self {
        match effects::find(kind.identifier).map(|e| e.means) {
            Some(Means::Samples) => Self::Faults,
            Some(Means::FullRate) => Self::Whole,
            _ => Self::Prepared,
        }
    }
}

/// The diagnosis of the recordings as they are, and of what is added to them.
#[derive(Debug)]
pub struct Trials<'a> {
    pub subject: &'a Subject,
    pub prepared: &'a Prepared<'a>,
    pub reference: Claims,
    registry: &'a Registry,
}

impl<'a> Trials<'a> {
    pub fn new(subject: &'a Subject, prepared: &'a Prepared<'a>, registry: &'a Registry) -> Self {
        Self { subject, prepared, reference: Claims::of(prepared.verdict()), registry }
    }

    pub fn rows(&self, effect: &Added) -> Result<AddedRows, Failure> {
        let mut rows = self.prepared.nothing();
        for (r, place) in self.subject.places().into_iter().enumerate() {
            if self.subject.has(place, effect) {
                let recorded = &self.subject.injection.recorded()[place.number];
                let measured = recorded.recording.measurement.as_deref().unwrap_or_default();
                rows[r] = self.prepared.rows_of(r, effect.torque(&recorded.scene, measured)?)?;
            }
        }
        Ok(rows)
    }

    /// What is claimed of rows with an effect; `turn` is that of [`Prepared::said_with`].
    pub fn claims(&self, kind: &Kind, added: &AddedRows, turn: f64) -> Result<Claims, Failure> {
        let joints = self.subject.injection.joints();
        Ok(match self.prepared.said_with(kind.identifier, added, turn)? {
            Some(verdict) => Claims::of(&verdict),
            // With the delay undone, the rest is what is claimed of the recordings as they are.
            None => {
                let named = !self.reference.is_unexplained();
                self.reference.clone().and(time_delay::EFFECT.id, (0..joints).collect(), named)
            }
        })
    }

    pub fn faults(&self, effect: &Added) -> Result<Claims, Failure> {
        let places = self.subject.places().into_iter();
        let altered =
            places.map(|place| self.subject.altered(place, &[effect])).collect::<Result<Vec<_>, _>>()?;
        let mut claims = self.reference.clone();
        for fault in self.prepared.faults_of(&altered)? {
            claims = claims.and(fault.effect.id, fault.joints, fault.named);
        }
        Ok(claims)
    }

    pub fn whole(&self, effect: &Added) -> Result<Claims, Failure> {
        self.subject.diagnosed(&[effect], self.registry)
    }
}
