//! Instruments: the regressor of the same motion behind a lower filter, which noise of the positions hardly passes.

use aurt_recording::{Segment, ZeroPhase};
use aurt_traits::Motion;

use crate::{
    CalibrationError,
    rows::{JointRows, Observed, Piece},
};

const ORDER: usize = 4;
/// Its cut-off over that of the parallel filter: at f_dyn by default. The power of noise in accelerations grows with the fifth
/// power of the cut-off.
const SHARE: f64 = 0.5;

/// Puts the columns of the instruments Z in the place of those of W; residuals stay, and rows that were not fitted stay zero.
pub(crate) fn put_instruments(
    observed: &Observed<'_>,
    piece: &Piece<'_>,
    rows: &mut [JointRows],
) -> Result<(), CalibrationError> {
    if rows.is_empty() {
        return Ok(());
    }
    let segment = smooth(piece.segment)?;
    let none = vec![0.0; observed.model.parameters().len()];
    let instruments = observed.rows_of(&segment, &piece.acting, &none)?;
    for (rows, instruments) in rows.iter_mut().zip(instruments) {
        rows.columns = instruments.columns;
        for column in &mut rows.columns {
            column.iter_mut().zip(&rows.residual).filter(|(_, e)| **e == 0.0).for_each(|(z, _)| *z = 0.0);
        }
    }
    Ok(())
}

/// The motion behind a filter below that of the rows.
fn smooth(segment: &Segment) -> Result<Segment, CalibrationError> {
    let filter = ZeroPhase::butterworth(ORDER, SHARE * segment.parallel_filter.cutoff_hz(), segment.rate_hz)?;
    let (view, period_s) = (segment.motion.view(), 1.0 / segment.rate_hz);
    let samples = view.joints() * view.samples();
    let [mut position, mut velocity, mut acceleration] = [(); 3].map(|()| Vec::with_capacity(samples));
    for joint in 0..view.joints() {
        let (q, v) = (view.position_rad(joint), view.velocity_rad_s(joint));
        // A sample more at either end, as preprocessing has it for the differences.
        let before = q.first().zip(v.first()).map(|(q, v)| q - v * period_s);
        let after = q.last().zip(v.last()).map(|(q, v)| q + v * period_s);
        let longer: Vec<f64> = before.into_iter().chain(q.iter().copied()).chain(after).collect();
        for three in filter.filter(&longer)?.windows(3) {
            position.push(three[1]);
            velocity.push((three[2] - three[0]) / (2.0 * period_s));
            acceleration.push((three[2] - 2.0 * three[1] + three[0]) / (period_s * period_s));
        }
    }
    let motion = Motion::new(view.joints(), view.time_s().to_vec(), position, velocity, acceleration)?;
    Ok(Segment { motion, ..segment.clone() })
}
