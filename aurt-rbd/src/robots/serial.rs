//! From a part of a tree to joints, merged bodies and limits.

use std::collections::HashMap;

use crate::{
    Coupling, INERTIAL_PARAMETERS, Joint, JointKind, Parent, RbdError, RobotDescription, inconsistencies,
};
use aurt_traits::Branch;
use nalgebra::{Matrix3, Vector3};

use crate::robots::pose::{Pose, along};
use crate::robots::selection::{Selection, select};
use crate::robots::tree::{Followed, Freedom, Tree, TreeJoint};
use crate::robots::{DescribedRobot, JointFriction, JointLimits, Part, RobotError, RobotErrors};

/// A link of a selection: everything between one of its moving joints and the next ones.
pub(crate) struct ChainLink {
    pub joint: usize,
    /// The link that it moves on, none of the base.
    parent: Option<usize>,
    kind: JointKind,
    sign: f64,
    /// The link's frame in the frame of its joint.
    turn: Matrix3<f64>,
    /// The link's frame in that of its parent.
    pose: Pose,
    /// The tree's links that it consists of; the first is that of its joint.
    pub parts: Vec<LinkPart>,
}

/// A link of the tree in a link of the selection.
pub(crate) struct LinkPart {
    pub link: usize,
    /// Its frame in that of the selection's link.
    pub pose: Pose,
    /// Whether fixed joints alone lead to it.
    pub welded: bool,
    /// Its standard parameters in the frame of the selection's link.
    pub standard: [f64; INERTIAL_PARAMETERS],
}

impl ChainLink {
    fn standard(&self) -> [f64; INERTIAL_PARAMETERS] {
        let mut sum = [0.0; INERTIAL_PARAMETERS];
        for part in &self.parts {
            sum.iter_mut().zip(part.standard).for_each(|(sum, value)| *sum += value);
        }
        sum
    }
}

/// The links of a selection, and the joints beside it that they carry.
pub(crate) fn links(tree: &Tree, selection: &Selection) -> (Vec<ChainLink>, Vec<usize>) {
    let mut links: Vec<ChainLink> = Vec::new();
    // Of the tree's links on the way: the selection's link that each is in (none in the base), and its frame there.
    let mut places = HashMap::from([(selection.base, (None, Pose::identity()))]);
    let mut carried = Vec::new();
    for joint_index in &selection.joints {
        let joint = &tree.joints[*joint_index];
        let Some((mut on, here)) = places.get(&joint.parent).copied() else { continue };
        let at_joint = here.then(&joint.pose);
        let moving = match joint.freedom {
            Freedom::Turns(axis) => Some((JointKind::Revolute, axis)),
            Freedom::Slides(axis) => Some((JointKind::Prismatic, axis)),
            Freedom::Fixed | Freedom::Other(_) => None,
        };
        let here = match moving {
            Some((kind, axis)) if selection.moves[*joint_index] => {
                let (turn, sign) = along(&axis);
                let pose = at_joint.then(&Pose::turned(turn));
                links.push(ChainLink {
                    joint: *joint_index,
                    parent: on,
                    kind,
                    sign,
                    turn,
                    pose,
                    parts: Vec::new(),
                });
                on = Some(links.len() - 1);
                Pose::turned(turn.transpose())
            }
            Some(_) => {
                carried.push(*joint_index);
                at_joint.then(&at_rest(tree, *joint_index))
            }
            None => at_joint,
        };
        places.insert(joint.child, (on, here));
        if let Some(link) = on {
            add_bodies(tree, joint.child, selection, &here, &mut links[link].parts, &mut carried);
        }
    }
    (links, carried)
}

pub(crate) fn robot(tree: &Tree, base: Option<&str>, part: Part) -> Result<DescribedRobot, RobotErrors> {
    let selection = &select(tree, base, &part)?;
    let (links, carried) = links(tree, selection);
    let standard: Vec<f64> = links.iter().flat_map(ChainLink::standard).collect();
    let notes = notes(tree, selection, &carried, &standard);
    let has_masses = standard.iter().any(|v| *v != 0.0);
    let (own, followers): (Vec<&ChainLink>, Vec<&ChainLink>) =
        links.iter().partition(|link| tree.joints[link.joint].mimic.is_none());
    let coordinates: HashMap<usize, usize> =
        own.iter().enumerate().map(|(k, link)| (link.joint, k)).collect();
    let mut own: Vec<OwnJoint> = own.into_iter().map(|link| OwnJoint::of(tree, link.joint)).collect();
    let followed = |link: &ChainLink| {
        let followed = tree.followed(link.joint)?;
        Some((*coordinates.get(&followed.joint)?, followed))
    };
    for follower in &followers {
        if let Some((coordinate, followed)) = followed(follower) {
            own[coordinate].moves_also(&tree.joints[follower.joint], followed);
        }
    }
    let coupled = links.iter().filter_map(followed).map(|(coordinate, followed)| Coupling {
        coordinate,
        multiplier: followed.multiplier,
        offset: followed.offset,
    });
    let couplings = if followers.is_empty() { Vec::new() } else { coupled.collect() };
    let described = DescribedRobot {
        name: tree.name.clone(),
        base: tree.links[selection.base].name.clone(),
        tip: selection.tip.map_or_else(String::new, |tip| tree.links[tip].name.clone()),
        part,
        joint_names: own.iter().map(|own| tree.joints[own.joint].name.clone()).collect(),
        link_names: links.iter().map(|link| tree.links[tree.joints[link.joint].child].name.clone()).collect(),
        joints: links
            .iter()
            .enumerate()
            .map(|(k, link)| Joint {
                kind: link.kind,
                parent: Parent::named(link.parent, k),
                placement: link.pose.placement(),
                theta_offset_rad: 0.0,
                sign: link.sign,
            })
            .collect(),
        couplings,
        limits: own.iter().map(|own| own.limits).collect(),
        friction: own.iter().map(|own| own.friction).collect(),
        armature_kg_m2: own.iter().map(|own| own.armature).collect(),
        standard_parameters: has_masses.then_some(standard),
        // A joint that follows another moves with that one, which recordings have.
        branches: carried
            .iter()
            .filter(|joint| tree.joints[**joint].mimic.is_none())
            .map(|joint| branch(tree, selection, &links, &own, *joint, has_masses))
            .chain(carriers(tree, selection.base, own.len()))
            .collect(),
        frames: links.iter().map(|link| link.turn.transpose().into()).collect(),
        notes,
    };
    match described.rigid_body([0.0; 3]) {
        Ok(_) => Ok(described),
        Err(error) => Err(impossible(tree, &links, error).into()),
    }
}

/// A complaint about the joints, with the place of the joint in the file.
fn impossible(tree: &Tree, links: &[ChainLink], error: RbdError) -> RobotError {
    let path = tree.path.clone();
    match error {
        RbdError::Joint { joint, what, reason } if joint < links.len() => {
            let of = &tree.joints[links[joint].joint];
            let reason = format!("{what} {reason}");
            RobotError::Element { path, line: of.line, what: format!("joint {}", of.name), reason }
        }
        other => RobotError::NoChain { path, reason: other.to_string() },
    }
}

/// A joint beside the selection, and what hangs on it with all further joints at rest.
///
/// Its motion changes the torque of all joints that carry it, and of those that it carries.
///
/// A turn by dq about the axis n through o displaces the first moment h of a mass m by n × (h − m o) dq, a slide by m n dq.
fn branch(
    tree: &Tree,
    selection: &Selection,
    links: &[ChainLink],
    own: &[OwnJoint],
    joint: usize,
    has_masses: bool,
) -> Branch {
    let of = &tree.joints[joint];
    let holder = links.iter().find(|link| link.parts.iter().any(|part| part.link == of.child));
    let mut before = Vec::new();
    let mut next = holder;
    while let Some(link) = next {
        before.push(link);
        next = link.parent.map(|parent| &links[parent]);
    }
    let carries = |link: &&ChainLink| {
        selection.on_path[joint] && tree.path_between(of.child, tree.joints[link.joint].child).is_some()
    };
    let behind: Vec<&ChainLink> = links.iter().filter(carries).collect();
    let own_place = |link: &ChainLink| {
        let moves = tree.followed(link.joint)?.joint;
        own.iter().position(|own| own.joint == moves)
    };
    let mut upstream: Vec<usize> = before.iter().chain(&behind).filter_map(|link| own_place(link)).collect();
    upstream.sort_unstable();
    upstream.dedup();
    let parts = holder.map_or(&[][..], |link| &link.parts);
    let hangs = |part: &&LinkPart| part.link == of.child || tree.path_between(of.child, part.link).is_some();
    let (mut mass_kg, mut moment_kg_m) = (0.0, Vector3::zeros());
    for [.., x, y, z, mass] in parts.iter().filter(hangs).map(|part| part.standard) {
        moment_kg_m += Vector3::new(x, y, z);
        mass_kg += mass;
    }
    let pose = parts.iter().find(|part| part.link == of.child).map(|part| &part.pose);
    let displaced =
        pose.zip((has_masses && behind.is_empty()).then_some(())).and_then(|(pose, ())| match &of.freedom {
            Freedom::Turns(axis) => {
                let about = moment_kg_m - mass_kg * pose.origin_m;
                Some((pose.rotation * axis.normalize()).cross(&about).norm())
            }
            Freedom::Slides(_) => Some(mass_kg),
            Freedom::Fixed | Freedom::Other(_) => None,
        });
    let slides = matches!(of.freedom, Freedom::Slides(_));
    Branch { joint: of.name.clone(), upstream, displaced, slides, carries_base: false }
}

/// The joints between the root and the base of a selection of so many joints.
fn carriers(tree: &Tree, base: usize, joints: usize) -> Vec<Branch> {
    let below =
        std::iter::successors(tree.links[base].parent, |joint| tree.links[tree.joints[*joint].parent].parent);
    below
        .map(|joint| &tree.joints[joint])
        .filter(|joint| matches!(joint.freedom, Freedom::Turns(_) | Freedom::Slides(_)))
        .map(|joint| Branch {
            joint: joint.name.clone(),
            upstream: (0..joints).collect(),
            displaced: None,
            slides: matches!(joint.freedom, Freedom::Slides(_)),
            carries_base: true,
        })
        .collect()
}

/// A joint of the selection that moves on its own, with what the joints that follow it add.
struct OwnJoint {
    joint: usize,
    limits: JointLimits,
    friction: JointFriction,
    armature: f64,
}

impl OwnJoint {
    fn of(tree: &Tree, joint: usize) -> Self {
        let of = &tree.joints[joint];
        let [armature, damping] = of.driven;
        let viscous_nm_s_rad = of.friction.viscous_nm_s_rad + damping;
        let friction = JointFriction { viscous_nm_s_rad, ..of.friction };
        Self { joint, limits: of.limits, friction, armature: of.armature + armature }
    }

    /// With a joint k at m q + o, friction and rotor act on q as m² viscous, |m| Coulomb and m² inertia, by the work that
    /// they do; q stays where both joints are within their limits. The torque limit is that of the joint's own drive.
    fn moves_also(&mut self, follower: &TreeJoint, Followed { multiplier, offset, .. }: Followed) {
        self.friction.viscous_nm_s_rad += multiplier.powi(2) * follower.friction.viscous_nm_s_rad;
        self.friction.coulomb_nm += multiplier.abs() * follower.friction.coulomb_nm;
        self.armature += multiplier.powi(2) * follower.armature;
        if let Some(limits) = follower.limits.position_rad {
            let [a, b] = limits.map(|limit| (limit - offset) / multiplier);
            let [low, high] = self.limits.position_rad.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            self.limits.position_rad = Some([low.max(a.min(b)), high.min(a.max(b))]);
        }
        if let Some(limit) = follower.limits.velocity_rad_s {
            let limit = limit / multiplier.abs();
            self.limits.velocity_rad_s = Some(self.limits.velocity_rad_s.map_or(limit, |v| v.min(limit)));
        }
    }
}

fn at_rest(tree: &Tree, joint: usize) -> Pose {
    let at = tree.rest(joint);
    match tree.joints[joint].freedom {
        Freedom::Turns(axis) if at != 0.0 => {
            Pose::turned(nalgebra::Rotation3::new(axis.normalize() * at).into_inner())
        }
        Freedom::Slides(axis) => Pose { origin_m: axis.normalize() * at, ..Pose::identity() },
        _ => Pose::identity(),
    }
}

/// Adds the body of the tree's link `from`, at `pose` in the selection's link, and of all that hangs on it but for the joints
/// of the selection; what moves on it stays at zero posture and goes to `carried`.
fn add_bodies(
    tree: &Tree,
    from: usize,
    selection: &Selection,
    pose: &Pose,
    parts: &mut Vec<LinkPart>,
    carried: &mut Vec<usize>,
) {
    let mut open = vec![(from, *pose, true)];
    while let Some((link, pose, welded)) = open.pop() {
        let body = tree.links[link].body;
        let standard = body.map_or([0.0; INERTIAL_PARAMETERS], |b| b.standard_parameters(&pose));
        parts.push(LinkPart { link, pose, welded, standard });
        let is_beside = |joint: &usize| !selection.on_path[*joint];
        for joint_index in tree.links[link].children.iter().copied().filter(is_beside) {
            let joint = &tree.joints[joint_index];
            if joint.freedom != Freedom::Fixed {
                carried.push(joint_index);
            }
            let welded = welded && joint.freedom == Freedom::Fixed;
            open.push((joint.child, pose.then(&joint.pose).then(&at_rest(tree, joint_index)), welded));
        }
    }
}

fn notes(tree: &Tree, selection: &Selection, carried: &[usize], standard: &[f64]) -> Vec<String> {
    let mut notes = tree.notes.clone();
    let followers: Vec<String> = selection
        .joints
        .iter()
        .filter(|j| tree.joints[**j].mimic.is_some() && selection.moves[**j])
        .filter_map(|j| Some((j, tree.followed(*j)?)))
        .map(|(j, Followed { joint, multiplier, offset })| {
            let (name, of) = (&tree.joints[*j].name, &tree.joints[joint].name);
            format!("{name} = {multiplier} {of} + {offset}")
        })
        .collect();
    if !followers.is_empty() {
        notes.push(format!(
            "joints that follow another are moved by it and are none of their own; recordings have the others alone: {}",
            followers.join(", ")
        ));
    }
    let moves_with_chain =
        |j: &&usize| tree.followed(**j).is_some_and(|f| f.joint != **j && selection.moves[f.joint]);
    let (following, resting): (Vec<&usize>, Vec<&usize>) = carried.iter().partition(moves_with_chain);
    let listed = |joints: &[&usize]| {
        let names: Vec<&str> = joints.iter().map(|j| tree.joints[**j].name.as_str()).collect();
        names.join(", ")
    };
    if !resting.is_empty() {
        notes.push(format!(
            "joints beside the chain are carried as fixed at zero (a joint that follows another, at its offset): {}",
            listed(&resting)
        ));
    }
    if !following.is_empty() {
        notes.push(format!(
            "joints beside the chain that follow one of the chain move in truth, and are carried as fixed at their offset: {}",
            listed(&following)
        ));
    }
    if tree.links[selection.base].parent.is_some() {
        let name = &tree.links[selection.base].name;
        notes.push(format!("the base `{name}` is taken to be at rest; gravity is given in its frame"));
    }
    if standard.iter().any(|v| *v != 0.0) {
        notes.extend(inconsistencies(standard).iter().map(ToString::to_string));
    }
    notes
}
