//! URDF files: links and joints as <https://wiki.ros.org/urdf/XML> describes them.

use std::cell::OnceCell;
use std::collections::HashMap;
use std::path::Path;

use crate::Placement;
use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

use crate::robots::element::{Element, Source};
use crate::robots::pose::{Body, Pose};
use crate::robots::tree::{BodyPlace, Freedom, Mimic, Spring, Tree, TreeJoint, TreeLink};
use crate::robots::{JointFriction, JointLimits, RobotError, RobotErrors};

pub(crate) const ROOT: &str = "robot";

/// Reads links and joints, and hangs them together.
pub(crate) fn read(root: Node<'_, '_>, path: &Path) -> Result<Tree, RobotErrors> {
    let source = Source::of(root, path);
    let line = source.line(root);
    if root.tag_name().name() != ROOT {
        let found = root.tag_name().name();
        let reason = format!(
            "the outermost element is <{found}>; a URDF file describes the robot in an element <robot>, an MJCF file in <mujoco>"
        );
        return Err(RobotError::Xml { path: path.into(), line, reason }.into());
    }
    let is_macro = |node: &Node<'_, '_>| node.tag_name().namespace().is_some_and(|n| n.contains("xacro"));
    if let Some(node) = root.descendants().find(is_macro) {
        let (line, text) = (source.line(node), format!("<xacro:{}>", node.tag_name().name()));
        return Err(RobotError::Xacro { path: path.into(), line, text }.into());
    }
    let mut reader = Reader {
        source: &source,
        errors: Vec::new(),
        notes: Vec::new(),
        rounded: Vec::new(),
        without_inertia: Vec::new(),
    };
    let links = reader.links(root);
    let names: HashMap<&str, usize> = links.iter().enumerate().map(|(k, l)| (l.name.as_str(), k)).collect();
    let joints = reader.joints(root, &names);
    let name = root.attribute("name").unwrap_or_default().to_owned();
    let Reader { mut errors, mut notes, rounded, without_inertia, .. } = reader;
    if !rounded.is_empty() {
        notes.push(format!(
            "{}; axes that are meant to be parallel or perpendicular are slightly not so, which adds base parameters that \
             no recording can determine; write all digits of the angle{}",
            rounded.join(", "),
            if rounded.len() > 1 { "s" } else { "" }
        ));
    }
    if !without_inertia.is_empty() {
        notes.push(format!(
            "no inertia is stated, and so none is assumed, for: {}",
            without_inertia.join(", ")
        ));
    }
    let (ties, followed) = (Vec::new(), OnceCell::new());
    let mut tree = Tree { path: path.into(), name, links, joints, notes, ties, followed };
    if errors.is_empty() {
        errors.extend(hang(&mut tree));
    }
    if errors.is_empty() { Ok(tree) } else { Err(RobotErrors(errors)) }
}

struct Reader<'a> {
    source: &'a Source<'a>,
    errors: Vec<RobotError>,
    notes: Vec<String>,
    /// Angles that look rounded, with how far they are off.
    rounded: Vec<String>,
    /// Links that have visible or touchable parts but no inertia.
    without_inertia: Vec<String>,
}

impl<'a> Reader<'a> {
    /// The children of a tag, named as messages call them.
    fn elements<'x>(&mut self, root: Node<'x, 'x>, tag: &'static str) -> Vec<(String, Element<'a, 'x>)> {
        let mut known: HashMap<&str, u32> = HashMap::new();
        let mut elements = Vec::new();
        for node in root.children().filter(|c| c.is_element() && c.tag_name().name() == tag) {
            let line = self.source.line(node);
            let mut element = Element { node, what: format!("<{tag}>"), source: self.source };
            match element.text("name") {
                Err(error) => self.errors.push(error),
                Ok(name) => {
                    element.what = format!("{tag} {name}");
                    if let Some(first) = known.insert(name, line) {
                        self.errors
                            .push(element.error(format!("the name is taken by line {first}; rename one")));
                    }
                    elements.push((name.to_owned(), element));
                }
            }
        }
        elements
    }

    fn links(&mut self, root: Node<'_, '_>) -> Vec<TreeLink> {
        let mut links = Vec::new();
        for (name, element) in self.elements(root, "link") {
            let body = element.child("inertial").map(|inertial| self.body(&inertial));
            let body = body.unwrap_or_else(|| {
                let solid = element.child("visual").is_some() || element.child("collision").is_some();
                if solid {
                    self.without_inertia.push(name.clone());
                }
                Ok(None)
            });
            let body = body.unwrap_or_else(|error| {
                self.errors.push(error);
                None
            });
            let inertial = element.child("inertial").map(|inertial| inertial.node.range().start);
            let place = BodyPlace { body: element.node.range().start, inertial, frame: Pose::identity() };
            links.push(TreeLink { name, body, parent: None, children: Vec::new(), place: Some(place) });
        }
        links
    }

    fn body(&mut self, inertial: &Element<'_, '_>) -> Result<Option<Body>, RobotError> {
        let pose = self.origin(inertial)?;
        let mass = inertial.child("mass").ok_or_else(|| inertial.error("lacks <mass value=\"…\"/> in kg"))?;
        let mass_kg = mass.required("value")?;
        let inertia = inertial
            .child("inertia")
            .ok_or_else(|| inertial.error("lacks <inertia ixx=\"…\" …/> in kg m^2"))?;
        let [xx, yy, zz] = [inertia.required("ixx")?, inertia.required("iyy")?, inertia.required("izz")?];
        let product = |name| Ok(inertia.number(name)?.unwrap_or(0.0));
        let [xy, xz, yz] = [product("ixy")?, product("ixz")?, product("iyz")?];
        let inertia_kg_m2 = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        Ok(Some(Body { mass_kg, pose, inertia_kg_m2 }))
    }

    /// The `<origin>` of an element; the identity without one.
    fn origin(&mut self, element: &Element<'_, '_>) -> Result<Pose, RobotError> {
        let Some(origin) = element.child("origin") else { return Ok(Pose::identity()) };
        let translation = origin.numbers("xyz")?.unwrap_or_default();
        let angles = origin.numbers("rpy")?.unwrap_or_default();
        Ok(Pose::of(Placement::from_roll_pitch_yaw(translation, angles)))
    }

    fn joints(&mut self, root: Node<'_, '_>, links: &HashMap<&str, usize>) -> Vec<TreeJoint> {
        let mut joints = Vec::new();
        for (name, element) in self.elements(root, "joint") {
            match self.joint(name, &element, links) {
                Ok(joint) => {
                    if joint.moves() {
                        self.note_rounding(&element);
                    }
                    joints.push(joint);
                }
                Err(error) => self.errors.push(error),
            }
        }
        joints
    }

    fn joint(
        &mut self,
        name: String,
        element: &Element<'_, '_>,
        links: &HashMap<&str, usize>,
    ) -> Result<TreeJoint, RobotError> {
        let link = |tag: &str| -> Result<usize, RobotError> {
            let end =
                element.child(tag).ok_or_else(|| element.error(format!("lacks <{tag} link=\"…\"/>")))?;
            let name = end.text("link")?;
            links.get(name).copied().ok_or_else(|| end.error(format!("there is no link `{name}`")))
        };
        let (parent, child) = (link("parent")?, link("child")?);
        let kind = element.text("type")?;
        let freedom = match kind {
            "fixed" => Freedom::Fixed,
            "revolute" | "continuous" => Freedom::Turns(axis(element)?),
            "prismatic" => Freedom::Slides(axis(element)?),
            "floating" | "planar" => Freedom::Other(kind.to_owned()),
            _ => {
                return Err(element.error(format!(
                    "the type `{kind}` is not known; known are revolute, continuous, prismatic, fixed, floating, planar"
                )));
            }
        };
        let mimic = match element.child("mimic") {
            None => None,
            Some(mimic) => Some(Mimic {
                joint: mimic.text("joint")?.to_owned(),
                multiplier: mimic.number("multiplier")?.unwrap_or(1.0),
                offset: mimic.number("offset")?.unwrap_or(0.0),
            }),
        };
        let mut limits = JointLimits::default();
        if let Some(limit) = element.child("limit") {
            let stated = [limit.number("lower")?, limit.number("upper")?];
            let is_stated = kind != "continuous" && stated.iter().any(Option::is_some);
            limits.position_rad = is_stated.then(|| stated.map(Option::unwrap_or_default));
            limits.velocity_rad_s = limit.number("velocity")?.filter(|v| *v > 0.0);
            limits.torque_nm = limit.number("effort")?.filter(|v| *v > 0.0);
        }
        let mut friction = JointFriction::default();
        if let Some(dynamics) = element.child("dynamics") {
            friction.viscous_nm_s_rad = dynamics.number("damping")?.unwrap_or(0.0);
            friction.coulomb_nm = dynamics.number("friction")?.unwrap_or(0.0);
        }
        let pose = self.origin(element)?;
        Ok(TreeJoint {
            name,
            line: element.line(),
            start: element.node.range().start,
            parent,
            child,
            pose,
            freedom,
            mimic,
            limits,
            friction,
            armature: 0.0,
            driven: [0.0; 2],
            spring: Spring::NONE,
        })
    }

    /// Notes angles that look like rounded multiples of π/4, as tables of modified Denavit–Hartenberg parameters do.
    fn note_rounding(&mut self, element: &Element<'_, '_>) {
        const STEP: f64 = std::f64::consts::FRAC_PI_4;
        let angles =
            element.child("origin").and_then(|o| o.numbers::<3>("rpy").ok().flatten()).unwrap_or_default();
        for (name, angle) in ["roll", "pitch", "yaw"].into_iter().zip(angles) {
            let quarters = (angle / STEP).round();
            let off = (angle - quarters * STEP).abs();
            if off > 1e-9 && off < 5e-4 {
                self.rounded
                    .push(format!("{}: {name} = {angle} is {off:.1e} rad off {quarters}*pi/4", element.what));
            }
        }
    }
}

/// The axis of a joint that moves: x without `<axis>`, as URDF has it.
fn axis(joint: &Element<'_, '_>) -> Result<Vector3<f64>, RobotError> {
    let Some(axis) = joint.child("axis") else { return Ok(Vector3::x()) };
    let direction = Vector3::from(axis.numbers("xyz")?.unwrap_or([1.0, 0.0, 0.0]));
    if direction.norm() < 1e-6 {
        let reason = format!("the axis has no direction, is {:?}", direction.as_slice());
        return Err(
            axis.error(format!("{reason}; give the direction in the joint's frame, such as xyz=\"0 0 1\""))
        );
    }
    Ok(direction)
}

/// Tells every link which joints it hangs on and carries; the complaints where that gives no tree.
fn hang(tree: &mut Tree) -> Vec<RobotError> {
    let mut errors = Vec::new();
    for (k, joint) in tree.joints.iter().enumerate() {
        if let Some(other) = tree.links[joint.child].parent {
            errors.push(RobotError::Element {
                path: tree.path.clone(),
                line: joint.line,
                what: format!("joint {}", joint.name),
                reason: format!(
                    "its child `{}` hangs on the joint {} as well; closed loops cannot be read, remove one of the two",
                    tree.links[joint.child].name, tree.joints[other].name
                ),
            });
            continue;
        }
        tree.links[joint.child].parent = Some(k);
        tree.links[joint.parent].children.push(k);
    }
    if !errors.is_empty() {
        return errors;
    }
    // With one parent a link, what is not reached from a root hangs in a loop.
    let mut reached = vec![false; tree.links.len()];
    let mut next: Vec<usize> = (0..tree.links.len()).filter(|l| tree.links[*l].parent.is_none()).collect();
    while let Some(link) = next.pop() {
        reached[link] = true;
        next.extend(tree.links[link].children.iter().map(|joint| tree.joints[*joint].child));
    }
    let looped: Vec<&str> =
        tree.links.iter().zip(&reached).filter(|(_, r)| !**r).map(|(l, _)| l.name.as_str()).collect();
    if !looped.is_empty() {
        let reason = format!("the joints of these links form a loop without a base: {}", looped.join(", "));
        errors.push(RobotError::NoTree { path: tree.path.clone(), reason });
    }
    if tree.links.is_empty() {
        errors.push(RobotError::NoTree { path: tree.path.clone(), reason: "there are no links".into() });
    }
    errors
}
