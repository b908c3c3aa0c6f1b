//! The library of a unit, made by the C compiler of this machine.

use std::process::Command;

use aurt_files::output::StagedFolder;

type File = (String, Vec<u8>);

/// The folder of libraries of this platform, if the standard has a name for it and libraries are made for it here.
const PLATFORM: Option<&str> =
    if cfg!(all(target_os = "linux", target_arch = "x86_64")) { Some("linux64") } else { None };

/// The library made of `sources` for this platform, and a word about it; none where it cannot be made.
pub(super) fn build(name: &str, sources: &[(String, String)]) -> (Option<File>, String) {
    let without = |reason: &str| {
        (
            None,
            format!(
                "the FMU holds sources only: {reason}; importers have to compile it, or install a C compiler"
            ),
        )
    };
    let Some(platform) = PLATFORM else {
        return without("libraries are made for Linux on x86-64 alone");
    };
    let compiler = std::env::var_os("CC").filter(|c| !c.is_empty()).unwrap_or_else(|| "cc".into());
    match compiled(name, &compiler, sources) {
        Ok(bytes) => {
            let file = format!("binaries/{platform}/{name}.so");
            (Some((file.clone(), bytes)), format!("{file} was made by `{}`", compiler.display()))
        }
        Err(reason) => without(&reason),
    }
}

fn compiled(name: &str, compiler: &std::ffi::OsStr, sources: &[(String, String)]) -> Result<Vec<u8>, String> {
    let no_room = |error: std::io::Error| format!("there is no room for the compiler: {error}");
    // What a killed export left there goes first.
    aurt_files::output::clear_unfinished(&std::env::temp_dir());
    let folder = StagedFolder::new(&std::env::temp_dir()).map_err(|error| no_room(error.source))?;
    for (file, text) in sources {
        std::fs::write(folder.path().join(file), text).map_err(no_room)?;
    }
    let library = format!("{name}.so");
    let run = Command::new(compiler)
        .args(["-std=c99", "-O2", "-ffp-contract=off", "-fPIC", "-fvisibility=hidden", "-shared", "-s"])
        .args(sources.iter().map(|(file, _)| file).filter(|file| file.ends_with(".c")))
        .args(["-o", &library, "-lm"])
        .current_dir(folder.path())
        .output();
    let run =
        run.map_err(|error| format!("the C compiler `{}` cannot be run ({error})", compiler.display()))?;
    if !run.status.success() {
        let words = String::from_utf8_lossy(&run.stderr);
        let first = words.lines().next().unwrap_or("without a word");
        return Err(format!("the C compiler `{}` failed: {first}", compiler.display()));
    }
    std::fs::read(folder.path().join(library)).map_err(no_room)
}
