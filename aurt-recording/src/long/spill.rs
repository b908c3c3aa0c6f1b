use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Rows of numbers in a temporary file, which is gone with this value or the process.
#[derive(Debug)]
pub(super) struct Spill {
    width: usize,
    rows: usize,
    writer: Option<BufWriter<File>>,
    reader: Mutex<File>,
}

impl Spill {
    pub(super) fn new(width: usize) -> io::Result<Self> {
        let file = tempfile::tempfile()?;
        let reader = Mutex::new(file.try_clone()?);
        Ok(Self { width, rows: 0, writer: Some(BufWriter::with_capacity(1 << 18, file)), reader })
    }

    pub(super) const fn rows(&self) -> usize {
        self.rows
    }

    /// Appends rows, given as one slice for each place in a row.
    pub(super) fn append(&mut self, columns: &[&[f64]]) -> io::Result<()> {
        let Some(writer) = &mut self.writer else { return Err(io::Error::other("already read")) };
        let rows = columns.first().map_or(0, |c| c.len());
        for row in 0..rows {
            for column in columns {
                writer.write_all(&column[row].to_ne_bytes())?;
            }
        }
        self.rows += rows;
        Ok(())
    }

    pub(super) fn finish(&mut self) -> io::Result<()> {
        self.writer.take().map_or(Ok(()), |mut writer| writer.flush())
    }

    /// Some rows, column after column.
    pub(super) fn read(&self, rows: Range<usize>) -> io::Result<Vec<Vec<f64>>> {
        const AT_ONCE: usize = 2048;
        let mut columns: Vec<Vec<f64>> = (0..self.width).map(|_| Vec::with_capacity(rows.len())).collect();
        let mut bytes = vec![0; self.width * AT_ONCE * size_of::<f64>()];
        let mut file = self.reader.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start((rows.start * self.width * size_of::<f64>()) as u64))?;
        let mut next = rows.start;
        while next < rows.end {
            let now = AT_ONCE.min(rows.end - next);
            let bytes = &mut bytes[..now * self.width * size_of::<f64>()];
            file.read_exact(bytes)?;
            let (numbers, _) = bytes.as_chunks::<{ size_of::<f64>() }>();
            for row in numbers.chunks_exact(self.width) {
                for (column, number) in columns.iter_mut().zip(row) {
                    column.push(f64::from_ne_bytes(*number));
                }
            }
            next += now;
        }
        Ok(columns)
    }
}
