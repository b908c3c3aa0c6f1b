//! A model behind the ABI: made from its configuration, described in C's terms.

use std::ffi::{CStr, CString, c_char};
use std::ptr;
use std::sync::{Mutex, PoisonError};

use serde_json::{Map, Value};

use super::configuration::Keyed;
use super::no_bodies::NoBodies;
use super::{
    ARM_TERM, COULOMB, ColumnDescription, Description, HYSTERESIS, LINEAR, LOGARITHMIC, ModelTable, NO_ROBOT,
    Series, ShapeDescription, VISCOUS,
};
use crate::{
    ArmTerm, Columns, CoulombModel, HysteresisModel, JointModel, ModelError, Parameter, Scale,
    ShapeParameter, ViscousBasis,
};

pub(super) struct Instance {
    model: Model,
    /// What the last description points to.
    described: Mutex<Described>,
}

enum Model {
    Coulomb(Box<dyn CoulombModel>),
    Hysteresis(Box<dyn HysteresisModel>),
    Viscous(Box<dyn ViscousBasis>),
    ArmTerm(Box<dyn ArmTerm>),
}

/// The memory behind a [`Description`].
#[derive(Default)]
struct Described {
    texts: Vec<CString>,
    columns: Vec<ColumnDescription>,
    shapes: Vec<ShapeDescription>,
    joints: Vec<usize>,
    acts_on: Vec<u8>,
}

// SAFETY: the pointers in `Described` lead to its own texts, which move with it.
unsafe impl Send for Described {}

impl Model {
    /// The model as a joint model, or as an arm term.
    fn kind(&self) -> Result<&dyn JointModel, &dyn ArmTerm> {
        match self {
            Self::Coulomb(m) => Ok(&**m),
            Self::Hysteresis(m) => Ok(&**m),
            Self::Viscous(m) => Ok(&**m),
            Self::ArmTerm(t) => Err(&**t),
        }
    }
}

impl Instance {
    /// The model of a table from a JSON object.
    pub(super) fn create(table: &ModelTable, config: &[u8]) -> Result<Self, String> {
        // SAFETY: the host hands back a table of this library, whose name is one of its own strings.
        let name = unsafe { CStr::from_ptr(table.name) }.to_string_lossy();
        let keys: Map<String, Value> = serde_json::from_slice(config)
            .map_err(|e| format!("the configuration is no JSON object: {e}"))?;
        let config = Keyed::new(&name, keys);
        let model = match table.slot {
            COULOMB => Model::Coulomb(config.read::<Box<dyn CoulombModel>>()?),
            HYSTERESIS => Model::Hysteresis(config.read::<Box<dyn HysteresisModel>>()?),
            VISCOUS => Model::Viscous(config.read::<Box<dyn ViscousBasis>>()?),
            ARM_TERM => Model::ArmTerm(config.read::<Box<dyn ArmTerm>>()?),
            other => return Err(format!("slot {other} is unknown")),
        };
        // Whether an arm term fits depends on the robot, so that is asked when it is described.
        if let Ok(joint_model) = model.kind() {
            joint_model.validate().map_err(|complaints| lines(&complaints))?;
        }
        Ok(Self { model, described: Mutex::default() })
    }

    pub(super) fn describe(&self, robot_joints: usize) -> Result<Description, String> {
        // A panic while describing leaves nothing that the next description does not replace.
        let mut described = self.described.lock().unwrap_or_else(PoisonError::into_inner);
        *described = Described::default();
        let d = &mut *described;
        let mut description = d.of_columns_and_shapes(
            &match self.model.kind() {
                Ok(model) => model.columns(),
                Err(_) if robot_joints == NO_ROBOT => Vec::new(),
                Err(term) => term.columns(robot_joints),
            },
            &self.model.kind().map_or_else(ArmTerm::shape_parameters, JointModel::shape_parameters),
        );
        match self.model.kind() {
            Ok(model) => {
                description.state_len = model.state_len();
                description.invariants = model.invariants().bits();
            }
            Err(term) => {
                description.invariants = term.invariants().bits();
                description.is_load = u32::from(term.is_load());
                if robot_joints == NO_ROBOT {
                    return Ok(description);
                }
                term.validate(robot_joints).map_err(|complaints| lines(&complaints))?;
                description.state_len = term.state_len(robot_joints);
                d.joints = term.joints(robot_joints);
                d.acts_on = d
                    .joints
                    .iter()
                    .flat_map(|joint| {
                        (0..d.columns.len()).map(|k| u8::from(term.acts_on(k, *joint, robot_joints)))
                    })
                    .collect();
                description.joint_count = d.joints.len();
                description.joints = d.joints.as_ptr();
                description.acts_on = d.acts_on.as_ptr();
            }
        }
        Ok(description)
    }

    pub(super) fn set_shape(&mut self, values: &[f64]) -> Result<(), String> {
        match &mut self.model {
            Model::Coulomb(m) => m.set_shape(values),
            Model::Hysteresis(m) => m.set_shape(values),
            Model::Viscous(m) => m.set_shape(values),
            Model::ArmTerm(t) => t.set_shape(values),
        }
        .map_err(|e| e.to_string())
    }

    /// # Safety
    /// `first` describes valid series.
    pub(super) unsafe fn initial_state(&self, first: &Series) -> Vec<f64> {
        match self.model.kind() {
            // SAFETY: the caller promises it.
            Ok(model) => model.initial_state(&unsafe { first.as_joint() }),
            Err(term) => {
                let bodies = NoBodies { joints: first.joints };
                // SAFETY: as above.
                term.initial_state(&unsafe { first.as_arm(&bodies) })
            }
        }
    }

    /// # Safety
    /// `series` describes valid series.
    pub(super) unsafe fn evaluate(
        &self,
        series: &Series,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), String> {
        match self.model.kind() {
            // SAFETY: the caller promises it.
            Ok(model) => model.evaluate(&unsafe { series.as_joint() }, state, out),
            Err(term) => {
                let bodies = NoBodies { joints: series.joints };
                // SAFETY: as above.
                term.evaluate(&unsafe { series.as_arm(&bodies) }, state, out)
            }
        }
        .map_err(|e| match e {
            // The host adds the model's name.
            ModelError::Evaluation { reason, .. } => reason,
            other => other.to_string(),
        })
    }
}

impl Described {
    fn of_columns_and_shapes(&mut self, columns: &[Parameter], shapes: &[ShapeParameter]) -> Description {
        // The texts must not move any more once something points to them.
        self.texts.reserve_exact(2 * (columns.len() + shapes.len()));
        for column in columns {
            let (name, unit) = (self.text(&column.name), self.text(&column.unit));
            self.columns.push(ColumnDescription { name, unit });
        }
        for shape in shapes {
            let (name, unit) = (self.text(&shape.name), self.text(&shape.unit));
            let scale = match shape.scale {
                Scale::Linear => LINEAR,
                Scale::Logarithmic => LOGARITHMIC,
            };
            let ShapeParameter { value, lower, upper, .. } = *shape;
            self.shapes.push(ShapeDescription { name, unit, value, lower, upper, scale, reserved: 0 });
        }
        Description {
            column_count: self.columns.len(),
            columns: self.columns.as_ptr(),
            shape_count: self.shapes.len(),
            shapes: self.shapes.as_ptr(),
            state_len: 0,
            invariants: 0,
            is_load: 0,
            joint_count: 0,
            joints: ptr::null(),
            acts_on: ptr::null(),
        }
    }

    fn text(&mut self, text: &str) -> *const c_char {
        self.texts.push(c_string(text));
        self.texts.last().map_or(ptr::null(), |t| t.as_ptr())
    }
}

fn lines(complaints: &[ModelError]) -> String {
    complaints
        .iter()
        .map(|complaint| match complaint {
            // The host adds the model's name.
            ModelError::InvalidParameter { parameter, reason, .. } => format!("`{parameter}` {reason}"),
            other => other.to_string(),
        })
        .collect::<Vec<_>>()
        .join("\n")
}

/// The text up to its first NUL.
pub(super) fn c_string(text: &str) -> CString {
    let end = text.find('\0').unwrap_or(text.len());
    CString::new(&text[..end]).unwrap_or_default()
}
