//! What noise and the rigid model explain of the rows, and what a gear explains beyond that.
//!
//! The positions' noise, filters, clocks and wrong inertias leave residuals that follow the motion, too. They have one thing
//! in common: at no frequency do they turn the phase sharply. A resonator does. So before a gear is judged, the residual
//! and the gear's torque are freed of
//! - M e_j q̈_j and M e_j τ_j, filtered at zero phase with any gain in each of several bands: noise of the encoder of joint j, and
//!   of those of other joints, which moves the load τ_j of a simulated link (the model answers to it and the drives do not), the
//!   positions' filter, an inertia that is wrong;
//! - on each joint i its load τ_i (gain), τ̇_i (delay, a drive's lag), τ̈_i (a second-order filter, inertia behind a gear
//!   whose encoder is at the link), q̇_i and q̈_i (viscous friction, rotor inertia).

use aurt_recording::ZeroPhase;

use super::link::{Deflection, Gear};
use super::rows::{Load, Rows};
use crate::error::DiagnosisError;

/// Upper ends of the bands in which the gains along M e_j q̈_j and M e_j τ_j are free, in units of the highest frequency of the rows.
const BANDS: [f64; 5] = [1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0, 0.75];
/// A column of which the others leave less than this share of its length is one of them.
const INDEPENDENT: f64 = 1e-6;

/// Rows of one segment, their residual freed of what each joint's own columns explain.
pub(super) struct OwnFreed {
    pub rows: Rows,
    pub target: bool,
    /// Orthonormal columns, `[joint][column][row]`.
    own: Vec<Vec<Vec<f64>>>,
    /// `[joint][row]`.
    residual: Vec<Vec<f64>>,
}

/// c·c and c·r of a gear's torque c and a residual r, block by block.
pub(super) type Moments = Vec<[f64; 2]>;

/// A segment's rows as far as a gear of one joint is concerned.
pub(super) struct Against<'a> {
    freed: &'a OwnFreed,
    joint: usize,
    /// The joints whose rows take part.
    span: Vec<Spanned>,
    /// Power of the residual of these rows, block by block.
    power: Vec<f64>,
}

/// Most columns of a joint's own, and along M e_j q̈_j and M e_j τ_j; then the residual.
const OWN: usize = 5;
const ALONG: usize = 2 * (BANDS.len() + 1);
const WIDTH: usize = OWN + ALONG + 1;

/// A number for each column that is taken off, and the residual.
type Products = [f64; WIDTH];

/// A joint whose rows take part: what is taken off a gear's torque there, row by row, so that one pass gives all products.
struct Spanned {
    joint: usize,
    /// Orthonormal columns and the residual.
    rows: Vec<Products>,
    /// Products among them, block by block.
    gram: Vec<[Products; WIDTH]>,
}

impl OwnFreed {
    pub fn new(rows: Rows, target: bool) -> Self {
        let joints = rows.white.len();
        let derivative = |series: &[f64]| -> Vec<f64> {
            let mut out = vec![0.0; series.len()];
            for k in 1..series.len().saturating_sub(1) {
                out[k] = 0.5 * rows.rate_hz * (series[k + 1] - series[k - 1]);
            }
            out
        };
        let (mut own, mut residual) = (Vec::with_capacity(joints), Vec::with_capacity(joints));
        for i in 0..joints {
            let load = rows.load_nm(i);
            let first = derivative(load);
            let second = derivative(&first);
            let columns = [load, &first, &second, &rows.velocity_rad_s[i], rows.acceleration_rad_s2(i)];
            let white: Vec<Vec<Vec<f64>>> =
                columns.iter().filter_map(|c| Some(vec![rows.whitened(i, c)?])).collect();
            let basis: Vec<Vec<f64>> = orthonormal(white).into_iter().flatten().collect();
            let mut left = rows.white[i].clone();
            rows.silence(i, &mut left);
            free(&mut left, &basis);
            own.push(basis);
            residual.push(left);
        }
        Self { rows, target, own, residual }
    }

    /// A series of joint i, whitened and freed of its own columns.
    fn column(&self, i: usize, series: &[f64]) -> Option<Vec<f64>> {
        let mut column = self.rows.whitened(i, series)?;
        free(&mut column, &self.own[i]);
        Some(column)
    }
}

impl<'a> Against<'a> {
    /// For gears of a joint, judged on the rows of all joints or on its own alone; `None` if its own have no noise to
    /// judge by.
    pub fn new(freed: &'a OwnFreed, joint: usize, all: bool) -> Result<Option<Self>, DiagnosisError> {
        let rows = &freed.rows;
        let judged = |i: &usize| rows.whitened(*i, &[]).is_some();
        if !judged(&joint) || rows.inertia(joint).is_none() {
            return Ok(None);
        }
        let span: Vec<usize> = if all { (0..freed.own.len()).filter(judged).collect() } else { vec![joint] };
        let moves = [rows.acceleration_rad_s2(joint), rows.load_nm(joint)];
        let mut filtered: Vec<Vec<f64>> = moves.map(<[f64]>::to_vec).to_vec();
        for edge in BANDS {
            let low = ZeroPhase::butterworth(4, edge * rows.top_hz, rows.rate_hz)?;
            for series in moves {
                filtered.push(low.filter(series)?);
            }
        }
        let columns = filtered
            .iter()
            .map(|q| {
                span.iter()
                    .map(|i| freed.column(*i, &rows.along_inertia(joint, *i, q)).unwrap_or_default())
                    .collect::<Vec<_>>()
            })
            .collect();
        let bands = orthonormal(columns);
        let mut residual: Vec<Vec<f64>> = span.iter().map(|i| freed.residual[*i].clone()).collect();
        free_all(&mut residual, &bands);
        let mut power = vec![0.0; rows.parts];
        let mut spanned = Vec::with_capacity(span.len());
        for (place, (i, residual)) in span.into_iter().zip(&residual).enumerate() {
            for (r, block) in residual.iter().zip(&rows.block) {
                if let Some(sum) = block.map(|b| &mut power[b]) {
                    *sum += r * r;
                }
            }
            let along: Vec<&Vec<f64>> = bands.iter().map(|band| &band[place]).collect();
            spanned.push(Spanned::new(freed, i, &along, residual));
        }
        Ok(Some(Self { freed, joint, span: spanned, power }))
    }

    /// How a gear's torque goes with the residual.
    ///
    /// The torque is c − Uα with the columns U that are taken off and α = Uᵀc; block by block its power is
    /// c·c − 2 αᵀUᵀc + αᵀUᵀUα and its product with the residual r is c·r − αᵀUᵀr.
    pub fn moments(&self, gear: Gear) -> Moments {
        let rows = &self.freed.rows;
        let deflection = rows.deflection(self.joint, gear, Load::Predicted);
        let products: Vec<Vec<(f64, Products)>> = self
            .span
            .iter()
            .map(|of| of.products(&self.white(of, gear, &deflection), &rows.block, rows.parts))
            .collect();
        let total = |of: &[(f64, Products)], k: usize| of.iter().map(|(_, p)| p[k]).sum::<f64>();
        let along: [f64; ALONG] =
            std::array::from_fn(|k| products.iter().map(|of| total(of, OWN + k)).sum::<f64>());
        let mut moments = vec![[0.0; 2]; rows.parts];
        for (of, products) in self.span.iter().zip(&products) {
            let mut share = [0.0; WIDTH - 1];
            share[OWN..].copy_from_slice(&along);
            share[..OWN].iter_mut().enumerate().for_each(|(k, s)| *s = total(products, k));
            for (([cc, cr], (square, product)), gram) in moments.iter_mut().zip(products).zip(&of.gram) {
                let mut own = *square;
                let mut with = product[WIDTH - 1];
                for (k, s) in share.iter().enumerate() {
                    let image: f64 = share.iter().zip(&gram[k]).map(|(t, g)| t * g).sum();
                    own += s * (image - 2.0 * product[k]);
                    with -= s * gram[k][WIDTH - 1];
                }
                *cc += own.max(0.0);
                *cr += with;
            }
        }
        moments
    }

    /// Gain in log-likelihood of a gear that is there, nats, block by block: ½ c·c with the torque c that is not taken off. The noise
    /// that drives the simulated link is none of it: one link is driven by the predicted load and one by the measured load, which have no
    /// noise in common, and c·c is the product of both. Of play counts only what the same flanks without play do not do.
    pub fn visible(&self, gear: Gear) -> Vec<f64> {
        let rows = &self.freed.rows;
        let deflections = [Load::Predicted, Load::Measured].map(|load| {
            let mut moved = rows.deflection(self.joint, gear, load);
            if gear.half_gap_rad > 0.0 {
                let closed = Gear { half_gap_rad: f64::MIN_POSITIVE, ..gear };
                let flanks = rows.deflection(self.joint, closed, load);
                // To stand at one flank or the other is another pose, which other parameters explain.
                moved.angle_rad.fill(0.0);
                let moves = moved.acceleration_rad_s2.iter_mut().zip(&flanks.acceleration_rad_s2);
                moves.for_each(|(a, b)| *a -= b);
            }
            moved
        });
        let freed = deflections.each_ref().map(|deflection| {
            let white: Vec<Vec<f64>> = self.span.iter().map(|of| self.white(of, gear, deflection)).collect();
            let products = self.span.iter().zip(&white).map(|(of, white)| {
                of.products(white, &rows.block, rows.parts).iter().fold(
                    [0.0; WIDTH],
                    |mut sum, (_, products)| {
                        sum.iter_mut().zip(products).for_each(|(s, p)| *s += p);
                        sum
                    },
                )
            });
            let products: Vec<Products> = products.collect();
            let along: [f64; ALONG] = std::array::from_fn(|k| products.iter().map(|p| p[OWN + k]).sum());
            let free = |((of, mut white), own): ((&Spanned, Vec<f64>), &Products)| {
                for (value, row) in white.iter_mut().zip(&of.rows) {
                    let taken = dot_of(&own[..OWN], &row[..OWN]) + dot_of(&along, &row[OWN..OWN + ALONG]);
                    *value -= taken;
                }
                white
            };
            self.span.iter().zip(white).zip(&products).map(free).collect::<Vec<_>>()
        });
        let mut gains = vec![0.0; rows.parts];
        for (one, other) in freed[0].iter().zip(&freed[1]) {
            for ((a, b), block) in one.iter().zip(other).zip(&rows.block) {
                if let Some(gain) = block.map(|b| &mut gains[b]) {
                    *gain += 0.5 * a * b;
                }
            }
        }
        gains
    }

    /// The torque of a deflection at one of the joints, whitened.
    fn white(&self, of: &Spanned, gear: Gear, deflection: &Deflection) -> Vec<f64> {
        let rows = &self.freed.rows;
        rows.whitened(of.joint, &rows.torque(self.joint, of.joint, gear, deflection)).unwrap_or_default()
    }

    /// Power of the residual, block by block.
    pub fn power(&self) -> &[f64] {
        &self.power
    }
}

impl Spanned {
    fn new(freed: &OwnFreed, joint: usize, along: &[&Vec<f64>], residual: &[f64]) -> Self {
        let all = &freed.rows;
        let mut rows: Vec<Products> = vec![[0.0; WIDTH]; residual.len()];
        let mut put = |at: usize, series: &[f64]| {
            rows.iter_mut().zip(series).for_each(|(row, value)| row[at] = *value);
        };
        freed.own[joint].iter().enumerate().for_each(|(k, column)| put(k, column));
        along.iter().enumerate().for_each(|(k, column)| put(OWN + k, column));
        put(WIDTH - 1, residual);
        let mut gram = vec![[[0.0; WIDTH]; WIDTH]; all.parts];
        for (row, block) in rows.iter().zip(&all.block) {
            let Some(gram) = block.map(|b| &mut gram[b]) else { continue };
            for (a, gram) in row.iter().zip(gram) {
                gram.iter_mut().zip(row).for_each(|(g, b)| *g += a * b);
            }
        }
        Self { joint, rows, gram }
    }

    /// c·c and the products of a column c with all others, block by block.
    fn products(&self, column: &[f64], block: &[Option<usize>], parts: usize) -> Vec<(f64, Products)> {
        let mut products = vec![(0.0, [0.0; WIDTH]); parts];
        for ((c, row), block) in column.iter().zip(&self.rows).zip(block) {
            let Some((square, products)) = block.map(|b| &mut products[b]) else { continue };
            *square += c * c;
            products.iter_mut().zip(row).for_each(|(p, value)| *p += c * value);
        }
        products
    }
}

/// Columns over several series, made orthonormal (modified Gram–Schmidt); those that the others contain are left out.
fn orthonormal(columns: Vec<Vec<Vec<f64>>>) -> Vec<Vec<Vec<f64>>> {
    let mut basis: Vec<Vec<Vec<f64>>> = Vec::with_capacity(columns.len());
    for mut column in columns {
        let before = dot(&column, &column).sqrt();
        // Twice, since columns are nearly the same at low frequencies.
        free_all(&mut column, &basis);
        free_all(&mut column, &basis);
        let length = dot(&column, &column).sqrt();
        if length > INDEPENDENT * before {
            column.iter_mut().flatten().for_each(|v| *v /= length);
            basis.push(column);
        }
    }
    basis
}

fn dot_of(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn dot(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| dot_of(a, b)).sum()
}

fn free_all(column: &mut [Vec<f64>], basis: &[Vec<Vec<f64>>]) {
    for unit in basis {
        let along = dot(column, unit);
        for (c, u) in column.iter_mut().zip(unit) {
            c.iter_mut().zip(u).for_each(|(c, u)| *c -= along * u);
        }
    }
}

fn free(column: &mut [f64], basis: &[Vec<f64>]) {
    for unit in basis {
        let along: f64 = column.iter().zip(unit).map(|(c, u)| c * u).sum();
        column.iter_mut().zip(unit).for_each(|(c, u)| *c -= along * u);
    }
}
