//! Ctrl-C: what is being written goes, what is written stays.

use std::{
    process::Command,
    sync::atomic::{AtomicU32, Ordering},
};

use crate::rendering::terminal::print_error;

/// Exit status of a command that was interrupted, as shells have it for SIGINT.
const INTERRUPTED: i32 = 130;

/// The process below that does the work, if there is one.
static BELOW: AtomicU32 = AtomicU32::new(0);

/// From now on interruptions are handed on to the process below, which ends by itself and so ends this one.
pub fn hand_on(process: u32) {
    BELOW.store(process, Ordering::SeqCst);
}

/// From now on a command that is interrupted (SIGINT, SIGTERM, SIGHUP) ends at once: what is being written is removed,
/// results that are written whole stay, and a line says so.
pub fn listen() {
    let listening = ctrlc::set_handler(|| {
        let below = BELOW.load(Ordering::SeqCst);
        if below != 0 {
            // One that has ended already cannot be told.
            let _ = Command::new("kill").args(["-s", "TERM", &below.to_string()]).output();
            return;
        }
        let kept = aurt_files::output::abandon();
        let said = match kept {
            0 => "nothing was written".to_owned(),
            1 => "one file had been written before and is whole".to_owned(),
            kept => format!("{kept} files had been written before and are whole"),
        };
        print_error(&format!("\ninterrupted: {said}; a sweep or a proof goes on when it is run again\n"));
        std::process::exit(INTERRUPTED);
    });
    // Without it an interruption ends the command all the same, and the next one removes what it left.
    drop(listening);
}
