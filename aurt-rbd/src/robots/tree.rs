use std::cell::OnceCell;
use std::collections::HashMap;
use std::path::PathBuf;

use nalgebra::Vector3;

use crate::robots::pose::{Body, Pose};
use crate::robots::{JointFriction, JointLimits};

#[derive(Debug)]
pub(crate) struct Tree {
    pub path: PathBuf,
    pub name: String,
    pub links: Vec<TreeLink>,
    pub joints: Vec<TreeJoint>,
    /// What a person should know of how the file was read.
    pub notes: Vec<String>,
    /// What ties joints in ways that models do not know.
    pub ties: Vec<Tie>,
    /// What each joint follows in the end, once it is asked.
    pub followed: OnceCell<Vec<Option<Followed>>>,
}

#[derive(Debug)]
pub(crate) struct TreeLink {
    pub name: String,
    pub body: Option<Body>,
    /// The joint that this link hangs on; `None` for the root.
    pub parent: Option<usize>,
    /// The joints that hang on this link.
    pub children: Vec<usize>,
    /// Where the file has it; none of the world, and of links between joints of one MJCF body.
    pub place: Option<BodyPlace>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct BodyPlace {
    /// Byte at which the element `body` or `link` begins.
    pub body: usize,
    /// Byte at which its element `inertial` begins, if it has one.
    pub inertial: Option<usize>,
    /// The frame, in the link's, in which that element is or would be given.
    pub frame: Pose,
}

/// What a joint lets its child do.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Freedom {
    Fixed,
    Turns(Vector3<f64>),
    Slides(Vector3<f64>),
    /// Anything else, by the file's own name.
    Other(String),
}

/// A joint that follows another: multiplier · q + offset.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mimic {
    pub joint: String,
    pub multiplier: f64,
    pub offset: f64,
}

/// An element that ties joints in a way that models do not know: none of them may move.
#[derive(Debug)]
pub(crate) struct Tie {
    pub line: u32,
    pub what: String,
    /// What it does.
    pub reason: String,
    pub joints: Vec<usize>,
}

/// What a joint follows in the end: multiplier · q_joint + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Followed {
    pub joint: usize,
    pub multiplier: f64,
    pub offset: f64,
}

#[derive(Debug)]
pub(crate) struct TreeJoint {
    pub name: String,
    pub line: u32,
    /// Byte at which its element begins.
    pub start: usize,
    pub parent: usize,
    pub child: usize,
    /// The joint's frame in the parent link at coordinate zero.
    pub pose: Pose,
    pub freedom: Freedom,
    pub mimic: Option<Mimic>,
    pub limits: JointLimits,
    pub friction: JointFriction,
    /// Inertia of the rotor as the joint feels it, in kg m² (kg where it slides).
    pub armature: f64,
    /// What actuators add to that and to the viscous friction.
    pub driven: [f64; 2],
    pub spring: Spring,
}

/// The spring of a joint, in the units of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spring {
    /// Nm/rad or N/m.
    pub stiffness: f64,
    /// Where it rests, in the file's unit of angles, or m.
    pub reference: f64,
    /// That unit in rad; 1 of a joint that slides.
    pub unit: f64,
}

impl Spring {
    pub const NONE: Self = Self { stiffness: 0.0, reference: 0.0, unit: 1.0 };
}

impl TreeJoint {
    /// Whether it is a joint of one degree of freedom.
    pub const fn moves(&self) -> bool {
        matches!(self.freedom, Freedom::Turns(_) | Freedom::Slides(_))
    }
}

impl Tree {
    /// The joints from the link `base` down to the link `tip`; `None` if the tip does not hang on the base.
    pub fn path_between(&self, base: usize, tip: usize) -> Option<Vec<usize>> {
        let mut joints = Vec::new();
        let mut link = tip;
        while link != base {
            let joint = self.links[link].parent?;
            joints.push(joint);
            link = self.joints[joint].parent;
        }
        joints.reverse();
        Some(joints)
    }

    /// What a joint follows in the end, through joints that follow others themselves; a joint that follows none is its own.
    ///
    /// `None` if a joint that is followed is not there or does not move, or if joints follow each other in a circle.
    pub fn followed(&self, joint: usize) -> Option<Followed> {
        self.followed.get_or_init(|| followed(&self.joints))[joint]
    }

    /// Where a joint beside the chain rests, if those that follow none rest at zero.
    pub fn rest(&self, joint: usize) -> f64 {
        let own = || self.joints[joint].mimic.as_ref().map_or(0.0, |mimic| mimic.offset);
        self.followed(joint).map_or_else(own, |followed| followed.offset)
    }
}

/// What every joint follows in the end; each is looked at once.
fn followed(joints: &[TreeJoint]) -> Vec<Option<Followed>> {
    let named: HashMap<&str, usize> = joints.iter().enumerate().map(|(k, j)| (j.name.as_str(), k)).collect();
    let mut known: Vec<Option<Option<Followed>>> = vec![None; joints.len()];
    for first in 0..joints.len() {
        let (mut at, mut open) = (first, Vec::new());
        let mut end = loop {
            if let Some(found) = known[at] {
                break found;
            }
            let Some(mimic) = &joints[at].mimic else {
                let own = Some(Followed { joint: at, multiplier: 1.0, offset: 0.0 });
                break *known[at].insert(own);
            };
            // What leads back to a joint that is still open is a circle.
            known[at] = Some(None);
            open.push((at, mimic));
            match named.get(mimic.joint.as_str()) {
                Some(next) if joints[*next].moves() => at = *next,
                _ => break None,
            }
        };
        for (joint, Mimic { multiplier, offset, .. }) in open.into_iter().rev() {
            end = end.map(|next: Followed| Followed {
                joint: next.joint,
                multiplier: multiplier * next.multiplier,
                offset: multiplier * next.offset + offset,
            });
            known[joint] = Some(end);
        }
    }
    known.into_iter().map(Option::flatten).collect()
}
