/// A block of output columns, each a contiguous run of samples, that a model writes.
///
/// Column k of n samples lives at `data[k * stride .. k * stride + n]`.
#[derive(Debug)]
pub struct Columns<'a> {
    data: &'a mut [f64],
    columns: usize,
    samples: usize,
    stride: usize,
}

impl<'a> Columns<'a> {
    /// Columns over `data`, which holds at least `(columns − 1) · stride + samples` values.
    ///
    /// # Panics
    /// If `data` is shorter than that or `stride < samples`.
    pub fn new(data: &'a mut [f64], columns: usize, samples: usize, stride: usize) -> Self {
        assert!(stride >= samples, "stride shorter than a column");
        assert!(columns == 0 || data.len() >= (columns - 1) * stride + samples, "data too short");
        Self { data, columns, samples, stride }
    }

    /// Number of columns.
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Number of samples per column.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Column `k`, to be written.
    pub fn column_mut(&mut self, k: usize) -> &mut [f64] {
        assert!(k < self.columns, "column {k} of {}", self.columns);
        &mut self.data[k * self.stride..k * self.stride + self.samples]
    }

    /// Column `k`.
    pub fn column(&self, k: usize) -> &[f64] {
        assert!(k < self.columns, "column {k} of {}", self.columns);
        &self.data[k * self.stride..k * self.stride + self.samples]
    }

    /// All columns and their stride, for models that write them at once.
    pub fn raw_mut(&mut self) -> (&mut [f64], usize) {
        (self.data, self.stride)
    }
}
