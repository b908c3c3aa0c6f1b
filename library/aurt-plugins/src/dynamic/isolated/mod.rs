//! Libraries in processes of their own: what such a process does wrong ends with it.
//!
//! A host that offers this ([`Registry::serve_with`](crate::Registry::serve_with)) names a program that becomes the
//! process of a library when it is started with [`Worker::ARGUMENT`] and the library's path; [`serve_if_asked`], called
//! first in `main`, makes a program one.
//!
//! Host and process talk over a socket, a request and a reply at a time (`frame`). A library has as many processes as
//! threads ask for it at once (`pool`). An instance lives on both sides (`remote`, `serve`): the host keeps what it was
//! made from, so that a process that ended is replaced at the next call.

mod frame;
mod pool;
mod remote;
mod serve;

use std::{
    env,
    ffi::OsString,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::Arc,
    time::Duration,
};

pub(super) use self::{pool::Pool, remote::Remote};
use super::library::{Code, LibraryListing, LibraryModel, LibraryProblem};
use crate::{Error, registry::ModelListing, registry::Origin};

/// Seconds that a single call of a library's function may take.
const TIME_LIMIT: &str = "AURT_LIBRARY_TIME_LIMIT_S";
/// Without [`TIME_LIMIT`]: a call evaluates some thousand samples, which takes milliseconds.
const USUAL_TIME: Duration = Duration::from_secs(60);
/// Memory that the process of a library may ask for, in units of 2^20 bytes.
const MEMORY_LIMIT: &str = "AURT_LIBRARY_MEMORY_LIMIT_MIB";
/// Without [`MEMORY_LIMIT`]: the series and columns of a recording of 10^7 rows have room.
const USUAL_MEMORY_MIB: u64 = 8192;

/// The program that serves libraries, and what stands before [`Worker::ARGUMENT`] among its arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Worker {
    /// The program.
    pub program: PathBuf,
    /// Its first arguments.
    pub arguments: Vec<OsString>,
}

impl Worker {
    /// What tells a program that it is to serve the library whose path follows.
    pub const ARGUMENT: &str = "serve-library";

    /// The program that is running, which calls [`serve_if_asked`] first of all.
    ///
    /// # Errors
    /// If the system does not say which program that is.
    pub fn this_program() -> std::io::Result<Self> {
        Ok(Self { program: env::current_exe()?, arguments: Vec::new() })
    }
}

/// The longest time that a call of a library's function may take: `AURT_LIBRARY_TIME_LIMIT_S`, or 60 s.
#[must_use]
pub fn time_limit() -> Duration {
    let wanted = env::var(TIME_LIMIT).ok().and_then(|text| text.parse::<f64>().ok()).filter(|s| *s > 0.0);
    wanted.and_then(|s| Duration::try_from_secs_f64(s).ok()).unwrap_or(USUAL_TIME)
}

fn memory_limit_mib() -> u64 {
    let wanted = env::var(MEMORY_LIMIT).ok().and_then(|text| text.parse::<u64>().ok());
    wanted.filter(|mib| *mib > 0).unwrap_or(USUAL_MEMORY_MIB)
}

/// If the program was started to serve a library, serves it until the host goes, and says with which status to leave.
///
/// ```no_run
/// use std::process::ExitCode;
///
/// fn main() -> ExitCode {
///     if let Some(status) = aurt_plugins::serve_if_asked() {
///         return status;
///     }
///     // What the program is otherwise for.
///     ExitCode::SUCCESS
/// }
/// ```
#[must_use]
pub fn serve_if_asked() -> Option<ExitCode> {
    let mut arguments = env::args_os().skip(1);
    if arguments.next()? != Worker::ARGUMENT {
        return None;
    }
    let library = PathBuf::from(arguments.next()?);
    Some(serve::serve(&library))
}

/// A model's listing and the model.
type Listed = (ModelListing, Arc<LibraryModel>);

/// Starts a process for a library and lists its models.
pub(crate) fn load(path: &Path, worker: &Worker) -> Result<(LibraryListing, Vec<Listed>), Error> {
    let fail = |problem| Error::Library { path: path.to_owned(), problem };
    let file = path.canonicalize().map_err(|_| fail(LibraryProblem::Missing))?;
    let blake3 = crate::trust::hash_of(&file)?;
    let (pool, offer) = Pool::start(file.clone(), worker.clone()).map_err(fail)?;
    let library = LibraryListing { name: offer.name, version: offer.version, path: file, blake3 };
    let pool = Arc::new(pool);
    let listed = |(number, model): (usize, frame::OfferedModel)| {
        let listing = ModelListing {
            slot: model.slot,
            name: model.name.clone(),
            summary: model.summary,
            equation: model.equation,
            use_when: model.use_when,
            source: model.source,
            example: model.example,
            origin: Origin::Library(library.clone()),
        };
        let model = LibraryModel {
            code: Code::Isolated { pool: pool.clone(), number },
            slot: model.slot,
            // As long as the process, like names of libraries that are loaded into it: once for each library.
            name: model.name.leak(),
            library: library.clone(),
        };
        (listing, Arc::new(model))
    };
    Ok((library.clone(), offer.models.into_iter().enumerate().map(listed).collect()))
}
