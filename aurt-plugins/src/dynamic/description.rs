use std::ffi::{CStr, c_char};
use std::slice;

use aurt_traits::abi::{self, Description};
use aurt_traits::{Invariants, Parameter, Scale, ShapeParameter};

/// More models, columns, joints or parameters than this are taken for an error of the library.
pub(super) const MOST: usize = 100_000;

/// A copy of what an instance told of itself.
#[derive(Debug, Clone)]
pub(crate) struct Described {
    pub columns: Vec<Parameter>,
    pub shapes: Vec<ShapeParameter>,
    pub state_len: usize,
    pub invariants: Invariants,
    pub is_load: bool,
    pub joints: Vec<usize>,
    /// By joint and column; empty if every column acts on every joint.
    pub acts_on: Vec<bool>,
}

impl Described {
    /// # Safety
    /// `d` was filled by a library and what it points to still lives.
    pub(super) unsafe fn read(d: &Description) -> Result<Self, String> {
        // SAFETY: the caller promises that each list has the length that stands beside it.
        let (columns, shapes, joints) = unsafe {
            (
                list(d.columns, d.column_count, "columns")?,
                list(d.shapes, d.shape_count, "shape parameters")?,
                list(d.joints, d.joint_count, "joints")?,
            )
        };
        let acts_on: &[u8] = if d.acts_on.is_null() {
            &[]
        } else {
            // SAFETY: as above; the product is bounded because both factors are.
            unsafe { list(d.acts_on, columns.len() * joints.len(), "acting columns")? }
        };
        let columns = columns
            .iter()
            // SAFETY: names and units end with NUL, or are NULL.
            .map(|c| unsafe {
                Ok(Parameter::new(text(c.name, "a column's name")?, text(c.unit, "a column's unit")?))
            })
            .collect::<Result<Vec<_>, String>>()?;
        let shapes = shapes
            .iter()
            .map(|s| {
                // SAFETY: as above.
                let (name, unit) =
                    unsafe { (text(s.name, "a shape parameter's name")?, text(s.unit, "its unit")?) };
                let scale = match s.scale {
                    abi::LINEAR => Scale::Linear,
                    abi::LOGARITHMIC => Scale::Logarithmic,
                    other => return Err(format!("shape parameter `{name}` has the unknown scale {other}")),
                };
                let ordered = s.lower <= s.value && s.value <= s.upper && (s.upper - s.lower).is_finite();
                if !ordered || (scale == Scale::Logarithmic && s.lower <= 0.0) {
                    let bounds = format!("{} between {} and {}", s.value, s.lower, s.upper);
                    return Err(format!("shape parameter `{name}` is {bounds}, which is no range"));
                }
                Ok(ShapeParameter { name, unit, value: s.value, lower: s.lower, upper: s.upper, scale })
            })
            .collect::<Result<Vec<_>, String>>()?;
        let mut named: Vec<&String> = columns.iter().map(|c| &c.name).collect();
        named.extend(shapes.iter().map(|s| &s.name));
        if named.iter().any(|name| name.is_empty()) {
            return Err("a column or a shape parameter has an empty name".to_owned());
        }
        named.sort_unstable();
        if let Some(twice) = named.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!("two of its columns or shape parameters are called `{}`", twice[0]));
        }
        if !joints.is_sorted_by(|a, b| a < b) {
            return Err(format!("its joints do not ascend: {joints:?}"));
        }
        if d.state_len > MOST {
            return Err(format!("it asks for {} state variables", d.state_len));
        }
        Ok(Self {
            columns,
            shapes,
            state_len: d.state_len,
            invariants: Invariants::from_bits(d.invariants),
            is_load: d.is_load != 0,
            joints: joints.to_vec(),
            acts_on: acts_on.iter().map(|a| *a != 0).collect(),
        })
    }
}

/// # Safety
/// `first` leads to `count` values that live during `'a`, or is NULL.
unsafe fn list<'a, T>(first: *const T, count: usize, what: &str) -> Result<&'a [T], String> {
    match count {
        0 => Ok(&[]),
        _ if first.is_null() || !first.is_aligned() => {
            Err(format!("it names {count} {what} but does not give them"))
        }
        _ if count > MOST => Err(format!("it names {count} {what}")),
        // SAFETY: the caller promises it.
        _ => Ok(unsafe { slice::from_raw_parts(first, count) }),
    }
}

/// # Safety
/// `text` ends with NUL, or is NULL.
unsafe fn text(text: *const c_char, what: &str) -> Result<String, String> {
    if text.is_null() {
        return Err(format!("{what} is missing"));
    }
    // SAFETY: the caller promises it.
    unsafe { CStr::from_ptr(text) }.to_str().map(str::to_owned).map_err(|_| format!("{what} is not UTF-8"))
}
