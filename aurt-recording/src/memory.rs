use std::path::Path;

use crate::error::RecordingError;
use crate::read_options::ReadOptions;

/// Memory for a file of size zero.
const LEAST_BYTES: u64 = 200 << 20;
/// Memory for each byte of a file: compressed recordings unpack to a few times their size.
const PER_BYTE: u64 = 20;

/// The memory that reading a file may take: 20 × its size + 200 MB, or [`ReadOptions::memory_bytes`].
///
/// What compressed files and headers claim is compared with it before room is made.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Memory<'a> {
    path: &'a Path,
    allowed_bytes: u64,
}

impl<'a> Memory<'a> {
    /// For a file, or several of one recording, of `input_bytes` bytes.
    pub(crate) fn of(path: &'a Path, input_bytes: u64, options: &ReadOptions) -> Self {
        let usual = || input_bytes.saturating_mul(PER_BYTE).saturating_add(LEAST_BYTES);
        Self { path, allowed_bytes: options.memory_bytes.unwrap_or_else(usual) }
    }

    #[cfg(feature = "parquet")]
    pub(crate) const fn bounded(path: &'a Path, allowed_bytes: u64) -> Self {
        Self { path, allowed_bytes }
    }

    pub(crate) const fn path(&self) -> &'a Path {
        self.path
    }

    pub(crate) const fn allowed_bytes(&self) -> u64 {
        self.allowed_bytes
    }

    pub(crate) fn claim(&self, what: &str, needed_bytes: u64) -> Result<(), RecordingError> {
        if needed_bytes <= self.allowed_bytes {
            return Ok(());
        }
        Err(RecordingError::TooLarge {
            path: self.path.to_owned(),
            what: what.to_owned(),
            needed_bytes,
            allowed_bytes: self.allowed_bytes,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_claimed_is_compared_with_twenty_times_the_file_and_200_mb() {
        let options = ReadOptions::default();
        let memory = Memory::of(Path::new("a.npz"), 1_000_000, &options);
        assert_eq!(memory.allowed_bytes(), 20_000_000 + 209_715_200);
        assert!(memory.claim("its arrays", memory.allowed_bytes()).is_ok());
        let text = memory.claim("its arrays", 8_000_000_000_000).unwrap_err().to_string();
        assert!(text.contains("a.npz") && text.contains("8000000 MB") && text.contains("230 MB"), "{text}");
        let huge = Memory::of(Path::new("a"), u64::MAX, &options);
        assert_eq!(huge.allowed_bytes(), u64::MAX);
    }
}
