//! The columns of joint stacks whose hysteresis and viscous models do not read the load torque: what these give is
//! computed once and used by all stacks that have them.

use std::sync::Arc;

use aurt_traits::{ColumnGroup, CoulombModel, JointModel, JointStack, RobotModel};

use super::{
    fit::{FitRows, Split, SplitColumn},
    load::LoadSeries,
    series::{filtered, identity, separable, unfiltered},
};
use crate::{CalibrationError, JointFactor, System};

/// The split columns of a stack: those of its parts, or products of them.
struct StackSplits {
    hysteresis: Arc<Vec<Split>>,
    viscous: Arc<Vec<Split>>,
    /// For each Coulomb column what its products with the hysteresis columns are.
    products: Vec<Products>,
}

enum Products {
    /// The Coulomb column is one: the hysteresis columns themselves.
    Same,
    Other(Vec<Split>),
}

impl StackSplits {
    /// All of them, in the order of the stack's columns.
    fn all(&self) -> Vec<&Split> {
        let products = self.products.iter().flat_map(|products| match products {
            Products::Same => self.hysteresis.iter(),
            Products::Other(splits) => splits.iter(),
        });
        products.chain(self.viscous.iter()).collect()
    }
}

impl FitRows<'_> {
    /// The split columns of a separable stack; `loads` holds τ_J of each piece.
    pub(crate) fn stack_columns(
        &self,
        (joint, stack, first_column): (usize, &JointStack, usize),
        loads: &[LoadSeries],
    ) -> Result<Vec<SplitColumn>, CalibrationError> {
        let splits = self.stack_splits(joint, stack, loads)?;
        let column = |(k, split): (usize, &Split)| SplitColumn {
            joint,
            column: first_column + k,
            split: split.clone(),
        };
        Ok(splits.all().into_iter().enumerate().map(column).collect())
    }

    /// The factor of a joint whose rows have no other columns than the rigid bodies' and those of a separable stack.
    pub(crate) fn stack_factor(
        &self,
        (joint, stack, first_column): (usize, &JointStack, usize),
        loads: &[LoadSeries],
    ) -> Result<JointFactor, CalibrationError> {
        let splits = self.stack_splits(joint, stack, loads)?;
        let all = splits.all();
        let columns = first_column..first_column + all.len();
        Ok(self.factor_of(joint, columns, self.triangle(joint, &all)))
    }

    /// The system of a model at τ_J = 0, where load-dependent columns vanish and all models with the same hysteresis and
    /// viscous parts have the same columns; these are factorised once. Nothing for a model that has other columns too.
    pub(crate) fn unloaded_system(&self, model: &RobotModel) -> Result<Option<System>, CalibrationError> {
        if !model.arm_terms().is_empty() {
            return Ok(None);
        }
        let mut factors = Vec::new();
        for (joint, stack) in model.stacks().iter().enumerate() {
            let parts = identity("hysteresis", stack.hysteresis()).zip(identity("viscous", stack.viscous()));
            let (Some((hysteresis, viscous)), true) = (parts, separable(stack)) else { return Ok(None) };
            let levels = self.unloaded_levels(joint, stack.coulomb())?;
            let Some(levels) = levels.as_deref() else { return Ok(None) };
            let mut ones = levels.iter().enumerate().filter(|(_, one)| **one).map(|(c, _)| c);
            let (Some(one), None) = (ones.next(), ones.next()) else { return Ok(None) };
            let key = (joint, hysteresis.clone(), viscous.clone());
            let triangle = self.triangles.get(
                Some(key),
                |t: &Vec<f64>| 8 * t.len(),
                || {
                    let hysteresis = self.part(joint, stack.hysteresis(), Some(&hysteresis))?;
                    let viscous = self.part(joint, stack.viscous(), Some(&viscous))?;
                    let all: Vec<&Split> = hysteresis.iter().chain(viscous.iter()).collect();
                    Ok::<_, CalibrationError>(self.triangle(joint, &all))
                },
            )?;
            let own = model.group(ColumnGroup::JointDynamics(joint));
            let width = stack.hysteresis().columns().len();
            let products = own.start + one * width..own.start + (one + 1) * width;
            let viscous = own.start + levels.len() * width..own.end;
            factors.push(self.factor_of(joint, products.chain(viscous), triangle.to_vec()));
        }
        Ok(Some(System::new(model.parameters().len(), factors)))
    }

    /// Which of a Coulomb model's columns are one where τ_J = 0, if all are one or zero there.
    fn unloaded_levels(
        &self,
        joint: usize,
        coulomb: &dyn CoulombModel,
    ) -> Result<Arc<Option<Vec<bool>>>, CalibrationError> {
        let key = identity("coulomb", coulomb).map(|identity| (joint, identity));
        self.unloaded.get(
            key,
            |_| 0,
            || {
                let mut levels: Vec<Option<bool>> = vec![None; coulomb.columns().len()];
                for piece in &self.pieces {
                    let segment = self.rigid.segment(piece.recording, piece.segment);
                    let samples = segment.motion.samples();
                    let columns = unfiltered(coulomb, segment, joint, &vec![0.0; samples])?;
                    for (level, column) in levels.iter_mut().zip(columns.chunks_exact(samples.max(1))) {
                        let all = |value: f64| column.iter().all(|v| *v == value);
                        let here = all(1.0);
                        if (!here && !all(0.0)) || level.is_some_and(|known| known != here) {
                            return Ok(None);
                        }
                        *level = Some(here);
                    }
                }
                Ok(levels.into_iter().collect())
            },
        )
    }

    fn stack_splits(
        &self,
        joint: usize,
        stack: &JointStack,
        loads: &[LoadSeries],
    ) -> Result<StackSplits, CalibrationError> {
        let of_hysteresis = identity("hysteresis", stack.hysteresis());
        let hysteresis = self.part(joint, stack.hysteresis(), of_hysteresis.as_ref())?;
        let viscous = self.part(joint, stack.viscous(), identity("viscous", stack.viscous()).as_ref())?;
        let levels: Vec<Vec<f64>> = self
            .pieces
            .iter()
            .zip(loads)
            .map(|(p, load)| {
                unfiltered(
                    stack.coulomb(),
                    self.rigid.segment(p.recording, p.segment),
                    joint,
                    load.joint(joint),
                )
            })
            .collect::<Result<_, _>>()?;
        let mut products = Vec::new();
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
            products.push(if is(1.0) {
                Products::Same
            } else if is(0.0) {
                Products::Other(hysteresis.iter().map(Split::zero).collect())
            } else {
                Products::Other(self.products(joint, &level, stack.hysteresis(), of_hysteresis.as_ref())?)
            });
        }
        Ok(StackSplits { hysteresis, viscous, products })
    }

    /// The split columns of a model that does not read the load torque.
    fn part(
        &self,
        joint: usize,
        model: &dyn JointModel,
        identity: Option<&String>,
    ) -> Result<Arc<Vec<Split>>, CalibrationError> {
        let key = identity.map(|identity| (joint, identity.clone()));
        let bytes = |splits: &Vec<Split>| splits.iter().map(|s| 8 * (s.along.len() + s.beyond.len())).sum();
        self.parts.get(key, bytes, || {
            let mut joined = vec![Vec::with_capacity(self.rows(joint)); model.columns().len()];
            for piece in &self.pieces {
                let place = (piece.recording, piece.segment, joint);
                let part = self.rigid.part(place, model, identity.cloned())?;
                joined.iter_mut().zip(&part.rows).for_each(|(to, rows)| piece.append(joint, rows, to));
            }
            Ok(self.joints[joint].split(&joined.iter().map(Vec::as_slice).collect::<Vec<_>>()))
        })
    }

    /// The split products of a Coulomb column, given for each piece, with each hysteresis column.
    fn products(
        &self,
        joint: usize,
        level: &[&[f64]],
        hysteresis: &dyn JointModel,
        identity: Option<&String>,
    ) -> Result<Vec<Split>, CalibrationError> {
        let count = hysteresis.columns().len();
        let mut joined = vec![Vec::with_capacity(self.rows(joint)); count];
        for (piece, level) in self.pieces.iter().zip(level) {
            let place = (piece.recording, piece.segment, joint);
            let part = self.rigid.part(place, hysteresis, identity.cloned())?;
            let mut product = Vec::with_capacity(count * level.len());
            for column in part.columns() {
                product.extend(column.iter().zip(*level).map(|(h, l)| l * h));
            }
            let rows = filtered(self.rigid.segment(piece.recording, piece.segment), &product, count)?;
            joined.iter_mut().zip(&rows).for_each(|(to, rows)| piece.append(joint, rows, to));
        }
        Ok(self.joints[joint].split(&joined.iter().map(Vec::as_slice).collect::<Vec<_>>()))
    }
}
