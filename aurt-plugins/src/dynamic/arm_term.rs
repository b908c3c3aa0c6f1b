use std::sync::Arc;

use aurt_traits::abi::Series;
use aurt_traits::{ArmSeries, ArmTerm, Columns, Invariants, ModelError, Parameter, Result, ShapeParameter};

use super::description::Described;
use super::instance::Fault;
use super::model::LibraryTerm;

impl LibraryTerm {
    /// The description for a robot; none if the term does not fit it, which `validate` reports.
    fn on(&self, robot_joints: usize) -> Option<Arc<Described>> {
        self.instance.describe(robot_joints).ok()
    }
}

impl ArmTerm for LibraryTerm {
    // As for joint models: the name is the library's, so `typetag`'s attribute cannot be used.
    fn typetag_name(&self) -> &'static str {
        self.instance.model.name
    }

    fn typetag_deserialize(&self) {}

    fn name(&self) -> &str {
        self.instance.model.name
    }

    fn boxed_clone(&self) -> Box<dyn ArmTerm> {
        Box::new(self.clone())
    }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        self.on(robot_joints).map(|d| d.joints.clone()).unwrap_or_default()
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        self.on(robot_joints).map(|d| d.columns.clone()).unwrap_or_default()
    }

    fn acts_on(&self, column: usize, joint: usize, robot_joints: usize) -> bool {
        self.on(robot_joints).is_some_and(|d| {
            d.joints
                .iter()
                .position(|j| *j == joint)
                .is_some_and(|i| d.acts_on.get(i * d.columns.len() + column).copied().unwrap_or(true))
        })
    }

    fn invariants(&self) -> Invariants {
        self.described.invariants
    }

    fn is_load(&self) -> bool {
        self.described.is_load
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        let name = self.instance.model.name;
        let described = self.instance.describe(robot_joints).map_err(|fault| {
            let complaint = |(key, reason): (Option<String>, String)| match key {
                Some(parameter) => ModelError::parameter(name, parameter, reason),
                None => self.instance.failed(reason),
            };
            fault.complaints(&self.instance.config).into_iter().map(complaint).collect::<Vec<_>>()
        })?;
        described.joints.iter().find(|j| **j >= robot_joints).map_or(Ok(()), |beyond| {
            Err(vec![self.instance.failed(format!("it acts on joint {beyond} of a robot of {robot_joints}"))])
        })
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        self.described.shapes.clone()
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        self.reshape(values)
    }

    fn state_len(&self, robot_joints: usize) -> usize {
        self.on(robot_joints).map_or(0, |d| d.state_len)
    }

    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        let Some(described) = self.on(first.motion.joints()) else { return Vec::new() };
        self.first_state(&described, &Series::of_arm(first))
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let described = self
            .instance
            .describe(series.motion.joints())
            .map_err(|Fault(reason)| self.instance.failed(reason))?;
        let columns = described.joints.len() * described.columns.len();
        let guarded = self.instance.is_new();
        let series = Series::of_arm(series);
        self.checked(&described, columns, &series, state, out, guarded)
    }
}
