//! The process's side: it loads the library, makes its instances, and evaluates every batch between guards.

use std::{
    collections::BTreeMap,
    io::{self, Read, Write},
    path::Path,
    process::ExitCode,
    sync::Arc,
};

use aurt_traits::{Columns, abi::Series};

use super::frame::{self, Offer, OfferedModel, Reply, Request, Size};
use crate::{
    Error,
    dynamic::{
        guarded,
        instance::{Fault, Instance},
        library::{self, LibraryModel, LibraryProblem},
    },
};

/// Status of a process that has nobody to serve.
const NOBODY: u8 = 2;

/// Serves a library over the socket that is the standard input, until the host closes it.
pub(super) fn serve(path: &Path) -> ExitCode {
    let served = system::socket().and_then(|mut socket| {
        let loaded = library::load(path);
        serve_over(&mut socket, loaded)
    });
    match served {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => ExitCode::SUCCESS,
        Err(error) => {
            // Nothing is left to do where standard error is closed.
            let _ = writeln!(io::stderr(), "Error: this serves libraries to other processes alone: {error}");
            ExitCode::from(NOBODY)
        }
    }
}

fn serve_over(socket: &mut (impl Read + Write), loaded: Result<library::Loaded, Error>) -> io::Result<()> {
    let (listing, models) = match loaded {
        Ok(loaded) => loaded,
        Err(error) => {
            let problem = match error {
                Error::Library { problem, .. } => problem,
                other => LibraryProblem::Process(other.to_string()),
            };
            return frame::write(socket, &Err::<Offer, _>(problem), &[]);
        }
    };
    let offered = models.iter().map(|(listing, _)| OfferedModel {
        slot: listing.slot,
        name: listing.name.clone(),
        summary: listing.summary.clone(),
        equation: listing.equation.clone(),
        use_when: listing.use_when.clone(),
        source: listing.source.clone(),
        example: listing.example.clone(),
    });
    let offer = Offer { name: listing.name, version: listing.version, models: offered.collect() };
    frame::write(socket, &Ok::<_, LibraryProblem>(offer), &[])?;
    let models: Vec<Arc<LibraryModel>> = models.into_iter().map(|(_, model)| model).collect();
    let mut instances = BTreeMap::new();
    loop {
        let (request, numbers) = frame::read::<Request>(socket, u64::MAX >> 4)?;
        match answer(&models, &mut instances, request, &numbers) {
            Ok((reply, numbers)) => frame::write(socket, &reply, &[&numbers])?,
            Err(Fault(reason)) => frame::write(socket, &Reply::Fault(reason), &[])?,
        }
    }
}

type Instances = BTreeMap<u64, Instance>;

fn answer(
    models: &[Arc<LibraryModel>],
    instances: &mut Instances,
    request: Request,
    numbers: &[f64],
) -> Result<(Reply, Vec<f64>), Fault> {
    let done = |numbers| Ok((Reply::Done, numbers));
    match request {
        Request::Forget => {
            instances.clear();
            done(Vec::new())
        }
        Request::Create { instance, model, config, shaped } => {
            let model = models.get(model).ok_or_else(|| Fault("it is not in the library".into()))?;
            let made = Instance::create(model.clone(), config)?;
            let made = if shaped { made.with_shape(numbers)? } else { made };
            instances.insert(instance, made);
            done(Vec::new())
        }
        Request::Describe { instance, robot_joints } => {
            let described = known(instances, instance)?.describe(robot_joints)?;
            Ok((Reply::Described((&*described).into()), Vec::new()))
        }
        Request::InitialState { instance, size, state_len } => {
            let instance = known(instances, instance)?;
            done(instance.initial_state(&series(size, numbers)?, state_len)?)
        }
        Request::Evaluate { instance, size, state_len, columns } => {
            let instance = known(instances, instance)?;
            let series = series(size, numbers)?;
            let state = numbers.get(size.numbers()..).filter(|state| state.len() == state_len);
            let mut state = state.ok_or_else(|| Fault("a state of another length".into()))?.to_vec();
            let mut values = vec![0.0; columns * size.samples];
            let mut out = Columns::new(&mut values, columns, size.samples, size.samples);
            guarded::evaluate(instance, &series, &mut state, &mut out)?;
            values.extend(state);
            done(values)
        }
    }
}

fn known(instances: &Instances, number: u64) -> Result<&Instance, Fault> {
    instances.get(&number).ok_or_else(|| Fault("there is no such instance in the process".into()))
}

/// The ABI's series of numbers, which have to outlive it.
fn series(size: Size, numbers: &[f64]) -> Result<Series, Fault> {
    let numbers = numbers.get(..size.numbers()).ok_or_else(|| Fault("series are too short".into()))?;
    let [time, position, velocity, acceleration, load] = size.read(numbers);
    Ok(Series {
        size: size_of::<Series>(),
        samples: size.samples,
        joints: size.joints,
        stride: size.samples,
        load_stride: size.samples,
        time_s: time.as_ptr(),
        position_rad: position.as_ptr(),
        velocity_rad_s: velocity.as_ptr(),
        acceleration_rad_s2: acceleration.as_ptr(),
        load_torque: load.as_ptr(),
    })
}

#[cfg(unix)]
mod system {
    use std::{
        fs, io,
        os::{
            fd::AsFd,
            unix::{net::UnixStream, process::parent_id},
        },
        time::Duration,
    };

    use rustix::process::{Resource, Rlimit, setrlimit};

    use super::super::memory_limit_mib;

    /// How often the process looks whether its host is still there.
    const EVERY: Duration = Duration::from_millis(500);

    /// The socket to the host; standard input is empty from now on, memory is limited, and the process ends with its
    /// host, also while the library runs.
    pub fn socket() -> io::Result<UnixStream> {
        let socket = UnixStream::from(io::stdin().as_fd().try_clone_to_owned()?);
        // What is no socket has no peer.
        socket.peer_addr()?;
        rustix::stdio::dup2_stdin(fs::File::open("/dev/null")?)?;
        let bytes = memory_limit_mib().saturating_mul(1 << 20);
        for (resource, most) in [(Resource::As, bytes), (Resource::Core, 0)] {
            // Where a system does not limit memory, a library has what there is.
            let _ = setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) });
        }
        let host = parent_id();
        std::thread::spawn(move || {
            while parent_id() == host {
                std::thread::sleep(EVERY);
            }
            std::process::exit(0);
        });
        Ok(socket)
    }
}

#[cfg(not(unix))]
mod system {
    use std::io::{self, Cursor};

    /// No socket: those between processes are Unix'.
    pub fn socket() -> io::Result<Cursor<Vec<u8>>> {
        Err(io::ErrorKind::Unsupported.into())
    }
}
