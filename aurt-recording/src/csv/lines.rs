use std::io::{self, Read};

/// Bytes asked for at a time.
const CHUNK: usize = 1 << 18;
/// Longest line that is read; 10⁵ columns of full precision take 2.5 MB.
const LONGEST_LINE: usize = 1 << 24;

/// The lines of a text, one after the other, in a buffer that is reused.
pub(super) struct Lines<R> {
    source: R,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    exhausted: bool,
    number: usize,
}

/// A line without its end.
pub(super) struct Line<'a> {
    /// Number of the line, from 1.
    pub(super) number: usize,
    /// Its bytes, without line feed and carriage return.
    pub(super) bytes: &'a [u8],
    /// Whether a line feed ended it; only the last line may lack one.
    pub(super) terminated: bool,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        Self { source, buffer: vec![0; CHUNK], start: 0, end: 0, exhausted: false, number: 0 }
    }

    /// The next line, or `None` after the last.
    pub(super) fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        let mut searched = 0;
        loop {
            let unread = &self.buffer[self.start + searched..self.end];
            if let Some(at) = unread.iter().position(|b| *b == b'\n') {
                let first = self.start;
                let end = first + searched + at;
                self.start = end + 1;
                return Ok(Some(self.line(first, end, true)));
            }
            searched = self.end - self.start;
            if self.exhausted {
                if searched == 0 {
                    return Ok(None);
                }
                let (first, end) = (self.start, self.end);
                self.start = end;
                return Ok(Some(self.line(first, end, false)));
            }
            self.refill()?;
        }
    }

    fn line(&mut self, first: usize, end: usize, terminated: bool) -> Line<'_> {
        self.number += 1;
        let bytes = &self.buffer[first..end];
        let bytes = bytes.strip_suffix(b"\r").unwrap_or(bytes);
        Line { number: self.number, bytes, terminated }
    }

    fn refill(&mut self) -> io::Result<()> {
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        if self.end >= LONGEST_LINE {
            let reason = format!("line {} is longer than {} MB", self.number + 1, LONGEST_LINE >> 20);
            return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
        }
        if self.end == self.buffer.len() {
            self.buffer.resize(2 * self.end, 0);
        }
        let read = loop {
            match self.source.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                other => break other?,
            }
        };
        self.exhausted = read == 0;
        self.end += read;
        Ok(())
    }
}
