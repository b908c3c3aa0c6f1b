use std::any::Any;
use std::fmt::Debug;

use serde::{Deserialize, Serialize};

use crate::{Branch, MotionView, Parameter};

/// The rigid bodies of a robot as a regressor in its standard inertial parameters:
/// τ_RBD = Y(q, q̇, q̈) π, with Y of N rows (joints) and P columns (parameters).
///
/// For a chain or tree of N revolute links P = 10 N, link after link, in the order
/// {XX XY XZ YY YZ ZZ mX mY mZ m}; inertias about the joint's centre of rotation (the link frame's origin).
///
/// Evaluation is batched: one call writes many samples, each (joint, parameter) entry as a contiguous column.
#[typetag::serde(tag = "kind")]
pub trait RigidBodyRegressor: Any + Debug + Send + Sync {
    /// Number of joints N.
    fn joints(&self) -> usize;

    /// The names of the N joints, by which recordings, models and exports match them; empty where they have none.
    fn joint_names(&self) -> &[String] {
        &[]
    }

    /// Whether a joint slides: its position is a length in m. By default all turn.
    fn slides(&self, _joint: usize) -> bool {
        false
    }

    /// The names of the bodies of [`Self::bodies`], for people; empty where they have none.
    fn link_names(&self) -> &[String] {
        &[]
    }

    /// The joints beside the chain, whose motion the regressor does not know.
    fn branches(&self) -> &[Branch] {
        &[]
    }

    /// The P standard parameters, e.g. `XX_0` in `kg m^2`.
    fn standard_parameters(&self) -> Vec<Parameter>;

    /// For each rigid body the indices of its ten standard parameters {XX XY XZ YY YZ ZZ mX mY mZ m}, inertia about the
    /// origin of the frame that the first moments are in: what physical consistency is a property of. By default ten
    /// after ten; parameters that are in none are of no body.
    fn bodies(&self) -> Vec<[usize; 10]> {
        let count = self.standard_parameters().len() / 10;
        (0..count).map(|body| std::array::from_fn(|k| 10 * body + k)).collect()
    }

    /// Whether `parameter` can load `joint`; entries for which this is false are zero and are never written.
    fn loads(&self, parameter: usize, joint: usize) -> bool;

    /// Writes the wanted entries of Y for every sample of `motion` into `out`.
    ///
    /// Every entry that `out` wants and [`Self::loads`] allows is written, zeros included.
    fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>);

    /// τ = Y π for every sample of `motion`, with π the P standard parameters: joint j's torque at sample k goes to
    /// `out[j · stride + k]`.
    ///
    /// Whoever knows his bodies overrides this: τ needs less work than the columns of Y, which are evaluated here for
    /// the parameters that are not zero.
    ///
    /// # Panics
    /// If there are not P parameters, or `out` or `stride` is too short.
    fn torque(&self, motion: MotionView<'_>, standard: &[f64], out: &mut [f64], stride: usize) {
        const AT_ONCE: usize = 256;
        let (joints, parameters) = (self.joints(), standard.len());
        let mut destination = vec![RegressorTile::UNWANTED; joints * parameters];
        let mut used = 0;
        for joint in 0..joints {
            for (k, value) in standard.iter().enumerate() {
                if *value != 0.0 && self.loads(k, joint) {
                    destination[joint * parameters + k] = used;
                    used += 1;
                }
            }
        }
        let mut data = vec![0.0; used as usize * AT_ONCE];
        for first in (0..motion.samples()).step_by(AT_ONCE) {
            let end = (first + AT_ONCE).min(motion.samples());
            let samples = end - first;
            let mut tile = RegressorTile::new(&destination, parameters, samples, AT_ONCE, &mut data);
            self.evaluate(motion.slice(first..end), &mut tile);
            for joint in 0..joints {
                let sum = &mut out[joint * stride + first..joint * stride + end];
                sum.fill(0.0);
                for (k, value) in standard.iter().enumerate() {
                    if let Some(column) = tile.entry_mut(joint, k) {
                        sum.iter_mut().zip(column).for_each(|(s, v)| *s += value * *v);
                    }
                }
            }
        }
    }

    /// Gravitational acceleration in the base frame, m/s².
    fn gravity_m_s2(&self) -> [f64; 3];

    /// The same bodies under another gravity vector (another mounting of the base).
    fn with_gravity(&self, gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor>;
}

/// Where a [`RigidBodyRegressor`] writes: for each (joint, parameter) either a column or nothing.
#[derive(Debug)]
pub struct RegressorTile<'a> {
    destination: &'a [u32],
    parameters: usize,
    stride: usize,
    samples: usize,
    data: &'a mut [f64],
}

impl<'a> RegressorTile<'a> {
    /// The entry of `destination` for "not wanted".
    pub const UNWANTED: u32 = u32::MAX;

    /// A tile whose entry (joint, parameter) goes to `data[d·stride .. d·stride + samples]` with
    /// `d = destination[joint · parameters + parameter]`.
    ///
    /// # Panics
    /// If `stride < samples` or a destination lies outside `data`.
    pub fn new(
        destination: &'a [u32],
        parameters: usize,
        samples: usize,
        stride: usize,
        data: &'a mut [f64],
    ) -> Self {
        assert!(stride >= samples, "stride shorter than a column");
        // One more than the last destination: those that are not wanted wrap around to 0, so that there is no
        // branch and the search is a fraction of a small tile's work.
        let end = destination.iter().map(|d| d.wrapping_add(1)).max().unwrap_or(0) as usize;
        assert!(
            end == 0 || (end - 1) * stride + samples <= data.len(),
            "a destination lies outside the tile"
        );
        Self { destination, parameters, stride, samples, data }
    }

    /// Number of samples per column.
    pub const fn samples(&self) -> usize {
        self.samples
    }

    /// Number of standard parameters P.
    pub const fn parameters(&self) -> usize {
        self.parameters
    }

    /// The column of (joint, parameter), if it is wanted.
    pub fn entry_mut(&mut self, joint: usize, parameter: usize) -> Option<&mut [f64]> {
        let d = self.destination[joint * self.parameters + parameter];
        if d == Self::UNWANTED {
            return None;
        }
        let start = d as usize * self.stride;
        Some(&mut self.data[start..start + self.samples])
    }

    /// Destinations, stride and data, for kernels that write in their own order.
    pub fn raw_mut(&mut self) -> (&[u32], usize, &mut [f64]) {
        (self.destination, self.stride, self.data)
    }
}

/// A minimal set of inertial parameters: the standard parameters whose columns are kept, and what each of
/// them collects from the others (paper, section III-A.1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BaseParameters {
    /// Indices of the kept (independent) standard parameters, ascending.
    pub columns: Vec<usize>,
    /// For each kept parameter, the standard parameters it stands for: (index, factor), its own factor 1
    /// first. A base parameter's value is Σ factor · standard value.
    pub combinations: Vec<Vec<(usize, f64)>>,
    /// Seed of the random motions that the numerical procedure used.
    pub seed: u64,
    /// Number of random samples after which the rank had settled.
    pub observations: usize,
}

impl BaseParameters {
    /// Number of base parameters.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The base parameters' values from standard parameter values.
    ///
    /// # Panics
    /// If `standard` is shorter than the largest index used.
    pub fn values(&self, standard: &[f64]) -> Vec<f64> {
        self.combinations.iter().map(|c| c.iter().map(|(i, factor)| factor * standard[*i]).sum()).collect()
    }
}
