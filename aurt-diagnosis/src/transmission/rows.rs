//! The rows on which the transmission is judged: band-limited, thinned out, white.

use aurt_recording::ZeroPhase;

use super::link::{Deflection, Drive, Gear};
use super::series::{FullRate, Piece};
use super::shape::Inertia;
use super::whiten::Whitener;
use super::{ELASTIC_TOP_HZ, PLAY_TOP_HZ};
use crate::error::DiagnosisError;

/// Rows end at this share of the cut-off of the positions' filter: there it still passes 0.86 of the motion.
const OF_POSITION_CUTOFF: f64 = 0.8;
/// … and of the sampling rate: above, differences are no derivatives.
pub(super) const OF_RATE: f64 = 0.2;
/// Rows per period of the highest frequency: the filter passes 1 % at half the row rate.
const ROWS_PER_PERIOD: f64 = 3.6;
/// Least rate at which a link with play is simulated, Hz: when it leaves a flank, and when it strikes the other, depend on its load's fast
/// part. A gap of 30 mrad that explains 0.87 of a joint's residual from loads of 100 Hz explains 0.65 from loads below 12 Hz.
const LINK_HZ: f64 = 100.0;
/// Cut-off of the loads that are thinned out to this rate, in units of it: the filter passes a seventh at half the rate.
const OF_LINK_RATE: f64 = 0.4;
/// Memory of the whitening filter, s: two periods of 10 Hz.
const WHITENED_S: f64 = 0.2;
/// Blocks of contiguous time, s, each of which either fits or judges, …
const BLOCK_S: f64 = 1.0;
/// … in parts whose gains count one by one: a jolt is over within one, a resonator keeps its phase through all.
pub(super) const PARTS: usize = 4;
/// At the ends of a block this much belongs to none, so that the filters' memory does not tie neighbours together, s.
const GAP_S: f64 = 0.1;
/// The link's motion at the start of a segment is unknown for this time, s.
const SETTLES_S: f64 = 0.5;

/// The rows of one segment.
pub(super) struct Rows {
    pub rate_hz: f64,
    pub top_hz: f64,
    /// `[joint][row]`.
    links: Links,
    /// The same for links with play, at least [`LINK_HZ`] where the recording has it, and the rows' filter at that rate.
    finer: Option<(Links, ZeroPhase)>,
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// M_ij and ∂g_i/∂q_j, `[j][i][row]`.
    inertia_kg_m2: Vec<Vec<Vec<f64>>>,
    gradient_nm_rad: Vec<Vec<Vec<f64>>>,
    whiteners: Vec<Option<Whitener>>,
    /// Residual after whitening, `[joint][row]`.
    pub white: Vec<Vec<f64>>,
    /// Which rows count, `[joint][row]`.
    pub counts: Vec<Vec<bool>>,
    /// The part of a block of each row; part p is of block p / [`PARTS`].
    pub block: Vec<Option<usize>>,
    pub parts: usize,
}

/// The series that drive links, `[joint][sample]`.
struct Links {
    /// Samples per row.
    per_row: usize,
    /// The load that the model predicts.
    load_nm: Vec<Vec<f64>>,
    /// The measured load less the predicted one.
    residual: Vec<Vec<f64>>,
    acceleration_rad_s2: Vec<Vec<f64>>,
}

/// Gears that rows are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Gears that give way.
    Elastic,
    /// Gears with play.
    Play,
}

impl Kind {
    /// The kind of a gear.
    pub fn of(half_gap_rad: f64) -> Self {
        if half_gap_rad > 0.0 { Self::Play } else { Self::Elastic }
    }

    /// Highest frequency of the rows, Hz.
    const fn top_hz(self) -> f64 {
        match self {
            Self::Elastic => ELASTIC_TOP_HZ,
            Self::Play => PLAY_TOP_HZ,
        }
    }
}

/// The torque that drives a link.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Load {
    /// The torque of the rigid model.
    Predicted,
    /// The measured torque, less friction: its noise is not that of the positions.
    Measured,
}

impl Links {
    /// Every `step`-th sample, below a frequency.
    fn new(full: &FullRate, step: usize, per_row: usize, top_hz: f64) -> Result<Self, DiagnosisError> {
        let low = ZeroPhase::butterworth(4, top_hz, full.rate_hz)?;
        let passed = |series: &[Vec<f64>]| -> Result<Vec<Vec<f64>>, DiagnosisError> {
            let thin = |series: Vec<f64>| series.into_iter().step_by(step).collect();
            Ok(low.filter_all(series)?.into_iter().map(thin).collect())
        };
        let (load_nm, residual) = (passed(&full.load)?, passed(&full.residual)?);
        Ok(Self { per_row, load_nm, residual, acceleration_rad_s2: passed(&full.acceleration_rad_s2)? })
    }
}

/// M_jj of a fitted model is taken as at least this share of its mean: a link has mass in every pose.
pub(super) const LEAST_INERTIA: f64 = 0.2;

impl Rows {
    /// The rows of a piece at full rate, white as others are, or by themselves.
    pub fn new(
        piece: &Piece<'_>,
        full: &FullRate,
        kind: Kind,
        as_white_as: Option<&Self>,
    ) -> Result<Self, DiagnosisError> {
        let Piece { segment, gradients, position_cutoff_hz, .. } = piece;
        let top_hz = (OF_POSITION_CUTOFF * position_cutoff_hz).min(OF_RATE * full.rate_hz).min(kind.top_hz());
        let step = ((full.rate_hz / (ROWS_PER_PERIOD * top_hz)) as usize).max(1);
        let of_links = ((full.rate_hz / LINK_HZ) as usize).clamp(1, step);
        let per_row = step / of_links;
        let step = of_links * per_row;
        let links = Links::new(full, step, 1, top_hz)?;
        let finer = (kind == Kind::Play).then(|| {
            let rate_hz = full.rate_hz / of_links as f64;
            let links = Links::new(full, of_links, per_row, top_hz.max(OF_LINK_RATE * rate_hz))?;
            Ok::<_, DiagnosisError>((links, ZeroPhase::butterworth(4, top_hz, rate_hz)?))
        });
        let rate_hz = full.rate_hz / step as f64;
        let low = ZeroPhase::butterworth(4, top_hz, full.rate_hz)?;
        let thin = |series: Vec<f64>| -> Vec<f64> { series.into_iter().step_by(step).collect() };
        let passed = |series: &[Vec<f64>]| -> Result<Vec<Vec<f64>>, DiagnosisError> {
            Ok(low.filter_all(series)?.into_iter().map(thin).collect())
        };
        let joints = full.joints();
        let motion = segment.motion.view();
        let of = |series: &dyn Fn(usize) -> Vec<f64>| -> Vec<Vec<f64>> { (0..joints).map(series).collect() };
        let velocity_rad_s = passed(&of(&|j| motion.velocity_rad_s(j).to_vec()))?;
        let residual = &links.residual;
        let rows = residual.first().map_or(0, Vec::len);
        let table = |at: &dyn Fn(usize, usize, usize) -> f64| -> Vec<Vec<Vec<f64>>> {
            let column = |j: usize, i: usize| (0..rows).map(|k| at(j, i, k * step)).collect();
            (0..joints).map(|j| (0..joints).map(|i| column(j, i)).collect()).collect()
        };
        let inertia_kg_m2 = table(&|j, i, k| full.inertia.at(j, i, k));
        let gradient_nm_rad = table(&|j, i, k| gradients.at(j, i, k));
        let order = (WHITENED_S * rate_hz).round() as usize;
        let settled = (SETTLES_S * rate_hz) as usize;
        let mut counts: Vec<Vec<bool>> =
            full.calm.iter().map(|c| c.iter().copied().step_by(step).collect()).collect();
        let whiteners: Vec<Option<Whitener>> = as_white_as.map_or_else(
            || (0..joints).map(|j| Whitener::of(&residual[j], &counts[j], order)).collect(),
            |rows| rows.whiteners.clone(),
        );
        let mut white = Vec::with_capacity(joints);
        for (j, whitener) in whiteners.iter().enumerate() {
            let silent = settled.max(whitener.as_ref().map_or(rows, Whitener::memory)).min(rows);
            counts[j][..silent].fill(false);
            white.push(whitener.as_ref().map_or_else(|| vec![0.0; rows], |w| w.apply(&residual[j])));
        }
        let per_block = (BLOCK_S * rate_hz) as usize;
        let gap = (GAP_S * rate_hz / 2.0).ceil() as usize;
        let blocks = rows / per_block.max(1);
        let block = (0..rows)
            .map(|k| {
                let (block, within) = (k / per_block, k % per_block);
                let inside = block < blocks && within >= gap && within + gap < per_block;
                inside.then_some(PARTS * block + (PARTS * within / per_block).min(PARTS - 1))
            })
            .collect();
        Ok(Self {
            rate_hz,
            top_hz,
            links,
            finer: finer.transpose()?,
            velocity_rad_s,
            inertia_kg_m2,
            gradient_nm_rad,
            whiteners,
            white,
            counts,
            block,
            parts: PARTS * blocks,
        })
    }

    /// τ_j.
    pub fn load_nm(&self, joint: usize) -> &[f64] {
        &self.links.load_nm[joint]
    }

    /// q̈_j.
    pub fn acceleration_rad_s2(&self, joint: usize) -> &[f64] {
        &self.links.acceleration_rad_s2[joint]
    }

    /// M_jj, if the fitted model has one.
    pub fn inertia(&self, joint: usize) -> Option<Inertia> {
        let series = &self.inertia_kg_m2[joint][joint];
        let mean_kg_m2 = series.iter().sum::<f64>() / series.len().max(1) as f64;
        let least_kg_m2 = series.iter().copied().fold(f64::INFINITY, f64::min);
        (mean_kg_m2 > 0.0).then_some(Inertia { mean_kg_m2, least_kg_m2 })
    }

    /// The motion of a joint's link against its motor, as the rows' filter passes it.
    pub fn deflection(&self, joint: usize, gear: Gear, load: Load) -> Deflection {
        // A link without play is linear: it may be driven by what the filter has passed.
        let finer = self.finer.as_ref().filter(|_| gear.half_gap_rad > 0.0);
        let links = finer.map_or(&self.links, |(links, _)| links);
        let of_residual = if load == Load::Measured { 1.0 } else { 0.0 };
        let own = &self.inertia_kg_m2[joint][joint];
        let least = LEAST_INERTIA * self.inertia(joint).map_or(f64::MIN_POSITIVE, |m| m.mean_kg_m2);
        let moved = links.load_nm[joint].iter().zip(&links.residual[joint]);
        let moved = moved.zip(&links.acceleration_rad_s2[joint]);
        let load: Vec<f64> =
            moved.map(|((load, r), q)| load + of_residual * r - gear.rotor_kg_m2 * q).collect();
        let at_links = |series: &[f64], value: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let rows = series.iter().flat_map(|v| std::iter::repeat_n(value(*v), links.per_row));
            rows.take(load.len()).collect()
        };
        let moved = gear.deflection(&Drive {
            period_s: 1.0 / (self.rate_hz * links.per_row as f64),
            load_nm: &load,
            inertia_kg_m2: &at_links(own, &|m| (m - gear.rotor_kg_m2).max(least)),
            gradient_nm_rad: &at_links(&self.gradient_nm_rad[joint][joint], &|g| g),
        });
        let Some((_, low)) = finer else { return moved };
        // The series is as long as those that the rows were made of: the filter takes it.
        let passed = low.filter_all(&[moved.angle_rad, moved.acceleration_rad_s2]).unwrap_or_default();
        let mut thin = passed.into_iter().map(|series| series.into_iter().step_by(links.per_row).collect());
        let mut next = || thin.next().unwrap_or_default();
        Deflection { angle_rad: next(), acceleration_rad_s2: next() }
    }

    /// The torque at joint i of joint j's deflection.
    pub fn torque(&self, joint: usize, i: usize, gear: Gear, deflection: &Deflection) -> Vec<f64> {
        let rotor = if i == joint { gear.rotor_kg_m2 } else { 0.0 };
        let (inertia, gradient) = (&self.inertia_kg_m2[joint][i], &self.gradient_nm_rad[joint][i]);
        let moved = deflection.acceleration_rad_s2.iter().zip(&deflection.angle_rad);
        inertia.iter().zip(gradient).zip(moved).map(|((m, g), (a, x))| (m - rotor) * a + g * x).collect()
    }

    /// M_ij times a series.
    pub fn along_inertia(&self, joint: usize, i: usize, series: &[f64]) -> Vec<f64> {
        self.inertia_kg_m2[joint][i].iter().zip(series).map(|(m, s)| m * s).collect()
    }

    /// A series of joint i, whitened as its residual is, where it counts; `None` for a joint without noise to judge by.
    pub fn whitened(&self, i: usize, series: &[f64]) -> Option<Vec<f64>> {
        let mut out = self.whiteners[i].as_ref()?.apply(series);
        self.silence(i, &mut out);
        Some(out)
    }

    /// Sets the rows of joint i that do not count to zero.
    pub fn silence(&self, i: usize, series: &mut [f64]) {
        for (value, (counts, block)) in series.iter_mut().zip(self.counts[i].iter().zip(&self.block)) {
            if !counts || block.is_none() {
                *value = 0.0;
            }
        }
    }
}
