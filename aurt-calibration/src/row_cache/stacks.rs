//! The columns of joint stacks whose hysteresis and viscous models do not read the load torque: what these give is
//! computed once and used by all stacks that have them.

use std::sync::Arc;

use aurt_traits::{JointModel, JointStack};

use super::fit::{FitRows, Piece, Split, SplitColumn};
use super::series::{LoadSeries, filtered, identity, unfiltered};
use crate::CalibrationError;

impl FitRows<'_> {
    /// The split columns of a separable stack; `loads` holds τ_J of each piece.
    pub(crate) fn stack_columns(
        &self,
        (joint, stack, first_column): (usize, &JointStack, usize),
        loads: &[LoadSeries],
    ) -> Result<Vec<SplitColumn>, CalibrationError> {
        let of_hysteresis = identity("hysteresis", stack.hysteresis());
        let hysteresis = self.part(joint, stack.hysteresis(), of_hysteresis.as_ref())?;
        let viscous = self.part(joint, stack.viscous(), identity("viscous", stack.viscous()).as_ref())?;
        let levels: Vec<Vec<f64>> = self
            .pieces
            .iter()
            .zip(loads)
            .map(|(p, load)| {
                let segment = self.rigid.segment(p.recording, p.segment);
                unfiltered(stack.coulomb(), segment, joint, load.joint(joint))
            })
            .collect::<Result<_, _>>()?;
        let mut splits: Vec<Arc<Split>> = Vec::new();
        for c in 0..stack.coulomb().columns().len() {
            let level: Vec<&[f64]> = levels
                .iter()
                .zip(&self.pieces)
                .map(|(l, p)| {
                    let samples = self.rigid.segment(p.recording, p.segment).motion.samples();
                    &l[c * samples..(c + 1) * samples]
                })
                .collect();
            let is = |value: f64| level.iter().all(|l| l.iter().all(|v| *v == value));
            if is(1.0) {
                splits.extend(hysteresis.iter().cloned());
            } else if is(0.0) {
                splits.extend(hysteresis.iter().map(|split| Arc::new(split.zero())));
            } else {
                splits.extend(self.products(joint, &level, stack.hysteresis(), of_hysteresis.as_ref())?);
            }
        }
        splits.extend(viscous.iter().cloned());
        let column = |(k, split)| SplitColumn { joint, column: first_column + k, split };
        Ok(splits.into_iter().enumerate().map(column).collect())
    }

    /// The split columns of a model that does not read the load torque.
    fn part(
        &self,
        joint: usize,
        model: &dyn JointModel,
        identity: Option<&String>,
    ) -> Result<Arc<Vec<Arc<Split>>>, CalibrationError> {
        let key = identity.map(|identity| (joint, identity.clone()));
        let bytes =
            |splits: &Vec<Arc<Split>>| splits.iter().map(|s| 8 * (s.along.len() + s.beyond.len())).sum();
        self.parts.get(key, bytes, || {
            self.joined(joint, model.columns().len(), |piece, _| {
                let place = (piece.recording, piece.segment, joint);
                Ok(self.rigid.part(place, model, identity.cloned())?.rows.clone())
            })
        })
    }

    /// The split products of a Coulomb column, given for each piece, with each hysteresis column.
    fn products(
        &self,
        joint: usize,
        level: &[&[f64]],
        hysteresis: &dyn JointModel,
        identity: Option<&String>,
    ) -> Result<Vec<Arc<Split>>, CalibrationError> {
        let count = hysteresis.columns().len();
        self.joined(joint, count, |piece, k| {
            let place = (piece.recording, piece.segment, joint);
            let part = self.rigid.part(place, hysteresis, identity.cloned())?;
            let mut product = Vec::with_capacity(count * level[k].len());
            for column in part.columns() {
                product.extend(column.iter().zip(level[k]).map(|(h, l)| l * h));
            }
            filtered(self.rigid.segment(piece.recording, piece.segment), &product, count)
        })
    }

    /// Some columns, split; `rows_of` gives their rows over each piece, which has that index.
    fn joined(
        &self,
        joint: usize,
        count: usize,
        rows_of: impl Fn(&Piece, usize) -> Result<Vec<Vec<f64>>, CalibrationError>,
    ) -> Result<Vec<Arc<Split>>, CalibrationError> {
        let mut joined = vec![Vec::with_capacity(self.rows(joint)); count];
        for (k, piece) in self.pieces.iter().enumerate() {
            joined.iter_mut().zip(&rows_of(piece, k)?).for_each(|(to, rows)| piece.append(joint, rows, to));
        }
        Ok(self.joints[joint].split(&joined.iter().map(Vec::as_slice).collect::<Vec<_>>()))
    }
}
