//! Recordings in blocks of time, as triangles.

use std::ops::Range;

use aurt_recording::Segment;
use rayon::prelude::*;

use super::{Full, rows};
use crate::{CalibrationError, JointFactor, NamedRecording, Rest, System, for_each_row_block};

/// No block is shorter than this, s; noise of drives remembers for a tenth of it.
const SHORTEST_S: f64 = 2.0;

/// A recording, and which columns act in it.
pub(crate) struct Listed<'a> {
    pub recording: &'a NamedRecording,
    pub acting: Vec<bool>,
}

/// The recordings, each once, in about so many blocks.
///
/// # Errors
/// What models report.
pub(super) fn blocks_of(
    full: &Full<'_>,
    listed: &[Listed<'_>],
    count: usize,
) -> Result<Vec<System>, CalibrationError> {
    let is_first = |k: usize| !listed[..k].iter().any(|l| l.recording.is_copy_of(listed[k].recording));
    let once: Vec<&Listed<'_>> = (0..listed.len()).filter(|k| is_first(*k)).map(|k| &listed[k]).collect();
    let total = rows(once.iter().flat_map(|l| &l.recording.data.segments));
    let length = total.div_ceil(count).max(1);
    let parts: Vec<(&Segment, &[bool], Range<usize>)> = once
        .iter()
        .flat_map(|l| l.recording.data.segments.iter().map(move |s| (s, l.acting.as_slice())))
        .flat_map(|(segment, acting)| {
            let count = segment.rows();
            let shortest = (SHORTEST_S * segment.rate_hz / segment.decimation as f64).ceil() as usize;
            let parts = ((count as f64 / length as f64).round() as usize).min(count / shortest.max(1)).max(1);
            (0..parts).map(move |k| (segment, acting, k * count / parts..(k + 1) * count / parts))
        })
        .collect();
    parts.into_par_iter().map(|(segment, acting, range)| block(full, segment, acting, range)).collect()
}

fn block(
    full: &Full<'_>,
    segment: &Segment,
    acting: &[bool],
    range: Range<usize>,
) -> Result<System, CalibrationError> {
    let Full { model, options, .. } = *full;
    let mut factors: Vec<JointFactor> =
        (0..model.joints()).map(|j| JointFactor::new(model.row_columns(j).to_vec())).collect();
    if let Some(measurement) = &segment.measurement {
        for_each_row_block(model, segment, full.load, |block| {
            let absent = vec![0.0; block.rows];
            for (joint, factor) in factors.iter_mut().enumerate() {
                let columns = model.row_columns(joint);
                let first_slot = model.row_slots(joint).start;
                factor.push(
                    |k| if acting[columns[k]] { block.column(first_slot + k) } else { &absent },
                    block.measurement(&measurement[joint]),
                    |row| {
                        range.contains(&(block.first_row + row))
                            && (options.rest == Rest::Keep
                                || block.speed(segment, joint, row) > options.rest_velocity_rad_s)
                    },
                );
            }
        })?;
    }
    Ok(System::new(full.system.coefficients(), factors))
}
