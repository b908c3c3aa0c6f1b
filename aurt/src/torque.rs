//! Torques of whole motions.

use aurt_calibration::Calibration;
use aurt_traits::{
    ArmSeries, ArmTerm, ColumnGroup, Columns, Invariant, JointSeries, JointStack, LoadTorque, ModelError,
    MotionView, RigidBodyRegressor, RobotModel,
};

use crate::calibrated_file::CalibratedModel;
use crate::error::Error;

/// Samples that are evaluated together: their columns stay in the fastest cache.
const AT_ONCE: usize = 256;

impl CalibratedModel {
    /// Torques (or currents) for a motion, as `[joint][sample]`, in [`Calibration::unit`](aurt_calibration::Calibration).
    /// Friction with memory starts at the first sample.
    ///
    /// τ = τ_RBD(q, q̇, q̈) + f_C(τ_J)·H(z, q̇) + f_v(q̇) + arm terms; τ_RBD by the batched inverse dynamics of
    /// [`RigidBodyRegressor::torque`](aurt_traits::RigidBodyRegressor::torque) with the standard parameters that stand for
    /// the base parameters at their values and all others at zero.
    ///
    /// # Errors
    /// [`ModelError::Count`] for another number of joints; whatever a model reports.
    pub fn torque(&self, motion: MotionView<'_>) -> Result<Vec<Vec<f64>>, Error> {
        let mut series = TorqueSeries::new(self)?;
        let mut torque = vec![Vec::with_capacity(motion.samples()); self.model.joints()];
        for first in (0..motion.samples()).step_by(AT_ONCE) {
            let part = motion.slice(first..(first + AT_ONCE).min(motion.samples()));
            let (values, stride) = series.next(part)?;
            for (joint, all) in torque.iter_mut().enumerate() {
                all.extend_from_slice(&values[joint * stride..joint * stride + part.samples()]);
            }
        }
        Ok(torque)
    }
}

/// Torques of a calibrated model for consecutive stretches of one motion.
///
/// ```
/// use aurt::{TorqueSeries, prelude::*, traits::Motion as Series};
/// # use aurt::{simulate, simulation::{Motion, Scenario, robots}};
///
/// # let machine = robots::two_link();
/// # let motion = Motion::MultiSine { duration_s: 5.0, harmonics: 5, top_hz: 1.0, share: 0.6 };
/// # let recording = simulate(&Scenario::new(machine.clone(), motion.plan(&machine, 1)?, 1))?;
/// # let robot = Robot::from_mdh(&machine.mdh_csv(), machine.gravity_m_s2)?;
/// # let model = Calibrator::new(robot.model().build()?).calibration(&recording).calibrate()?.calibrated;
/// let mut torques = TorqueSeries::new(&model)?;
/// // Three samples of two joints, joint after joint.
/// let motion = Series::new(2, vec![0.0, 0.1, 0.2], vec![0.1; 6], vec![0.0; 6], vec![0.0; 6])?;
/// let (torque, stride) = torques.next(motion.view())?;
/// let of_joint_1 = &torque[stride..stride + 3];
/// assert_eq!(of_joint_1.len(), 3);
/// # Ok::<(), aurt::Error>(())
/// ```
#[derive(Debug)]
pub struct TorqueSeries<'m> {
    model: &'m RobotModel,
    coefficients: Vec<f64>,
    /// Weights of the load torque.
    weights: Vec<f64>,
    /// Standard parameters of the torque, and of the load torque where that has others.
    standard: Vec<f64>,
    load_standard: Option<Vec<f64>>,
    /// Whether anything asks for the load torque.
    reads_load: bool,
    state: State,
    torque: Vec<f64>,
    load: Vec<f64>,
    columns: Vec<f64>,
}

/// What friction and arm terms remember between stretches.
#[derive(Debug, Default)]
struct State {
    started: bool,
    stacks: Vec<Vec<f64>>,
    terms: Vec<Vec<f64>>,
}

impl<'m> TorqueSeries<'m> {
    /// The torques of a model before a motion begins.
    ///
    /// # Errors
    /// [`ModelError::Count`] if the coefficients are not the model's.
    pub fn new(calibrated: &'m CalibratedModel) -> Result<Self, ModelError> {
        Self::of(&calibrated.model, &calibrated.calibration)
    }

    fn of(model: &'m RobotModel, calibration: &Calibration) -> Result<Self, ModelError> {
        let coefficients = calibration.coefficients();
        let (expected, base) = (model.parameters().len(), model.base());
        let weights = match &calibration.load {
            LoadTorque::Fitted(weights) => weights.clone(),
            LoadTorque::Literal => {
                let is_base = |k: usize| if k < base.len() { 1.0 } else { 0.0 };
                (0..expected).map(is_base).collect()
            }
        };
        for (what, found) in
            [("coefficients", coefficients.len()), ("weights of the load torque", weights.len())]
        {
            if found != expected {
                return Err(ModelError::Count { what: what.into(), expected, found });
            }
        }
        let standard = |values: &[f64]| {
            let mut standard = vec![0.0; model.rigid_body().standard_parameters().len()];
            for (column, value) in base.columns.iter().zip(values) {
                standard[*column] = *value;
            }
            standard
        };
        let same = weights[..base.len()] == coefficients[..base.len()];
        let reads_load = !model.arm_terms().is_empty() || model.stacks().iter().any(reads_load);
        Ok(Self {
            load_standard: (reads_load && !same).then(|| standard(&weights)),
            standard: standard(&coefficients),
            state: State {
                started: false,
                stacks: vec![Vec::new(); model.joints()],
                terms: vec![Vec::new(); model.arm_terms().len()],
            },
            torque: Vec::new(),
            load: Vec::new(),
            columns: Vec::new(),
            model,
            coefficients,
            weights,
            reads_load,
        })
    }

    /// Torques (or currents) for the next stretch of the motion, and the distance between those of two joints: joint j's
    /// at sample k is `torque[j · stride + k]`. Stretches of some hundred samples are fastest.
    ///
    /// # Errors
    /// [`ModelError::Count`] for another number of joints; whatever a model reports.
    pub fn next(&mut self, motion: MotionView<'_>) -> Result<(&[f64], usize), ModelError> {
        let (joints, samples) = (self.model.joints(), motion.samples());
        if motion.joints() != joints {
            return Err(ModelError::Count {
                what: "joints of the motion".into(),
                expected: joints,
                found: motion.joints(),
            });
        }
        let padded = samples.next_multiple_of(8);
        let stride = if padded.is_multiple_of(64) { padded + 8 } else { padded };
        self.torque.resize(joints * stride, 0.0);
        self.load.resize(joints * stride, 0.0);
        if samples == 0 {
            return Ok((&self.torque, stride));
        }
        let bodies = self.model.rigid_body();
        bodies.torque(motion, &self.standard, &mut self.torque, stride);
        match &self.load_standard {
            Some(standard) => bodies.torque(motion, standard, &mut self.load, stride),
            None if self.reads_load => self.load.copy_from_slice(&self.torque),
            None => {}
        }
        self.add_terms(true, motion, stride, &**bodies, |_| true)?;
        for joint in 0..joints {
            self.add_friction(joint, motion, stride)?;
        }
        self.add_terms(false, motion, stride, &**bodies, |_| true)?;
        self.state.started = true;
        Ok((&self.torque, stride))
    }

    fn add_friction(
        &mut self,
        joint: usize,
        motion: MotionView<'_>,
        stride: usize,
    ) -> Result<(), ModelError> {
        let (samples, stack) = (motion.samples(), &self.model.stacks()[joint]);
        let series = JointSeries::of(motion, joint, &self.load[joint * stride..joint * stride + samples]);
        if !self.state.started {
            self.state.stacks[joint] = stack.initial_state(&series.slice(0..1));
        }
        let coefficients = &self.coefficients[self.model.group(ColumnGroup::JointDynamics(joint))];
        self.columns.resize(coefficients.len() * stride, 0.0);
        let mut columns = Columns::new(&mut self.columns, coefficients.len(), samples, stride);
        stack.evaluate(&series, &mut self.state.stacks[joint], &mut columns)?;
        let torque = &mut self.torque[joint * stride..joint * stride + samples];
        for (k, coefficient) in coefficients.iter().enumerate() {
            add(torque, *coefficient, columns.column(k));
        }
        Ok(())
    }

    /// As [`Self::next`] of `bodies`, those of the model under any gravity, and of arm terms without memory; without the
    /// friction of joints.
    pub(crate) fn without_friction(
        &mut self,
        motion: MotionView<'_>,
        bodies: &dyn RigidBodyRegressor,
    ) -> Result<(&[f64], usize), ModelError> {
        let (joints, stride) = (self.model.joints(), motion.samples());
        self.torque.resize(joints * stride, 0.0);
        self.load.resize(joints * stride, 0.0);
        bodies.torque(motion, &self.standard, &mut self.torque, stride);
        bodies.torque(motion, self.load_standard.as_ref().unwrap_or(&self.standard), &mut self.load, stride);
        for loads in [true, false] {
            self.add_terms(loads, motion, stride, bodies, |term| {
                term.invariants().contains(Invariant::Memoryless)
            })?;
        }
        Ok((&self.torque, stride))
    }

    /// Adds the arm terms that are loads, or those that are not, of those that `choose` takes.
    fn add_terms(
        &mut self,
        loads: bool,
        motion: MotionView<'_>,
        stride: usize,
        bodies: &dyn RigidBodyRegressor,
        choose: impl Fn(&dyn ArmTerm) -> bool,
    ) -> Result<(), ModelError> {
        let (model, samples) = (self.model, motion.samples());
        let terms = model.arm_terms().iter().enumerate();
        for (k, term) in terms.filter(|(_, term)| term.is_load() == loads && choose(&***term)) {
            // Terms that are loads are evaluated before the load torque is complete, and see none of it.
            let group = model.group(ColumnGroup::ArmTerm(k));
            let acting = term.joints(model.joints());
            let count = acting.len() * group.len();
            self.columns.resize(count * stride, 0.0);
            let nothing;
            let load_torque = if loads {
                nothing = vec![0.0; self.load.len()];
                &nothing
            } else {
                &self.load
            };
            let series = ArmSeries { motion, load_torque, load_stride: stride, rigid_body: bodies };
            if !self.state.started {
                let first = ArmSeries { motion: motion.slice(0..1), ..series };
                self.state.terms[k] = ArmTerm::initial_state(&**term, &first);
            }
            let mut columns = Columns::new(&mut self.columns, count, samples, stride);
            term.evaluate(&series, &mut self.state.terms[k], &mut columns)?;
            for (i, joint) in acting.iter().enumerate() {
                let rows = joint * stride..joint * stride + samples;
                for (c, column) in group.clone().enumerate() {
                    let values = columns.column(i * group.len() + c);
                    add(&mut self.torque[rows.clone()], self.coefficients[column], values);
                    if loads {
                        add(&mut self.load[rows.clone()], self.weights[column], values);
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether anything that a stack gives depends on the load torque.
fn reads_load(stack: &JointStack) -> bool {
    stack.coulomb().reads_load() || stack.hysteresis().reads_load() || stack.viscous().reads_load()
}

fn add(sum: &mut [f64], coefficient: f64, values: &[f64]) {
    sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += coefficient * value);
}
