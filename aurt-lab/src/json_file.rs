use std::path::Path;

use serde::de::DeserializeOwned;

use aurt_simulation::SimulationError;

pub(crate) fn read<T: DeserializeOwned>(path: &Path) -> Result<T, SimulationError> {
    let text = aurt_files::read_text(path, aurt_files::MOST_MODEL_BYTES)
        .map_err(|source| SimulationError::Io { path: path.into(), source })?;
    serde_json::from_str(&text)
        .map_err(|error| SimulationError::Unreadable { path: path.into(), reason: error.to_string() })
}
