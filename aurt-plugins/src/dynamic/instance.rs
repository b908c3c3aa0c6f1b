use std::cell::Cell;
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::{fmt, ptr};

use aurt_traits::abi::{self, ErrorBuffer, Series};
use aurt_traits::{Columns, ModelError};
use serde_json::{Map, Value};

use super::description::Described;
use super::library::LibraryModel;

/// The key under which a saved model of a library says where it is from.
pub(crate) const PLUGIN_KEY: &str = "plugin";

const MESSAGE_BYTES: usize = 4096;
/// Batches that a new instance evaluates between guards.
const GUARDED_BATCHES: usize = 2;

/// A model of a library, made from a configuration. Never changed: other shape parameters are another instance.
pub(crate) struct Instance {
    pub model: Arc<LibraryModel>,
    /// The keys it was made from, without `model`.
    pub config: Map<String, Value>,
    pointer: *mut c_void,
    /// What it said of itself, by number of joints; locked while it is asked.
    described: Mutex<BTreeMap<usize, Arc<Described>>>,
    /// How many batches it has evaluated between guards.
    guarded: AtomicUsize,
}

// SAFETY: the ABI demands that instances may be used from any thread, and `describe` is called under a lock.
unsafe impl Send for Instance {}
// SAFETY: as above.
unsafe impl Sync for Instance {}

impl fmt::Debug for Instance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} of {}", self.model.name, Value::Object(self.config.clone()), self.model.library.name)
    }
}

/// Why a function of a library failed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault(pub String);

impl Fault {
    /// The complaints in a message: one a line, each with the key of `config` that it begins with.
    pub(crate) fn complaints(&self, config: &Map<String, Value>) -> Vec<(Option<String>, String)> {
        self.0
            .lines()
            .filter(|line| !line.trim().is_empty())
            .map(|line| {
                let named = line.strip_prefix('`').and_then(|rest| rest.split_once('`'));
                match named.filter(|(key, _)| config.contains_key(*key)) {
                    Some((key, rest)) => {
                        (Some(key.to_owned()), rest.trim_start_matches(':').trim_start().to_owned())
                    }
                    None => (None, line.to_owned()),
                }
            })
            .collect()
    }
}

thread_local! {
    /// Kept from call to call: a simulation evaluates sample by sample.
    static MESSAGE: Cell<Vec<u8>> = const { Cell::new(Vec::new()) };
}

/// Calls a function of the library with a buffer for its message.
fn call(function: impl FnOnce(*mut ErrorBuffer) -> i32) -> Result<(), Fault> {
    let mut message = MESSAGE.take();
    message.resize(MESSAGE_BYTES, 0);
    message[0] = 0;
    let mut buffer = ErrorBuffer { message: message.as_mut_ptr().cast::<c_char>(), capacity: MESSAGE_BYTES };
    let code = function(&raw mut buffer);
    let result = outcome(code, &message);
    MESSAGE.set(message);
    result
}

fn outcome(code: i32, message: &[u8]) -> Result<(), Fault> {
    if code == abi::OK {
        return Ok(());
    }
    let text = CStr::from_bytes_until_nul(message).map_or(message, CStr::to_bytes);
    let text = String::from_utf8_lossy(text);
    let text = text.trim();
    Err(Fault(match (code, text.is_empty()) {
        (abi::FAILED, true) => "it gives no reason".to_owned(),
        (abi::FAILED, false) => text.to_owned(),
        (abi::PANICKED, _) => format!("it panicked: {text}"),
        (other, _) => format!("it returned the unknown code {other}: {text}"),
    }))
}

impl Instance {
    pub(crate) fn create(model: Arc<LibraryModel>, config: Map<String, Value>) -> Result<Self, Fault> {
        let text = Value::Object(config.clone()).to_string();
        let mut pointer = ptr::null_mut();
        let function = model.table.functions.create.ok_or_else(|| missing("create"))?;
        // SAFETY: the table is the library's own, the text has the given length, and the pointers are to local values.
        call(|error| unsafe {
            function(model.table.address, text.as_ptr().cast(), text.len(), &raw mut pointer, error)
        })?;
        Ok(Self { model, config, pointer, described: Mutex::default(), guarded: AtomicUsize::new(0) })
    }

    pub(crate) fn with_shape(&self, values: &[f64]) -> Result<Self, Fault> {
        let other = Self::create(self.model.clone(), self.config.clone())?;
        let function = self.model.table.functions.set_shape.ok_or_else(|| missing("set_shape"))?;
        // SAFETY: nobody else knows the new instance; the values have the given length.
        call(|error| unsafe { function(other.pointer, values.as_ptr(), values.len(), error) })?;
        Ok(other)
    }

    /// What the model says of itself, for a robot of that many joints; asked once.
    pub(crate) fn describe(&self, robot_joints: usize) -> Result<Arc<Described>, Fault> {
        let table = &self.model.table;
        let mut known = self.described.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(described) = known.get(&robot_joints) {
            return Ok(described.clone());
        }
        let function = table.functions.describe.ok_or_else(|| missing("describe"))?;
        // A library of a later minor version writes a longer description.
        let mut place = vec![0_u64; table.description_size.div_ceil(8)];
        let description = place.as_mut_ptr().cast::<abi::Description>();
        // SAFETY: the place has the size that the library declares; the lock keeps other descriptions away.
        call(|error| unsafe { function(self.pointer, robot_joints, description, error) })?;
        // SAFETY: the library has filled the description; what it points to lives until the next one.
        let described = unsafe { Described::read(&*description) }.map_err(Fault)?;
        let described = Arc::new(described);
        known.insert(robot_joints, described.clone());
        Ok(described)
    }

    /// The state before the first sample; zeros if the model has no function for it.
    pub(crate) fn initial_state(&self, first: &Series, state_len: usize) -> Result<Vec<f64>, Fault> {
        let mut state = vec![0.0; state_len];
        if let Some(function) = self.model.table.functions.initial_state {
            // SAFETY: series and state are ours for the time of the call, of the lengths given.
            call(|error| unsafe { function(self.pointer, first, state.as_mut_ptr(), state_len, error) })?;
        }
        Ok(state)
    }

    /// Evaluates the series into `out`; the caller has checked that state and columns are as many as described.
    pub(crate) fn evaluate(
        &self,
        series: &Series,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), Fault> {
        let function = self.model.table.functions.evaluate.ok_or_else(|| missing("evaluate"))?;
        let columns = out.columns();
        let (out, stride) = out.raw_mut();
        // SAFETY: series, state and output are ours for the time of the call, of the lengths given.
        call(|error| unsafe {
            function(
                self.pointer,
                series,
                state.as_mut_ptr(),
                state.len(),
                out.as_mut_ptr(),
                columns,
                stride,
                error,
            )
        })
    }

    /// Whether the next batch is to be evaluated between guards: the first ones of every instance are.
    pub(crate) fn is_new(&self) -> bool {
        self.guarded.load(Ordering::Relaxed) < GUARDED_BATCHES
            && self.guarded.fetch_add(1, Ordering::Relaxed) < GUARDED_BATCHES
    }

    /// The keys with the present values of the shape parameters, and where the model is from: what is saved.
    pub(crate) fn saved(&self, shapes: &[aurt_traits::ShapeParameter]) -> Map<String, Value> {
        let mut keys = self.config.clone();
        for shape in shapes {
            // Numbers that were not changed stay as they were written.
            if keys.get(&shape.name).and_then(Value::as_f64) != Some(shape.value) {
                keys.insert(shape.name.clone(), Value::from(shape.value));
            }
        }
        let library = &self.model.library;
        keys.insert(
            PLUGIN_KEY.to_owned(),
            serde_json::json!({
                "name": library.name,
                "version": library.version,
                "library": library.path.to_string_lossy(),
                "blake3": library.blake3,
            }),
        );
        keys
    }

    pub(crate) fn failed(&self, reason: impl Into<String>) -> ModelError {
        let LibraryModel { name, library, .. } = &*self.model;
        ModelError::evaluation(*name, format!("{} ({})", reason.into(), library.name))
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some(destroy) = self.model.table.functions.destroy {
            // SAFETY: the pointer is from `create` and this is its end.
            unsafe { destroy(self.pointer) };
        }
    }
}

fn missing(function: &str) -> Fault {
    Fault(format!("it has no function `{function}`"))
}
