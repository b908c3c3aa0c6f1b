//! MJCF files: the bodies and joints of MuJoCo, as <https://mujoco.readthedocs.io/en/stable/XMLreference.html> describes them.

mod actuators;
mod classes;
mod equality;
mod joint;
mod settings;
mod shapes;

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use crate::robots::element::{Element, Source};
use crate::robots::pose::{Body, Pose};
use crate::robots::tree::{BodyPlace, Freedom, Spring, Tree, TreeJoint, TreeLink};
use crate::robots::{JointFriction, JointLimits, RobotError, RobotErrors};
pub use actuators::{PositionActuator, position_actuators};
use classes::Classes;
use joint::{ReadJoint, Reading};
use settings::{FromShapes, Settings, WRITE_OUT};

pub(crate) const ROOT: &str = "mujoco";
/// The link that everything hangs on.
const WORLD: &str = "world";
/// Elements that make bodies, joints or masses which are not read.
const GENERATING: [&str; 5] = ["attach", "composite", "flexcomp", "include", "replicate"];

pub(crate) fn read(root: Node<'_, '_>, path: &Path) -> Result<Tree, RobotErrors> {
    let name = root.attribute("model").unwrap_or_default().to_owned();
    let world = TreeLink { name: WORLD.into(), body: None, parent: None, children: Vec::new(), place: None };
    let tree = Tree {
        path: path.into(),
        name,
        links: vec![world],
        joints: Vec::new(),
        notes: Vec::new(),
        ties: Vec::new(),
        followed: OnceCell::new(),
    };
    let source = Source::of(root, path);
    let mut errors = Vec::new();
    for node in root.descendants().filter(|n| GENERATING.contains(&n.tag_name().name())) {
        let element = Element { node, what: format!("<{}>", node.tag_name().name()), source: &source };
        errors.push(
            element.error(format!("generates or opens other elements, which is not done here; {WRITE_OUT}")),
        );
    }
    if !errors.is_empty() {
        return Err(RobotErrors(errors));
    }
    let settings = Settings::read(root, &source)?;
    let classes = Classes::read(root);
    let mut reader = Reader {
        source: &source,
        taken: HashSet::from([WORLD.to_owned()]),
        settings,
        classes: &classes,
        tree,
        errors,
        unstated: Vec::new(),
        weighed: Vec::new(),
        unweighed: Vec::new(),
        springs: Vec::new(),
        damped: Vec::new(),
        lifted: Vec::new(),
        references: HashMap::new(),
    };
    reader.bodies(root);
    reader.refuse_shapes();
    if let Err(error) = equality::read(root, &source, &reader.references, &mut reader.tree) {
        reader.errors.push(error);
    }
    let driven = actuators::drive(root, (&source, &classes), &mut reader.tree.joints);
    reader.errors.extend(driven.err());
    for joint in &mut reader.tree.joints {
        if actuators::is_disabled(root, "damper") {
            (joint.friction.viscous_nm_s_rad, joint.driven[1]) = (0.0, 0.0);
        }
        if actuators::is_disabled(root, "frictionloss") {
            joint.friction.coulomb_nm = 0.0;
        }
    }
    reader.note(root);
    let Reader { tree, errors, .. } = reader;
    if tree.joints.is_empty() && errors.is_empty() {
        let reason = "there is no <body> in <worldbody>".into();
        return Err(RobotError::NoTree { path: path.into(), reason }.into());
    }
    if errors.is_empty() { Ok(tree) } else { Err(RobotErrors(errors)) }
}

/// An element of a body, out of the `<frame>`s around it.
struct Own<'x> {
    node: Node<'x, 'x>,
    /// The frame that it is given in, in the body's.
    frame: Pose,
    /// The class of elements here that name none.
    class: Option<&'x str>,
}

struct Reader<'a, 'x> {
    source: &'a Source<'a>,
    taken: HashSet<String>,
    settings: Settings,
    classes: &'a Classes<'x>,
    tree: Tree,
    errors: Vec<RobotError>,
    /// Bodies that have neither an `<inertial>` nor, by `<compiler>`, the mass of their shapes.
    unstated: Vec<String>,
    /// Links that have the mass of their shapes.
    weighed: Vec<usize>,
    /// Links that would, and what is wrong with a shape.
    unweighed: Vec<(usize, RobotError)>,
    springs: Vec<String>,
    /// Joints with `springdamper`.
    damped: Vec<String>,
    /// Bodies that MuJoCo holds against gravity.
    lifted: Vec<String>,
    /// The coordinates at which joints are where the file has them, of those that say so.
    references: HashMap<String, f64>,
}

impl<'a, 'x> Reader<'a, 'x> {
    fn bodies(&mut self, root: Node<'x, 'x>) {
        // Bodies that are still to be read: the link that each hangs on, and the frame there that it is given in.
        let mut open: Vec<(Own<'x>, usize)> = Vec::new();
        let worlds: Vec<_> = root.children().filter(|c| c.has_tag_name("worldbody")).collect();
        for world in worlds.into_iter().rev() {
            let class = world.attribute("childclass");
            self.hang_on(Own { node: world, frame: Pose::identity(), class }, 0, &mut open);
        }
        while let Some((own, parent)) = open.pop() {
            match self.body(&own, parent) {
                Ok((link, frame)) => {
                    let class = own.node.attribute("childclass").or(own.class);
                    self.hang_on(Own { node: own.node, frame, class }, link, &mut open);
                }
                Err(error) => self.errors.push(error),
            }
        }
    }

    /// Lets the bodies within `of`, whose frame in `link` it has, be read next, in the order of the file.
    fn hang_on(&self, of: Own<'x>, link: usize, open: &mut Vec<(Own<'x>, usize)>) {
        let own = self.own(of);
        open.extend(own.into_iter().rev().filter(|o| o.node.has_tag_name("body")).map(|o| (o, link)));
    }

    /// The elements of a body, those within its `<frame>`s among them, in the order of the file.
    fn own(&self, of: Own<'x>) -> Vec<Own<'x>> {
        let children = |of: &Own<'x>| -> Vec<Own<'x>> {
            let elements = of.node.children().filter(Node::is_element);
            elements.map(|node| Own { node, frame: of.frame, class: of.class }).collect()
        };
        let mut found = Vec::new();
        let mut open = children(&of);
        open.reverse();
        while let Some(mut own) = open.pop() {
            if !own.node.has_tag_name("frame") {
                found.push(own);
                continue;
            }
            // A frame that cannot be read is complained about by its body.
            if let Ok(pose) = self.settings.angles.pose(&self.element(own.node, "<frame>".into())) {
                own.frame = own.frame.then(&pose);
                own.class = own.node.attribute("childclass").or(own.class);
                let mut inner = children(&own);
                inner.reverse();
                open.extend(inner);
            }
        }
        found
    }

    fn element(&self, node: Node<'x, 'x>, what: String) -> Element<'a, 'x> {
        Element { node, what, source: self.source }
    }

    /// Reads a body with its joints; its link, and its frame in that.
    fn body(&mut self, own: &Own<'x>, parent: usize) -> Result<(usize, Pose), RobotError> {
        let node = own.node;
        let name = self.name(node, "body", self.tree.links.len());
        let element = self.element(node, format!("body {name}"));
        if let Some(class) = self.classes.unknown(node) {
            return Err(element.error(format!("there is no class `{class}` under <default>")));
        }
        if self.taken.contains(&name) {
            return Err(element.error(format!("the name `{name}` is taken; rename one of the two")));
        }
        for frame in node.children().filter(|c| c.has_tag_name("frame")) {
            self.settings.angles.pose(&self.element(frame, format!("body {name}, <frame>")))?;
        }
        let mut before = own.frame.then(&self.settings.angles.pose(&element)?);
        let class = node.attribute("childclass").or(own.class);
        let inside = self.own(Own { node, frame: Pose::identity(), class });
        let is_joint = |o: &&Own<'x>| o.node.has_tag_name("joint") || o.node.has_tag_name("freejoint");
        let joints: Vec<&Own<'x>> = inside.iter().filter(is_joint).collect();
        let mut link = parent;
        for (place, own) in joints.iter().enumerate() {
            let last = place + 1 == joints.len();
            let joint_name = self.name(own.node, "joint", self.tree.joints.len());
            let joint_element = self.element(own.node, format!("body {name}, joint {joint_name}"));
            let reading = Reading {
                classes: self.classes,
                unit_rad: self.settings.angles.unit_rad,
                autolimits: self.settings.autolimits,
            };
            if let Some(class) = self.classes.unknown(own.node) {
                return Err(joint_element.error(format!("there is no class `{class}` under <default>")));
            }
            let ReadJoint { pose, body, freedom, limits, friction, armature, spring, reference } =
                reading.joint(&joint_element, own.class, &own.frame)?;
            if reference != 0.0 {
                self.references.insert(joint_name.clone(), reference);
            }
            let damper = self.classes.attribute(own.node, own.class, "springdamper");
            if damper.is_some_and(|d| d.split_whitespace().all(|n| n.parse().is_ok_and(|n: f64| n > 0.0))) {
                self.damped.push(joint_name.clone());
            }
            if spring.stiffness != 0.0 {
                self.springs.push(joint_name.clone());
            }
            // Between several joints of one body there are links without mass.
            let child = if last { name.clone() } else { format!("{name}, behind {joint_name}") };
            let pose = before.then(&pose);
            let joint = (joint_name, own.node, pose, freedom);
            link = self.add(link, child, joint, (limits, friction, armature, spring));
            before = body;
        }
        if joints.is_empty() {
            let joint = (format!("weld of {name}"), node, before, Freedom::Fixed);
            let still = (JointLimits::default(), JointFriction::default(), 0.0, Spring::NONE);
            link = self.add(link, name.clone(), joint, still);
            before = Pose::identity();
        }
        if node.attribute("gravcomp").is_some_and(|g| g.trim().parse() != Ok(0.0)) {
            self.lifted.push(name.clone());
        }
        let inertial = inside.iter().find(|o| o.node.has_tag_name("inertial"));
        self.tree.links[link].place = Some(BodyPlace {
            body: node.range().start,
            inertial: inertial.map(|own| own.node.range().start),
            frame: inertial.map_or(before, |own| before.then(&own.frame)),
        });
        let stated = inertial.map(|own| {
            let element = self.element(own.node, format!("body {name}, <inertial>"));
            self.inertial(&element, &before.then(&own.frame))
        });
        let stated = stated.transpose()?;
        self.tree.links[link].body = match (stated, self.settings.from_shapes) {
            (Some(_), FromShapes::Never | FromShapes::WithoutInertial) => stated,
            (stated, from_shapes) => {
                let shapes = inside.iter().filter(|own| own.node.has_tag_name("geom"));
                let shapes = shapes.map(|own| {
                    let element = self.element(own.node, format!("body {name}, <geom>"));
                    let world = (self.classes, &self.settings);
                    shapes::mass(&element, own.class, &before.then(&own.frame), world)
                });
                match shapes.filter_map(Result::transpose).collect::<Result<Vec<Body>, _>>() {
                    Ok(none) if none.is_empty() => stated,
                    _ if from_shapes == FromShapes::Never => {
                        self.unstated.push(name);
                        None
                    }
                    Ok(shapes) => {
                        self.weighed.push(link);
                        Some(Body::of_parts(&shapes))
                    }
                    Err(error) => {
                        self.unweighed.push((link, error));
                        None
                    }
                }
            }
        };
        Ok((link, before))
    }

    fn add(
        &mut self,
        parent: usize,
        name: String,
        (joint_name, node, pose, freedom): (String, Node<'x, 'x>, Pose, Freedom),
        (limits, friction, armature, spring): (JointLimits, JointFriction, f64, Spring),
    ) -> usize {
        let (child, joint) = (self.tree.links.len(), self.tree.joints.len());
        self.taken.insert(name.clone());
        self.tree.links.push(TreeLink {
            name,
            body: None,
            parent: Some(joint),
            children: Vec::new(),
            place: None,
        });
        self.tree.links[parent].children.push(joint);
        self.tree.joints.push(TreeJoint {
            name: joint_name,
            line: self.source.line(node),
            start: node.range().start,
            parent,
            child,
            pose,
            freedom,
            mimic: None,
            limits,
            friction,
            armature,
            spring,
            driven: [0.0; 2],
        });
        child
    }

    fn inertial(&self, element: &Element<'_, 'x>, frame: &Pose) -> Result<Body, RobotError> {
        let mass_kg = element.required("mass")?;
        let pose = frame.then(&self.settings.angles.pose(element)?);
        let inertia_kg_m2 = match (element.numbers("diaginertia")?, element.numbers("fullinertia")?) {
            (Some(diagonal), None) => Matrix3::from_diagonal(&Vector3::from(diagonal)),
            (None, Some([xx, yy, zz, xy, xz, yz])) => Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            (Some(_), Some(_)) => {
                return Err(element.error("`diaginertia` and `fullinertia` are two inertias; remove one"));
            }
            (None, None) => return Err(element.error("lacks `diaginertia` or `fullinertia`, in kg m^2")),
        };
        Ok(Body { mass_kg, pose, inertia_kg_m2 })
    }

    /// Refuses bodies that move and whose shapes cannot be weighed.
    fn refuse_shapes(&mut self) {
        let unweighed = std::mem::take(&mut self.unweighed);
        let moves = self.moving();
        let moving = unweighed.into_iter().filter(|(link, _)| moves[*link]);
        let errors: Vec<RobotError> = moving.map(|(_, error)| error).collect();
        self.errors.extend(errors);
    }

    /// Of each link, whether a joint that moves leads to it; a link comes after the one that it hangs on.
    fn moving(&self) -> Vec<bool> {
        let mut moves = vec![false; self.tree.links.len()];
        for joint in &self.tree.joints {
            moves[joint.child] = moves[joint.parent] || joint.freedom != Freedom::Fixed;
        }
        moves
    }

    fn note(&mut self, root: Node<'x, 'x>) {
        let of = |what: &str, names: &[String]| format!("{what}: {}", names.join(", "));
        if !self.unstated.is_empty() {
            self.tree.notes.push(of("no inertia is stated, and so none is assumed, for", &self.unstated));
        }
        let moves = self.moving();
        let weighed = self.weighed.iter().filter(|link| moves[**link]);
        let weighed: Vec<String> = weighed.map(|link| self.tree.links[*link].name.clone()).collect();
        if !weighed.is_empty() {
            let what = "mass and inertia are computed from shapes and their density, as MuJoCo does, of";
            self.tree.notes.push(of(what, &weighed));
        }
        if root.children().any(|c| c.has_tag_name("tendon") && c.children().any(|n| n.is_element())) {
            self.tree.notes.push("springs, damping and limits of <tendon> are not read".into());
        }
        if !self.damped.is_empty() {
            let what = "`springdamper` is not read; write out its stiffness and damping; it is in";
            self.tree.notes.push(of(what, &self.damped));
        }
        self.tree.notes.extend(actuators::notes(root));
        if !self.springs.is_empty() && !actuators::is_disabled(root, "spring") {
            self.tree
                .notes
                .push(of("springs are not read; an arm term `spring` is one; they are in", &self.springs));
        }
        if !self.lifted.is_empty() {
            self.tree.notes.push(of("`gravcomp` is not read; it is in", &self.lifted));
        }
    }

    fn name(&self, node: Node<'x, 'x>, kind: &str, number: usize) -> String {
        node.attribute("name").map_or_else(|| format!("{kind}_{number}"), str::to_owned)
    }
}
