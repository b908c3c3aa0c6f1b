//! Points as jobs of a Slurm array, each `aurt sweep point N`.

use std::{
    ffi::OsString,
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::{Folder, SweepError};

/// A job array.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// Slurm's number of the array.
    pub job: String,
    /// Its elements: numbers of points.
    pub points: Vec<usize>,
    /// Where the jobs' output goes.
    pub output: PathBuf,
}

/// Submits points as a job array; `arguments` go to `sbatch` as they are (`--partition=…`, `--time=…`, `--wait`).
///
/// # Errors
/// [`SweepError::Slurm`] if `sbatch` cannot be run or refuses.
pub fn submit(
    folder: &Folder,
    points: &[usize],
    program: &Path,
    plugins: &[PathBuf],
    arguments: &[String],
) -> Result<Submission, SweepError> {
    let absolute = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let output = absolute(folder.path()).join("slurm");
    fs::create_dir_all(&output).map_err(|source| SweepError::Write { path: output.clone(), source })?;
    let mut script = vec!["exec".to_owned(), shell_word(&absolute(program))];
    script.extend(plugins.iter().map(|p| format!("--plugin {}", shell_word(&absolute(p)))));
    script.push("sweep point \"$SLURM_ARRAY_TASK_ID\" --out".into());
    script.push(shell_word(&absolute(folder.path())));
    let mut log = OsString::from("--output=");
    log.push(output.join("%A_%a.out"));
    let mut command = Command::new("sbatch");
    command
        .args(["--parsable", "--job-name=aurt-sweep"])
        .arg(format!("--array={}", ranges(points)))
        .arg(log)
        .args(arguments)
        .arg("--wrap")
        .arg(script.join(" "));
    let done = command.output().map_err(|e| SweepError::Slurm {
        problem: format!("cannot be run: {e}; is this a machine from which Slurm takes jobs?"),
    })?;
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    if !done.status.success() {
        // With --wait, the status is that of the jobs.
        let waited = arguments.iter().any(|a| a == "--wait" || a == "-W") && !said(&done.stdout).is_empty();
        if !waited {
            return Err(SweepError::Slurm { problem: format!("refused: {}", said(&done.stderr)) });
        }
    }
    // "JOB" or "JOB;CLUSTER".
    let answer = said(&done.stdout);
    let job = answer.lines().next().and_then(|l| l.split(';').next()).unwrap_or_default().to_owned();
    Ok(Submission { job, points: points.to_vec(), output })
}

/// Ascending numbers as Slurm writes them: `1-3,7`.
#[must_use]
pub fn ranges(numbers: &[usize]) -> String {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for n in numbers {
        match runs.last_mut() {
            Some((_, last)) if *last + 1 == *n => *last = *n,
            _ => runs.push((*n, *n)),
        }
    }
    let text = |(first, last): (usize, usize)| {
        if first == last { first.to_string() } else { format!("{first}-{last}") }
    };
    runs.into_iter().map(text).collect::<Vec<_>>().join(",")
}

/// A path as one word of a shell command.
fn shell_word(path: &Path) -> String {
    format!("'{}'", path.to_string_lossy().replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_numbers_are_written_as_ranges() {
        assert_eq!(ranges(&[1, 2, 3, 7, 9, 10]), "1-3,7,9-10");
        assert_eq!(ranges(&[]), "");
    }

    #[test]
    fn paths_with_spaces_and_quotes_stay_one_word() {
        assert_eq!(shell_word(Path::new("/a b/it's")), "'/a b/it'\\''s'");
    }
}
