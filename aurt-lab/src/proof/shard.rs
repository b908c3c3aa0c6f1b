//! A proof in parts, on several machines, and put together again.

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::case::World;
use crate::product::Failure;

use super::Place;

/// A part of the cases: those whose index leaves a remainder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Default for Shard {
    fn default() -> Self {
        Self { number: 1, of: 1 }
    }
}

impl Shard {
    /// Whether a case belongs to it; `index` counts from 0.
    pub fn has(self, index: usize) -> bool {
        index % self.of == self.number - 1
    }

    pub fn count(self, cases: usize) -> usize {
        (0..cases).filter(|index| self.has(*index)).count()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let refuse = || format!("`{text}` is no part: write 3/8 for the third of eight");
        let (number, of) = text.split_once('/').ok_or_else(refuse)?;
        let shard = Self {
            number: number.trim().parse().map_err(|_| refuse())?,
            of: of.trim().parse().map_err(|_| refuse())?,
        };
        if shard.number >= 1 && shard.number <= shard.of { Ok(shard) } else { Err(refuse()) }
    }
}

/// Copies what parts of a proof have found into one folder; what is there already stays.
pub fn collect(parts: &[PathBuf], out: &Path) -> Result<(), Failure> {
    for part in parts {
        let mut found = false;
        for world in World::ALL {
            let from = Place::new(part, world);
            let Some(proof) = from.proof()? else { continue };
            found = true;
            let to = Place::new(out, world);
            to.create(&proof)?;
            for (from, to) in from.results().iter().zip(to.results()) {
                copy(from, &to)?;
            }
        }
        if !found {
            return Err(Failure::argument(
                "--collect",
                format!("{} holds no proof", part.display()),
                "name folders that `aurt-lab prove --out` wrote",
            ));
        }
    }
    Ok(())
}

/// Copies files that are not there yet, folders and all; each appears whole.
fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    let fail = |path: &Path| {
        let path = path.to_owned();
        move |source| Failure::write(path, source)
    };
    fs::create_dir_all(to).map_err(fail(to))?;
    let Ok(entries) = fs::read_dir(from) else { return Ok(()) };
    for entry in entries {
        let entry = entry.map_err(fail(from))?;
        let (path, target) = (entry.path(), to.join(entry.file_name()));
        if path.is_dir() {
            copy(&path, &target)?;
        } else if !target.exists() {
            let contents = fs::read(&path).map_err(fail(&path))?;
            crate::product::OutputFile::new("--out", &target, &[])?.write(&contents)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_make_a_whole() {
        let parts: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|p| p.parse().unwrap()).to_vec();
        for index in 0..20 {
            assert_eq!(parts.iter().filter(|p| p.has(index)).count(), 1, "{index}");
        }
        assert_eq!(parts.iter().map(|p| p.count(20)).collect::<Vec<_>>(), [7, 7, 6]);
        for wrong in ["0/3", "4/3", "1", "a/2", "1/0", ""] {
            assert!(wrong.parse::<Shard>().is_err(), "{wrong}");
        }
    }
}
