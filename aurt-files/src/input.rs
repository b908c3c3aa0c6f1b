//! Opening and reading the files of users.

use std::fs::{self, File};
use std::io::{Error, ErrorKind, Read, Result};
#[cfg(unix)]
use std::os::unix::fs::{FileTypeExt, MetadataExt, OpenOptionsExt};
use std::path::Path;
use std::time::{Duration, Instant};

#[cfg(unix)]
use crate::protected::is_known;
use crate::protected::note;

/// Largest text that is written by hand: experiments, scenarios, plans, limits, geometries.
pub const MOST_TEXT_BYTES: u64 = 16 << 20;
/// Largest saved model, verdict or plan of a sweep.
pub const MOST_MODEL_BYTES: u64 = 1 << 30;

/// Bytes of a file that are held at once where it is not needed as a whole.
const PIECE_BYTES: usize = 1 << 16;

/// How long a pipe may be without a writer, or its writer without a word.
#[cfg(unix)]
const PIPE_PATIENCE: Duration = Duration::from_secs(5);

/// Opens a file to be read: a regular one, or a pipe that somebody writes to (`<(zcat a.csv.gz)`).
///
/// # Errors
/// What the system says; [`ErrorKind::IsADirectory`] for folders; [`ErrorKind::InvalidInput`] for devices, sockets and files
/// of the kernel (`/proc/kmsg`), which may never end; [`ErrorKind::TimedOut`] for a pipe without a byte within five seconds;
/// [`ErrorKind::NotSeekable`] for one that the command has read before.
pub fn open(path: &Path) -> Result<File> {
    let (file, metadata) = open_at_once(path)?;
    if metadata.is_file() {
        note(path, &metadata);
        return Ok(file);
    }
    #[cfg(unix)]
    {
        if is_known(&metadata) {
            return Err(readable_once());
        }
        wait_for_writer(&file)?;
        note(path, &metadata);
    }
    Ok(file)
}

/// Refusal of a pipe where it has been read before, or is to be read again later.
fn readable_once() -> Error {
    let reason = "it is a pipe, which can be read once only; save its contents to a file and name that";
    Error::new(ErrorKind::NotSeekable, reason)
}

/// As [`open`] for what is read more than once: a regular file, and no pipe.
///
/// # Errors
/// As [`open`]; [`ErrorKind::NotSeekable`] for pipes.
pub fn open_regular(path: &Path) -> Result<File> {
    // Opening a pipe and closing it again would end its writer.
    #[cfg(unix)]
    if fs::metadata(path)?.file_type().is_fifo() {
        return Err(readable_once());
    }
    let (file, metadata) = open_at_once(path)?;
    if !metadata.is_file() {
        return Err(readable_once());
    }
    note(path, &metadata);
    Ok(file)
}

/// Hands the bytes of a regular file to `take`, piece by piece.
///
/// # Errors
/// As [`open_regular`]; what reading says.
pub fn read_pieces(path: &Path, mut take: impl FnMut(&[u8])) -> Result<()> {
    let mut file = open_regular(path)?;
    let mut piece = vec![0; PIECE_BYTES];
    loop {
        match file.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(length) => take(&piece[..length]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// The bytes of a regular file of at most `most_bytes` bytes that is no input of a command: its program may write it again
/// (a list, a plan), or run it (a library).
///
/// # Errors
/// As [`open`], but [`ErrorKind::InvalidInput`] for every pipe; [`ErrorKind::FileTooLarge`].
pub fn read_regular(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    let (file, metadata) = open_at_once(path)?;
    if !metadata.is_file() {
        return Err(Error::new(
            ErrorKind::InvalidInput,
            "it is a pipe; save its contents to a file and name that",
        ));
    }
    read_bounded(&file, most_bytes)
}

/// Opens a regular file or a pipe without waiting for anybody. Opening a device can have an effect, so its name is looked at
/// first; what was opened is looked at again, since the name may have come to mean another file in between.
fn open_at_once(path: &Path) -> Result<(File, fs::Metadata)> {
    readable(&fs::metadata(path)?)?;
    let mut options = fs::OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    options.custom_flags(rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    let file = options.open(path)?;
    let metadata = file.metadata()?;
    readable(&metadata)?;
    Ok((file, metadata))
}

/// Refuses all but regular files and pipes.
fn readable(metadata: &fs::Metadata) -> Result<()> {
    let refuse = |kind, reason: &str| Err(Error::new(kind, reason));
    let kind = metadata.file_type();
    if kind.is_dir() {
        return refuse(ErrorKind::IsADirectory, "it is a folder; name a file in it");
    }
    #[cfg(unix)]
    if kind.is_fifo() {
        return Ok(());
    }
    if !kind.is_file() {
        let reason = "it is a device or a socket; save its contents to a file and name that";
        return refuse(ErrorKind::InvalidInput, reason);
    }
    #[cfg(unix)]
    if is_of_kernel(metadata) {
        let reason =
            "it is not a regular file but one of the kernel; save its contents to a file and name that";
        return refuse(ErrorKind::InvalidInput, reason);
    }
    Ok(())
}

/// Whether a file that calls itself regular is made up by the kernel while it is read; some wait for events.
#[cfg(unix)]
fn is_of_kernel(metadata: &fs::Metadata) -> bool {
    let device = |folder: &str| fs::metadata(folder).ok().map(|folder| folder.dev());
    // Without these file systems their folders, if there are any, are of an ordinary one.
    let of_kernel = ["/proc", "/sys"].map(device).contains(&Some(metadata.dev()));
    of_kernel && device("/") != Some(metadata.dev())
}

/// Waits until a pipe that was opened without waiting has a first byte; later ones may take as long as they take.
#[cfg(unix)]
fn wait_for_writer(pipe: &File) -> Result<()> {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
    let end = Instant::now() + PIPE_PATIENCE;
    loop {
        let left = end.saturating_duration_since(Instant::now());
        let mut looked_at = [PollFd::new(pipe, PollFlags::IN)];
        match poll(&mut looked_at, Timespec::try_from(left).ok().as_ref()) {
            Err(rustix::io::Errno::INTR) => {}
            Err(error) => return Err(error.into()),
            Ok(0) => break,
            Ok(_) => {
                fcntl_setfl(pipe, fcntl_getfl(pipe)? - OFlags::NONBLOCK)?;
                return Ok(());
            }
        }
    }
    let seconds = PIPE_PATIENCE.as_secs();
    let reason = format!("it is a pipe that nobody writes to within {seconds} s; start its writer first");
    Err(Error::new(ErrorKind::TimedOut, reason))
}

/// The text of a file of at most `most_bytes` bytes, without a byte order mark.
///
/// # Errors
/// As [`open`]; [`ErrorKind::FileTooLarge`]; [`ErrorKind::InvalidData`] as [`text_of`].
pub fn read_text(path: &Path, most_bytes: u64) -> Result<String> {
    text_of(read_bytes(path, most_bytes)?)
}

/// The bytes of a file, at most `most_bytes`.
///
/// # Errors
/// As [`open`]; [`ErrorKind::FileTooLarge`].
pub fn read_bytes(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    read_bounded(&open(path)?, most_bytes)
}

fn read_bounded(file: &File, most_bytes: u64) -> Result<Vec<u8>> {
    let length = file.metadata().map_or(0, |m| if m.is_file() { m.len() } else { 0 });
    let too_large = || {
        let reason =
            format!("it is larger than {} MB, which no such file is; check the path", most_bytes >> 20);
        Error::new(ErrorKind::FileTooLarge, reason)
    };
    if length > most_bytes {
        return Err(too_large());
    }
    let mut bytes = Vec::with_capacity(usize::try_from(length).unwrap_or(0) + 1);
    file.take(most_bytes + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most_bytes {
        return Err(too_large());
    }
    Ok(bytes)
}

/// Bytes as text, without a byte order mark.
///
/// # Errors
/// [`ErrorKind::InvalidData`] with what they are instead: compressed, UTF-16, binary, or text in another encoding.
pub fn text_of(mut bytes: Vec<u8>) -> Result<String> {
    const MARK: &[u8] = b"\xef\xbb\xbf";
    let refuse = |reason: String| Err(Error::new(ErrorKind::InvalidData, reason));
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return refuse("it is compressed with gzip; unpack it first (gunzip)".into());
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return refuse("it is UTF-16 text; save it as UTF-8".into());
    }
    if bytes.starts_with(MARK) {
        bytes.drain(..MARK.len());
    }
    let line = |bytes: &[u8]| bytes.iter().filter(|b| **b == b'\n').count() + 1;
    if let Some(at) = bytes.iter().position(|b| *b == 0) {
        let reason =
            format!("it has a zero byte on line {}, so it is no text; check the path", line(&bytes[..at]));
        return refuse(reason);
    }
    String::from_utf8(bytes).or_else(|error| {
        let at = error.utf8_error().valid_up_to();
        refuse(format!("it is no UTF-8 text (line {}); save it as UTF-8", line(&error.as_bytes()[..at])))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(bytes: &[u8]) -> String {
        text_of(bytes.to_vec()).unwrap_err().to_string()
    }

    #[test]
    fn what_is_no_text_is_told_apart() {
        assert!(said(b"\x1f\x8b\x08").contains("gzip"));
        assert!(said(b"\xff\xfea\0").contains("UTF-16"));
        assert!(said(b"a\nb\0c").contains("zero byte on line 2"));
        assert!(said(b"a\n\nb\xffc").contains("line 3"));
        assert_eq!(text_of(b"\xef\xbb\xbfa = 1".to_vec()).unwrap(), "a = 1");
    }

    #[test]
    fn sizes_are_bounded_whether_or_not_the_system_knows_them() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        fs::write(&path, "x".repeat((1 << 20) + 1)).unwrap();
        let error = read_text(&path, 1 << 20).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("larger than 1 MB"), "{error}");
        assert_eq!(read_text(&path, (1 << 20) + 1).unwrap().len(), (1 << 20) + 1);
    }

    #[test]
    #[cfg(unix)]
    fn devices_and_pipes_without_a_writer_are_refused_and_others_read() {
        let error = |path: &Path| open(path).unwrap_err();
        assert!(error(Path::new("/dev/zero")).to_string().contains("device"));
        assert_eq!(error(Path::new("/")).kind(), ErrorKind::IsADirectory);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status().unwrap();
        assert!(made.success());
        assert_eq!(read_regular(&path, 1).unwrap_err().kind(), ErrorKind::InvalidInput);
        let begin = Instant::now();
        assert_eq!(error(&path).kind(), ErrorKind::TimedOut);
        assert!(begin.elapsed() < 2 * PIPE_PATIENCE);
        let once = open_regular(&path).unwrap_err();
        assert_eq!(once.kind(), ErrorKind::NotSeekable);
        assert!(once.to_string().contains("once"), "{once}");
        let writer = std::thread::spawn({
            let path = path.clone();
            move || fs::write(path, "schema = 1").unwrap()
        });
        assert_eq!(read_text(&path, 100).unwrap(), "schema = 1");
        writer.join().unwrap();
        // Somebody has opened it to write, and does not.
        let silent = std::thread::spawn({
            let path = path.clone();
            move || {
                let file = fs::OpenOptions::new().write(true).open(path).unwrap();
                std::thread::sleep(2 * PIPE_PATIENCE);
                drop(file);
            }
        });
        let begin = Instant::now();
        assert_eq!(error(&path).kind(), ErrorKind::TimedOut);
        assert!(begin.elapsed() < 2 * PIPE_PATIENCE);
        silent.join().unwrap();
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn files_of_the_kernel_are_refused() {
        for path in ["/proc/kmsg", "/proc/cpuinfo"] {
            let both = [open(Path::new(path)).unwrap_err(), read_regular(Path::new(path), 1).unwrap_err()];
            for error in both {
                assert_eq!(error.kind(), ErrorKind::InvalidInput);
                assert!(error.to_string().contains("not a regular file"), "{error}");
            }
        }
    }
}
