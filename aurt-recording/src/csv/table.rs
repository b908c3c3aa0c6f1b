//! Rows of numbers from anything but text, through the search for columns and the checks that text passes.

use std::path::Path;

use crate::csv::collector::Collector;
use crate::csv::columns::Selected;
use crate::csv::header::Header;
use crate::csv::search::Search;
use crate::error::RecordingError;
use crate::format::Reading;
use crate::memory::Memory;
use crate::read_options::ReadOptions;
use crate::recording::{ReadReport, RecordedJoints, Recording};

/// Columns that an array or a list may have; longer ones have no number for each joint.
pub(crate) const MOST_COLUMNS: usize = 4096;

/// Rows, and numbers of all their columns, that room is made for at once; a file may claim more than it holds.
const ROOM_ROWS: usize = 1 << 16;
const ROOM_NUMBERS: usize = 1 << 22;

/// A table of numbers whose columns are known and whose rows are still to come.
pub(crate) struct Table<'a> {
    path: &'a Path,
    memory: Memory<'a>,
    header: Header,
    selected: Selected,
}

impl<'a> Table<'a> {
    /// Finds the columns that are needed; `names` is empty if the `columns` columns have none.
    pub(crate) fn new(
        memory: Memory<'a>,
        names: Vec<String>,
        columns: usize,
        options: &ReadOptions,
    ) -> Result<Self, RecordingError> {
        let path = memory.path();
        let header = Header { names, columns, line: 0, is_data: false };
        let selected = Search { path, header: &header, options }.run()?;
        Ok(Self { path, memory, header, selected })
    }

    /// The columns that a row has, in its order.
    pub(crate) fn wanted(&self) -> Vec<usize> {
        self.selected.all()
    }

    pub(crate) const fn time(&self) -> Option<usize> {
        self.selected.time
    }

    pub(crate) fn belongs_to(&mut self, joints: RecordedJoints) {
        self.selected.joints = joints;
    }

    pub(crate) fn remark(&mut self, remark: String) {
        self.selected.remarks.push(remark);
    }

    /// Refuses a table whose rows would not fit into memory, where they are not read in pieces.
    pub(crate) fn make_room(&self, rows: u64, piece_rows: usize) -> Result<(), RecordingError> {
        let width = self.selected.all().len() as u64 + 1;
        let held = rows.min(piece_rows as u64);
        self.memory.claim(&format!("its {rows} rows"), held.saturating_mul(8 * width))
    }

    /// Reads rows until `next` has no more: it fills the row and says whether there was one.
    pub(crate) fn read(
        mut self,
        format: String,
        Reading { options, piece_rows, visit }: Reading<'_>,
        next: &mut dyn FnMut(&mut [f64]) -> Result<bool, RecordingError>,
    ) -> Result<Recording, RecordingError> {
        let wanted = self.wanted();
        let first = usize::from(self.selected.time.is_none());
        let mut row = vec![0.0; first + wanted.len()];
        let remarks = std::mem::take(&mut self.selected.remarks);
        let room_rows = (ROOM_NUMBERS / row.len().max(1)).clamp(1, ROOM_ROWS);
        let mut collector = Collector::new(&self.selected, options, piece_rows.min(room_rows));
        while next(&mut row[first..])? {
            let needed = row.len() - self.selected.branches.len();
            let number = collector.rows() + 1;
            match row[first..needed].iter().position(|v| !v.is_finite()) {
                None => collector.add(&mut row, number),
                Some(place) if options.recorded.drops_rows() => collector.skip(number, wanted[place]),
                Some(place) => collector.refuse(RecordingError::Value {
                    path: self.path.to_owned(),
                    row: number,
                    name: self.header.name(wanted[place]),
                    value: row[first + place],
                    rows: 1,
                })?,
            }
            // Not every format says beforehand how many rows there are.
            if collector.held().is_multiple_of(room_rows) {
                self.make_room(collector.held() as u64, piece_rows)?;
            }
            if collector.held() >= piece_rows {
                let series = collector.piece(false);
                visit(&self.selected.recording(self.path, series, ReadReport::default()))?;
            }
        }
        if collector.rows() == 0 {
            let found = "it has columns, but no rows".to_owned();
            return Err(RecordingError::NoRows { path: self.path.to_owned(), found });
        }
        let mut recording = collector.finish(self.path, &self.header, format, options.max_corrupt_share)?;
        recording.report.remarks.splice(0..0, remarks);
        recording.report.line_is_row = true;
        Ok(recording)
    }
}
