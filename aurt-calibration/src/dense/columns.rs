/// Partial sums of a scalar product; columns are read in pieces of so many rows.
pub(crate) const LANES: usize = 8;

type Lanes = [f64; LANES];

/// Some columns of equal length, `stride` apart. Everything is `#[inline(always)]`, for the code to be compiled for
/// the instruction set of the function that it ends up in.
#[derive(Clone, Copy)]
pub(super) struct Columns<'a> {
    data: &'a [f64],
    stride: usize,
    count: usize,
    pieces: usize,
}

impl<'a> Columns<'a> {
    /// The first `pieces` · [`LANES`] rows of `count` columns.
    ///
    /// # Panics
    /// If `data` has fewer.
    #[inline(always)]
    pub(super) fn new(data: &'a [f64], stride: usize, count: usize, pieces: usize) -> Self {
        assert!(count == 0 || (count - 1) * stride + pieces * LANES <= data.len(), "columns too short");
        Self { data, stride, count, pieces }
    }

    /// The scalar product of every column with every one of `others`: `out[other · count + column]`.
    #[inline(always)]
    pub(super) fn products<const FUSED: bool, const K: usize, const C: usize>(
        self,
        others: Columns<'_>,
        out: &mut [f64],
    ) {
        assert!(others.pieces >= self.pieces && out.len() >= self.count * others.count);
        let mut c = 0;
        while c + C <= others.count {
            self.products_with::<FUSED, K, C>(others, c, out);
            c += C;
        }
        while c < others.count {
            self.products_with::<FUSED, K, 1>(others, c, out);
            c += 1;
        }
    }

    #[inline(always)]
    fn products_with<const FUSED: bool, const K: usize, const C: usize>(
        self,
        others: Columns<'_>,
        c: usize,
        out: &mut [f64],
    ) {
        let mut k = 0;
        while k + K <= self.count {
            self.block_of_products::<FUSED, K, C>(k, others, c, out);
            k += K;
        }
        while k < self.count {
            self.block_of_products::<FUSED, 1, C>(k, others, c, out);
            k += 1;
        }
    }

    #[inline(always)]
    fn block_of_products<const FUSED: bool, const K: usize, const C: usize>(
        self,
        k: usize,
        others: Columns<'_>,
        c: usize,
        out: &mut [f64],
    ) {
        let mut sums = [[[0.0; LANES]; C]; K];
        let (left, right) = (self.data.as_ptr(), others.data.as_ptr());
        for piece in 0..self.pieces {
            // SAFETY: `new` compared the last row of the last column with the length of the data, `products` the
            // pieces of both sides; k + K and c + C are at most the number of columns.
            unsafe {
                let mut y = [[0.0; LANES]; C];
                for (j, y) in y.iter_mut().enumerate() {
                    *y = right.add((c + j) * others.stride + piece * LANES).cast::<Lanes>().read();
                }
                for (i, sums) in sums.iter_mut().enumerate() {
                    let x = left.add((k + i) * self.stride + piece * LANES).cast::<Lanes>().read();
                    for (sum, y) in sums.iter_mut().zip(&y) {
                        for lane in 0..LANES {
                            sum[lane] = mul_add::<FUSED>(x[lane], y[lane], sum[lane]);
                        }
                    }
                }
            }
        }
        for (i, sums) in sums.iter().enumerate() {
            for (j, sum) in sums.iter().enumerate() {
                out[(c + j) * self.count + k + i] = total(sum);
            }
        }
    }

    /// Adds `factors[other · count + column]` times each column to each of the columns of `to`, `stride` apart.
    #[inline(always)]
    pub(super) fn add_multiples<const FUSED: bool, const K: usize, const C: usize>(
        self,
        factors: &[f64],
        to: &mut [f64],
        stride: usize,
        count: usize,
    ) {
        if count == 0 {
            return;
        }
        assert!(
            (count - 1) * stride + self.pieces * LANES <= to.len() && factors.len() >= self.count * count
        );
        let mut c = 0;
        while c + C <= count {
            self.add_multiples_to::<FUSED, K, C>(&factors[c * self.count..], &mut to[c * stride..], stride);
            c += C;
        }
        while c < count {
            self.add_multiples_to::<FUSED, K, 1>(&factors[c * self.count..], &mut to[c * stride..], stride);
            c += 1;
        }
    }

    #[inline(always)]
    fn add_multiples_to<const FUSED: bool, const K: usize, const C: usize>(
        self,
        factors: &[f64],
        to: &mut [f64],
        stride: usize,
    ) {
        let mut k = 0;
        while k + K <= self.count {
            self.add_block::<FUSED, K, C>(k, factors, to, stride);
            k += K;
        }
        while k < self.count {
            self.add_block::<FUSED, 1, C>(k, factors, to, stride);
            k += 1;
        }
    }

    #[inline(always)]
    fn add_block<const FUSED: bool, const K: usize, const C: usize>(
        self,
        k: usize,
        factors: &[f64],
        to: &mut [f64],
        stride: usize,
    ) {
        let mut w = [[0.0; C]; K];
        for (i, w) in w.iter_mut().enumerate() {
            for (j, w) in w.iter_mut().enumerate() {
                *w = factors[j * self.count + k + i];
            }
        }
        let (left, right) = (self.data.as_ptr(), to.as_mut_ptr());
        for piece in 0..self.pieces {
            // SAFETY: as in `block_of_products`; `add_multiples` compared the last row of the last column of `to`
            // with its length, and it is borrowed exclusively.
            unsafe {
                let mut sums = [[0.0; LANES]; C];
                for (j, sum) in sums.iter_mut().enumerate() {
                    *sum = right.add(j * stride + piece * LANES).cast::<Lanes>().read();
                }
                for (i, w) in w.iter().enumerate() {
                    let x = left.add((k + i) * self.stride + piece * LANES).cast::<Lanes>().read();
                    for (sum, w) in sums.iter_mut().zip(w) {
                        for lane in 0..LANES {
                            sum[lane] = mul_add::<FUSED>(x[lane], *w, sum[lane]);
                        }
                    }
                }
                for (j, sum) in sums.iter().enumerate() {
                    right.add(j * stride + piece * LANES).cast::<Lanes>().write(*sum);
                }
            }
        }
    }
}

/// a · b + c, rounded once if `FUSED`.
#[inline(always)]
pub(super) fn mul_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// The sum of partial sums, in pairs.
#[inline(always)]
pub(super) fn total(lanes: &Lanes) -> f64 {
    let [a, b, c, d, e, f, g, h] = *lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
