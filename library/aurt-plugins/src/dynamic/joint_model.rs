use std::sync::{Arc, Mutex, PoisonError};

use aurt_traits::{
    Columns, CoulombModel, HysteresisModel, Invariants, JointModel, JointSeries, ModelError, Parameter,
    ShapeParameter, ViscousBasis,
    abi::{NO_ROBOT, Series},
};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use super::{
    description::Described,
    guarded,
    instance::{Fault, Instance},
    library::LibraryModel,
};

/// A Coulomb, hysteresis or viscous model of a library. It is built for the slot that its table declares, and for no
/// other.
#[derive(Debug, Clone)]
pub(crate) struct LibraryJointModel {
    instance: Arc<Instance>,
    described: Arc<Described>,
    /// Why the last initial state could not be had; evaluation then reports it.
    failure: Arc<Mutex<Option<String>>>,
}

impl LibraryJointModel {
    pub(crate) fn create(model: Arc<LibraryModel>, config: Map<String, Value>) -> Result<Self, Fault> {
        Self::of(Instance::create(model, config)?)
    }

    fn of(instance: Instance) -> Result<Self, Fault> {
        let described = instance.describe(NO_ROBOT)?;
        Ok(Self { instance: Arc::new(instance), described, failure: Arc::default() })
    }
}

impl Serialize for LibraryJointModel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.instance.saved(&self.described.shapes).serialize(serializer)
    }
}

impl JointModel for LibraryJointModel {
    fn name(&self) -> &str {
        self.instance.model.name
    }

    fn columns(&self) -> Vec<Parameter> {
        self.described.columns.clone()
    }

    fn invariants(&self) -> Invariants {
        self.described.invariants
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        self.described.shapes.clone()
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if let Some(other) = with_shape(&self.instance, &self.described, values)? {
            *self = Self::of(other).map_err(|Fault(reason)| self.instance.failed(reason))?;
        }
        Ok(())
    }

    fn state_len(&self) -> usize {
        self.described.state_len
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        initial_state(&self.instance, &self.described, &Series::of_joint(first), &self.failure)
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        let columns = self.described.columns.len();
        let described = &*self.described;
        if !self.instance.is_new() {
            let of_joint = Series::of_joint(series);
            return evaluate(&self.instance, described, columns, &of_joint, state, out, &self.failure, false);
        }
        let before = state.to_vec();
        let of_joint = Series::of_joint(series);
        evaluate(&self.instance, described, columns, &of_joint, state, out, &self.failure, true)?;
        let mut again = |series: &JointSeries<'_>, out: &mut Columns<'_>| {
            self.instance.evaluate(&Series::of_joint(series), &mut before.clone(), out)
        };
        guarded::check_invariants(described.invariants, series, out, &mut again)
            .map_err(|Fault(reason)| self.instance.failed(reason))
    }
}

/// An instance with other shape parameters; none if there is nothing to set.
pub(super) fn with_shape(
    instance: &Instance,
    described: &Described,
    values: &[f64],
) -> Result<Option<Instance>, ModelError> {
    if values.len() != described.shapes.len() {
        return Err(ModelError::Count {
            what: format!("shape parameters of `{}`", instance.model.name),
            expected: described.shapes.len(),
            found: values.len(),
        });
    }
    if values.is_empty() {
        return Ok(None);
    }
    instance.with_shape(values).map(Some).map_err(|Fault(reason)| instance.failed(reason))
}

/// The state before the first sample. Where the library fails, a state that is not finite stands for that, and
/// `failure` keeps the reason for the evaluation that follows.
pub(super) fn initial_state(
    instance: &Instance,
    described: &Described,
    first: &Series,
    failure: &Mutex<Option<String>>,
) -> Vec<f64> {
    let state = instance.initial_state(first, described.state_len);
    let mut failure = failure.lock().unwrap_or_else(PoisonError::into_inner);
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
pub(super) fn evaluate(
    instance: &Instance,
    described: &Described,
    columns: usize,
    series: &Series,
    state: &mut [f64],
    out: &mut Columns<'_>,
    failure: &Mutex<Option<String>>,
    guarded: bool,
) -> Result<(), ModelError> {
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
        let reason = failure.lock().unwrap_or_else(PoisonError::into_inner).clone();
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
            return Err(instance.failed(format!("column `{name}` is {value} at sample {sample} of a batch")));
        }
    }
    Ok(())
}

// `#[typetag::serde]` on an implementation registers one fixed name, but these models have the names that their
// libraries give them. The two hidden functions that the attribute adds are therefore written out; the registry, not
// `typetag`, reads such models back.
macro_rules! fills_slot {
    ($slot:ident) => {
        impl $slot for LibraryJointModel {
            fn typetag_name(&self) -> &'static str {
                self.instance.model.name
            }

            fn typetag_deserialize(&self) {}

            fn boxed_clone(&self) -> Box<dyn $slot> {
                Box::new(self.clone())
            }
        }
    };
}

fills_slot!(CoulombModel);
fills_slot!(HysteresisModel);
fills_slot!(ViscousBasis);
