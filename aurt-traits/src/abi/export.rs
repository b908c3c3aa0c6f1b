//! The models of a Rust crate as the ABI's tables; what [`export_plugin!`](crate::export_plugin) exports.

use std::any::Any;
use std::ffi::{c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;
use std::{ptr, slice};

use super::instance::{Instance, c_string};
use super::{
    ABI_MAJOR, ABI_MINOR, Declaration, Description, ErrorBuffer, FAILED, MAGIC, ModelTable, OK, PANICKED,
    Series,
};
use crate::{Columns, ModelEntry};

/// A declaration that may be shared: everything that it points to is constant and lives as long as the process.
struct Shared(Declaration);

// SAFETY: nothing behind the pointers of a declaration ever changes.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

static DECLARATION: OnceLock<Shared> = OnceLock::new();

/// The declaration of all models that the crate `name` has registered in this library, made at the first call; NULL
/// if that panics.
pub fn declaration(name: &'static str, version: &'static str) -> *const Declaration {
    catch_unwind(|| ptr::from_ref(&DECLARATION.get_or_init(|| declare(name, version)).0))
        .unwrap_or(ptr::null())
}

fn declare(name: &'static str, version: &'static str) -> Shared {
    // Other crates that are linked into the library register models too, but those are not its own.
    let tables: Vec<ModelTable> = inventory::iter::<ModelEntry>
        .into_iter()
        .filter(|entry| entry.origin == name)
        .map(|entry| ModelTable {
            slot: entry.slot as u32,
            reserved: 0,
            name: leaked(entry.name),
            summary: leaked(entry.summary),
            equation: leaked(entry.equation),
            use_when: leaked(entry.use_when),
            source: leaked(entry.source),
            example: leaked(entry.example),
            create: Some(create),
            destroy: Some(destroy),
            describe: Some(describe),
            set_shape: Some(set_shape),
            initial_state: Some(initial_state),
            evaluate: Some(evaluate),
        })
        .collect();
    let tables = Vec::leak(tables);
    Shared(Declaration {
        magic: MAGIC,
        abi_major: ABI_MAJOR,
        abi_minor: ABI_MINOR,
        declaration_size: size_of::<Declaration>() as u32,
        model_size: size_of::<ModelTable>() as u32,
        description_size: size_of::<Description>() as u32,
        series_size: size_of::<Series>() as u32,
        name: leaked(name),
        version: leaked(version),
        model_count: tables.len(),
        models: tables.as_ptr(),
    })
}

fn leaked(text: &str) -> *const c_char {
    c_string(text).into_raw()
}

/// Runs the body of an entry; its failure or panic becomes a code and a message.
///
/// # Safety
/// `error` is NULL or points to a valid [`ErrorBuffer`].
unsafe fn guarded(error: *mut ErrorBuffer, body: impl FnOnce() -> Result<(), String>) -> i32 {
    // A panic may leave the instance half changed only in `set_shape`, after which the host drops it.
    let (code, message) = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return OK,
        Ok(Err(message)) => (FAILED, message),
        Err(payload) => (PANICKED, panic_message(&*payload)),
    };
    // SAFETY: the caller promises that `error` is NULL or valid.
    if let Some(buffer) = unsafe { error.as_mut() } {
        // SAFETY: a valid buffer has `capacity` bytes at `message`.
        unsafe { buffer.write(&message) };
    }
    code
}

fn panic_message(payload: &(dyn Any + Send)) -> String {
    payload
        .downcast_ref::<&str>()
        .map(|text| (*text).to_owned())
        .or_else(|| payload.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "a panic without a message".to_owned())
}

impl ErrorBuffer {
    /// Writes a message, cut at a character's end to fit.
    ///
    /// # Safety
    /// `message` points to `capacity` writable bytes, or is NULL.
    unsafe fn write(&mut self, text: &str) {
        if self.message.is_null() || self.capacity == 0 {
            return;
        }
        let mut len = text.len().min(self.capacity - 1);
        while !text.is_char_boundary(len) {
            len -= 1;
        }
        // SAFETY: `len + 1 ≤ capacity` bytes are writable, and the two texts do not overlap.
        unsafe {
            ptr::copy_nonoverlapping(text.as_ptr().cast(), self.message, len);
            *self.message.add(len) = 0;
        }
    }
}

unsafe extern "C" fn create(
    model: *const ModelTable,
    config: *const c_char,
    config_len: usize,
    instance: *mut *mut c_void,
    error: *mut ErrorBuffer,
) -> i32 {
    let body = || {
        // SAFETY: the host hands back the table that it got from the declaration, and a text of `config_len` bytes.
        let (table, config) = unsafe { (&*model, slice::from_raw_parts(config.cast::<u8>(), config_len)) };
        let made = Instance::create(table, config)?;
        // SAFETY: the host gives a place for the pointer.
        unsafe { *instance = Box::into_raw(Box::new(made)).cast() };
        Ok(())
    };
    // SAFETY: the host gives a valid buffer.
    unsafe { guarded(error, body) }
}

unsafe extern "C" fn destroy(instance: *mut c_void) {
    if !instance.is_null() {
        // SAFETY: the host hands back, once, what `create` gave it.
        let owned = unsafe { Box::from_raw(instance.cast::<Instance>()) };
        // A model whose destruction panics is lost, but the host goes on.
        let _ = catch_unwind(AssertUnwindSafe(move || drop(owned)));
    }
}

unsafe extern "C" fn describe(
    instance: *mut c_void,
    robot_joints: usize,
    description: *mut Description,
    error: *mut ErrorBuffer,
) -> i32 {
    let body = || {
        // SAFETY: `instance` is from `create`; the host gives a place for the description and a valid buffer.
        let (instance, place) = unsafe { (&*instance.cast::<Instance>(), &mut *description) };
        *place = instance.describe(robot_joints)?;
        Ok(())
    };
    // SAFETY: as above.
    unsafe { guarded(error, body) }
}

unsafe extern "C" fn set_shape(
    instance: *mut c_void,
    values: *const f64,
    count: usize,
    error: *mut ErrorBuffer,
) -> i32 {
    let body = || {
        // SAFETY: `instance` is from `create` and nobody else uses it now; `values` leads to `count` numbers.
        let instance = unsafe { &mut *instance.cast::<Instance>() };
        // SAFETY: as above.
        instance.set_shape(unsafe { numbers(values, count) })
    };
    // SAFETY: the host gives a valid buffer.
    unsafe { guarded(error, body) }
}

unsafe extern "C" fn initial_state(
    instance: *const c_void,
    first: *const Series,
    state: *mut f64,
    state_len: usize,
    error: *mut ErrorBuffer,
) -> i32 {
    let body = || {
        // SAFETY: `instance` is from `create`; series and state are the host's, as the ABI describes them.
        let (instance, first, state) =
            unsafe { (&*instance.cast::<Instance>(), &*first, numbers_mut(state, state_len)) };
        // SAFETY: as above.
        let begin = unsafe { instance.initial_state(first) };
        if begin.len() != state.len() {
            return Err(format!("the initial state has {} entries instead of {}", begin.len(), state.len()));
        }
        state.copy_from_slice(&begin);
        Ok(())
    };
    // SAFETY: the host gives a valid buffer.
    unsafe { guarded(error, body) }
}

unsafe extern "C" fn evaluate(
    instance: *const c_void,
    series: *const Series,
    state: *mut f64,
    state_len: usize,
    out: *mut f64,
    out_columns: usize,
    out_stride: usize,
    error: *mut ErrorBuffer,
) -> i32 {
    let body = || {
        // SAFETY: `instance` is from `create`; series and state are the host's, as the ABI describes them.
        let (instance, series, state) =
            unsafe { (&*instance.cast::<Instance>(), &*series, numbers_mut(state, state_len)) };
        let len = if out_columns == 0 { 0 } else { (out_columns - 1) * out_stride + series.samples };
        // SAFETY: the host gives room for so many columns, `out_stride` apart.
        let out = unsafe { numbers_mut(out, len) };
        // SAFETY: as above.
        unsafe {
            instance.evaluate(series, state, &mut Columns::new(out, out_columns, series.samples, out_stride))
        }
    };
    // SAFETY: the host gives a valid buffer.
    unsafe { guarded(error, body) }
}

/// # Safety
/// `first` leads to `count` numbers that nobody changes during `'a`; with a count of zero it may be anything.
unsafe fn numbers<'a>(first: *const f64, count: usize) -> &'a [f64] {
    // SAFETY: the caller promises it.
    if count == 0 { &[] } else { unsafe { slice::from_raw_parts(first, count) } }
}

/// # Safety
/// `first` leads to `count` numbers that nobody else uses during `'a`; with a count of zero it may be anything.
unsafe fn numbers_mut<'a>(first: *mut f64, count: usize) -> &'a mut [f64] {
    // SAFETY: the caller promises it.
    if count == 0 { &mut [] } else { unsafe { slice::from_raw_parts_mut(first, count) } }
}

/// Exports every model that the crate registers with [`register_model!`](crate::register_model), so that the crate
/// built as a `cdylib` is a library that AURT loads. To be called once, in the crate's root.
///
/// ```
/// aurt_traits::export_plugin!();
/// # fn main() {}
/// ```
///
/// A program may contain only one exported function of that name: a crate that is also to be linked statically calls
/// this behind a feature that the static use switches off.
#[macro_export]
macro_rules! export_plugin {
    () => {
        /// What this library offers to its host.
        // SAFETY: no other function of this library has that name.
        #[unsafe(no_mangle)]
        pub extern "C" fn aurt_plugin() -> *const $crate::abi::Declaration {
            $crate::abi::declaration(env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
        }
    };
}
