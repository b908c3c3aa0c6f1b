//! Ctrl-C: what is being written goes, what is written stays.

use crate::rendering::terminal::print_error;

/// Exit status of a command that was interrupted, as shells have it for SIGINT.
const INTERRUPTED: i32 = 130;

/// From now on a command that is interrupted (SIGINT, SIGTERM, SIGHUP) ends at once: what is being written is removed,
/// results that are written whole stay, and a line says so.
pub fn listen() {
    let listening = ctrlc::set_handler(|| {
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
