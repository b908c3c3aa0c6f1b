//! Opening and reading the files of users.

use std::{
    fs::{self, File},
    io::{Error, ErrorKind, Read, Result},
    path::Path,
};
#[cfg(unix)]
use std::{
    io::{Write, copy, pipe},
    os::fd::OwnedFd,
    sync::mpsc,
    time::Duration,
};

use crate::protected::note;

/// Largest text that is written by hand: experiments, scenarios, plans, limits, geometries.
pub const MOST_TEXT_BYTES: u64 = 16 << 20;
/// Largest saved model, verdict or plan of a sweep.
pub const MOST_MODEL_BYTES: u64 = 1 << 30;

/// How long a pipe may be without a writer, or its writer without a word.
#[cfg(unix)]
const PIPE_PATIENCE: Duration = Duration::from_secs(5);

/// Opens a file to be read: a regular one, or a pipe that somebody writes to (`<(zcat a.csv.gz)`).
///
/// # Errors
/// What the system says; [`ErrorKind::IsADirectory`] for folders; [`ErrorKind::InvalidInput`] for devices, sockets and files
/// of the kernel (`/proc/kmsg`), which may never end; [`ErrorKind::TimedOut`] for a pipe without a byte within five seconds.
pub fn open(path: &Path) -> Result<File> {
    match readable(path)? {
        Readable::Regular => {
            let file = File::open(path)?;
            note(path, &file.metadata()?);
            Ok(file)
        }
        #[cfg(unix)]
        Readable::Pipe => open_pipe(path),
    }
}

/// A kind of file that can be read to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Readable {
    Regular,
    #[cfg(unix)]
    Pipe,
}

fn readable(path: &Path) -> Result<Readable> {
    let metadata = fs::metadata(path)?;
    let kind = metadata.file_type();
    if kind.is_file() {
        #[cfg(unix)]
        if is_of_kernel(&metadata) {
            let reason =
                "it is not a regular file but one of the kernel; save its contents to a file and name that";
            return Err(Error::new(ErrorKind::InvalidInput, reason));
        }
        return Ok(Readable::Regular);
    }
    if kind.is_dir() {
        return Err(Error::new(ErrorKind::IsADirectory, "it is a folder; name a file in it"));
    }
    #[cfg(unix)]
    if is_pipe(kind) {
        return Ok(Readable::Pipe);
    }
    Err(Error::new(
        ErrorKind::InvalidInput,
        "it is a device or a socket; save its contents to a file and name that",
    ))
}

/// The bytes of a regular file of at most `most_bytes` bytes that is no input of a command: its program may write it again
/// (a list, a plan), or run it (a library).
///
/// # Errors
/// As [`open`], but [`ErrorKind::InvalidInput`] for every pipe; [`ErrorKind::FileTooLarge`].
pub fn read_regular(path: &Path, most_bytes: u64) -> Result<Vec<u8>> {
    if readable(path)? != Readable::Regular {
        return Err(Error::new(
            ErrorKind::InvalidInput,
            "it is a pipe; save its contents to a file and name that",
        ));
    }
    read_bounded(&File::open(path)?, most_bytes)
}

#[cfg(unix)]
fn is_pipe(kind: fs::FileType) -> bool {
    use std::os::unix::fs::FileTypeExt;
    kind.is_fifo()
}

/// Whether a file that calls itself regular is made up by the kernel while it is read; some wait for events.
#[cfg(unix)]
fn is_of_kernel(metadata: &fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |folder: &str| fs::metadata(folder).ok().map(|folder| folder.dev());
    // Without these file systems their folders, if there are any, are of an ordinary one.
    let of_kernel = ["/proc", "/sys"].map(device).contains(&Some(metadata.dev()));
    of_kernel && device("/") != Some(metadata.dev())
}

/// Opening a pipe waits until somebody writes to it, and reading it until something was written, so another thread waits
/// and hands on what comes. It is left behind where nothing comes; it holds nothing but the path.
#[cfg(unix)]
fn open_pipe(path: &Path) -> Result<File> {
    let (send, opened) = mpsc::channel();
    let owned = path.to_owned();
    std::thread::spawn(move || {
        let begun = File::open(owned).and_then(|mut source| {
            let mut first = vec![0; 1 << 16];
            let bytes = source.read(&mut first)?;
            first.truncate(bytes);
            let (reader, writer) = pipe()?;
            Ok((source, first, writer, File::from(OwnedFd::from(reader))))
        });
        // In every case below nobody may listen any more: it took too long, or has read enough.
        let _ = match begun {
            Err(error) => send.send(Err(error)).map_err(Error::other),
            Ok((mut source, first, mut writer, file)) => send
                .send(Ok(file))
                .map_err(Error::other)
                .and_then(|()| writer.write_all(&first))
                .and_then(|()| copy(&mut source, &mut writer).map(drop)),
        };
    });
    opened.recv_timeout(PIPE_PATIENCE).unwrap_or_else(|_| {
        let seconds = PIPE_PATIENCE.as_secs();
        let reason = format!("it is a pipe that nobody writes to within {seconds} s; start its writer first");
        Err(Error::new(ErrorKind::TimedOut, reason))
    })
}

/// The text of a file of at most `most_bytes` bytes, without a byte order mark.
///
/// # Errors
/// As [`open`]; [`ErrorKind::FileTooLarge`]; [`ErrorKind::InvalidData`] as [`text_of`].
pub fn read_text(path: &Path, most_bytes: u64) -> Result<String> {
    text_of(read_bounded(&open(path)?, most_bytes)?)
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
        let begin = std::time::Instant::now();
        assert_eq!(error(&path).kind(), ErrorKind::TimedOut);
        assert!(begin.elapsed() < 2 * PIPE_PATIENCE);
        // The thread that was left behind is still in open, and would take what a writer sends.
        fs::remove_file(&path).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
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
        let begin = std::time::Instant::now();
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
