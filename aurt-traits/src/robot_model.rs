use std::ops::Range;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::{
    ArmSeries, ArmTerm, BaseParameters, Columns, JointSeries, JointStack, MeasurementUnit, ModelError,
    MotionView, Parameter, RegressorTile, RigidBodyRegressor, RobotNames,
};

/// The robot dynamics as one regressor, linear in its coefficients:
/// τ = Y_RBD(q, q̇, q̈) ζ_RBD + Y_JD ζ_JD (paper, equations 1–6), plus arm terms.
///
/// The coefficients are ordered: base inertial parameters, the joint dynamics joint after joint, the arm terms.
/// Rows are sparse (a link loads only the joints that carry it, a stack only its own joint), so a [`RobotTile`]
/// holds for each joint the columns that can be non-zero there: [`Self::row_columns`].
#[derive(Debug, Clone)]
pub struct RobotModel {
    rigid_body: Arc<dyn RigidBodyRegressor>,
    base: BaseParameters,
    stacks: Vec<JointStack>,
    arm_terms: Vec<Box<dyn ArmTerm>>,
    parameters: Vec<Parameter>,
    groups: Vec<(ColumnGroup, Range<usize>)>,
    rows: Vec<Vec<usize>>,
    row_start: Vec<usize>,
    destination: Vec<u32>,
    known_bodies: Option<KnownBodies>,
}

/// What is known of the rigid bodies before any recording, from CAD or a description.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownBodies {
    /// Values of all standard parameters, in the order of [`RigidBodyRegressor::standard_parameters`].
    pub standard: Vec<f64>,
    /// How strongly estimates that can use them are pulled towards them: 1/σ² of their relative standard deviation σ; with zero
    /// they decide only what the data leave open.
    pub weight: f64,
}

impl KnownBodies {
    /// The weight where nothing else is said: masses and second moments are known to 20 %.
    pub const USUAL_WEIGHT: f64 = 25.0;
}

/// What a run of coefficients belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColumnGroup {
    /// The base inertial parameters.
    RigidBody,
    /// The stack of a joint.
    JointDynamics(usize),
    /// An arm term, by its index.
    ArmTerm(usize),
}

/// How τ_J, the load that enters load-dependent friction, is formed from the rigid-body columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadTorque {
    /// The paper's: the sum of the base regressor's row, ζ_RBD = (1, …, 1).
    Literal,
    /// Σ weight · column over all coefficients of the model that are a load (rigid bodies and arm terms with
    /// [`ArmTerm::is_load`]); the weights are those of a fit. Others' weights are ignored.
    Fitted(Vec<f64>),
}

/// What the stacks and arm terms remember between two batches of one recording.
#[derive(Debug, Clone, Default)]
pub struct RobotState {
    stacks: Vec<Vec<f64>>,
    arm_terms: Vec<Vec<f64>>,
    started: bool,
}

/// The regressor's entries over a batch of samples; reuse it from batch to batch.
#[derive(Debug, Clone, Default)]
pub struct RobotTile {
    data: Vec<f64>,
    load: Vec<f64>,
    arm: Vec<f64>,
    samples: usize,
    stride: usize,
}

impl RobotTile {
    /// Number of samples in the tile.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Column `slot` (see [`RobotModel::row_slots`]), one value per sample.
    pub fn slot(&self, slot: usize) -> &[f64] {
        &self.data[slot * self.stride..slot * self.stride + self.samples]
    }

    /// All slots, `stride` apart.
    pub fn raw(&self) -> &[f64] {
        &self.data
    }

    /// Distance between the first samples of two slots in [`Self::raw`].
    pub const fn stride(&self) -> usize {
        self.stride
    }

    /// The load torque of a joint over the batch.
    pub fn load_torque(&self, joint: usize) -> &[f64] {
        &self.load[joint * self.stride..joint * self.stride + self.samples]
    }

    /// A distance between columns that is at least `samples`, a multiple of eight and not of 4096 bytes, so
    /// that columns do not fall on the same cache sets.
    fn resize(&mut self, slots: usize, joints: usize, samples: usize) {
        self.samples = samples;
        let padded = samples.next_multiple_of(8);
        self.stride = if padded.is_multiple_of(64) { padded + 8 } else { padded };
        self.data.resize(slots * self.stride, 0.0);
        self.load.resize(joints * self.stride, 0.0);
    }
}

impl RobotModel {
    /// A model of rigid bodies, one stack per joint, and arm terms.
    ///
    /// # Errors
    /// If the number of stacks is not the number of joints, or an arm term does not fit the robot.
    pub fn new(
        rigid_body: Arc<dyn RigidBodyRegressor>,
        base: BaseParameters,
        stacks: Vec<JointStack>,
        arm_terms: Vec<Box<dyn ArmTerm>>,
    ) -> Result<Self, Vec<ModelError>> {
        let joints = rigid_body.joints();
        let mut errors = Vec::new();
        if stacks.len() != joints {
            errors.push(ModelError::count("joint stacks", joints, stacks.len()));
        }
        let links = rigid_body.bodies().len().max(joints);
        errors.extend(arm_terms.iter().filter_map(|t| t.validate_on(joints, links).err()).flatten());
        if !errors.is_empty() {
            return Err(errors);
        }

        let standard = rigid_body.standard_parameters();
        let mut parameters: Vec<Parameter> = base.columns.iter().map(|c| standard[*c].clone()).collect();
        let mut groups = vec![(ColumnGroup::RigidBody, 0..parameters.len())];
        for (j, stack) in stacks.iter().enumerate() {
            let first = parameters.len();
            parameters.extend(
                stack.columns().into_iter().map(|p| Parameter::new(format!("{}_{j}", p.name), p.unit)),
            );
            groups.push((ColumnGroup::JointDynamics(j), first..parameters.len()));
        }
        for (k, term) in arm_terms.iter().enumerate() {
            let first = parameters.len();
            let twin = arm_terms[..k].iter().filter(|t| t.name() == term.name()).count();
            let prefix =
                if twin == 0 { term.name().to_owned() } else { format!("{}#{}", term.name(), twin + 1) };
            parameters.extend(
                term.columns(joints)
                    .into_iter()
                    .map(|p| Parameter::new(format!("{prefix}.{}", p.name), p.unit)),
            );
            groups.push((ColumnGroup::ArmTerm(k), first..parameters.len()));
        }

        let acts = |group: ColumnGroup, within: usize, joint: usize| match group {
            ColumnGroup::RigidBody => rigid_body.loads(base.columns[within], joint),
            ColumnGroup::JointDynamics(j) => j == joint,
            ColumnGroup::ArmTerm(k) => arm_terms[k].acts_on(within, joint, joints),
        };
        let rows: Vec<Vec<usize>> = (0..joints)
            .map(|joint| {
                groups
                    .iter()
                    .flat_map(|(g, range)| range.clone().map(move |c| (*g, c - range.start, c)))
                    .filter(|(g, within, _)| acts(*g, *within, joint))
                    .map(|(_, _, column)| column)
                    .collect()
            })
            .collect();
        let mut row_start = vec![0];
        for row in &rows {
            row_start.push(row_start[row_start.len() - 1] + row.len());
        }
        let mut destination = vec![RegressorTile::UNWANTED; joints * standard.len()];
        for (joint, row) in rows.iter().enumerate() {
            for (k, column) in row.iter().enumerate().take_while(|(_, c)| **c < base.len()) {
                destination[joint * standard.len() + base.columns[*column]] = (row_start[joint] + k) as u32;
            }
        }
        let known_bodies = None;
        Ok(Self {
            rigid_body,
            base,
            stacks,
            arm_terms,
            parameters,
            groups,
            rows,
            row_start,
            destination,
            known_bodies,
        })
    }

    /// The same model with what is known of its rigid bodies.
    #[must_use]
    pub fn with_known_bodies(self, known: KnownBodies) -> Self {
        Self { known_bodies: Some(known), ..self }
    }

    /// What is known of the rigid bodies before any recording.
    pub const fn known_bodies(&self) -> Option<&KnownBodies> {
        self.known_bodies.as_ref()
    }

    /// Names of the robot's joints and links.
    pub fn names(&self) -> RobotNames<'_> {
        RobotNames::of(&**self.rigid_body())
    }

    /// Number of joints N.
    pub fn joints(&self) -> usize {
        self.stacks.len()
    }

    /// The rigid bodies.
    pub fn rigid_body(&self) -> &Arc<dyn RigidBodyRegressor> {
        &self.rigid_body
    }

    /// The base inertial parameters.
    pub const fn base(&self) -> &BaseParameters {
        &self.base
    }

    /// The joints' stacks.
    pub fn stacks(&self) -> &[JointStack] {
        &self.stacks
    }

    /// The arm terms.
    pub fn arm_terms(&self) -> &[Box<dyn ArmTerm>] {
        &self.arm_terms
    }

    /// All coefficients, in column order. Names carry the joint (`F_C0_2`) or the arm term (`spring.k_1`).
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The unit of a coefficient in a model of what is measured. What acts on one joint alone, and is no load, has the units of
    /// that joint, which turns or slides.
    pub fn unit(&self, column: usize, measured: MeasurementUnit) -> String {
        let unit = &self.parameters[column].unit;
        let mut joints = (0..self.joints()).filter(|joint| self.rows[*joint].contains(&column));
        let slides =
            matches!((joints.next(), joints.next()), (Some(joint), None) if self.rigid_body.slides(joint));
        measured.express_of_joint(unit, slides && !self.is_load()[column])
    }

    /// The column ranges, in order.
    pub fn groups(&self) -> &[(ColumnGroup, Range<usize>)] {
        &self.groups
    }

    /// The column range of a group; empty for a group that the model does not have.
    pub fn group(&self, group: ColumnGroup) -> Range<usize> {
        self.groups.iter().find(|(g, _)| *g == group).map_or(0..0, |(_, r)| r.clone())
    }

    /// The columns that can be non-zero in a joint's row, ascending.
    pub fn row_columns(&self, joint: usize) -> &[usize] {
        &self.rows[joint]
    }

    /// The tile slots of a joint's row, in the order of [`Self::row_columns`].
    pub fn row_slots(&self, joint: usize) -> Range<usize> {
        self.row_start[joint]..self.row_start[joint + 1]
    }

    /// Number of slots of a tile, over all joints.
    pub fn slots(&self) -> usize {
        self.row_start[self.joints()]
    }

    /// Whether each coefficient is a load that joints transmit.
    pub fn is_load(&self) -> Vec<bool> {
        let mut load = vec![false; self.parameters.len()];
        for (group, range) in &self.groups {
            let is_load = match group {
                ColumnGroup::RigidBody => true,
                ColumnGroup::JointDynamics(_) => false,
                ColumnGroup::ArmTerm(k) => self.arm_terms[*k].is_load(),
            };
            load[range.clone()].fill(is_load);
        }
        load
    }

    /// Writes the regressor's entries for every sample of `motion` into `tile` and moves `state` on.
    ///
    /// `state` starts as [`RobotState::default`] at the beginning of a recording; consecutive views of the
    /// recording continue it.
    ///
    /// # Errors
    /// Whatever a model reports; [`ModelError::Count`] if motion or weights do not fit the robot.
    pub fn evaluate(
        &self,
        motion: MotionView<'_>,
        load: &LoadTorque,
        state: &mut RobotState,
        tile: &mut RobotTile,
    ) -> Result<(), ModelError> {
        if motion.joints() != self.joints() {
            return Err(ModelError::count("joints of the motion", self.joints(), motion.joints()));
        }
        tile.resize(self.slots(), self.joints(), motion.samples());
        let (samples, stride) = (tile.samples, tile.stride);
        if samples == 0 {
            return Ok(());
        }
        let RobotTile { data, load: load_torque, arm: scratch, .. } = tile;
        let standard = self.destination.len() / self.joints();
        self.rigid_body
            .evaluate(motion, &mut RegressorTile::new(&self.destination, standard, samples, stride, data));

        state.arm_terms.resize(self.arm_terms.len(), Vec::new());
        state.stacks.resize(self.stacks.len(), Vec::new());
        load_torque.fill(0.0);
        self.evaluate_arm_terms(true, motion, (load_torque, stride), state, scratch, data)?;
        self.sum_load(load, samples, stride, data, load_torque)?;
        for (j, stack) in self.stacks.iter().enumerate() {
            let series = JointSeries::of(motion, j, &load_torque[j * stride..j * stride + samples]);
            if !state.started {
                state.stacks[j] = stack.initial_state(&series.slice(0..1));
            }
            let columns = self.group(ColumnGroup::JointDynamics(j));
            let first = self.rows[j].partition_point(|c| *c < columns.start);
            let start = (self.row_start[j] + first) * stride;
            let mut out = Columns::new(&mut data[start..], columns.len(), samples, stride);
            stack.evaluate(&series, &mut state.stacks[j], &mut out)?;
        }
        self.evaluate_arm_terms(false, motion, (load_torque, stride), state, scratch, data)?;
        state.started = true;
        Ok(())
    }

    /// Evaluates the arm terms that are loads, or those that are not, into their slots of `data`.
    fn evaluate_arm_terms(
        &self,
        loads: bool,
        motion: MotionView<'_>,
        (load_torque, load_stride): (&[f64], usize),
        state: &mut RobotState,
        scratch: &mut Vec<f64>,
        data: &mut [f64],
    ) -> Result<(), ModelError> {
        let (samples, stride, joints) = (motion.samples(), load_stride, self.joints());
        for (k, term) in self.arm_terms.iter().enumerate().filter(|(_, t)| t.is_load() == loads) {
            let series = ArmSeries { motion, load_torque, load_stride, rigid_body: &*self.rigid_body };
            if !state.started {
                let first = ArmSeries { motion: motion.slice(0..1), ..series };
                state.arm_terms[k] = term.initial_state(&first);
            }
            let columns = self.group(ColumnGroup::ArmTerm(k));
            let acting = term.joints(joints);
            scratch.resize(acting.len() * columns.len() * stride, 0.0);
            let mut out = Columns::new(scratch, acting.len() * columns.len(), samples, stride);
            term.evaluate(&series, &mut state.arm_terms[k], &mut out)?;
            for (i, joint) in acting.iter().enumerate() {
                for (slot, column) in self.row_slots(*joint).zip(&self.rows[*joint]) {
                    if columns.contains(column) {
                        let from = out.column(i * columns.len() + column - columns.start);
                        data[slot * stride..slot * stride + samples].copy_from_slice(from);
                    }
                }
            }
        }
        Ok(())
    }

    /// τ_J of every joint from the columns already in `data`.
    fn sum_load(
        &self,
        load: &LoadTorque,
        samples: usize,
        stride: usize,
        data: &[f64],
        load_torque: &mut [f64],
    ) -> Result<(), ModelError> {
        if let LoadTorque::Fitted(weights) = load
            && weights.len() != self.parameters.len()
        {
            return Err(ModelError::count(
                "weights of the load torque",
                self.parameters.len(),
                weights.len(),
            ));
        }
        let is_load = self.is_load();
        for joint in 0..self.joints() {
            let sum = &mut load_torque[joint * stride..joint * stride + samples];
            sum.fill(0.0);
            for (slot, column) in self.row_slots(joint).zip(&self.rows[joint]) {
                let weight = match load {
                    LoadTorque::Literal if *column < self.base.len() => 1.0,
                    LoadTorque::Fitted(weights) if is_load[*column] => weights[*column],
                    LoadTorque::Literal | LoadTorque::Fitted(_) => continue,
                };
                let values = &data[slot * stride..slot * stride + samples];
                for (s, v) in sum.iter_mut().zip(values) {
                    *s += weight * v;
                }
            }
        }
        Ok(())
    }
}
