//! Columns of models that do not read the load torque, kept for all robot models that have them.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, PoisonError};

/// What is kept may take this much memory; what comes after is computed each time.
const MOST_BYTES: usize = 1 << 28;

/// The columns of a model at a joint over a segment.
#[derive(Debug)]
pub(crate) struct Part {
    /// Unfiltered, column after column.
    pub(super) unfiltered: Vec<f64>,
    pub(super) samples: usize,
    /// Filtered and decimated.
    pub rows: Vec<Vec<f64>>,
}

impl Part {
    pub(crate) fn columns(&self) -> impl Iterator<Item = &[f64]> {
        self.unfiltered.chunks_exact(self.samples.max(1))
    }
}

/// Recording, segment, joint, and the model with its configuration.
pub(super) type Key = (usize, usize, usize, String);

pub(super) type Parts = Kept<Key, Part>;

/// Results under what they depend on, up to some memory.
#[derive(Debug)]
pub(super) struct Kept<K, V>(Mutex<(HashMap<K, Arc<V>>, usize)>);

impl<K, V> Default for Kept<K, V> {
    fn default() -> Self {
        Self(Mutex::new((HashMap::new(), 0)))
    }
}

impl<K: Eq + Hash, V> Kept<K, V> {
    /// What is kept under `key`, or else what `make` makes. Two threads may make it at the same time: they make the same.
    /// Without a key nothing is kept.
    pub(super) fn get<E>(
        &self,
        key: Option<K>,
        bytes: impl Fn(&V) -> usize,
        make: impl FnOnce() -> Result<V, E>,
    ) -> Result<Arc<V>, E> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = key.as_ref().and_then(|key| kept().0.get(key).cloned()) {
            return Ok(known);
        }
        let made = Arc::new(make()?);
        if let Some(key) = key {
            let bytes = bytes(&made);
            let mut kept = kept();
            if kept.1 + bytes <= MOST_BYTES && kept.0.insert(key, Arc::clone(&made)).is_none() {
                kept.1 += bytes;
            }
        }
        Ok(made)
    }
}
