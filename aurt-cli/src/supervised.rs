//! Libraries of models run in a process of their own kind: the same command once more, below one that says which library
//! crashed or does not return.
//!
//! A library is code that runs with the rights of whoever named it; this is no protection against malice. It keeps a
//! crash from passing without a word and an endless loop from lasting for ever.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::{Command, ExitStatus},
    sync::OnceLock,
    time::Duration,
};

use crate::rendering::terminal::print_error;

/// Names the file in which the process below notes what it calls; also says that it is the one below.
const NOTE: &str = "AURT_LIBRARY_NOTE";
/// Seconds that a single call of a library's function may take.
const LIMIT: &str = "AURT_LIBRARY_TIME_LIMIT_S";
/// How often calls are looked at.
const EVERY: Duration = Duration::from_millis(100);
/// Exit status of a command that failed.
const FAILURE: i32 = 2;
/// In the place of a call: the command has come to its end.
const ENDED: &str = "ended";

/// The file of notes of this process.
static NOTED: OnceLock<PathBuf> = OnceLock::new();

/// Called before a library is loaded. In the first process this runs the whole command in a second one and ends with
/// its status; in that one it notes the library.
pub fn before_library(library: &Path) {
    if let Some(note) = env::var_os(NOTE) {
        if NOTED.set(note.into()).is_ok() {
            aurt_plugins::watch_calls(note_call);
            watch_time();
        }
        note_call(&format!("the loading of the library {}", library.display()));
        return;
    }
    // Where there is no second process to be had, the library runs in this one, as it would have anyhow.
    let Ok(note) = tempfile::NamedTempFile::new() else { return };
    let Ok(program) = env::current_exe() else { return };
    let mut below = Command::new(program);
    below.args(env::args_os().skip(1)).env(NOTE, note.path());
    // Whoever interrupts the first process means the second, which has the files.
    let Ok(mut running) = below.spawn() else { return };
    crate::interrupt::hand_on(running.id());
    let Ok(status) = running.wait() else { return };
    let status = status.code().unwrap_or_else(|| {
        let called = fs::read_to_string(note.path()).unwrap_or_default();
        say(&format!("{called} crashed{}; nothing that was being written is kept", signal(status)));
        FAILURE
    });
    let unfinished = || fs::read_to_string(note.path()).ok().filter(|called| called != ENDED);
    if status < FAILURE
        && let Some(called) = unfinished()
    {
        say(&format!("{called} ended the command with exit status {status}, which a library must not do"));
        drop(note);
        std::process::exit(FAILURE);
    }
    // `exit` runs no destructors.
    drop(note);
    std::process::exit(status);
}

/// Notes that the command came to its end, so that whoever is above knows that no library has ended it.
pub fn ended() {
    if NOTED.get().is_some() {
        note_call(ENDED);
    }
}

fn note_call(called: &str) {
    if let Some(path) = NOTED.get() {
        // A note that cannot be written only makes a later message shorter.
        let _ = fs::write(path, called);
    }
}

/// Ends the command when a call takes longer than it may.
fn watch_time() {
    let limit = aurt_plugins::time_limit();
    std::thread::spawn(move || {
        loop {
            std::thread::sleep(EVERY);
            if let Some((called, time)) = aurt_plugins::longest_call().filter(|(_, time)| *time > limit) {
                let kept = aurt_files::output::abandon();
                say(&format!(
                    "{called} has not returned for {:.1} s and is ended ({kept} files had been written before); \
                     {LIMIT} sets another limit",
                    time.as_secs_f64()
                ));
                std::process::exit(FAILURE);
            }
        }
    });
}

fn say(what: &str) {
    print_error(&format!("Error: {what}\n"));
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> String {
    use std::os::unix::process::ExitStatusExt;
    status.signal().map_or_else(String::new, |number| format!(" (signal {number})"))
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> String {
    String::new()
}
