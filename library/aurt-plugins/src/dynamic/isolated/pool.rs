//! The host's side: processes of a library, each for one thread at a time.

use std::{
    collections::HashSet,
    io::{self, Read},
    path::PathBuf,
    sync::{
        Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use super::{
    TIME_LIMIT, Worker,
    frame::{self, Offer, Reply, Request},
    remote::Remote,
    time_limit,
};
use crate::dynamic::{instance::Fault, library::LibraryProblem};

/// Processes of one library that may end before it is given up.
const MOST_CRASHES: usize = 16;
/// Instances that a process may hold before it is told to forget them.
const MOST_INSTANCES: usize = 256;

/// The processes of a library.
#[derive(Debug)]
pub struct Pool {
    library: PathBuf,
    worker: Worker,
    time_limit: Duration,
    /// Processes at once.
    most: usize,
    next_instance: AtomicU64,
    state: Mutex<State>,
    returned: Condvar,
}

#[derive(Debug, Default)]
struct State {
    idle: Vec<Process>,
    /// Processes that run, idle or not.
    running: usize,
    crashes: usize,
}

/// A process and the instances that it has.
#[derive(Debug)]
struct Process {
    child: system::Child,
    known: HashSet<u64>,
}

impl Pool {
    /// Starts the first process of a library.
    ///
    /// # Errors
    /// What the process says of the library, or how it ended.
    pub(super) fn start(library: PathBuf, worker: Worker) -> Result<(Self, Offer), LibraryProblem> {
        let pool = Self {
            library,
            worker,
            time_limit: time_limit(),
            most: std::thread::available_parallelism().map_or(1, usize::from),
            next_instance: AtomicU64::new(0),
            state: Mutex::default(),
            returned: Condvar::new(),
        };
        let (process, offer) = pool.spawn()?;
        pool.locked().running = 1;
        pool.give_back(process);
        Ok((pool, offer))
    }

    fn locked(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn new_instance(&self) -> u64 {
        self.next_instance.fetch_add(1, Ordering::Relaxed)
    }

    fn spawn(&self) -> Result<(Process, Offer), LibraryProblem> {
        let mut child = system::spawn(&self.worker, &self.library)
            .map_err(|e| LibraryProblem::Process(format!("cannot be started: {e}")))?;
        let deadline = Instant::now() + self.time_limit;
        match frame::read::<Result<Offer, LibraryProblem>>(&mut child.until(deadline), 0) {
            Ok((Ok(offer), _)) => Ok((Process { child, known: HashSet::new() }, offer)),
            Ok((Err(problem), _)) => Err(problem),
            Err(error) => Err(LibraryProblem::Process(self.ended(child, &error))),
        }
    }

    /// How a process ended that did not answer.
    fn ended(&self, mut child: system::Child, error: &io::Error) -> String {
        match error.kind() {
            io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut => {
                child.kill();
                format!(
                    "has not returned for {:.1} s and was ended; {TIME_LIMIT} sets another limit",
                    self.time_limit.as_secs_f64()
                )
            }
            io::ErrorKind::InvalidData => {
                child.kill();
                format!("answered what is no answer ({error}) and was ended")
            }
            _ => child.how_it_ended(),
        }
    }

    /// A process, one that has the instance where there is a choice; waits where as many as may be are at work.
    fn take(&self, instance: u64) -> Result<Process, Fault> {
        let mut state = self.locked();
        loop {
            if let Some(known) = state.idle.iter().position(|p| p.known.contains(&instance)) {
                return Ok(state.idle.swap_remove(known));
            }
            if let Some(process) = state.idle.pop() {
                return Ok(process);
            }
            if state.crashes >= MOST_CRASHES {
                return Err(Fault(format!(
                    "its library's process has ended {MOST_CRASHES} times and is not started again"
                )));
            }
            if state.running < self.most {
                state.running += 1;
                drop(state);
                return self.spawn().map(|(process, _)| process).map_err(|problem| {
                    self.lost();
                    Fault(format!("its library {} {problem}", self.library.display()))
                });
            }
            state = self.returned.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn give_back(&self, process: Process) {
        self.locked().idle.push(process);
        self.returned.notify_one();
    }

    fn lost(&self) {
        let mut state = self.locked();
        state.running -= 1;
        state.crashes += 1;
        drop(state);
        self.returned.notify_one();
    }

    /// Has an instance do something; `most` numbers are expected in return.
    ///
    /// # Errors
    /// What the library says; how its process ended, with the library's path.
    pub(super) fn call(
        &self,
        instance: &Remote,
        request: &Request,
        numbers: &[&[f64]],
        most: usize,
    ) -> Result<(Reply, Vec<f64>), Fault> {
        let mut process = self.take(instance.number)?;
        match self.ask(&mut process, instance, request, numbers, most) {
            Ok(answer) => {
                self.give_back(process);
                match answer {
                    (Reply::Fault(reason), _) => Err(Fault(reason)),
                    done => Ok(done),
                }
            }
            Err(error) => {
                let how = self.ended(process.child, &error);
                self.lost();
                let library = self.library.display();
                Err(Fault(format!("the process of its library {library} {how}")))
            }
        }
    }

    fn ask(
        &self,
        process: &mut Process,
        instance: &Remote,
        request: &Request,
        numbers: &[&[f64]],
        most: usize,
    ) -> io::Result<(Reply, Vec<f64>)> {
        let mut answered = |request: &Request, numbers: &[&[f64]], most: usize| {
            frame::write(&mut process.child.until(Instant::now() + self.time_limit), request, numbers)?;
            let deadline = Instant::now() + self.time_limit;
            frame::read::<Reply>(&mut process.child.until(deadline), most as u64)
        };
        if !process.known.contains(&instance.number) {
            if process.known.len() >= MOST_INSTANCES {
                answered(&Request::Forget, &[], 0)?;
                process.known.clear();
            }
            let shape = instance.shape.as_deref();
            let create = instance.create(shape.is_some());
            let (reply, _) = answered(&create, &[shape.unwrap_or_default()], 0)?;
            if let Reply::Fault(_) = reply {
                return Ok((reply, Vec::new()));
            }
            process.known.insert(instance.number);
        }
        answered(request, numbers, most)
    }
}

/// Reads until a moment.
pub(super) struct Until<'c, S> {
    pub(super) stream: &'c mut S,
    pub(super) deadline: Instant,
}

impl<S> Until<'_, S> {
    /// The time that is left.
    fn left(&self) -> io::Result<Duration> {
        let left = self.deadline.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(io::ErrorKind::TimedOut.into()) } else { Ok(left) }
    }
}

#[cfg(unix)]
mod system {
    use std::{
        io::Write,
        os::{
            fd::{AsFd, OwnedFd},
            unix::{
                net::UnixStream,
                process::{CommandExt, ExitStatusExt},
            },
        },
        path::Path,
        process::{self, Command, Stdio},
    };

    use super::{super::memory_limit_mib, Duration, Instant, Read, Until, Worker, io};

    /// Time that a process without a socket has to end.
    const GOING: Duration = Duration::from_secs(2);

    #[derive(Debug)]
    pub struct Child {
        process: process::Child,
        stream: UnixStream,
    }

    pub fn spawn(worker: &Worker, library: &Path) -> io::Result<Child> {
        let (ours, theirs) = UnixStream::pair()?;
        // What a library prints is no result of the command.
        let printed: OwnedFd = io::stderr().as_fd().try_clone_to_owned()?;
        let process = Command::new(&worker.program)
            .args(&worker.arguments)
            .arg(Worker::ARGUMENT)
            .arg(library)
            .stdin(Stdio::from(OwnedFd::from(theirs)))
            .stdout(Stdio::from(printed))
            // Ctrl-C is for the host, which takes its processes with it.
            .process_group(0)
            .spawn()?;
        Ok(Child { process, stream: ours })
    }

    impl Child {
        pub fn until(&mut self, deadline: Instant) -> Until<'_, UnixStream> {
            Until { stream: &mut self.stream, deadline }
        }

        pub fn kill(&mut self) {
            // A process that has ended already cannot be ended.
            let _ = self.process.kill();
            let _ = self.process.wait();
        }

        /// The signal or status of a process that has closed its socket.
        pub fn how_it_ended(&mut self) -> String {
            let begin = Instant::now();
            while begin.elapsed() < GOING {
                match self.process.try_wait() {
                    Ok(Some(status)) => {
                        return match (status.signal(), status.code()) {
                            (Some(signal), _) => format!(
                                "crashed (signal {signal}; it may ask for {} MiB of memory)",
                                memory_limit_mib()
                            ),
                            (None, Some(code)) => format!("ended itself with exit status {code}"),
                            (None, None) => "ended without a status".to_owned(),
                        };
                    }
                    Ok(None) => std::thread::sleep(Duration::from_millis(1)),
                    Err(_) => break,
                }
            }
            self.kill();
            "closed its socket".to_owned()
        }
    }

    impl Drop for Child {
        fn drop(&mut self) {
            self.kill();
        }
    }

    impl Read for Until<'_, UnixStream> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.stream.set_read_timeout(Some(self.left()?))?;
            self.stream.read(buffer)
        }
    }

    impl Write for Until<'_, UnixStream> {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.stream.set_write_timeout(Some(self.left()?))?;
            self.stream.write(bytes)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
}

#[cfg(not(unix))]
mod system {
    use std::{io::Write, path::Path};

    use super::{Instant, Read, Until, Worker, io};

    /// No process: sockets between processes are Unix'.
    #[derive(Debug)]
    pub enum Child {}

    /// Nothing to read from.
    #[derive(Debug)]
    pub struct Nothing;

    pub fn spawn(_: &Worker, _: &Path) -> io::Result<Child> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "libraries have processes of their own on Unix alone"))
    }

    impl Child {
        pub fn until(&mut self, _: Instant) -> Until<'_, Nothing> {
            match *self {}
        }

        pub fn kill(&mut self) {
            match *self {}
        }

        pub fn how_it_ended(&mut self) -> String {
            match *self {}
        }
    }

    impl Read for Until<'_, Nothing> {
        fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
            self.left().map(|_| 0)
        }
    }

    impl Write for Until<'_, Nothing> {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            self.left().map(|_| 0)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
}
