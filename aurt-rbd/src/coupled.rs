use aurt_traits::{Branch, Motion, MotionView, Parameter, RegressorTile, RigidBodyRegressor};
use serde::{Deserialize, Serialize};

use crate::chain::{check_branches, check_joint_names};
use crate::{INERTIAL_PARAMETERS, Joint, JointKind, RbdError, SerialChain};

/// Samples that are evaluated at once, so that the columns of all joints stay in a cache.
const AT_ONCE: usize = 256;
/// Largest size of a multiplier: beyond it a joint is no joint of a coupled mechanism.
const LARGEST_MULTIPLIER: f64 = 1e3;

/// How a joint of a [`CoupledChain`] follows a coordinate: q_k = multiplier · u_c + offset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Coupling {
    /// The coordinate c that it follows, from 0.
    pub coordinate: usize,
    /// Motion of the joint per motion of the coordinate: rad or m per rad or m.
    pub multiplier: f64,
    /// Position of the joint where the coordinate is zero, rad or m.
    pub offset: f64,
}

impl Coupling {
    /// A joint that is a coordinate of its own.
    pub const fn own(coordinate: usize) -> Self {
        Self { coordinate, multiplier: 1.0, offset: 0.0 }
    }

    /// Whether a coordinate is a length: the joint slides that is the coordinate's own, or the first that follows it. Without
    /// couplings each joint is a coordinate.
    pub fn slides(coordinate: usize, joints: &[Joint], couplings: &[Self]) -> bool {
        let follows = |k: &usize| couplings[*k].coordinate == coordinate;
        let own = (0..couplings.len()).find(|k| couplings[*k] == Self::own(coordinate));
        let joint = if couplings.is_empty() {
            Some(coordinate)
        } else {
            own.or_else(|| (0..couplings.len()).find(follows))
        };
        joint.and_then(|k| joints.get(k)).is_some_and(|joint| joint.kind == JointKind::Prismatic)
    }
}

/// A chain of M joints that N ≤ M coordinates u move: q = G u + o, where row k of G holds the multiplier of joint k at
/// its coordinate (`mimic` of URDF files; parallelograms that keep a link's direction, telescopes, fingers).
///
/// The couplings are ideal: their forces do no work, so that by the principle of virtual work the torque of coordinate c is
/// Σ multiplier_k τ_k over the joints k that follow it, and Y = Gᵀ Y_chain(G u + o, G u̇, G ü): N rows of 10 M standard
/// parameters, those of all M links.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "CoupledSpec", into = "CoupledSpec")]
pub struct CoupledChain {
    chain: SerialChain,
    couplings: Vec<Coupling>,
    coordinates: usize,
    joint_names: Vec<String>,
    branches: Vec<Branch>,
}

impl CoupledChain {
    /// A chain whose joint k moves as `couplings[k]` says.
    ///
    /// # Errors
    /// [`RbdError::Count`] if there is not a coupling for each joint; [`RbdError::Joint`] for a multiplier that is zero or
    /// not finite, an offset that is not finite, or coordinates that are not 0, 1, … without a gap.
    pub fn new(chain: SerialChain, couplings: Vec<Coupling>) -> Result<Self, RbdError> {
        let expected = chain.joints().len();
        if couplings.len() != expected {
            return Err(RbdError::Count { what: "couplings", expected, found: couplings.len() });
        }
        let coordinates = couplings.iter().map(|c| c.coordinate.saturating_add(1)).max().unwrap_or(0);
        let has_all_before = |coordinate: usize| {
            coordinate < expected
                && (0..coordinate).all(|before| couplings.iter().any(|c| c.coordinate == before))
        };
        for (joint, coupling) in couplings.iter().enumerate() {
            let size = coupling.multiplier.abs();
            // Written so that a NaN is a complaint too.
            let moves = size > 0.0 && size <= LARGEST_MULTIPLIER;
            let complaint = if !moves {
                let reason = format!(
                    "must not be zero, and {LARGEST_MULTIPLIER} in size at most, is {}",
                    coupling.multiplier
                );
                Some(("multiplier", reason))
            } else if !coupling.offset.is_finite() {
                Some(("offset", format!("must be finite, is {}", coupling.offset)))
            } else if !has_all_before(coupling.coordinate) {
                Some(("coordinate", format!("is {}, and no joint has the one before", coupling.coordinate)))
            } else {
                None
            };
            if let Some((what, reason)) = complaint {
                return Err(RbdError::Joint { joint, what, reason });
            }
        }
        Ok(Self { chain, couplings, coordinates, joint_names: Vec::new(), branches: Vec::new() })
    }

    /// The same with names for the N joints that move on their own; an empty list for none.
    ///
    /// # Errors
    /// As [`SerialChain::with_joint_names`].
    pub fn with_joint_names(self, joint_names: Vec<String>) -> Result<Self, RbdError> {
        check_joint_names(&joint_names, self.coordinates)?;
        Ok(Self { joint_names, ..self })
    }

    /// The same with the joints beside the chain.
    ///
    /// # Errors
    /// As [`SerialChain::with_branches`].
    pub fn with_branches(self, branches: Vec<Branch>) -> Result<Self, RbdError> {
        check_branches(&branches, self.coordinates)?;
        Ok(Self { branches, ..self })
    }

    /// The chain of all M joints, as if each moved on its own.
    pub const fn chain(&self) -> &SerialChain {
        &self.chain
    }

    /// How each of the M joints moves.
    pub fn couplings(&self) -> &[Coupling] {
        &self.couplings
    }

    /// The motion of all joints: q = G u + o, q̇ = G u̇, q̈ = G ü.
    fn expanded(&self, motion: MotionView<'_>) -> Option<Motion> {
        let of = |series: &dyn Fn(usize) -> Vec<f64>, with_offset: bool| -> Vec<f64> {
            let joint = |c: &Coupling| {
                let offset = if with_offset { c.offset } else { 0.0 };
                series(c.coordinate).into_iter().map(move |v| c.multiplier * v + offset).collect::<Vec<_>>()
            };
            self.couplings.iter().flat_map(joint).collect()
        };
        Motion::new(
            self.couplings.len(),
            motion.time_s().to_vec(),
            of(&|c| motion.position_rad(c).to_vec(), true),
            of(&|c| motion.velocity_rad_s(c).to_vec(), false),
            of(&|c| motion.acceleration_rad_s2(c).to_vec(), false),
        )
        .ok()
    }

    fn followers(&self, coordinate: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.couplings.iter().enumerate();
        all.filter(move |(_, c)| c.coordinate == coordinate).map(|(k, c)| (k, c.multiplier))
    }

    /// Evaluates the samples of `motion`, which begin at sample `first` of `out`.
    fn evaluate_part(
        &self,
        motion: MotionView<'_>,
        first: usize,
        wanted: &[u32],
        scratch: &mut [f64],
        out: &mut RegressorTile<'_>,
    ) {
        let (samples, parameters) = (motion.samples(), out.parameters());
        let Some(expanded) = self.expanded(motion) else { return };
        RigidBodyRegressor::evaluate(
            &self.chain,
            expanded.view(),
            &mut RegressorTile::new(wanted, parameters, samples, AT_ONCE, scratch),
        );
        for coordinate in 0..self.coordinates {
            for parameter in 0..parameters {
                let Some(column) = out.entry_mut(coordinate, parameter) else { continue };
                let column = &mut column[first..first + samples];
                let mut is_first = true;
                for (joint, multiplier) in self.followers(coordinate) {
                    let from = wanted[joint * parameters + parameter];
                    if from == RegressorTile::UNWANTED {
                        continue;
                    }
                    let start = from as usize * AT_ONCE;
                    let values = &scratch[start..start + samples];
                    if is_first {
                        column.iter_mut().zip(values).for_each(|(s, v)| *s = multiplier * v);
                    } else {
                        column.iter_mut().zip(values).for_each(|(s, v)| *s += multiplier * v);
                    }
                    is_first = false;
                }
            }
        }
    }
}

#[typetag::serde(name = "coupled_chain")]
impl RigidBodyRegressor for CoupledChain {
    fn joints(&self) -> usize {
        self.coordinates
    }

    fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    fn slides(&self, joint: usize) -> bool {
        Coupling::slides(joint, self.chain.joints(), &self.couplings)
    }

    fn link_names(&self) -> &[String] {
        self.chain.link_names()
    }

    fn branches(&self) -> &[Branch] {
        &self.branches
    }

    fn standard_parameters(&self) -> Vec<Parameter> {
        RigidBodyRegressor::standard_parameters(&self.chain)
    }

    fn loads(&self, parameter: usize, joint: usize) -> bool {
        self.followers(joint).any(|(k, _)| self.chain.loads(parameter, k))
    }

    fn evaluate(&self, motion: MotionView<'_>, out: &mut RegressorTile<'_>) {
        assert_eq!(motion.joints(), self.coordinates, "joints of the motion");
        assert_eq!(out.parameters(), self.couplings.len() * INERTIAL_PARAMETERS, "parameters of the tile");
        assert_eq!(out.samples(), motion.samples(), "samples of the tile");
        let parameters = out.parameters();
        let mut wanted = vec![RegressorTile::UNWANTED; self.couplings.len() * parameters];
        let mut used = 0;
        for (joint, coupling) in self.couplings.iter().enumerate() {
            for parameter in 0..parameters {
                let is_wanted = out.entry_mut(coupling.coordinate, parameter).is_some();
                if is_wanted && self.chain.loads(parameter, joint) {
                    wanted[joint * parameters + parameter] = used;
                    used += 1;
                }
            }
        }
        let mut scratch = vec![0.0; used as usize * AT_ONCE];
        for first in (0..motion.samples()).step_by(AT_ONCE) {
            let end = (first + AT_ONCE).min(motion.samples());
            self.evaluate_part(motion.slice(first..end), first, &wanted, &mut scratch, out);
        }
    }

    fn torque(&self, motion: MotionView<'_>, standard: &[f64], out: &mut [f64], stride: usize) {
        let mut all = vec![0.0; self.couplings.len() * AT_ONCE];
        for first in (0..motion.samples()).step_by(AT_ONCE) {
            let end = (first + AT_ONCE).min(motion.samples());
            let Some(expanded) = self.expanded(motion.slice(first..end)) else { return };
            self.chain.torque(expanded.view(), standard, &mut all, AT_ONCE);
            for coordinate in 0..self.coordinates {
                let sum = &mut out[coordinate * stride + first..coordinate * stride + end];
                sum.fill(0.0);
                for (joint, multiplier) in self.followers(coordinate) {
                    let torque = &all[joint * AT_ONCE..joint * AT_ONCE + end - first];
                    sum.iter_mut().zip(torque).for_each(|(s, t)| *s += multiplier * t);
                }
            }
        }
    }

    fn gravity_m_s2(&self) -> [f64; 3] {
        SerialChain::gravity_m_s2(&self.chain)
    }

    fn with_gravity(&self, gravity_m_s2: [f64; 3]) -> Box<dyn RigidBodyRegressor> {
        Box::new(Self { chain: self.chain.under_gravity(gravity_m_s2), ..self.clone() })
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CoupledSpec {
    gravity_m_s2: [f64; 3],
    joints: Vec<Joint>,
    couplings: Vec<Coupling>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    joint_names: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    link_names: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    branches: Vec<Branch>,
}

impl From<CoupledChain> for CoupledSpec {
    fn from(coupled: CoupledChain) -> Self {
        Self {
            gravity_m_s2: SerialChain::gravity_m_s2(&coupled.chain),
            joints: coupled.chain.joints().to_vec(),
            couplings: coupled.couplings,
            joint_names: coupled.joint_names,
            link_names: coupled.chain.link_names().to_vec(),
            branches: coupled.branches,
        }
    }
}

impl TryFrom<CoupledSpec> for CoupledChain {
    type Error = RbdError;

    fn try_from(spec: CoupledSpec) -> Result<Self, RbdError> {
        let chain = SerialChain::new(spec.joints, spec.gravity_m_s2)?.with_link_names(spec.link_names)?;
        Self::new(chain, spec.couplings)?.with_joint_names(spec.joint_names)?.with_branches(spec.branches)
    }
}
