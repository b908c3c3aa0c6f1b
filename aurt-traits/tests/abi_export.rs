//! A Rust model through its own C tables, in one process: what a host sees of it, panics included.

#![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::ffi::{CStr, c_char, c_void};

use aurt_traits::abi::{self, Declaration, Description, ErrorBuffer, ModelTable, Series};
use aurt_traits::reexport::typetag;
use aurt_traits::{
    Columns, HysteresisModel, Invariant, Invariants, JointModel, JointSeries, ModelError, Parameter, Scale,
    ShapeParameter, register_model,
};
use serde::{Deserialize, Serialize};

aurt_traits::export_plugin!();

/// Counts samples, for a state to look at; panics where the velocity is infinite.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Counter {
    step: f64,
    #[serde(default)]
    labels: Vec<String>,
}

impl JointModel for Counter {
    fn name(&self) -> &str {
        "counter"
    }

    fn columns(&self) -> Vec<Parameter> {
        vec![Parameter::new("count", "1"), Parameter::new("velocity", "Nm s/rad")]
    }

    fn invariants(&self) -> Invariants {
        Invariants::of(&[Invariant::RateIndependent])
    }

    fn shape_parameters(&self) -> Vec<ShapeParameter> {
        let (name, unit) = ("step".to_owned(), "1".to_owned());
        vec![ShapeParameter {
            name,
            unit,
            value: self.step,
            lower: 0.1,
            upper: 10.0,
            scale: Scale::Logarithmic,
        }]
    }

    fn set_shape(&mut self, values: &[f64]) -> Result<(), ModelError> {
        self.step = values[0];
        Ok(())
    }

    fn validate(&self) -> Result<(), Vec<ModelError>> {
        if self.step > 0.0 {
            return Ok(());
        }
        let reason = format!("must be positive, is {}", self.step);
        Err(vec![ModelError::InvalidParameter { model: "counter".into(), parameter: "step".into(), reason }])
    }

    fn state_len(&self) -> usize {
        1
    }

    fn initial_state(&self, first: &JointSeries<'_>) -> Vec<f64> {
        vec![100.0 * first.position_rad[0]]
    }

    fn evaluate(
        &self,
        series: &JointSeries<'_>,
        state: &mut [f64],
        out: &mut Columns<'_>,
    ) -> Result<(), ModelError> {
        for (i, v) in series.velocity_rad_s.iter().enumerate() {
            assert!(v.is_finite(), "velocity {v} at sample {i}");
            state[0] += self.step;
            out.column_mut(0)[i] = state[0];
            out.column_mut(1)[i] = *v;
        }
        Ok(())
    }
}

#[typetag::serde(name = "counter")]
impl HysteresisModel for Counter {
    fn boxed_clone(&self) -> Box<dyn HysteresisModel> {
        Box::new(self.clone())
    }
}

register_model! {
    slot: Hysteresis,
    name: "counter",
    summary: "counts samples",
    equation: "h(n) = n step",
    use_when: "in tests",
    source: "none",
    example: r#"{ model = "counter", step = 1.0 }"#,
}

fn table() -> &'static ModelTable {
    // SAFETY: the export of this very test.
    let declaration: &'static Declaration = unsafe { &*aurt_plugin() };
    assert_eq!((declaration.magic, declaration.abi_major), (abi::MAGIC, abi::ABI_MAJOR));
    assert_eq!(declaration.model_count, 1);
    // SAFETY: as above.
    unsafe { &*declaration.models }
}

fn text(pointer: *const c_char) -> String {
    // SAFETY: only called with texts of the declaration.
    unsafe { CStr::from_ptr(pointer) }.to_str().unwrap().to_owned()
}

/// Calls with a buffer of `capacity`; the code and the message.
fn call(capacity: usize, function: impl FnOnce(*mut ErrorBuffer) -> i32) -> (i32, String) {
    let mut bytes = vec![0_u8; capacity];
    let mut buffer = ErrorBuffer { message: bytes.as_mut_ptr().cast(), capacity };
    let code = function(&raw mut buffer);
    (code, CStr::from_bytes_until_nul(&bytes).unwrap().to_string_lossy().into_owned())
}

fn create(config: &str) -> Result<*mut c_void, (i32, String)> {
    let mut instance = std::ptr::null_mut();
    let (code, message) = call(200, |error| {
        // SAFETY: as the ABI asks.
        unsafe {
            table().create.unwrap()(table(), config.as_ptr().cast(), config.len(), &raw mut instance, error)
        }
    });
    if code == abi::OK { Ok(instance) } else { Err((code, message)) }
}

fn evaluate(instance: *mut c_void, velocity: &[f64], state: &mut [f64], out: &mut [f64]) -> (i32, String) {
    let series = JointSeries {
        time_s: velocity,
        position_rad: velocity,
        velocity_rad_s: velocity,
        acceleration_rad_s2: velocity,
        load_torque: velocity,
    };
    let series = Series::of_joint(&series);
    let stride = out.len() / 2;
    call(200, |error| {
        // SAFETY: as the ABI asks.
        unsafe {
            let (state, out) = ((state.as_mut_ptr(), state.len()), out.as_mut_ptr());
            table().evaluate.unwrap()(instance, &raw const series, state.0, state.1, out, 2, stride, error)
        }
    })
}

#[test]
fn the_table_says_what_was_registered() {
    assert_eq!(table().slot, abi::HYSTERESIS);
    assert_eq!(text(table().name), "counter");
    assert_eq!(text(table().example), r#"{ model = "counter", step = 1.0 }"#);
}

#[test]
fn an_instance_lives_from_configuration_to_end() {
    let instance = create(r#"{"step": 2, "labels": ["a"]}"#).unwrap();
    // SAFETY: plain numbers and pointers, for which zeros are values.
    let mut d: Description = unsafe { std::mem::zeroed() };
    // SAFETY: as the ABI asks.
    let (code, _) = call(200, |error| unsafe { table().describe.unwrap()(instance, 0, &raw mut d, error) });
    assert_eq!((code, d.column_count, d.shape_count, d.state_len), (abi::OK, 2, 1, 1));
    // SAFETY: the description names one shape parameter and two columns.
    let (shape, column) = unsafe { (&*d.shapes, &*d.columns.add(1)) };
    assert_eq!((text(shape.name), shape.value, shape.scale), ("step".to_owned(), 2.0, abi::LOGARITHMIC));
    assert_eq!(text(column.unit), "Nm s/rad");
    assert_eq!(d.invariants, Invariants::of(&[Invariant::RateIndependent]).bits());

    let (mut state, mut out) = ([0.0], [0.0; 6]);
    assert_eq!(evaluate(instance, &[5.0, 6.0, 7.0], &mut state, &mut out).0, abi::OK);
    assert_eq!((out, state), ([2.0, 4.0, 6.0, 5.0, 6.0, 7.0], [6.0]));
    // SAFETY: as the ABI asks.
    let (code, _) = call(200, |e| unsafe { table().set_shape.unwrap()(instance, [0.5].as_ptr(), 1, e) });
    assert_eq!(code, abi::OK);
    assert_eq!(evaluate(instance, &[1.0], &mut state, &mut out[..2]).0, abi::OK);
    assert_eq!(out[..2], [6.5, 1.0]);
    // SAFETY: its end, once.
    unsafe { table().destroy.unwrap()(instance) };
}

#[test]
fn complaints_name_the_key() {
    let complaint = |config| create(config).unwrap_err();
    assert_eq!(complaint(r#"{"step": -1}"#), (abi::FAILED, "`step` must be positive, is -1".into()));
    assert_eq!(
        complaint(r#"{"step": "much"}"#),
        (abi::FAILED, "`step`: invalid type: string \"much\", expected f64".into())
    );
    assert_eq!(
        complaint(r#"{"step": 1, "stop": 2}"#),
        (abi::FAILED, "unknown field `stop`, expected `step` or `labels`".into())
    );
    assert_eq!(complaint("{}"), (abi::FAILED, "missing field `step`".into()));
    assert!(complaint("[1]").1.starts_with("the configuration is no JSON object"));
}

#[test]
fn a_panic_becomes_a_code_and_a_message() {
    let instance = create(r#"{"step": 1}"#).unwrap();
    let (mut state, mut out) = ([0.0], [0.0; 4]);
    assert_eq!(
        evaluate(instance, &[1.0, f64::INFINITY], &mut state, &mut out),
        (abi::PANICKED, "velocity inf at sample 1".into())
    );
    // The instance still works.
    assert_eq!(evaluate(instance, &[1.0, 1.0], &mut state, &mut out).0, abi::OK);
    // SAFETY: its end, once.
    unsafe { table().destroy.unwrap()(instance) };
}

#[test]
fn a_message_is_cut_to_fit() {
    let mut instance = std::ptr::null_mut();
    let config = r#"{"täglich": 1}"#;
    // "unknown field `tä…": the cut falls into the two bytes of ä.
    let (_, message) = call(18, |error| {
        // SAFETY: as the ABI asks.
        unsafe {
            table().create.unwrap()(table(), config.as_ptr().cast(), config.len(), &raw mut instance, error)
        }
    });
    assert_eq!(message, "unknown field `t");
}
