//! Points as jobs of a Slurm array, each `aurt sweep point N`.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::sweep::{Folder, SweepError};

/// Largest element of an array that Slurm takes unless `MaxArraySize` allows more.
const LARGEST_ELEMENT: usize = 1000;

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Submission {
    /// Slurm's numbers of the arrays: one for each thousand points of the plan.
    pub jobs: Vec<String>,
    pub points: Vec<usize>,
    pub output: PathBuf,
}

/// Submits points, in ascending order, as job arrays. `program` is the command line that starts `aurt`; `arguments` go to
/// `sbatch` as they are (`--partition=…`, `--time=…`, `--wait`).
pub fn submit(
    folder: &Folder,
    points: &[usize],
    program: &[OsString],
    plugins: &[PathBuf],
    arguments: &[String],
) -> Result<Submission, SweepError> {
    let absolute = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let output = absolute(folder.path()).join("slurm");
    fs::create_dir_all(&output).map_err(|source| SweepError::Write { path: output.clone(), source })?;
    let mut words = vec!["exec".to_owned()];
    words.extend(program.iter().map(|word| shell_word(Path::new(word))));
    words.extend(plugins.iter().map(|p| format!("--plugin {}", shell_word(&absolute(p)))));
    let mut log = OsString::from("--output=");
    log.push(output.join("%A_%a.out"));
    let mut jobs: Vec<String> = Vec::new();
    for chunk in points.chunk_by(|a, b| block_of(*a) == block_of(*b)) {
        let Some(offset) = chunk.first().map(|p| block_of(*p) * LARGEST_ELEMENT) else { continue };
        let elements: Vec<usize> = chunk.iter().map(|p| p - offset).collect();
        let point = match offset {
            0 => "\"$SLURM_ARRAY_TASK_ID\"".to_owned(),
            _ => format!("\"$((SLURM_ARRAY_TASK_ID + {offset}))\""),
        };
        let script =
            format!("{} sweep point {point} --out {}", words.join(" "), shell_word(&absolute(folder.path())));
        let mut command = Command::new("sbatch");
        command
            .args(["--parsable", "--job-name=aurt-sweep"])
            .arg(format!("--array={}", ranges(&elements)))
            .arg(&log)
            .args(arguments)
            .arg("--wrap")
            .arg(script);
        let job = submitted(&mut command, arguments).map_err(|problem| SweepError::Slurm {
            problem: if jobs.is_empty() {
                problem
            } else {
                format!("{problem}; before that it took {}", jobs.join(", "))
            },
        })?;
        jobs.push(job);
    }
    Ok(Submission { jobs, points: points.to_vec(), output })
}

const fn block_of(point: usize) -> usize {
    point.saturating_sub(1) / LARGEST_ELEMENT
}

/// The number of the job that `sbatch` took, or why it did not.
fn submitted(sbatch: &mut Command, arguments: &[String]) -> Result<String, String> {
    let done = sbatch
        .output()
        .map_err(|e| format!("cannot be run: {e}; is this a machine from which Slurm takes jobs?"))?;
    let said = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim().to_owned();
    // With --wait, the status is that of the jobs.
    let waited = arguments.iter().any(|a| a == "--wait" || a == "-W") && !said(&done.stdout).is_empty();
    if !done.status.success() && !waited {
        return Err(format!("refused: {}", said(&done.stderr)));
    }
    // "JOB" or "JOB;CLUSTER".
    Ok(said(&done.stdout).lines().next().and_then(|l| l.split(';').next()).unwrap_or_default().to_owned())
}

/// Ascending numbers as Slurm writes them: `1-3,7`.
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
    fn arrays_hold_a_thousand_points() {
        let blocks: Vec<usize> = [1, 1000, 1001, 2000, 2001].map(block_of).to_vec();
        assert_eq!(blocks, [0, 0, 1, 1, 2]);
    }

    #[test]
    fn paths_with_spaces_and_quotes_stay_one_word() {
        assert_eq!(shell_word(Path::new("/a b/it's")), "'/a b/it'\\''s'");
    }
}
