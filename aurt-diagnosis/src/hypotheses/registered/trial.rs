//! Whether a model that others wrote can be evaluated at all on the recordings in question.

use aurt_traits::{ArmSeries, Columns};
use rayon::prelude::*;

use super::Proposed;
use crate::request::Question;

/// Evaluates every configuration over all recordings, without load: a model that fails would end the whole diagnosis,
/// for which it is but one candidate of many.
pub(super) fn evaluates(question: &Question<'_>, proposed: &[Proposed]) -> Result<(), String> {
    proposed.par_iter().map(|one| evaluate(question, one)).collect()
}

fn evaluate(question: &Question<'_>, proposed: &Proposed) -> Result<(), String> {
    let term = &*proposed.term;
    for segment in question.recordings.iter().flat_map(|r| &r.data.data.segments) {
        let motion = segment.motion.view();
        let (joints, samples) = (motion.joints(), motion.samples());
        if samples == 0 {
            continue;
        }
        let load = vec![0.0; joints * samples];
        let series = ArmSeries {
            motion,
            load_torque: &load,
            load_stride: samples,
            rigid_body: &**question.model.rigid_body(),
        };
        let mut state = term.initial_state(&ArmSeries { motion: motion.slice(0..1), ..series });
        let columns = term.columns(joints).len() * term.joints(joints).len();
        let mut data = vec![0.0; columns * samples];
        let mut out = Columns::new(&mut data, columns, samples, samples);
        term.evaluate(&series, &mut state, &mut out).map_err(|e| e.to_string())?;
        if data.iter().any(|x| !x.is_finite()) {
            return Err("it gives numbers that are not finite".to_owned());
        }
    }
    Ok(())
}
