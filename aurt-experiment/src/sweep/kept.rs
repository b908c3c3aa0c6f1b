//! The file of a result: what came out, and a hash that tells whether it still is what was written.

use serde::{Deserialize, Serialize};

use crate::sweep::result::{Outcome, PointResult, SCHEMA};

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    schema: u32,
    key: String,
    /// BLAKE3 of the key and the outcome as compact JSON. Numbers survive writing and reading to the last bit, so the
    /// hash of what was read is that of what was written unless somebody changed it.
    checksum: String,
    outcome: Outcome,
}

/// What a file of results turned out to be.
#[derive(Debug)]
pub enum Found {
    Whole(Box<PointResult>),
    /// Half a file, another version's, or one that was changed after it was written.
    Damaged,
}

fn checksum(key: &str, outcome: &Outcome) -> serde_json::Result<String> {
    let text = serde_json::to_vec(&(key, outcome))?;
    Ok(blake3::hash(&text).to_hex().as_str()[..40].to_owned())
}

pub fn to_bytes(result: &PointResult) -> serde_json::Result<Vec<u8>> {
    let checksum = checksum(&result.key, &result.outcome)?;
    let PointResult { schema, key, outcome } = result.clone();
    let mut text = serde_json::to_vec_pretty(&Kept { schema, key, checksum, outcome })?;
    text.push(b'\n');
    Ok(text)
}

/// The result under `key` that a file has.
pub fn from_bytes(bytes: &[u8], key: &str) -> Found {
    let Ok(kept) = serde_json::from_slice::<Kept>(bytes) else { return Found::Damaged };
    let same = checksum(&kept.key, &kept.outcome).is_ok_and(|sum| sum == kept.checksum);
    if kept.schema != SCHEMA || kept.key != key || !same {
        return Found::Damaged;
    }
    Found::Whole(Box::new(PointResult { schema: kept.schema, key: kept.key, outcome: kept.outcome }))
}
