//! Joints of MJCF files, with the defaults of their class.

use nalgebra::{Rotation3, Vector3};
use roxmltree::Node;

use super::classes::Classes;
use crate::robots::element::Element;
use crate::robots::pose::Pose;
use crate::robots::tree::{Freedom, Spring};
use crate::robots::{JointFriction, JointLimits, RobotError};

pub(super) struct ReadJoint {
    /// The joint's frame in the frame of the body before it moves, at coordinate zero.
    pub pose: Pose,
    /// The frame of the body in the joint's frame once that has moved.
    pub body: Pose,
    pub freedom: Freedom,
    pub limits: JointLimits,
    pub friction: JointFriction,
    pub armature: f64,
    pub spring: Spring,
    /// The coordinate at which the body is where the file has it.
    pub reference: f64,
}

pub(super) struct Reading<'c, 'x> {
    pub classes: &'c Classes<'x>,
    /// An angle's unit in rad.
    pub unit_rad: f64,
    /// Whether a range limits a joint that does not say whether it is limited.
    pub autolimits: bool,
}

impl<'x> Reading<'_, 'x> {
    /// Reads `<joint>` or `<freejoint>`; `frame` is that of the frames around it in its body.
    pub fn joint(
        &self,
        element: &Element<'_, 'x>,
        class: Option<&str>,
        frame: &Pose,
    ) -> Result<ReadJoint, RobotError> {
        let node = element.node;
        let of = |name: &str| self.attribute(node, class, name);
        let vector = |name: &'static str, default: [f64; 3]| -> Result<Vector3<f64>, RobotError> {
            let found = of(name).map(|text| element.parsed(name, text)).transpose()?;
            Ok(found.unwrap_or(default).into())
        };
        let number = |name: &'static str| -> Result<f64, RobotError> {
            let Some(text) = of(name) else { return Ok(0.0) };
            let [value] = element.parsed(name, text).map_err(|error| match name {
                "damping" | "stiffness" if text.split_whitespace().count() > 1 => element.error(format!(
                    "`{name}` is a polynomial, `{text}`, and its first number alone is read: remove the others, and \
                     calibrate what they are"
                )),
                _ => error,
            })?;
            Ok(value)
        };
        let kind = if node.has_tag_name("freejoint") { "free" } else { of("type").unwrap_or("hinge") };
        let axis = frame.rotation * vector("axis", [0.0, 0.0, 1.0])?;
        if axis.norm() < 1e-10 {
            return Err(element
                .error("the axis has no direction; give it in the body's frame, such as axis=\"0 0 1\""));
        }
        let axis = axis.normalize();
        let anchor = frame.origin_m + frame.rotation * vector("pos", [0.0; 3])?;
        let (shift, unit, freedom) = match kind {
            "hinge" => (anchor, self.unit_rad, Freedom::Turns(axis)),
            // Where a joint slides, it does not matter where its axis is.
            "slide" => (Vector3::zeros(), 1.0, Freedom::Slides(axis)),
            "free" | "ball" => (Vector3::zeros(), 1.0, Freedom::Other(format!("a {kind} joint"))),
            _ => {
                return Err(element
                    .error(format!("the type `{kind}` is not known; known are hinge, slide, ball, free")));
            }
        };
        // At the coordinate `ref` the body is where the file has it.
        let reference = number("ref")? * unit;
        let back = -reference;
        let at_zero = match freedom {
            Freedom::Turns(_) => Pose::turned(Rotation3::new(axis * back).into_inner()),
            _ => Pose { origin_m: axis * back, ..Pose::identity() },
        };
        let moved = |origin_m| Pose { origin_m, ..Pose::identity() };
        let limits = self.limits(element, of, unit)?;
        let friction =
            JointFriction { viscous_nm_s_rad: number("damping")?, coulomb_nm: number("frictionloss")? };
        Ok(ReadJoint {
            pose: moved(shift).then(&at_zero),
            body: moved(-shift),
            freedom,
            limits,
            friction,
            armature: number("armature")?,
            spring: Spring { stiffness: number("stiffness")?, reference: number("springref")?, unit },
            reference,
        })
    }

    fn limits<'t>(
        &self,
        element: &Element<'_, '_>,
        of: impl Fn(&str) -> Option<&'t str>,
        unit: f64,
    ) -> Result<JointLimits, RobotError> {
        let pair = |name: &'static str, flag: &str| -> Result<Option<[f64; 2]>, RobotError> {
            let limited = match of(flag) {
                Some("true") => true,
                Some("false") => false,
                _ => self.autolimits,
            };
            of(name).filter(|_| limited).map(|text| element.parsed(name, text)).transpose()
        };
        let torque = pair("actuatorfrcrange", "actuatorfrclimited")?;
        Ok(JointLimits {
            position_rad: pair("range", "limited")?.map(|range| range.map(|v| v * unit)),
            velocity_rad_s: None,
            torque_nm: torque.map(|[low, high]| high.min(-low)).filter(|torque| *torque > 0.0),
        })
    }

    fn attribute(&self, node: Node<'x, 'x>, class: Option<&str>, name: &str) -> Option<&'x str> {
        self.classes.attribute(node, class, name)
    }
}
