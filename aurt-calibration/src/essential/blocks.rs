//! Recordings in blocks of time, as triangles.

use std::ops::Range;

use rayon::prelude::*;

use crate::rows::{Observed, Piece};
use crate::{CalibrationError, JointFactor, Rest, System, for_each_row_block};

/// No block is shorter than this, s; noise of drives remembers for a tenth of it.
const SHORTEST_S: f64 = 2.0;

/// What parameters are eliminated from.
pub(crate) struct Full<'a> {
    pub rows: Observed<'a>,
    /// The rows of all recordings.
    pub system: &'a System,
    /// 1/σ_j.
    pub weights: &'a [f64],
}

/// The recordings, each once, in about so many blocks.
pub(super) fn blocks_of(full: &Full<'_>, count: usize) -> Result<Vec<System>, CalibrationError> {
    let pieces = full.rows.pieces();
    let total: usize = pieces.iter().map(|piece| piece.segment.rows()).sum();
    let length = total.div_ceil(count).max(1);
    let parts: Vec<(&Piece<'_>, Range<usize>)> = pieces
        .iter()
        .flat_map(|piece| {
            let segment = piece.segment;
            let count = segment.rows();
            let shortest = (SHORTEST_S * segment.rate_hz / segment.decimation as f64).ceil() as usize;
            let parts = ((count as f64 / length as f64).round() as usize).min(count / shortest.max(1)).max(1);
            (0..parts).map(move |k| (piece, k * count / parts..(k + 1) * count / parts))
        })
        .collect();
    parts.into_par_iter().map(|(piece, range)| block(full, piece, range)).collect()
}

fn block(full: &Full<'_>, piece: &Piece<'_>, range: Range<usize>) -> Result<System, CalibrationError> {
    let Observed { model, options, load, .. } = full.rows;
    let Piece { segment, acting, .. } = piece;
    let mut factors: Vec<JointFactor> =
        (0..model.joints()).map(|j| JointFactor::new(model.row_columns(j).to_vec())).collect();
    if let Some(measurement) = &segment.measurement {
        for_each_row_block(model, segment, load, |block| {
            let absent = vec![0.0; block.rows];
            for (joint, factor) in factors.iter_mut().enumerate() {
                let columns = model.row_columns(joint);
                let first_slot = model.row_slots(joint).start;
                let rest = options.rest_velocity(&**model.rigid_body(), joint);
                factor.push(
                    |k| if acting[columns[k]] { block.column(first_slot + k) } else { &absent },
                    block.measurement(&measurement[joint]),
                    |row| {
                        range.contains(&(block.first_row + row))
                            && (options.rest == Rest::Keep || block.speed(segment, joint, row) > rest)
                    },
                );
            }
        })?;
    }
    Ok(System::new(full.system.coefficients(), factors))
}
