//! The host's side of an instance that lives in another process.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

use aurt_traits::{Columns, MotionView};
use serde_json::{Map, Value};

use super::{
    Pool,
    frame::{Reply, Request, Size},
};
use crate::dynamic::{description::Described, instance::Fault};

/// An instance of a library's model in the library's process.
#[derive(Debug)]
pub(crate) struct Remote {
    pool: Arc<Pool>,
    pub(super) number: u64,
    model: usize,
    config: Map<String, Value>,
    pub(super) shape: Option<Vec<f64>>,
    described: Mutex<BTreeMap<usize, Arc<Described>>>,
}

fn wrong(what: &str) -> Fault {
    Fault(format!("the process of its library answered {what}"))
}

impl Remote {
    pub(crate) fn new(
        pool: Arc<Pool>,
        model: usize,
        config: &Map<String, Value>,
        shape: Option<&[f64]>,
    ) -> Result<Self, Fault> {
        let number = pool.new_instance();
        let (config, shape) = (config.clone(), shape.map(<[f64]>::to_vec));
        let remote = Self { pool, number, model, config, shape, described: Mutex::default() };
        // A configuration that is refused is refused here, not at the first batch.
        remote.describe(aurt_traits::abi::NO_ROBOT)?;
        Ok(remote)
    }

    pub(super) fn create(&self, shaped: bool) -> Request {
        Request::Create { instance: self.number, model: self.model, config: self.config.clone(), shaped }
    }

    /// The same model with other shape parameters, as another instance.
    pub(crate) fn with_shape(&self, values: &[f64]) -> Result<Self, Fault> {
        Self::new(self.pool.clone(), self.model, &self.config, Some(values))
    }

    /// What the model says of itself, for a robot of that many joints; asked once.
    pub(crate) fn describe(&self, robot_joints: usize) -> Result<Arc<Described>, Fault> {
        let mut known = self.described.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(described) = known.get(&robot_joints) {
            return Ok(described.clone());
        }
        let request = Request::Describe { instance: self.number, robot_joints };
        let (Reply::Described(text), _) = self.pool.call(self, &request, &[], 0)? else {
            return Err(wrong("without a description"));
        };
        let described = Arc::new(Described::from(text));
        known.insert(robot_joints, described.clone());
        Ok(described)
    }

    /// The state before the first sample.
    pub(crate) fn initial_state(
        &self,
        motion: &MotionView<'_>,
        load: &[f64],
        load_stride: usize,
        state_len: usize,
    ) -> Result<Vec<f64>, Fault> {
        let (size, numbers) = Size::written(motion, load, load_stride);
        let request = Request::InitialState { instance: self.number, size, state_len };
        let (_, state) = self.pool.call(self, &request, &[&numbers], state_len)?;
        if state.len() == state_len { Ok(state) } else { Err(wrong("a state of another length")) }
    }

    /// Evaluates series into `out` and moves the state to their end.
    pub(crate) fn evaluate(
        &self,
        motion: &MotionView<'_>,
        load: &[f64],
        load_stride: usize,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), Fault> {
        let (size, numbers) = Size::written(motion, load, load_stride);
        let (columns, samples, state_len) = (out.columns(), out.samples(), state.len());
        let request = Request::Evaluate { instance: self.number, size, state_len, columns };
        let expected = columns * samples + state_len;
        let (_, result) = self.pool.call(self, &request, &[&numbers, state], expected)?;
        if result.len() != expected {
            return Err(wrong("columns of another length"));
        }
        let (values, after) = result.split_at(columns * samples);
        for k in 0..columns {
            out.column_mut(k).copy_from_slice(&values[k * samples..(k + 1) * samples]);
        }
        state.copy_from_slice(after);
        Ok(())
    }
}
