use std::io::{self, BufRead, BufReader, Read};

/// Bytes asked for at a time.
const CHUNK: usize = 1 << 18;
/// Longest line that is read; 10⁵ columns of full precision take 2.5 MB.
const LONGEST_LINE: u64 = 1 << 24;

/// The lines of a text, one after the other, in a buffer that is reused.
pub(super) struct Lines<R> {
    source: BufReader<R>,
    buffer: Vec<u8>,
    number: usize,
    /// Whether a line without line feed was seen, which is the last.
    ended: bool,
}

pub(super) struct Line<'a> {
    pub(super) number: usize,
    /// Its bytes, without line feed and carriage return.
    pub(super) bytes: &'a [u8],
    /// Whether a line feed ended it; only the last line may lack one.
    pub(super) terminated: bool,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        Self { source: BufReader::with_capacity(CHUNK, source), buffer: Vec::new(), number: 0, ended: false }
    }

    pub(super) fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        if self.ended {
            return Ok(None);
        }
        self.buffer.clear();
        self.number += 1;
        let read = self.source.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut self.buffer)?;
        let (bytes, terminated) = match self.buffer.strip_suffix(b"\n") {
            Some(bytes) => (bytes, true),
            None if read as u64 == LONGEST_LINE => {
                let reason = format!("line {} is longer than {} MB", self.number, LONGEST_LINE >> 20);
                return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
            }
            None => (self.buffer.as_slice(), false),
        };
        self.ended = !terminated;
        let bytes = bytes.strip_suffix(b"\r").unwrap_or(bytes);
        Ok((read > 0).then_some(Line { number: self.number, bytes, terminated }))
    }
}
