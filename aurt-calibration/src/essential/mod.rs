//! Essential parameters: the fewest that predict as well as all.
//!
//! Parameters that explain nothing but noise make predictions worse elsewhere. The recordings are cut into blocks of time; each
//! block is predicted by a fit to the others, from the triangles of both. Backward elimination takes out, one by one, the
//! parameter without which the weighted squared residual grows least (Pham and Gautier 1991), ζ_k²/(A⁻¹)_kk. With d_b the
//! growth of the mean squared error of block b over that of the best set so far, elimination ends where the mean of d is
//! significant in Student's one-sided test at 5 % over the blocks. Blocks are far longer than noise remembers, so that their
//! errors are independent whatever the autocorrelation within them.

mod blocks;
mod report;

use rayon::prelude::*;

pub(crate) use blocks::Full;
pub use report::{EssentialReport, EssentialStep};

use crate::statistics::{ONE_SIDED_5, student};
use crate::{CalibrationError, JointFactor, System};
use blocks::blocks_of;

/// Blocks that the recordings are cut into, about.
const BLOCKS: usize = 12;
/// Of fewer blocks the errors vary so much that Student's test finds nothing significant: with four, elimination went on until
/// predictions elsewhere were 2.6 times as wrong (docs/estimation.md).
const FEWEST_BLOCKS: usize = 6;
/// Elimination is shown until the error has grown this much over the best.
const SHOWN_GROWTH: f64 = 0.5;

/// Rows that are predicted, and those that the prediction is fitted to.
struct Fold {
    held_out: System,
    others: System,
    rows: f64,
}

/// The parameters that are kept, and how it came to them.
pub(crate) fn eliminate(full: &Full<'_>) -> Result<(Vec<bool>, EssentialReport), CalibrationError> {
    let blocks = blocks_of(full, BLOCKS)?;
    if blocks.len() < FEWEST_BLOCKS {
        return Err(CalibrationError::TooFewBlocks { found: blocks.len(), needed: FEWEST_BLOCKS });
    }
    let folds = folds(&blocks)?;
    let parameters = full.rows.model.parameters();
    let excited = full.system.solve(full.weights, |_| true)?.excited;
    let mut active = excited.clone();
    let mut best = errors(full, &folds, &active)?;
    let error_of_all = mean(&best);
    let critical = student(ONE_SIDED_5, (folds.len() - 1) as f64);
    let mut steps: Vec<EssentialStep> = Vec::new();
    let (mut kept, mut is_over) = (active.clone(), false);
    while let Some((parameter, loss)) = least(full, &active)? {
        active[parameter] = false;
        let found = errors(full, &folds, &active)?;
        let (growth, deviation) = compare(&found, &best);
        let is_significant = growth > critical * deviation;
        is_over |= is_significant;
        if !is_over {
            kept.clone_from(&active);
        }
        steps.push(EssentialStep {
            parameter: parameters[parameter].name.clone(),
            chi_squared: loss,
            held_out_error: mean(&found),
            growth,
            growth_std: deviation,
            significant: is_significant,
            eliminated: !is_over,
        });
        if is_over && mean(&found) > (1.0 + SHOWN_GROWTH) * mean(&best) {
            break;
        }
        if mean(&found) < mean(&best) {
            best = found;
        }
    }
    let report = EssentialReport {
        blocks: folds.len(),
        parameters: excited.iter().filter(|e| **e).count(),
        kept: kept.iter().filter(|k| **k).count(),
        held_out_error: error_of_all,
        steps,
    };
    Ok((kept, report))
}

/// The active parameter whose removal costs least, and its cost in χ².
fn least(full: &Full<'_>, active: &[bool]) -> Result<Option<(usize, f64)>, CalibrationError> {
    if active.iter().filter(|a| **a).count() < 2 {
        return Ok(None);
    }
    let solution = full.system.solve(full.weights, |k| active[k])?;
    let n = active.len();
    let costs = (0..n).filter(|k| active[*k]).map(|k| {
        let variance = solution.covariance[k * n + k];
        let cost = if variance > 0.0 { solution.coefficients[k].powi(2) / variance } else { 0.0 };
        (k, cost)
    });
    Ok(costs.min_by(|a, b| a.1.total_cmp(&b.1)))
}

/// Mean squared error of each block, in σ_j², from a fit to the others.
fn errors(full: &Full<'_>, folds: &[Fold], active: &[bool]) -> Result<Vec<f64>, CalibrationError> {
    folds
        .par_iter()
        .map(|fold| {
            let coefficients = fold.others.solve_coefficients_of(full.weights, |k| active[k])?;
            let residuals = fold.held_out.residual_sum(&coefficients);
            let sum: f64 = residuals.iter().zip(full.weights).map(|(r, w)| r * w * w).sum();
            Ok(sum / fold.rows)
        })
        .collect()
}

fn folds(blocks: &[System]) -> Result<Vec<Fold>, CalibrationError> {
    (0..blocks.len())
        .into_par_iter()
        .map(|held| {
            let mut others: Option<System> = None;
            for (_, block) in blocks.iter().enumerate().filter(|(k, _)| *k != held) {
                match &mut others {
                    None => others = Some(block.clone()),
                    Some(sum) => sum.merge(block)?,
                }
            }
            let others = others.ok_or(CalibrationError::NothingToCalibrateOn)?;
            let held_out = blocks[held].clone();
            let rows = held_out.factors().iter().map(JointFactor::rows).sum::<usize>();
            Ok(Fold { others, rows: rows.max(1) as f64, held_out })
        })
        .collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Mean of the differences, and its standard deviation.
fn compare(found: &[f64], best: &[f64]) -> (f64, f64) {
    let differences: Vec<f64> = found.iter().zip(best).map(|(f, b)| f - b).collect();
    let mean = mean(&differences);
    let count = differences.len() as f64;
    let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
    (mean, (squares / (count - 1.0) / count).sqrt())
}
