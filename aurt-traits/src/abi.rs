//! The C ABI of models in dynamic libraries: plain tables of functions, for libraries in Rust, C or anything that
//! can export a C symbol. `include/aurt_plugin.h` says the same in C.
//!
//! A library exports one function, [`ENTRY`], that returns its [`Declaration`]: the numbers by which a host
//! recognises it, and its [`ModelTable`]s. For each model a host creates instances from a configuration, asks them
//! to describe themselves, and evaluates them on whole batches.
//!
//! Rust crates need none of this by hand: [`export_plugin!`](crate::export_plugin) builds the tables from the models
//! that [`register_model!`](crate::register_model) lists.
//!
//! # What can be in a library
//! Models of every [`Slot`]: Coulomb, hysteresis, viscous models and arm terms.
//! [`RigidBodyRegressor`](crate::RigidBodyRegressor) cannot: its kernel writes tiles that are shared with the host, and
//! base parameters, forward dynamics and simulation all lean on it. An arm term in a library is therefore not given
//! the robot's rigid bodies either.
//!
//! # Rules of the boundary
//! - Every function returns [`OK`], [`FAILED`] or [`PANICKED`]; except on [`OK`] it leaves a message in the caller's
//!   [`ErrorBuffer`]. Nothing unwinds across the boundary.
//! - Strings are UTF-8. Those in tables end with NUL and live as long as the process: libraries are never unloaded.
//! - What [`ModelTable::describe`] points to lives until the next `describe` of the same instance, or its end.
//! - `evaluate` and `initial_state` may run on one instance from several threads at once, also beside `describe`;
//!   `set_shape`, `describe` and `destroy` are never called twice at once. No instance changes by being evaluated:
//!   what a model remembers is in the state that the caller keeps.
//!
//! # Versions
//! A host accepts its own [`ABI_MAJOR`] alone. A higher [`ABI_MINOR`] only appends fields to structs; every struct that
//! crosses the boundary comes with its size, and fields beyond the size of the older side do not exist.

mod configuration;
mod export;
mod instance;
mod no_bodies;
mod series;

use std::ffi::{c_char, c_void};

use crate::Slot;

pub use export::declaration;

/// First field of every declaration: `AURTPLUG` as eight little-endian bytes.
pub const MAGIC: u64 = u64::from_le_bytes(*b"AURTPLUG");

/// Version of the ABI; libraries of another one are refused.
pub const ABI_MAJOR: u32 = 1;

/// Version of what was appended since.
pub const ABI_MINOR: u32 = 0;

/// Name of the function that a library exports, `const Declaration *aurt_plugin(void)`.
pub const ENTRY: &str = "aurt_plugin";

/// The interface in C, the text of `aurt_plugin.h`.
pub const HEADER: &str = include_str!("../include/aurt_plugin.h");

/// All went well.
pub const OK: i32 = 0;

/// The function could not do what it was asked for; the error buffer says why.
pub const FAILED: i32 = 1;

/// The function panicked; the error buffer holds the panic's message.
pub const PANICKED: i32 = 2;

/// [`ModelTable::slot`] of a Coulomb model.
pub const COULOMB: u32 = Slot::Coulomb as u32;
/// [`ModelTable::slot`] of a hysteresis model.
pub const HYSTERESIS: u32 = Slot::Hysteresis as u32;
/// [`ModelTable::slot`] of a viscous model.
pub const VISCOUS: u32 = Slot::Viscous as u32;
/// [`ModelTable::slot`] of an arm term.
pub const ARM_TERM: u32 = Slot::ArmTerm as u32;

/// [`ShapeDescription::scale`]: steps are differences.
pub const LINEAR: u32 = 0;
/// [`ShapeDescription::scale`]: steps are factors.
pub const LOGARITHMIC: u32 = 1;

/// The number of joints by which [`ModelTable::describe`] asks an arm term only for what does not depend on the robot:
/// shape parameters, invariants, whether it is a load.
pub const NO_ROBOT: usize = 0;

/// What a library is.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Declaration {
    /// [`MAGIC`].
    pub magic: u64,
    /// [`ABI_MAJOR`] that the library was built with.
    pub abi_major: u32,
    /// [`ABI_MINOR`] that the library was built with.
    pub abi_minor: u32,
    /// Size of this struct in the library.
    pub declaration_size: u32,
    /// Size of [`ModelTable`] in the library, which is the distance between two of its tables.
    pub model_size: u32,
    /// Size of [`Description`] in the library.
    pub description_size: u32,
    /// Size of [`Series`] in the library.
    pub series_size: u32,
    /// The library's name.
    pub name: *const c_char,
    /// The library's version.
    pub version: *const c_char,
    /// Number of models.
    pub model_count: usize,
    /// The models.
    pub models: *const ModelTable,
}

/// A model: its listing and its functions.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ModelTable {
    /// [`COULOMB`], [`HYSTERESIS`], [`VISCOUS`] or [`ARM_TERM`].
    pub slot: u32,
    /// Zero.
    pub reserved: u32,
    /// Name in experiments.
    pub name: *const c_char,
    /// One line for listings.
    pub summary: *const c_char,
    /// The equation, in plain text.
    pub equation: *const c_char,
    /// When to use the model, and when another.
    pub use_when: *const c_char,
    /// Where the equation is from.
    pub source: *const c_char,
    /// A working configuration, as a TOML inline table.
    pub example: *const c_char,
    /// Makes an instance from a configuration: a JSON object of `config_len` bytes, UTF-8, without the `model` key. It
    /// may hold numbers, booleans, strings, lists and objects. Complaints name the key in backticks, one a line.
    pub create: Option<Create>,
    /// Ends an instance.
    pub destroy: Option<Destroy>,
    /// Tells what the instance is, for a robot of `robot_joints` joints, or [`NO_ROBOT`] (joint models do not depend on
    /// them). An arm term that does not fit the robot fails.
    pub describe: Option<Describe>,
    /// Sets all shape parameters, in the order of the description. May be absent if there are none.
    pub set_shape: Option<SetShape>,
    /// Writes the state before the first sample of a series; `first` holds that sample alone. If absent, the state
    /// begins with zeros.
    pub initial_state: Option<InitialState>,
    /// Writes every column over the whole series and moves `state` to its end: sample s of column k of the i-th
    /// of the described joints goes to `out[(i · columns + k) · out_stride + s]`; `out_columns` is the number of columns
    /// over all these joints.
    pub evaluate: Option<Evaluate>,
}

/// [`ModelTable::create`].
pub type Create = unsafe extern "C" fn(
    model: *const ModelTable,
    config: *const c_char,
    config_len: usize,
    instance: *mut *mut c_void,
    error: *mut ErrorBuffer,
) -> i32;

/// [`ModelTable::destroy`].
pub type Destroy = unsafe extern "C" fn(instance: *mut c_void);

/// [`ModelTable::describe`].
pub type Describe = unsafe extern "C" fn(
    instance: *mut c_void,
    robot_joints: usize,
    description: *mut Description,
    error: *mut ErrorBuffer,
) -> i32;

/// [`ModelTable::set_shape`].
pub type SetShape = unsafe extern "C" fn(
    instance: *mut c_void,
    values: *const f64,
    count: usize,
    error: *mut ErrorBuffer,
) -> i32;

/// [`ModelTable::initial_state`].
pub type InitialState = unsafe extern "C" fn(
    instance: *const c_void,
    first: *const Series,
    state: *mut f64,
    state_len: usize,
    error: *mut ErrorBuffer,
) -> i32;

/// [`ModelTable::evaluate`].
pub type Evaluate = unsafe extern "C" fn(
    instance: *const c_void,
    series: *const Series,
    state: *mut f64,
    state_len: usize,
    out: *mut f64,
    out_columns: usize,
    out_stride: usize,
    error: *mut ErrorBuffer,
) -> i32;

/// What an instance tells of itself. The host hands it over filled with zeros.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Description {
    /// Number of linear coefficients, and so of output columns.
    pub column_count: usize,
    /// The coefficients.
    pub columns: *const ColumnDescription,
    /// Number of parameters in which the model is not linear.
    pub shape_count: usize,
    /// These parameters, with their present values.
    pub shapes: *const ShapeDescription,
    /// Number of state variables.
    pub state_len: usize,
    /// What the model declares of itself: bit k stands for `Invariant::ALL[k]`.
    pub invariants: u32,
    /// Arm terms: whether the joints transmit the term's torque, so that it belongs to their load (0 or 1).
    pub is_load: u32,
    /// Arm terms: number of joints whose rows the term writes.
    pub joint_count: usize,
    /// Arm terms: these joints, ascending, from 0.
    pub joints: *const usize,
    /// Arm terms: whether column k can act on the i-th of these joints, at `i · column_count + k` (0 or 1); NULL if
    /// every column acts on every one of them.
    pub acts_on: *const u8,
}

/// A linear coefficient.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ColumnDescription {
    /// Its name, unique within the model.
    pub name: *const c_char,
    /// Its unit for a torque-measuring robot.
    pub unit: *const c_char,
}

/// A parameter in which a model is not linear.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ShapeDescription {
    /// Its name, equal to the configuration key.
    pub name: *const c_char,
    /// Its unit.
    pub unit: *const c_char,
    /// Present value.
    pub value: f64,
    /// Smallest value that makes sense physically.
    pub lower: f64,
    /// Largest value that makes sense physically.
    pub upper: f64,
    /// [`LINEAR`] or [`LOGARITHMIC`].
    pub scale: u32,
    /// Zero.
    pub reserved: u32,
}

/// A batch of a time series. Sample s of joint j is at `j · stride + s`; a joint model gets one joint.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Series {
    /// Size of this struct in the host.
    pub size: usize,
    /// Number of samples.
    pub samples: usize,
    /// Number of joints.
    pub joints: usize,
    /// Distance between the first samples of two joints in positions, velocities, accelerations.
    pub stride: usize,
    /// Distance between the first samples of two joints in load torques.
    pub load_stride: usize,
    /// Times in s, one series for all joints.
    pub time_s: *const f64,
    /// Joint angles q in rad.
    pub position_rad: *const f64,
    /// Joint velocities q̇ in rad/s.
    pub velocity_rad_s: *const f64,
    /// Joint accelerations q̈ in rad/s².
    pub acceleration_rad_s2: *const f64,
    /// Load torque τ_J that each joint transmits.
    pub load_torque: *const f64,
}

/// Where a failing function leaves its message, UTF-8, NUL-terminated, cut to fit.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct ErrorBuffer {
    /// The caller's bytes.
    pub message: *mut c_char,
    /// Their number, the NUL included.
    pub capacity: usize,
}
