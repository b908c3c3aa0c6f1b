use aurt_traits::Branch;
use serde::{Deserialize, Serialize};

use crate::joint::{Joint, JointFrame, Parent};
use crate::kernel::{Branching, Place};
use crate::plausible::{angle_complaint, gravity_complaint};
use crate::{MOST_JOINTS, MdhTable, RbdError};

/// A tree of N ≥ 1 links on a fixed base, joined by revolute and prismatic joints: a chain, where every joint sits on the
/// link of the joint before.
///
/// Joint j moves link j against its parent link p(j) < j, or against the base ([`Parent`](crate::Parent)). The joints that
/// carry a link are those of its [path](Self::path) from the base; the links that a joint carries are its subtree.
///
/// Link frame j has its origin on the axis of joint j and its z axis along it. Frame j relative to that of the parent
/// link is the joint's constant [`Placement`](crate::Placement) followed by
///
/// - Rot_z(sign · q_j + offset) for a revolute joint, q_j in rad;
/// - Rot_z(offset) Trans_z(sign · q_j) for a prismatic joint, q_j in m.
///
/// Wherever an interface of this crate names positions in rad, velocities in rad/s, accelerations in rad/s² and torques
/// in Nm, the entries of prismatic joints are in m, m/s, m/s² and N, and their rotor inertia is in kg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ChainSpec", into = "ChainSpec")]
pub struct SerialChain {
    joints: Vec<Joint>,
    frames: Vec<JointFrame>,
    places: Vec<Place>,
    paths: Vec<usize>,
    gravity_m_s2: [f64; 3],
    joint_names: Vec<String>,
    link_names: Vec<String>,
    branches: Vec<Branch>,
}

impl SerialChain {
    /// A chain or tree of the given joints, each behind the one that moves its parent link; gravity in the base frame.
    ///
    /// # Errors
    /// [`RbdError::NoJoints`], [`RbdError::TooManyJoints`], [`RbdError::Joint`] (value not finite, sign not ±1, no rotation matrix, parent not before
    /// the joint) or [`RbdError::Gravity`].
    pub fn new(mut joints: Vec<Joint>, gravity_m_s2: [f64; 3]) -> Result<Self, RbdError> {
        if joints.is_empty() {
            return Err(RbdError::NoJoints);
        }
        if joints.len() > MOST_JOINTS {
            return Err(RbdError::TooManyJoints { joints: joints.len(), most: MOST_JOINTS });
        }
        for (joint, j) in joints.iter_mut().enumerate() {
            let parent = j.parent.of(joint);
            if let Some(link) = parent.filter(|link| *link >= joint) {
                let reason =
                    format!("must be a link before it, is link {link}; list the joints from the base on");
                return Err(RbdError::Joint { joint, what: "parent", reason });
            }
            j.parent = Parent::named(parent, joint);
            if let Some((what, reason)) = j.placement.complaint() {
                return Err(RbdError::Joint { joint, what, reason });
            }
            if let Some(reason) = angle_complaint(j.theta_offset_rad) {
                return Err(RbdError::Joint { joint, what: "theta offset", reason });
            }
            if j.sign.abs() != 1.0 {
                let reason = format!("must be 1 or -1, is {}", j.sign);
                return Err(RbdError::Joint { joint, what: "sign", reason });
            }
        }
        if let Some(reason) = gravity_complaint(gravity_m_s2) {
            return Err(RbdError::Gravity { reason });
        }
        let frames: Vec<_> = joints.iter().map(Joint::frame).collect();
        let (places, paths) = places(&joints, &frames);
        Ok(Self {
            joints,
            frames,
            places,
            paths,
            gravity_m_s2,
            joint_names: Vec::new(),
            link_names: Vec::new(),
            branches: Vec::new(),
        })
    }

    /// The chain of a table of modified Denavit–Hartenberg parameters.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn from_mdh(table: &MdhTable, gravity_m_s2: [f64; 3]) -> Result<Self, RbdError> {
        Self::new(table.joints(), gravity_m_s2)
    }

    /// The same chain with names for its joints, base first; an empty list for none.
    ///
    /// # Errors
    /// [`RbdError::Count`] if the number of names is not that of the joints; [`RbdError::JointName`].
    pub fn with_joint_names(self, joint_names: Vec<String>) -> Result<Self, RbdError> {
        check_joint_names(&joint_names, self.joints.len())?;
        Ok(Self { joint_names, ..self })
    }

    /// The same chain with names for its links, that of joint 0 first; an empty list for none.
    ///
    /// # Errors
    /// [`RbdError::Count`] if the number of names is not that of the joints.
    pub fn with_link_names(self, link_names: Vec<String>) -> Result<Self, RbdError> {
        let (expected, found) = (self.joints.len(), link_names.len());
        if found != 0 && found != expected {
            return Err(RbdError::Count { what: "link names", expected, found });
        }
        Ok(Self { link_names, ..self })
    }

    /// The same chain with the joints beside it.
    ///
    /// # Errors
    /// [`RbdError::Branch`] if one is said to be behind a joint that is not there.
    pub fn with_branches(self, branches: Vec<Branch>) -> Result<Self, RbdError> {
        check_branches(&branches, self.joints.len())?;
        Ok(Self { branches, ..self })
    }

    /// The joints beside the chain.
    pub fn branches(&self) -> &[Branch] {
        &self.branches
    }

    /// The joints' names, base first; empty where they have none.
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// The links' names, that of joint 0 first; empty where they have none.
    pub fn link_names(&self) -> &[String] {
        &self.link_names
    }

    /// The joints, base first.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// The link that a joint sits on, `None` for the base.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn parent(&self, joint: usize) -> Option<usize> {
        self.joints[joint].parent.of(joint)
    }

    /// The joints that carry a link, base first, its own last.
    ///
    /// # Panics
    /// If there is no such link.
    pub fn path(&self, link: usize) -> &[usize] {
        let Branching { path, depth, .. } = self.places[link].branching;
        &self.paths[path..=path + depth]
    }

    /// Whether every joint sits on the link of the joint before.
    pub fn is_serial(&self) -> bool {
        self.check_serial().is_ok()
    }

    /// Refuses trees.
    ///
    /// # Errors
    /// [`RbdError::Tree`] with the first joint that does not sit on the link of the joint before.
    pub fn check_serial(&self) -> Result<(), RbdError> {
        match self.joints.iter().position(|joint| joint.parent != Parent::Previous) {
            Some(joint) => Err(RbdError::Tree { joint }),
            None => Ok(()),
        }
    }

    /// Gravitational acceleration in the base frame, m/s².
    pub const fn gravity_m_s2(&self) -> [f64; 3] {
        self.gravity_m_s2
    }

    pub(crate) fn frames(&self) -> &[JointFrame] {
        &self.frames
    }

    pub(crate) fn places(&self) -> &[Place] {
        &self.places
    }

    pub(crate) fn paths(&self) -> &[usize] {
        &self.paths
    }

    /// The same bodies under another gravity vector.
    pub fn under_gravity(&self, gravity_m_s2: [f64; 3]) -> Self {
        Self { gravity_m_s2, ..self.clone() }
    }
}

/// The joints' places as the regressor kernel wants them, and the paths of all links.
fn places(joints: &[Joint], frames: &[JointFrame]) -> (Vec<Place>, Vec<usize>) {
    let mut paths: Vec<usize> = Vec::new();
    let mut places: Vec<Place> = Vec::with_capacity(joints.len());
    let mut kept = 0;
    for (j, (joint, frame)) in joints.iter().zip(frames).enumerate() {
        let parent = joint.parent.of(j);
        let path = paths.len();
        let mut branching = Branching { path, ..Branching::default() };
        if let Some(before) = parent.map(|parent| &mut places[parent].branching) {
            branching.depth = before.depth + 1;
            if joint.parent != Parent::Previous {
                branching.resumes = Some(*before.kept.get_or_insert(kept));
                kept = kept.max(branching.resumes.map_or(0, |k| k + 1));
            }
            let before = before.path;
            paths.extend_from_within(before..before + branching.depth);
        }
        paths.push(j);
        places.push(Place::new(joint.kind, frame, parent.map(|parent| &joints[parent]), branching));
    }
    (places, paths)
}

/// Whether names can be those of `joints` joints: none at all, or one each, of which no two are alike.
pub(crate) fn check_joint_names(names: &[String], joints: usize) -> Result<(), RbdError> {
    if !names.is_empty() && names.len() != joints {
        return Err(RbdError::Count { what: "joint names", expected: joints, found: names.len() });
    }
    let refused = |(joint, name): &(usize, &String)| name.trim().is_empty() || names[..*joint].contains(name);
    match names.iter().enumerate().find(refused) {
        Some((joint, name)) => Err(RbdError::JointName { joint, name: name.clone() }),
        None => Ok(()),
    }
}

pub(crate) fn check_branches(branches: &[Branch], joints: usize) -> Result<(), RbdError> {
    match branches.iter().find(|b| b.upstream.iter().any(|j| *j >= joints)) {
        Some(branch) => Err(RbdError::Branch { name: branch.joint.clone(), joints }),
        None => Ok(()),
    }
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ChainSpec {
    gravity_m_s2: [f64; 3],
    joints: Vec<Joint>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    joint_names: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    link_names: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    branches: Vec<Branch>,
}

impl From<SerialChain> for ChainSpec {
    fn from(chain: SerialChain) -> Self {
        let SerialChain { gravity_m_s2, joints, joint_names, link_names, branches, .. } = chain;
        Self { gravity_m_s2, joints, joint_names, link_names, branches }
    }
}

impl TryFrom<ChainSpec> for SerialChain {
    type Error = RbdError;

    fn try_from(spec: ChainSpec) -> Result<Self, RbdError> {
        Self::new(spec.joints, spec.gravity_m_s2)?
            .with_joint_names(spec.joint_names)?
            .with_link_names(spec.link_names)?
            .with_branches(spec.branches)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::Placement;

    #[test]
    fn a_saved_chain_reads_back_and_is_checked() {
        let placement = Placement::Mdh { alpha_rad: FRAC_PI_2, a_m: -0.4, d_m: 0.1 };
        let turned = Placement::Fixed {
            rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            translation_m: [0.1, 0.2, 0.3],
        };
        let joints = vec![
            Joint { theta_offset_rad: 0.1, sign: -1.0, ..Joint::revolute(placement) },
            Joint::revolute(turned),
        ];
        let names = ["a\"\n*/", "b"].map(str::to_owned).to_vec();
        let nameless = SerialChain::new(joints, [0.0, 6.937, -6.937]).unwrap();
        assert!(!serde_json::to_string(&nameless).unwrap().contains("joint_names"));
        let links = ["upper arm", "upper arm"].map(str::to_owned).to_vec();
        assert!(nameless.clone().with_link_names(links[..1].to_vec()).is_err());
        let chain = nameless.clone().with_joint_names(names).unwrap().with_link_names(links.clone()).unwrap();
        for bad in [vec!["a"], vec!["a", "a"], vec!["a", " "]] {
            let bad = bad.into_iter().map(str::to_owned).collect();
            assert!(nameless.clone().with_joint_names(bad).is_err());
        }
        let boxed: Box<dyn aurt_traits::RigidBodyRegressor> = Box::new(chain.clone());
        let text = serde_json::to_string(&boxed).unwrap();
        assert!(text.contains(r#""kind":"serial_chain""#), "{text}");
        let read: Box<dyn aurt_traits::RigidBodyRegressor> = serde_json::from_str(&text).unwrap();
        assert_eq!(format!("{read:?}"), format!("{chain:?}"));
        assert_eq!(read.link_names(), links);

        let bad = text.replace(r#""sign":-1.0"#, r#""sign":0.5"#);
        let error = serde_json::from_str::<Box<dyn aurt_traits::RigidBodyRegressor>>(&bad).unwrap_err();
        assert!(error.to_string().contains("joint 0: sign must be 1 or -1"), "{error}");
        let unknown = text.replace("theta_offset_rad", "offset");
        assert!(serde_json::from_str::<Box<dyn aurt_traits::RigidBodyRegressor>>(&unknown).is_err());
        let mirrored = text.replace("[0.0,-1.0,0.0]", "[0.0,1.0,0.0]");
        assert!(serde_json::from_str::<Box<dyn aurt_traits::RigidBodyRegressor>>(&mirrored).is_err());
    }
}
