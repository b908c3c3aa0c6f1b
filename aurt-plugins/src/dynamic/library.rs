use std::collections::BTreeMap;
use std::ffi::{CStr, c_char};
use std::sync::{Arc, Mutex, PoisonError};

use aurt_traits::Slot;
use aurt_traits::abi::{self, Declaration, ModelTable};
use libloading::Library;

use super::description::MOST;
use super::file::LibraryFile;
use crate::error::LibraryProblem;
use crate::listing::{LibraryListing, ModelListing, Origin};

/// A model of a library.
#[derive(Debug)]
pub struct LibraryModel {
    pub table: Table,
    /// Lives as long as the process.
    pub name: &'static str,
    pub library: LibraryListing,
}

/// The functions of a model of a library that is loaded into this process.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    pub functions: ModelTable,
    /// Bytes that `describe` may write.
    pub description_size: usize,
    /// The table's place in the library, which `create` gets back.
    pub address: *const ModelTable,
}

// SAFETY: tables and the texts behind them are constant, and their functions may be called from any thread, as the
// ABI demands.
unsafe impl Send for Table {}
// SAFETY: as above.
unsafe impl Sync for Table {}

type Listed = (ModelListing, Arc<LibraryModel>);

pub(crate) type Loaded = (LibraryListing, Vec<Listed>);

/// The declaration of a loaded library, which lives as long as the process.
#[derive(Debug, Clone, Copy)]
struct DeclarationAddress(*const Declaration);

// SAFETY: declarations are constant, as the ABI demands.
unsafe impl Send for DeclarationAddress {}

/// What is loaded, by hashes: the same bytes are loaded once.
static LOADED: Mutex<BTreeMap<String, DeclarationAddress>> = Mutex::new(BTreeMap::new());

pub(crate) fn load(file: &LibraryFile) -> Result<Loaded, LibraryProblem> {
    let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    let declaration = match loaded.get(&file.blake3) {
        Some(known) => *known,
        None => load_first(file)?,
    };
    loaded.insert(file.blake3.clone(), declaration);
    // SAFETY: the entry returned the library's declaration, which lives as long as the library.
    let (name, version, models) = unsafe { read_declaration(declaration.0) }?;
    let listing = LibraryListing { name, version, path: file.path.clone(), blake3: file.blake3.clone() };
    let models = models
        .into_iter()
        // SAFETY: `read_declaration` found these tables within the declared ones.
        .map(|(address, size)| unsafe { read_model(address, size, &listing) })
        .collect::<Result<Vec<_>, LibraryProblem>>()?;
    Ok((listing, models))
}

/// Loads the bytes that were read: the file may be another one by now.
fn load_first(file: &LibraryFile) -> Result<DeclarationAddress, LibraryProblem> {
    let library = file
        .with_private_copy(|copy| {
            // SAFETY: loading runs the library's initialisers. That is what the user asks for by naming it: a plugin is
            // code that runs with the user's rights, like a linked crate.
            unsafe { Library::new(copy) }.map_err(|error| refused(&error, &format!("{}: ", copy.display())))
        })
        .map_err(|error| LibraryProblem::NotALibrary(format!("it cannot be copied: {error}")))??;
    let declaration = {
        // SAFETY: a function of this name is the ABI's entry; what it returns is checked before it is believed.
        let entry = unsafe { library.get::<unsafe extern "C" fn() -> *const Declaration>(abi::ENTRY) }
            .map_err(|_| LibraryProblem::NotAPlugin)?;
        // SAFETY: as above.
        unsafe { entry() }
    };
    // Code and constants of the library will be in use until the process ends.
    std::mem::forget(library);
    Ok(DeclarationAddress(declaration))
}

/// What the loader says of a library, which stands in the error's source.
fn refused(error: &libloading::Error, of_copy: &str) -> LibraryProblem {
    let said = std::error::Error::source(error).map_or_else(|| error.to_string(), ToString::to_string);
    LibraryProblem::NotALibrary(match said.strip_prefix(of_copy) {
        Some(said) => said.to_owned(),
        None => format!(
            "{said}; a plugin is one file, and libraries that lie beside it are not loaded: link them into it"
        ),
    })
}

type Tables = Vec<(*const ModelTable, usize)>;

/// # Safety
/// `declaration` is NULL, or what a library's entry returned.
unsafe fn read_declaration(
    declaration: *const Declaration,
) -> Result<(String, String, Tables), LibraryProblem> {
    if declaration.is_null() || !declaration.is_aligned() {
        return Err(LibraryProblem::NoDeclaration);
    }
    // SAFETY: magic and versions come first in every version of the declaration, so these may be read before anything
    // else is known of it.
    let (magic, major, minor) =
        unsafe { ((*declaration).magic, (*declaration).abi_major, (*declaration).abi_minor) };
    if magic != abi::MAGIC {
        return Err(LibraryProblem::NoDeclaration);
    }
    if major != abi::ABI_MAJOR {
        return Err(LibraryProblem::OtherVersion { major, minor });
    }
    // SAFETY: within a major version the declaration begins with our fields.
    let d = unsafe { &*declaration };
    for (what, found, least) in [
        ("declaration", d.declaration_size, size_of::<Declaration>()),
        ("model table", d.model_size, size_of::<ModelTable>()),
        ("description", d.description_size, size_of::<abi::Description>()),
        ("series", d.series_size, size_of::<abi::Series>()),
    ] {
        if (found as usize) < least || !(found as usize).is_multiple_of(8) {
            let reason = format!("its {what} has {found} bytes, version {major}.{minor} has {least}");
            return Err(LibraryProblem::Faulty(reason));
        }
    }
    if d.model_count > 0 && (d.models.is_null() || !d.models.is_aligned()) {
        return Err(LibraryProblem::Faulty("its list of models is missing".to_owned()));
    }
    if d.model_count > MOST {
        let reason = format!("it claims {} models; a library has at most {MOST}", d.model_count);
        return Err(LibraryProblem::Faulty(reason));
    }
    // SAFETY: the texts of a declaration are NULL or end with NUL.
    let (name, version) =
        unsafe { (text(d.name, "name of the library"), text(d.version, "version of the library")) };
    let tables = (0..d.model_count)
        // SAFETY: the library declares `model_count` tables, `model_size` bytes apart.
        .map(|i| unsafe { d.models.byte_add(i * d.model_size as usize) })
        .map(|table| (table, d.description_size as usize))
        .collect();
    Ok((name?.to_owned(), version?.to_owned(), tables))
}

/// # Safety
/// `address` is a table of a loaded library whose declaration was accepted.
unsafe fn read_model(
    address: *const ModelTable,
    description_size: usize,
    library: &LibraryListing,
) -> Result<Listed, LibraryProblem> {
    // SAFETY: the caller promises it.
    let table = unsafe { *address };
    // SAFETY: the texts of a table are NULL or end with NUL.
    let named = |t, what| unsafe { text(t, what) };
    let name = named(table.name, "name of a model")?;
    let faulty = |what: &str| LibraryProblem::Faulty(format!("model `{name}` {what}"));
    if name.is_empty() || name.contains(|c: char| c.is_whitespace() || c.is_control() || c == '`') {
        let reason = format!("a model is called `{}`; names are words", aurt_files::clipped(name));
        return Err(LibraryProblem::Faulty(reason));
    }
    let slot = match table.slot {
        abi::COULOMB => Slot::Coulomb,
        abi::HYSTERESIS => Slot::Hysteresis,
        abi::VISCOUS => Slot::Viscous,
        abi::ARM_TERM => Slot::ArmTerm,
        other => return Err(faulty(&format!("is for slot {other}, which does not exist"))),
    };
    for (function, there) in [
        ("create", table.create.is_some()),
        ("destroy", table.destroy.is_some()),
        ("describe", table.describe.is_some()),
        ("evaluate", table.evaluate.is_some()),
    ] {
        if !there {
            return Err(faulty(&format!("has no function `{function}`")));
        }
    }
    let listing = ModelListing {
        slot,
        name: name.to_owned(),
        summary: named(table.summary, "summary of a model")?.to_owned(),
        equation: named(table.equation, "equation of a model")?.to_owned(),
        use_when: named(table.use_when, "use of a model")?.to_owned(),
        source: named(table.source, "source of a model")?.to_owned(),
        example: named(table.example, "example of a model")?.to_owned(),
        origin: Origin::Library(library.clone()),
    };
    let table = Table { functions: table, description_size, address };
    Ok((listing, Arc::new(LibraryModel { table, name, library: library.clone() })))
}

/// # Safety
/// `text` is NULL, or a text of a loaded library that ends with NUL.
unsafe fn text(text: *const c_char, what: &str) -> Result<&'static str, LibraryProblem> {
    if text.is_null() {
        return Err(LibraryProblem::Faulty(format!("the {what} is missing")));
    }
    // SAFETY: the caller promises it; libraries are never unloaded.
    unsafe { CStr::from_ptr(text) }
        .to_str()
        .map_err(|_| LibraryProblem::Faulty(format!("the {what} is not UTF-8")))
}
