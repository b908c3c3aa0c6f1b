use std::ops::Range;

use aurt_traits::Dispatch;
use num_complex::Complex64 as Complex;

use crate::error::RecordingError;
use crate::preprocess::bank_kernel::{
    CHUNK, Lanes, PackRows, PackSamples, PackState, Sums, run_backward, take_in,
};
use crate::preprocess::modes::{Modes, State, WIDTH};
use crate::preprocess::zero_phase::ZeroPhase;

/// Part of an output that future samples may still contribute when a row is delivered.
const NEGLIGIBLE: f64 = 1e-17;

/// Many columns, filtered by one [`ZeroPhase`] and decimated, while they are being made.
///
/// Feed consecutive tiles of samples with [`Self::push`], then call [`Self::finish`]: the rows that come out
/// are those of [`ZeroPhase::filter`] over each whole column followed by taking every `decimation`-th sample
/// from the first, to rounding. Neither the input nor the filtered series is kept: the memory is that of a few
/// hundred rows per column, however long the series is. Results do not depend on how the series is cut into tiles,
/// nor on the processor.
///
/// How: the filter is a sum of first-order modes that run forward and backward over the input itself, so only sums
/// over blocks of `decimation` samples are formed. The backward direction needs what comes later; a row is held back
/// until later samples could change it by no more than 1e-17 of their size.
#[derive(Debug)]
pub struct ZeroPhaseBank {
    modes: Modes,
    level: Dispatch,
    columns: usize,
    factor: usize,
    padding: usize,
    look_ahead: usize,
    capacity: usize,
    /// Forward states before the next block, `[pack][group]`.
    forward: Vec<PackState>,
    started: bool,
    /// Samples of an unfinished block (before the start: the first samples), `[column][carry_stride]`.
    carry: Vec<f64>,
    carry_stride: usize,
    carried: usize,
    /// The latest `padding` + 1 samples, `[column][padding + 1]`.
    tail: Vec<f64>,
    samples: usize,
    /// Rows held back: what past and present contribute, `[pack][capacity]`.
    past: Vec<Lanes>,
    /// Rows held back: backward sums of the row's own block, `[pack][group][1 + capacity]`; the first is a dummy
    /// that stands before the oldest row.
    future: Vec<PackState>,
    pending: usize,
    delivered: usize,
    /// Rows that are handed out, of all that the filter has.
    kept: Range<usize>,
    out: Vec<f64>,
    sums: Box<Sums>,
}

/// Rows that a [`ZeroPhaseBank`] delivers.
#[derive(Debug, Clone, Copy)]
pub struct DecimatedTile<'a> {
    first_row: usize,
    rows: usize,
    stride: usize,
    data: &'a [f64],
}

impl<'a> DecimatedTile<'a> {
    /// Index of the tile's first row; row k belongs to sample k · decimation.
    pub const fn first_row(&self) -> usize {
        self.first_row
    }

    /// Number of rows.
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// The rows of one column.
    pub fn column(&self, column: usize) -> &'a [f64] {
        &self.data[column * self.stride..column * self.stride + self.rows]
    }

    /// Copies each column to its rows of a whole series.
    pub fn copy_to<'c>(&self, series: impl Iterator<Item = &'c mut [f64]>) {
        for (k, rows) in series.enumerate() {
            rows[self.first_row..self.first_row + self.rows].copy_from_slice(self.column(k));
        }
    }
}

impl ZeroPhaseBank {
    /// A bank for `columns` columns that keeps every `decimation`-th row (0 counts as 1).
    pub fn new(filter: &ZeroPhase, columns: usize, decimation: usize) -> Self {
        Self::at_level(filter, columns, decimation, Dispatch::active())
    }

    fn at_level(filter: &ZeroPhase, columns: usize, decimation: usize, level: Dispatch) -> Self {
        let factor = decimation.max(1);
        let modes = Modes::new(filter.design(), factor);
        let (groups, packs) = (modes.groups.len(), columns.div_ceil(WIDTH));
        let padding = filter.padding();
        let look_ahead = filter.design().decay_samples(NEGLIGIBLE).div_ceil(factor) + 1;
        // Twice as many rows delivered at once as looked ahead, but no more than caches like.
        let capacity = look_ahead + (2 * look_ahead).clamp(2 * CHUNK, 512);
        let carry_stride = factor.max(padding + 1);
        Self {
            level,
            columns,
            factor,
            padding,
            look_ahead,
            capacity,
            forward: vec![PackState::default(); packs * groups],
            started: false,
            carry: vec![0.0; columns * carry_stride],
            carry_stride,
            carried: 0,
            tail: vec![0.0; columns * (padding + 1)],
            samples: 0,
            past: vec![Lanes::default(); packs * capacity],
            future: vec![PackState::default(); packs * groups * (capacity + 1)],
            pending: 0,
            delivered: 0,
            kept: 0..usize::MAX,
            out: vec![0.0; columns * capacity],
            sums: Box::new([[[0.0; WIDTH]; CHUNK]; WIDTH]),
            modes,
        }
    }

    /// The same, which hands out only the rows `kept` and counts them from 0.
    #[must_use]
    pub fn keeping(self, kept: Range<usize>) -> Self {
        Self { kept, ..self }
    }

    /// Takes the next `samples` samples of all columns, column k at `data[k * stride .. k * stride + samples]`,
    /// and hands the rows that are ready to `sink`, in their order. Many calls have none ready.
    ///
    /// # Panics
    /// If `stride < samples` or `data` is too short.
    pub fn push(
        &mut self,
        data: &[f64],
        stride: usize,
        samples: usize,
        sink: &mut dyn FnMut(DecimatedTile<'_>),
    ) {
        if samples == 0 || self.columns == 0 {
            return;
        }
        assert!(stride >= samples, "stride shorter than a column");
        assert!(data.len() >= (self.columns - 1) * stride + samples, "data too short");
        self.remember_tail(data, stride, samples);
        self.samples += samples;
        let mut used = 0;
        if !self.started {
            used = samples.min(self.padding + 1 - self.carried);
            self.carry_over(data, stride, 0, used);
            if self.carried <= self.padding {
                return;
            }
            self.start();
            self.blocks_of_carry(sink);
        }
        if self.carried > 0 {
            let more = (self.factor - self.carried).min(samples - used);
            self.carry_over(data, stride, used, more);
            used += more;
            self.blocks_of_carry(sink);
        }
        let ready = (samples - used) / self.factor;
        self.blocks(data, stride, used, ready, sink);
        used += ready * self.factor;
        self.carry_over(data, stride, used, samples - used);
    }

    /// Ends the columns and hands their remaining rows to `sink`. The bank can then be used for other columns.
    ///
    /// # Errors
    /// [`RecordingError::TooShortToFilter`] unless more than [`ZeroPhase::padding`] samples were pushed.
    pub fn finish(&mut self, sink: &mut dyn FnMut(DecimatedTile<'_>)) -> Result<(), RecordingError> {
        let samples = self.samples;
        if self.columns == 0 {
            return Ok(());
        }
        if !self.started {
            self.reset();
            return Err(RecordingError::TooShortToFilter { samples, needed: self.padding + 1 });
        }
        let after = self.after_last();
        let last = if self.carried == 0 { self.factor } else { self.carried };
        if self.carried > 0 {
            // The last block is filled up with zeros; that spoils the forward states, which are no longer needed.
            let (from, factor) = (self.carried, self.factor);
            for carry in self.carry.chunks_exact_mut(self.carry_stride) {
                carry[from..factor].fill(0.0);
            }
            self.carried = factor;
            self.blocks_of_carry(sink);
        }
        let groups = self.modes.groups.len();
        for (column, states) in after.iter().enumerate() {
            let (pack, lane) = (column / WIDTH, column % WIDTH);
            for (g, state) in states.iter().enumerate() {
                let newest = (pack * groups + g) * (self.capacity + 1) + self.pending;
                let reach = self.modes.powers(g, last - 1);
                let parts = parts(&[reach[0] * state[0], reach[1] * state[1]]);
                for (part, value) in parts.iter().enumerate() {
                    self.future[newest][part][lane] += value;
                }
            }
        }
        let rows = self.pending;
        self.deliver(rows, sink);
        self.reset();
        Ok(())
    }

    /// The backward states just after the last sample of each column.
    fn after_last(&self) -> Vec<Vec<State>> {
        let groups = self.modes.groups.len();
        let of_column = |column: usize| {
            let (pack, lane) = (column / WIDTH, column % WIDTH);
            let mut states: Vec<State> = self.forward[pack * groups..(pack + 1) * groups]
                .iter()
                .map(|s| [Complex::new(s[0][lane], s[1][lane]), Complex::new(s[2][lane], s[3][lane])])
                .collect();
            let rest = &self.carry[column * self.carry_stride..][..self.carried];
            self.modes.run_on(&mut states, rest);
            self.modes.after_last(&states, &self.tail[column * (self.padding + 1)..][..=self.padding])
        };
        (0..self.columns).map(of_column).collect()
    }

    fn reset(&mut self) {
        self.started = false;
        self.carried = 0;
        self.samples = 0;
        self.pending = 0;
        self.delivered = 0;
        self.tail.fill(0.0);
    }

    /// Keeps the latest `padding` + 1 samples of every column.
    fn remember_tail(&mut self, data: &[f64], stride: usize, samples: usize) {
        let length = self.padding + 1;
        let fresh = samples.min(length);
        for (column, tail) in self.tail.chunks_exact_mut(length).enumerate() {
            tail.copy_within(fresh.., 0);
            let end = column * stride + samples;
            tail[length - fresh..].copy_from_slice(&data[end - fresh..end]);
        }
    }

    /// Appends `count` samples from `first` on to the carried ones.
    fn carry_over(&mut self, data: &[f64], stride: usize, first: usize, count: usize) {
        if count == 0 {
            return;
        }
        for (column, carry) in self.carry.chunks_exact_mut(self.carry_stride).enumerate() {
            let from = column * stride + first;
            carry[self.carried..self.carried + count].copy_from_slice(&data[from..from + count]);
        }
        self.carried += count;
    }

    /// The forward states before the first sample, from the carried head of each column.
    fn start(&mut self) {
        let groups = self.modes.groups.len();
        for column in 0..self.columns {
            let head = &self.carry[column * self.carry_stride..][..=self.padding];
            let (pack, lane) = (column / WIDTH, column % WIDTH);
            for (g, state) in self.modes.before_first(head).iter().enumerate() {
                for (part, value) in parts(state).iter().enumerate() {
                    self.forward[pack * groups + g][part][lane] = *value;
                }
            }
        }
        self.started = true;
    }

    /// Takes in the whole blocks among the carried samples.
    fn blocks_of_carry(&mut self, sink: &mut dyn FnMut(DecimatedTile<'_>)) {
        let ready = self.carried / self.factor;
        if ready == 0 {
            return;
        }
        let mut carry = std::mem::take(&mut self.carry);
        self.blocks(&carry, self.carry_stride, 0, ready, sink);
        let used = ready * self.factor;
        for column in carry.chunks_exact_mut(self.carry_stride) {
            column.copy_within(used..self.carried, 0);
        }
        self.carry = carry;
        self.carried -= used;
    }

    /// Takes in `count` whole blocks of every column, from sample `first` of `data` on.
    fn blocks(
        &mut self,
        data: &[f64],
        stride: usize,
        first: usize,
        count: usize,
        sink: &mut dyn FnMut(DecimatedTile<'_>),
    ) {
        let groups = self.modes.groups.len();
        let mut done = 0;
        while done < count {
            let blocks = (count - done).min(CHUNK).min(self.capacity - self.pending);
            for pack in 0..self.columns.div_ceil(WIDTH) {
                let start = pack * WIDTH * stride + first + done * self.factor;
                let columns = (self.columns - pack * WIDTH).min(WIDTH);
                let samples = PackSamples { data: &data[start..], stride, columns, blocks };
                let row = pack * self.capacity + self.pending;
                let past = &mut self.past[row..row + blocks];
                past.fill(Lanes::default());
                for (g, group) in self.modes.groups.iter().enumerate() {
                    let state = &mut self.forward[pack * groups + g];
                    let at = (pack * groups + g) * (self.capacity + 1) + self.pending;
                    let future = &mut self.future[at..=at + blocks];
                    take_in(self.level, group, samples, state, PackRows { past, future }, &mut self.sums);
                }
            }
            self.pending += blocks;
            done += blocks;
            if self.pending == self.capacity {
                self.deliver(self.capacity - self.look_ahead, sink);
            }
        }
    }

    /// Runs backward over the rows held back, hands out the first `rows` of them and forgets these.
    fn deliver(&mut self, rows: usize, sink: &mut dyn FnMut(DecimatedTile<'_>)) {
        let groups = self.modes.groups.len();
        for pack in 0..self.columns.div_ceil(WIDTH) {
            let first = pack * self.capacity;
            let past = &mut self.past[first..first + self.pending];
            for (g, group) in self.modes.groups.iter().enumerate() {
                let at = (pack * groups + g) * (self.capacity + 1);
                let future = &mut self.future[at..=at + self.pending];
                run_backward(self.level, group, &future[1..], &mut past[..rows]);
                future.copy_within(rows.., 0);
            }
            let columns = (self.columns - pack * WIDTH).min(WIDTH);
            for lane in 0..columns {
                let start = (pack * WIDTH + lane) * self.capacity;
                for (out, row) in self.out[start..start + rows].iter_mut().zip(&*past) {
                    *out = row[lane];
                }
            }
            past.copy_within(rows.., 0);
        }
        let first = self.delivered.max(self.kept.start);
        let end = (self.delivered + rows).min(self.kept.end);
        if first < end {
            let (first_row, data) = (first - self.kept.start, &self.out[first - self.delivered..]);
            sink(DecimatedTile { first_row, rows: end - first, stride: self.capacity, data });
        }
        self.pending -= rows;
        self.delivered += rows;
    }
}

fn parts(state: &State) -> [f64; 4] {
    [state[0].re, state[0].im, state[1].re, state[1].im]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(filter: &ZeroPhase, level: Dispatch, columns: usize, decimation: usize, tile: usize) -> Vec<f64> {
        let samples = 2345;
        let value = |column: usize, k: usize| ((k * (column + 3)) as f64 * 0.0137).sin() + (k % 17) as f64;
        let mut bank = ZeroPhaseBank::at_level(filter, columns, decimation, level);
        let mut out = vec![Vec::new(); columns];
        let mut sink = |rows: DecimatedTile<'_>| {
            for (column, out) in out.iter_mut().enumerate() {
                out.extend_from_slice(rows.column(column));
            }
        };
        for first in (0..samples).step_by(tile) {
            let now = tile.min(samples - first);
            let data: Vec<f64> =
                (0..columns).flat_map(|c| (first..first + now).map(move |k| value(c, k))).collect();
            bank.push(&data, now, now, &mut sink);
        }
        bank.finish(&mut sink).unwrap();
        out.concat()
    }

    #[test]
    fn every_instruction_set_and_every_cut_into_tiles_gives_the_same_bits() {
        for (order, columns, decimation) in [(4, 1, 10), (4, 9, 3), (7, 19, 8), (3, 8, 1), (4, 17, 61)] {
            let filter = ZeroPhase::butterworth(order, 4.0, 100.0).unwrap();
            let reference = rows(&filter, Dispatch::Baseline, columns, decimation, 256);
            assert_eq!(reference.len(), columns * 2345_usize.div_ceil(decimation));
            for level in Dispatch::available() {
                for tile in [1, 7, 256, 1000, 2345] {
                    assert!(
                        rows(&filter, level, columns, decimation, tile) == reference,
                        "{level:?}, {tile}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_bank_serves_one_series_after_the_other() {
        let filter = ZeroPhase::butterworth(4, 4.0, 100.0).unwrap();
        let mut bank = ZeroPhaseBank::new(&filter, 1, 2);
        let series: Vec<f64> = (0..100).map(|k| f64::from(k * k % 23)).collect();
        let expected: Vec<f64> = filter.filter(&series).unwrap().into_iter().step_by(2).collect();
        for _ in 0..3 {
            let mut out = Vec::new();
            let mut sink = |rows: DecimatedTile<'_>| out.extend_from_slice(rows.column(0));
            bank.push(&series, 100, 100, &mut sink);
            bank.finish(&mut sink).unwrap();
            assert!(out.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
            assert_eq!(out.len(), expected.len());
            bank.push(&series, 100, 15, &mut |_| {});
            assert!(matches!(
                bank.finish(&mut |_| {}),
                Err(RecordingError::TooShortToFilter { samples: 15, needed: 16 })
            ));
        }
    }
}
