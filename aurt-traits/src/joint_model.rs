use std::fmt::Debug;

use crate::{Columns, Invariant, Invariants, JointSeries, ModelError, Parameter, ShapeParameter};

/// A friction model of one joint: columns over a series, linear in its coefficients.
///
/// The model's force is Σ_k coefficient_k · column_k(series, state). What a model remembers is in `state`,
/// created by [`Self::initial_state`] and carried from batch to batch, so that a series may be split anywhere:
/// evaluating two halves one after the other gives what evaluating the whole gives.
///
/// Implement this and one of [`CoulombModel`], [`HysteresisModel`], [`ViscousBasis`].
pub trait JointModel: Debug + Send + Sync {
    /// The registered name, as `model = "…"` in an experiment spells it.
    fn name(&self) -> &str;

    /// The linear coefficients, one for each output column.
    fn columns(&self) -> Vec<Parameter>;

    /// What the model declares of itself; the property tests hold it to that.
    fn invariants(&self) -> Invariants;

    /// Whether anything that the model gives depends on τ_J. The columns of a model that says no are computed once for
    /// all calculations that differ in τ_J alone; the property tests hold it to that.
    fn reads_load(&self) -> bool {
        true
    }

    /// The parameters in which the model is not linear.
    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        Vec::new()
    }

    /// Sets all shape parameters, in the order of [`Self::shape_parameters`].
    ///
    /// # Errors
    /// If the number of values or a value does not fit.
    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        if values.is_empty() {
            return Ok(());
        }
        Err(ModelError::count(format!("shape parameters of `{}`", self.name()), 0, values.len()))
    }

    /// Whether the configuration makes sense (powers positive, thresholds ascending, …).
    ///
    /// # Errors
    /// Every complaint, not only the first.
    fn validate(&self) -> Result<(), Vec<ModelError>> {
        Ok(())
    }

    /// Number of state variables.
    fn state_len(&self) -> usize {
        0
    }

    /// The state before the first sample of a series (`first` holds that sample alone).
    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        let _ = first;
        vec![0.0; self.state_len()]
    }

    /// Writes every column over the whole series and moves `state` to its end.
    ///
    /// A model with memory integrates from the previous sample, whatever it needs of which (time, position)
    /// it keeps in `state`.
    ///
    /// # Errors
    /// [`ModelError::Evaluation`] where the model cannot be evaluated; the output is then unspecified.
    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError>;
}

/// Coulomb level f_C(τ_J) of equation (6): even in the load torque and strictly positive.
#[typetag::serde(tag = "model")]
pub trait CoulombModel: JointModel {
    /// A copy, for variants with other shape parameters.
    fn boxed_clone(&self) -> Box<dyn CoulombModel>;
}

/// Generalised hysteresis H(z, q̇) of equation (6): bounded by one in magnitude.
#[typetag::serde(tag = "model")]
pub trait HysteresisModel: JointModel {
    /// A copy, for variants with other shape parameters.
    fn boxed_clone(&self) -> Box<dyn HysteresisModel>;
}

/// Viscous friction f_v(q̇) of equation (6): odd, continuous and of the sign of velocity.
#[typetag::serde(tag = "model")]
pub trait ViscousBasis: JointModel {
    /// A copy, for variants with other shape parameters.
    fn boxed_clone(&self) -> Box<dyn ViscousBasis>;
}

macro_rules! cloned_in_boxes {
    ($($model:ident),+) => {
        $(impl Clone for Box<dyn $model> {
            fn clone(&self) -> Self {
                (**self).boxed_clone()
            }
        })+
    };
}
cloned_in_boxes!(CoulombModel, HysteresisModel, ViscousBasis);

/// The joint dynamics of one joint, τ_JD = f_C(τ_J)·H(z, q̇) + f_v(q̇) (equation 6), as columns:
/// every Coulomb column times every hysteresis column, each product with a coefficient of its own
/// (`c_i.h_k`, Coulomb index running slower), then the viscous columns.
#[derive(Debug, Clone)]
pub struct JointStack {
    coulomb: Box<dyn CoulombModel>,
    hysteresis: Box<dyn HysteresisModel>,
    viscous: Box<dyn ViscousBasis>,
}

impl JointStack {
    /// A stack of three models.
    ///
    /// # Errors
    /// [`ModelError::SlotRefused`] for a model that does not declare what its slot of equation (6) asks for,
    /// and whatever the models' own validation says.
    pub fn new(
        coulomb: Box<dyn CoulombModel>,
        hysteresis: Box<dyn HysteresisModel>,
        viscous: Box<dyn ViscousBasis>,
    ) -> Result<Self, Vec<ModelError>> {
        let mut errors = Vec::new();
        let slots: [(&dyn JointModel, &'static str, &[Invariant]); 3] = [
            (&*coulomb, "coulomb", &[Invariant::EvenInLoad, Invariant::Positive]),
            (&*hysteresis, "hysteresis", &[Invariant::BoundedByOne]),
            (
                &*viscous,
                "viscous",
                &[Invariant::OddInVelocity, Invariant::ContinuousInVelocity, Invariant::SignOfVelocity],
            ),
        ];
        for (model, slot, required) in slots {
            let declared = model.invariants();
            errors.extend(required.iter().filter(|i| !declared.contains(**i)).map(|i| {
                ModelError::SlotRefused {
                    model: model.name().to_owned(),
                    slot,
                    invariant: i.in_words(),
                    remedy: "enter it as an arm term, outside equation (6), instead".to_owned(),
                }
            }));
            if let Err(complaints) = model.validate() {
                errors.extend(complaints);
            }
        }
        if errors.is_empty() { Ok(Self { coulomb, hysteresis, viscous }) } else { Err(errors) }
    }

    /// The Coulomb model.
    pub fn coulomb(&self) -> &dyn CoulombModel {
        &*self.coulomb
    }

    /// The hysteresis model.
    pub fn hysteresis(&self) -> &dyn HysteresisModel {
        &*self.hysteresis
    }

    /// The viscous model.
    pub fn viscous(&self) -> &dyn ViscousBasis {
        &*self.viscous
    }

    fn models(&self) -> [&dyn JointModel; 3] {
        [&*self.coulomb, &*self.hysteresis, &*self.viscous]
    }

    /// The stack's coefficients, in column order.
    pub fn columns(&self) -> Vec<Parameter> {
        let hysteresis = self.hysteresis.columns();
        let mut columns = Vec::new();
        for c in self.coulomb.columns() {
            for h in &hysteresis {
                let name =
                    if hysteresis.len() == 1 { c.name.clone() } else { format!("{}.{}", c.name, h.name) };
                columns.push(Parameter::new(name, c.unit.clone()));
            }
        }
        columns.extend(self.viscous.columns());
        columns
    }

    /// The shape parameters of the three models, Coulomb first.
    pub fn shape_parameters(&self) -> Vec<ShapeParameter> {
        self.models().into_iter().flat_map(JointModel::shape_parameters).collect()
    }

    /// Sets all shape parameters, in the order of [`Self::shape_parameters`].
    ///
    /// # Errors
    /// As the models' [`JointModel::set_shape`].
    pub fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        let [c, h, v] = self.models().map(|model| model.shape_parameters().len());
        if values.len() != c + h + v {
            return Err(ModelError::count("shape parameters of a joint", c + h + v, values.len()));
        }
        self.coulomb.set_shape(&values[..c])?;
        self.hysteresis.set_shape(&values[c..c + h])?;
        self.viscous.set_shape(&values[c + h..])
    }

    /// The state before the first sample of a series.
    pub fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        self.models().into_iter().flat_map(|model| model.initial_state(first)).collect()
    }

    /// Writes all columns over the series and moves `state` to its end. Shapes: `out` has
    /// `self.columns().len()` columns of `series.samples()` values.
    ///
    /// # Errors
    /// Whatever a model reports.
    pub fn evaluate(
        &self,
        series: &JointSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        let (samples, c, h) =
            (series.samples(), self.coulomb.columns().len(), self.hysteresis.columns().len());
        let (coulomb_state, rest) = state.split_at_mut(self.coulomb.state_len());
        let (hysteresis_state, viscous_state) = rest.split_at_mut(self.hysteresis.state_len());
        let mut factors = vec![0.0; (c + h) * samples];
        let (levels, shapes) = factors.split_at_mut(c * samples);
        self.coulomb.evaluate(series, coulomb_state, &mut Columns::new(levels, c, samples, samples))?;
        self.hysteresis.evaluate(series, hysteresis_state, &mut Columns::new(shapes, h, samples, samples))?;
        for i in 0..c {
            let level = &levels[i * samples..(i + 1) * samples];
            for k in 0..h {
                let shape = &shapes[k * samples..(k + 1) * samples];
                for ((o, l), s) in out.column_mut(i * h + k).iter_mut().zip(level).zip(shape) {
                    *o = l * s;
                }
            }
        }
        let viscous_columns = out.columns() - c * h;
        let (data, stride) = out.raw_mut();
        let mut viscous = Columns::new(&mut data[c * h * stride..], viscous_columns, samples, stride);
        self.viscous.evaluate(series, viscous_state, &mut viscous)
    }
}
