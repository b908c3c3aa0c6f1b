//! A model of a library: what its slots and arm terms have in common.

use std::sync::{Arc, Mutex, PoisonError};

use aurt_traits::abi::{NO_ROBOT, Series};
use aurt_traits::{Columns, ModelError};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use super::description::Described;
use super::guarded;
use super::instance::{Fault, Instance};
use super::library::LibraryModel;

/// A model of a library, of any slot. It is built for the slot that its table declares, and for no other.
#[derive(Debug, Clone)]
pub(crate) struct LibraryTerm {
    pub(super) instance: Arc<Instance>,
    /// What does not depend on the robot.
    pub(super) described: Arc<Described>,
    /// Why the last initial state could not be had; evaluation then reports it.
    failure: Arc<Mutex<Option<String>>>,
}

impl Serialize for LibraryTerm {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.instance.saved(&self.described.shapes).serialize(serializer)
    }
}

impl LibraryTerm {
    pub(crate) fn create(model: Arc<LibraryModel>, config: Map<String, Value>) -> Result<Self, Fault> {
        Self::of(Instance::create(model, config)?)
    }

    fn of(instance: Instance) -> Result<Self, Fault> {
        let described = instance.describe(NO_ROBOT)?;
        Ok(Self { instance: Arc::new(instance), described, failure: Arc::default() })
    }

    /// Takes other shape parameters, in an instance of its own.
    pub(super) fn reshape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if values.len() != self.described.shapes.len() {
            return Err(ModelError::count(
                format!("shape parameters of `{}`", self.instance.model.name),
                self.described.shapes.len(),
                values.len(),
            ));
        }
        if !values.is_empty() {
            let failed = |Fault(reason)| self.instance.failed(reason);
            *self = self.instance.with_shape(values).and_then(Self::of).map_err(failed)?;
        }
        Ok(())
    }

    /// The state before the first sample. Where the library fails, a state that is not finite stands for that, and
    /// it keeps the reason for the evaluation that follows.
    pub(super) fn first_state(&self, described: &Described, first: &Series) -> Vec<f64> {
        let state = self.instance.initial_state(first, described.state_len);
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        match state {
            Ok(state) => {
                *failure = None;
                state
            }
            Err(Fault(reason)) => {
                *failure = Some(reason);
                vec![f64::NAN; described.state_len]
            }
        }
    }

    /// Evaluates a model of a library and does not believe it: lengths are checked before, finiteness after.
    pub(super) fn checked(
        &self,
        described: &Described,
        columns: usize,
        series: &Series,
        state: &mut [f64],
        out: &mut Columns<'_>,
        guarded: bool,
    ) -> Result<(), ModelError> {
        let instance = &*self.instance;
        for (what, expected, found) in [
            ("state variables", described.state_len, state.len()),
            ("output columns", columns, out.columns()),
            ("output samples", series.samples, out.samples()),
        ] {
            if expected != found {
                let what = format!("{what} of `{}`", instance.model.name);
                return Err(ModelError::Count { what, expected, found });
            }
        }
        if !state.iter().all(|x| x.is_finite()) {
            let reason = self.failure.lock().unwrap_or_else(PoisonError::into_inner).clone();
            let reason = reason.map_or_else(
                || "its state is not finite".to_owned(),
                |reason| format!("it has no initial state: {reason}"),
            );
            return Err(instance.failed(reason));
        }
        let evaluated = if guarded {
            guarded::evaluate(instance, series, state, out)
        } else {
            instance.evaluate(series, state, out)
        };
        evaluated.map_err(|Fault(reason)| instance.failed(reason))?;
        let per_joint = described.columns.len().max(1);
        for k in 0..columns {
            if let Some(sample) = out.column(k).iter().position(|x| !x.is_finite()) {
                let name = &described.columns[k % per_joint].name;
                let value = out.column(k)[sample];
                return Err(
                    instance.failed(format!("column `{name}` is {value} at sample {sample} of a batch"))
                );
            }
        }
        Ok(())
    }
}
