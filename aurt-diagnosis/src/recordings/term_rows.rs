//! The rows of one arm term by itself.

use aurt_recording::{DecimatedTile, Preprocessed, Segment};
use aurt_traits::{ArmSeries, ArmTerm, Columns, RigidBodyRegressor};

use crate::error::DiagnosisError;

/// Filtered, decimated rows of the columns of an arm term that does not read the load, over all segments of a
/// recording: `[joint of the term][column][row]`.
pub(crate) fn term_rows(
    term: &dyn ArmTerm,
    rigid_body: &dyn RigidBodyRegressor,
    data: &Preprocessed,
) -> Result<Vec<Vec<Vec<f64>>>, DiagnosisError> {
    let rows: usize = data.segments.iter().map(Segment::rows).sum();
    let mut series: Vec<Vec<Vec<f64>>> = Vec::new();
    let mut first = 0;
    for segment in &data.segments {
        let motion = segment.motion.view();
        let (joints, samples, count) = (motion.joints(), motion.samples(), segment.rows());
        let (own, columns) = (term.joints(joints).len(), term.columns(joints).len());
        series.resize(own, vec![vec![0.0; rows]; columns]);
        let load = vec![0.0; joints * samples];
        let all = ArmSeries { motion, load_torque: &load, load_stride: samples, rigid_body };
        let beginning =
            ArmSeries { motion: motion.slice(0..1), load_torque: &load, load_stride: samples, rigid_body };
        let mut state = term.initial_state(&beginning);
        let mut values = vec![0.0; own * columns * samples];
        let mut out = Columns::new(&mut values, own * columns, samples, samples);
        term.evaluate(&all, &mut state, &mut out)?;
        for (k, column) in values.chunks_exact_mut(samples.max(1)).enumerate() {
            segment.silence(term.joints(joints)[k / columns], 0, column);
        }
        let mut bank = segment.bank(own * columns);
        let mut write = |tile: DecimatedTile<'_>| {
            tile.copy_to(series.iter_mut().flatten().map(|column| &mut column[first..]));
        };
        bank.push(&values, samples, samples, &mut write);
        bank.finish(&mut write)?;
        first += count;
    }
    Ok(series)
}
