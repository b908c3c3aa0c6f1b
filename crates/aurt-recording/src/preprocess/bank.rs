use crate::RecordingError;
use crate::preprocess::bank_kernel::{Level, WIDTH, block_sums};
use crate::preprocess::complex::Complex;
use crate::preprocess::modes::{Modes, State};
use crate::preprocess::zero_phase::ZeroPhase;

/// Blocks of one column that are summed before the next column is touched.
const CHUNK: usize = 32;

/// Part of an output that future samples may still contribute when a row is delivered.
const NEGLIGIBLE: f64 = 1e-18;

/// Many columns, filtered by one [`ZeroPhase`] and decimated, while they are being made.
///
/// Feed consecutive tiles of samples with [`Self::push`], then call [`Self::finish`]: the rows that come out
/// are those of [`ZeroPhase::filter`] over each whole column followed by taking every `decimation`-th sample
/// from the first, to rounding. Neither the input nor the filtered series is kept: the memory is that of a few
/// hundred rows per column, however long the series is.
///
/// How: see the decomposition into modes in the source of this module. The backward direction needs what
/// comes later; a row is held back until the later samples could change it by less than 1e-18 of their size.
#[derive(Debug)]
pub struct ZeroPhaseBank {
    modes: Modes,
    level: Level,
    columns: usize,
    factor: usize,
    padding: usize,
    look_ahead: usize,
    capacity: usize,
    /// Forward states before the next block, `[column][group]`.
    forward: Vec<State>,
    started: bool,
    /// Samples of an unfinished block (before the start: the first samples), `[column][carry_stride]`.
    carry: Vec<f64>,
    carry_stride: usize,
    carried: usize,
    /// The latest `padding` + 1 samples, `[column][padding + 1]`.
    tail: Vec<f64>,
    samples: usize,
    /// Rows held back: what the past contributes to the output, `[column][capacity]`.
    past: Vec<f64>,
    /// Rows held back: backward sums of the row's own block, `[column][capacity][group]`.
    future: Vec<State>,
    pending: usize,
    delivered: usize,
    out: Vec<f64>,
    sums: Vec<[f64; WIDTH]>,
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
    #[must_use]
    pub const fn first_row(&self) -> usize {
        self.first_row
    }

    /// Number of rows.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// The rows of one column.
    #[must_use]
    pub fn column(&self, column: usize) -> &'a [f64] {
        &self.data[column * self.stride..column * self.stride + self.rows]
    }

    /// All columns and their stride: column k is `data[k * stride .. k * stride + rows]`.
    #[must_use]
    pub const fn raw(&self) -> (&'a [f64], usize) {
        (self.data, self.stride)
    }
}

impl ZeroPhaseBank {
    /// A bank for `columns` columns that keeps every `decimation`-th row (0 counts as 1).
    #[must_use]
    pub fn new(filter: &ZeroPhase, columns: usize, decimation: usize) -> Self {
        Self::at_level(filter, columns, decimation, Level::detect())
    }

    fn at_level(filter: &ZeroPhase, columns: usize, decimation: usize, level: Level) -> Self {
        let factor = decimation.max(1);
        let modes = Modes::new(filter.design(), factor);
        let groups = modes.groups.len();
        let padding = filter.padding();
        let look_ahead = filter.design().decay_samples(NEGLIGIBLE).div_ceil(factor) + 1;
        let capacity = look_ahead + look_ahead.clamp(CHUNK, 1024);
        let carry_stride = factor.max(padding + 1);
        Self {
            level,
            columns,
            factor,
            padding,
            look_ahead,
            capacity,
            forward: vec![State::default(); columns * groups],
            started: false,
            carry: vec![0.0; columns * carry_stride],
            carry_stride,
            carried: 0,
            tail: vec![0.0; columns * (padding + 1)],
            samples: 0,
            past: vec![0.0; columns * capacity],
            future: vec![State::default(); columns * capacity * groups],
            pending: 0,
            delivered: 0,
            out: vec![0.0; columns * capacity],
            sums: vec![[0.0; WIDTH]; CHUNK],
            modes,
        }
    }

    /// Number of columns.
    #[must_use]
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Samples pushed so far.
    #[must_use]
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Takes the next `samples` samples of all columns, column k at `data[k * stride .. k * stride + samples]`,
    /// and hands the rows that are ready to `sink` (not at every call, and never in more than one order).
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
            let ready = self.carried / self.factor;
            let carry = std::mem::take(&mut self.carry);
            self.blocks(&carry, self.carry_stride, 0, ready, sink);
            self.carry = carry;
            let kept = ready * self.factor;
            for carry in self.carry.chunks_exact_mut(self.carry_stride) {
                carry.copy_within(kept..self.carried, 0);
            }
            self.carried -= kept;
        }
        if self.carried > 0 {
            let more = (self.factor - self.carried).min(samples - used);
            self.carry_over(data, stride, used, more);
            used += more;
            if self.carried == self.factor {
                let carry = std::mem::take(&mut self.carry);
                self.blocks(&carry, self.carry_stride, 0, 1, sink);
                self.carry = carry;
                self.carried = 0;
            }
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
        if !self.started && self.columns > 0 {
            self.reset();
            return Err(RecordingError::TooShortToFilter { samples, needed: self.padding + 1 });
        }
        let groups = self.modes.groups.len();
        let rest = self.carried;
        if rest > 0 {
            self.last_block(rest);
        }
        let last = if rest == 0 { self.factor } else { rest };
        let rows = self.pending;
        for column in 0..self.columns {
            let tail = &self.tail[column * (self.padding + 1)..][..=self.padding];
            let after = self.modes.after_last(&self.forward[column * groups..][..groups], tail);
            let newest = (column * self.capacity + rows - 1) * groups;
            for (g, state) in after.iter().enumerate() {
                let reach = self.modes.powers(g, last - 1);
                add(&mut self.future[newest + g], times(reach, *state));
            }
            self.backward(column, rows);
        }
        self.deliver(rows, sink);
        self.reset();
        Ok(())
    }

    /// Readies the bank for other columns.
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
            let states = self.modes.before_first(head);
            self.forward[column * groups..][..groups].copy_from_slice(&states);
        }
        self.started = true;
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
        let mut done = 0;
        while done < count {
            let now = (count - done).min(CHUNK).min(self.capacity - self.pending);
            for column in 0..self.columns {
                let start = column * stride + first + done * self.factor;
                self.take_in(column, &data[start..start + now * self.factor], now);
            }
            self.pending += now;
            done += now;
            if self.pending == self.capacity {
                let rows = self.capacity - self.look_ahead;
                for column in 0..self.columns {
                    self.backward(column, rows);
                }
                self.deliver(rows, sink);
            }
        }
    }

    /// Takes in `count` blocks of one column: the rows' own sums, and the forward states past them.
    fn take_in(&mut self, column: usize, x: &[f64], count: usize) {
        let groups = self.modes.groups.len();
        let first = column * self.capacity + self.pending;
        let past = &mut self.past[first..first + count];
        for (row, block) in past.iter_mut().zip(x.chunks_exact(self.factor)) {
            *row = self.modes.centre * block[0];
        }
        let sums = &mut self.sums[..count];
        for (g, group) in self.modes.groups.iter().enumerate() {
            block_sums(self.level, x, &group.weights, sums);
            let mut state = self.forward[column * groups + g];
            // The row before the first one waits for this block's first sample, unless there is none.
            let future = &mut self.future[(column * self.capacity) * groups..];
            for (k, (sum, row)) in sums.iter().zip(past.iter_mut()).enumerate() {
                *row += real_part(&group.output, &state);
                state = advance(&group.step, &state, sum);
                let at = (self.pending + k) * groups + g;
                future[at] = [Complex::new(sum[4], sum[5]), Complex::new(sum[6], sum[7])];
                if self.pending + k > 0 {
                    let x0 = x[k * self.factor];
                    let earlier = &mut future[at - groups];
                    for slot in 0..2 {
                        earlier[slot].re += group.bridge[slot].re * x0;
                        earlier[slot].im += group.bridge[slot].im * x0;
                    }
                }
            }
            self.forward[column * groups + g] = state;
        }
    }

    /// Takes in the last, shorter block of every column; afterwards the forward states stand at its end.
    fn last_block(&mut self, samples: usize) {
        let groups = self.modes.groups.len();
        for column in 0..self.columns {
            let x = &self.carry[column * self.carry_stride..][..samples];
            let first = column * self.capacity + self.pending;
            self.past[first] = self.modes.centre * x[0];
            for (g, group) in self.modes.groups.iter().enumerate() {
                let at = first * groups + g;
                let state = &mut self.forward[column * groups + g];
                self.past[first] += real_part(&group.output, state);
                for slot in 0..2 {
                    let pole = self.modes.powers(g, 1)[slot];
                    let mut backward = Complex::default();
                    for value in x[1..].iter().rev() {
                        backward = pole * backward + Complex::real(*value);
                    }
                    for value in x {
                        state[slot] = pole * state[slot] + Complex::real(*value);
                    }
                    self.future[at][slot] = backward;
                    if self.pending > 0 {
                        let earlier = &mut self.future[at - groups][slot];
                        *earlier = *earlier + group.bridge[slot] * Complex::real(x[0]);
                    }
                }
            }
        }
        self.pending += 1;
    }

    /// Runs backward over the rows that one column holds back and writes the first `rows` of them to `out`.
    fn backward(&mut self, column: usize, rows: usize) {
        let groups = self.modes.groups.len();
        let first = column * self.capacity;
        let past = &self.past[first..first + self.pending];
        let out = &mut self.out[first..first + rows];
        out.copy_from_slice(&past[..rows]);
        for (g, group) in self.modes.groups.iter().enumerate() {
            let mut state = State::default();
            for k in (0..self.pending).rev() {
                state = step(&group.step, &state, &self.future[(first + k) * groups + g]);
                if k < rows {
                    out[k] += real_part(&group.output, &state);
                }
            }
        }
    }

    /// Hands out the first `rows` rows and forgets them.
    fn deliver(&mut self, rows: usize, sink: &mut dyn FnMut(DecimatedTile<'_>)) {
        let groups = self.modes.groups.len();
        if rows > 0 {
            let first_row = self.delivered;
            sink(DecimatedTile { first_row, rows, stride: self.capacity, data: &self.out });
        }
        for column in 0..self.columns {
            let first = column * self.capacity;
            let (kept, end) = (first + rows, first + self.pending);
            self.past.copy_within(kept..end, first);
            self.future.copy_within(kept * groups..end * groups, first * groups);
        }
        self.pending -= rows;
        self.delivered += rows;
    }
}

fn real_part(coefficient: &State, state: &State) -> f64 {
    let [c, d] = coefficient;
    let [s, t] = state;
    (c.re * s.re - c.im * s.im) + (d.re * t.re - d.im * t.im)
}

fn times(factor: State, state: State) -> State {
    [factor[0] * state[0], factor[1] * state[1]]
}

fn add(state: &mut State, other: State) {
    *state = [state[0] + other[0], state[1] + other[1]];
}

fn step(factor: &State, state: &State, input: &State) -> State {
    [factor[0] * state[0] + input[0], factor[1] * state[1] + input[1]]
}

fn advance(factor: &State, state: &State, sum: &[f64; WIDTH]) -> State {
    step(factor, state, &[Complex::new(sum[0], sum[1]), Complex::new(sum[2], sum[3])])
}
