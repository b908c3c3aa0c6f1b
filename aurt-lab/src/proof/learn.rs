//! What confidence is made of: hit rates of finished proofs.

use std::path::Path;

use crate::case::World;
use crate::product::{Failure, OutputFile, pretty};
use crate::score::{CaseScore, learnt};
use aurt_diagnosis::Learnt;
use serde_json::json;

pub fn learn(path: &Path, scores: &[(World, u64, Vec<CaseScore>)]) -> Result<Learnt, Failure> {
    let output = OutputFile::new("--learn", path, &[])?;
    let proofs: Vec<(World, u64, &[CaseScore])> =
        scores.iter().map(|(world, seed, scores)| (*world, *seed, scores.as_slice())).collect();
    let learnt = learnt(&proofs);
    if learnt.confidence.curves.is_empty() {
        return Err(Failure::argument(
            "--learn",
            "there is no finding with evidence to learn from",
            "name finished proofs with --proof",
        ));
    }
    output.write(pretty(&json!(learnt)).as_bytes())?;
    Ok(learnt)
}
