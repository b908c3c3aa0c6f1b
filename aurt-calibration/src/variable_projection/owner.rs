use aurt_traits::{ArmTerm, ColumnGroup, JointStack, ModelError, RobotModel, Scale, ShapeParameter};

use crate::row_cache::Source;

/// A joint's stack or an arm term that has shape parameters.
#[derive(Debug, Clone)]
pub(super) struct Owner {
    /// Its column group.
    pub group: ColumnGroup,
    /// Its shape parameters at their values when the search begins.
    pub shapes: Vec<ShapeParameter>,
    /// The model that has each of them.
    pub models: Vec<String>,
    variant: Variant,
}

#[derive(Debug, Clone)]
pub(super) enum Variant {
    Stack(JointStack),
    Term(Box<dyn ArmTerm>),
}

/// The models of a robot that have shape parameters, each named once: those that
/// [`calibrate_shapes`](crate::calibrate_shapes) would search.
pub fn shapes_of(model: &RobotModel) -> Vec<String> {
    let mut names: Vec<String> = Owner::all(model).into_iter().flat_map(|owner| owner.models).collect();
    names.sort();
    names.dedup();
    names
}

impl Owner {
    pub(super) fn all(model: &RobotModel) -> Vec<Self> {
        let stacks = model.stacks().iter().enumerate().map(|(joint, stack)| {
            let parts: [(&str, Vec<ShapeParameter>); 3] = [
                (stack.coulomb().name(), stack.coulomb().shape_parameters()),
                (stack.hysteresis().name(), stack.hysteresis().shape_parameters()),
                (stack.viscous().name(), stack.viscous().shape_parameters()),
            ];
            let models = parts.iter().flat_map(|(name, shapes)| vec![(*name).to_owned(); shapes.len()]);
            Self {
                group: ColumnGroup::JointDynamics(joint),
                models: models.collect(),
                shapes: stack.shape_parameters(),
                variant: Variant::Stack(stack.clone()),
            }
        });
        let terms = model.arm_terms().iter().enumerate().map(|(k, term)| {
            let shapes = term.shape_parameters();
            Self {
                group: ColumnGroup::ArmTerm(k),
                models: vec![term.name().to_owned(); shapes.len()],
                shapes,
                variant: Variant::Term(term.clone()),
            }
        });
        stacks.chain(terms).filter(|owner| !owner.shapes.is_empty()).collect()
    }

    /// The present shapes as shares of their ranges.
    pub(super) fn units(&self) -> Vec<f64> {
        self.shapes.iter().map(unit).collect()
    }

    /// The owner with its shapes at these shares of their ranges.
    pub(super) fn at(&self, units: &[f64]) -> Result<Variant, ModelError> {
        let values: Vec<f64> = self.shapes.iter().zip(units).map(|(s, u)| value(s, *u)).collect();
        let mut variant = self.variant.clone();
        match &mut variant {
            Variant::Stack(stack) => stack.set_shape(&values)?,
            Variant::Term(term) => term.set_shape(&values)?,
        }
        Ok(variant)
    }
}

impl Variant {
    /// What evaluates the variant's columns in the place of the model's own.
    pub(super) fn source<'m>(&'m self, model: &'m RobotModel, group: ColumnGroup) -> Source<'m> {
        let first_column = model.group(group).start;
        match self {
            Self::Stack(stack) => {
                let joint = if let ColumnGroup::JointDynamics(joint) = group { joint } else { 0 };
                Source::Stack { joint, stack, first_column }
            }
            Self::Term(term) => {
                Source::Term { term: &**term, first_column, rigid_body: &**model.rigid_body() }
            }
        }
    }

    pub(super) fn put_into(
        self,
        model: &RobotModel,
        group: ColumnGroup,
    ) -> Result<RobotModel, Vec<ModelError>> {
        let mut stacks = model.stacks().to_vec();
        let mut terms = model.arm_terms().to_vec();
        match (self, group) {
            (Self::Stack(stack), ColumnGroup::JointDynamics(joint)) => stacks[joint] = stack,
            (Self::Term(term), ColumnGroup::ArmTerm(k)) => terms[k] = term,
            _ => {}
        }
        RobotModel::new(model.rigid_body().clone(), model.base().clone(), stacks, terms)
    }
}

/// Where a shape's value lies in its range: 0 at the lower bound, 1 at the upper.
fn unit(shape: &ShapeParameter) -> f64 {
    let share = match shape.scale {
        Scale::Linear => (shape.value - shape.lower) / (shape.upper - shape.lower),
        Scale::Logarithmic => libm::log(shape.value / shape.lower) / libm::log(shape.upper / shape.lower),
    };
    if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 }
}

/// The value at a share of a shape's range.
pub(super) fn value(shape: &ShapeParameter, unit: f64) -> f64 {
    let value = match shape.scale {
        Scale::Linear => shape.lower + unit * (shape.upper - shape.lower),
        Scale::Logarithmic => shape.lower * libm::pow(shape.upper / shape.lower, unit),
    };
    value.clamp(shape.lower, shape.upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_and_values_are_each_other_s_inverse() {
        for scale in [Scale::Linear, Scale::Logarithmic] {
            for v in [0.001, 0.0234, 0.7, 1.0] {
                let shape = ShapeParameter {
                    name: "v".into(),
                    unit: "rad/s".into(),
                    value: v,
                    lower: 0.001,
                    upper: 1.0,
                    scale,
                };
                assert!((value(&shape, unit(&shape)) - v).abs() < 1e-15, "{scale:?} {v}");
            }
        }
    }
}
