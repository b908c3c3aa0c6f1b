//! Predicting one sample at a time, in a control loop.

use aurt_calibration::Calibration;
use aurt_rbd::{ChainDynamics, SerialChain};
use aurt_traits::{
    ArmSeries, ColumnGroup, Columns, JointSeries, JointStack, LoadTorque, ModelError, MotionView,
    RigidBodyRegressor, RobotModel,
};
use std::any::Any;
use std::sync::Arc;

use crate::error::Error;

/// Torques of a calibrated model, sample by sample, with the memory of its friction.
///
/// τ = τ_RBD(q, q̇, q̈) + f_C(τ_J)·H(z, q̇) + f_v(q̇) + arm terms, τ_RBD with the standard parameters that stand for the
/// base parameters at their values and all others at zero: of a serial chain by the recursive Newton–Euler algorithm, of
/// other rigid bodies by [`RigidBodyRegressor::torque`].
///
/// From the second sample on, [`Self::torque`] of a serial chain allocates no memory for rigid bodies and the friction
/// models that come with AURT, except for `maxwell_slip` and `gms`, which list their thresholds for every sample. Arm
/// terms may allocate: each lists its joints, and `payload` and `base_tilt` evaluate the rigid bodies.
#[derive(Debug, Clone)]
pub struct Predictor {
    model: RobotModel,
    bodies: Bodies,
    /// The bodies of which the load torque is made; none if these are the same.
    load_bodies: Option<Bodies>,
    joints: Vec<JointPart>,
    terms: Vec<TermPart>,
    started: bool,
    time_s: f64,
    load_torque: Vec<f64>,
    torque: Vec<f64>,
}

/// Rigid bodies with values of their standard parameters.
#[derive(Debug, Clone)]
enum Bodies {
    Chain(Box<ChainDynamics>),
    /// Bodies of any other kind.
    Regressor {
        regressor: Arc<dyn RigidBodyRegressor>,
        standard: Vec<f64>,
    },
}

impl Bodies {
    fn new(model: &RobotModel, value: impl Fn(usize) -> f64) -> Result<Self, Error> {
        let regressor = model.rigid_body();
        let mut standard = vec![0.0; regressor.standard_parameters().len()];
        for (k, column) in model.base().columns.iter().enumerate() {
            standard[*column] = value(k);
        }
        let any: &dyn Any = &**regressor;
        Ok(match any.downcast_ref::<SerialChain>() {
            Some(chain) => Self::Chain(Box::new(ChainDynamics::new(chain.clone(), &standard)?)),
            None => Self::Regressor { regressor: regressor.clone(), standard },
        })
    }

    fn torque(&mut self, motion: MotionView<'_>, [q, qd, qdd]: [&[f64]; 3], torque: &mut [f64]) {
        match self {
            Self::Chain(chain) => chain.inverse_dynamics(q, qd, qdd, torque),
            Self::Regressor { regressor, standard } => regressor.torque(motion, standard, torque, 1),
        }
    }
}

/// A joint's stack with its coefficients, memory and room for its columns.
#[derive(Debug, Clone)]
struct JointPart {
    coulomb: Vec<f64>,
    hysteresis: Vec<f64>,
    viscous: Vec<f64>,
    coefficients: Vec<f64>,
    state: Vec<f64>,
    /// Numbers of state variables of the Coulomb level and of the hysteresis.
    states: [usize; 2],
}

/// An arm term with its coefficients, memory and room for its columns.
#[derive(Debug, Clone)]
struct TermPart {
    acting: Vec<usize>,
    coefficients: Vec<f64>,
    /// Weights of its columns in the load torque.
    weights: Vec<f64>,
    is_load: bool,
    columns: Vec<f64>,
    state: Vec<f64>,
}

impl Predictor {
    /// A predictor of a model with coefficients.
    ///
    /// # Errors
    /// Coefficients that are not finite.
    pub fn new(model: &RobotModel, calibration: &Calibration) -> Result<Self, Error> {
        let coefficients = calibration.coefficients();
        let (load_bodies, load_weights) = match &calibration.load {
            LoadTorque::Literal => (Some(Bodies::new(model, |_| 1.0)?), None),
            LoadTorque::Fitted(weights) => {
                let same = weights.iter().zip(&coefficients).take(model.base().len()).all(|(a, b)| a == b);
                let other = if same { None } else { Some(Bodies::new(model, |k| weights[k])?) };
                (other, Some(weights.clone()))
            }
        };
        let joints = model.joints();
        let of = |group| coefficients[model.group(group)].to_vec();
        let stack = |(j, stack): (usize, &JointStack)| {
            let (c, h) = (stack.coulomb().columns().len(), stack.hysteresis().columns().len());
            JointPart {
                coulomb: vec![0.0; c],
                hysteresis: vec![0.0; h],
                viscous: vec![0.0; stack.viscous().columns().len()],
                coefficients: of(ColumnGroup::JointDynamics(j)),
                state: Vec::new(),
                states: [stack.coulomb().state_len(), stack.hysteresis().state_len()],
            }
        };
        let terms = model.arm_terms().iter().enumerate().map(|(k, term)| {
            let acting = term.joints(joints);
            let own = of(ColumnGroup::ArmTerm(k));
            let weights = load_weights.as_ref().map_or_else(
                || vec![0.0; own.len()],
                |weights| weights[model.group(ColumnGroup::ArmTerm(k))].to_vec(),
            );
            let columns = vec![0.0; acting.len() * own.len()];
            TermPart {
                acting,
                coefficients: own,
                weights,
                is_load: term.is_load(),
                columns,
                state: Vec::new(),
            }
        });
        let terms = terms.collect();
        Ok(Self {
            bodies: Bodies::new(model, |k| coefficients[k])?,
            load_bodies,
            joints: model.stacks().iter().enumerate().map(stack).collect(),
            terms,
            started: false,
            time_s: 0.0,
            load_torque: vec![0.0; joints],
            torque: vec![0.0; joints],
            model: model.clone(),
        })
    }

    /// Torques (or currents) of all joints for a sample `dt_s` after the last one; of the first sample `dt_s` has no
    /// effect.
    ///
    /// # Errors
    /// [`ModelError::Count`] for another number of joints; whatever a model reports.
    pub fn torque(
        &mut self,
        dt_s: f64,
        q_rad: &[f64],
        qd_rad_s: &[f64],
        qdd_rad_s2: &[f64],
    ) -> Result<&[f64], ModelError> {
        let joints = self.joints.len();
        for (what, series) in [("positions", q_rad), ("velocities", qd_rad_s), ("accelerations", qdd_rad_s2)]
        {
            if series.len() != joints {
                return Err(ModelError::Count { what: what.into(), expected: joints, found: series.len() });
            }
        }
        self.time_s += if self.started { dt_s } else { 0.0 };
        let time_s = self.time_s;
        let motion = MotionView::of_sample(&time_s, q_rad, qd_rad_s, qdd_rad_s2);
        let sample = [q_rad, qd_rad_s, qdd_rad_s2];
        self.bodies.torque(motion, sample, &mut self.torque);
        match &mut self.load_bodies {
            Some(bodies) => bodies.torque(motion, sample, &mut self.load_torque),
            None => self.load_torque.copy_from_slice(&self.torque),
        }
        self.add_terms(true, motion)?;
        for (j, (part, stack)) in self.joints.iter_mut().zip(self.model.stacks()).enumerate() {
            let series = JointSeries::of(motion, j, &self.load_torque[j..=j]);
            if !self.started {
                part.state = stack.initial_state(&series);
            }
            self.torque[j] += part.evaluate(stack, &series)?;
        }
        self.add_terms(false, motion)?;
        self.started = true;
        Ok(&self.torque)
    }

    /// Forgets the past: the next sample is a first one.
    pub fn reset(&mut self) {
        self.started = false;
        self.time_s = 0.0;
    }

    fn add_terms(&mut self, loads: bool, motion: MotionView<'_>) -> Result<(), ModelError> {
        let Self { model, terms, load_torque, torque, started, .. } = self;
        for (part, term) in terms.iter_mut().zip(model.arm_terms()).filter(|(part, _)| part.is_load == loads)
        {
            let series = ArmSeries { motion, load_torque, load_stride: 1, rigid_body: &**model.rigid_body() };
            if !*started {
                part.state = term.initial_state(&series);
            }
            let count = part.columns.len();
            term.evaluate(&series, &mut part.state, &mut Columns::new(&mut part.columns, count, 1, 1))?;
            let own = part.coefficients.len();
            for (joint, columns) in part.acting.iter().zip(part.columns.chunks_exact(own.max(1))) {
                torque[*joint] += dot(&part.coefficients, columns);
                load_torque[*joint] += dot(&part.weights, columns);
            }
        }
        Ok(())
    }
}

impl JointPart {
    fn evaluate(&mut self, stack: &JointStack, series: &JointSeries<'_>) -> Result<f64, ModelError> {
        let (c, h, v) = (self.coulomb.len(), self.hysteresis.len(), self.viscous.len());
        let (coulomb_state, rest) = self.state.split_at_mut(self.states[0]);
        let (hysteresis_state, viscous_state) = rest.split_at_mut(self.states[1]);
        stack.coulomb().evaluate(series, coulomb_state, &mut Columns::new(&mut self.coulomb, c, 1, 1))?;
        stack.hysteresis().evaluate(
            series,
            hysteresis_state,
            &mut Columns::new(&mut self.hysteresis, h, 1, 1),
        )?;
        stack.viscous().evaluate(series, viscous_state, &mut Columns::new(&mut self.viscous, v, 1, 1))?;
        let (products, linear) = self.coefficients.split_at(c * h);
        let mut sum = dot(linear, &self.viscous);
        for (level, row) in self.coulomb.iter().zip(products.chunks_exact(h.max(1))) {
            sum += level * dot(row, &self.hysteresis);
        }
        Ok(sum)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
