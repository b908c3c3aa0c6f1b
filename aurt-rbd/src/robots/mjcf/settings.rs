//! `<compiler>`: how the file is to be read; the six ways in which MJCF writes an orientation.

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use roxmltree::Node;

use crate::robots::RobotError;
use crate::robots::element::{Element, Source};
use crate::robots::pose::Pose;

/// What makes a file readable that is not so as it stands. Without `saveinertial` MuJoCo does not write masses of shapes.
pub(super) const WRITE_OUT: &str = "let MuJoCo write the file out: put `saveinertial=\"true\"` into its <compiler> \
    and run mujoco.mj_saveLastXML(\"robot.xml\", mujoco.MjModel.from_xml_path(FILE))";

/// Where bodies have their masses from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FromShapes {
    /// From `<inertial>` alone.
    Never,
    /// From shapes where there is no `<inertial>`.
    WithoutInertial,
    /// From shapes, whether there is an `<inertial>` or not.
    Always,
}

/// What `<compiler>` says that matters to bodies and joints.
#[derive(Debug, Clone, Copy)]
pub(super) struct Settings {
    pub angles: Angles,
    pub autolimits: bool,
    pub from_shapes: FromShapes,
    /// The groups of shapes that have mass, first and last.
    pub mass_groups: [f64; 2],
}

impl Settings {
    /// The settings of a file; later `<compiler>` elements overrule earlier ones.
    pub fn read(root: Node<'_, '_>, source: &Source<'_>) -> Result<Self, RobotError> {
        let mut settings = Self {
            angles: Angles::DEFAULT,
            autolimits: true,
            from_shapes: FromShapes::WithoutInertial,
            mass_groups: [0.0, 5.0],
        };
        for node in root.children().filter(|c| c.has_tag_name("compiler")) {
            settings.take(&Element { node, what: "<compiler>".into(), source })?;
        }
        Ok(settings)
    }

    fn take(&mut self, compiler: &Element<'_, '_>) -> Result<(), RobotError> {
        let text = |name: &str| compiler.node.attribute(name);
        let unknown = |name: &str, value: &str, known: &str| {
            Err(compiler.error(format!("`{name}` is `{value}`; known are {known}")))
        };
        match text("angle") {
            None => {}
            Some("degree") => self.angles.unit_rad = Angles::DEFAULT.unit_rad,
            Some("radian") => self.angles.unit_rad = 1.0,
            Some(other) => return unknown("angle", other, "degree and radian"),
        }
        if let Some(order) = text("eulerseq") {
            match Angles::order(order) {
                Some(axes) => self.angles.euler = axes,
                None => return unknown("eulerseq", order, "three of x, y, z, X, Y, Z, such as xyz"),
            }
        }
        match text("autolimits") {
            None => {}
            Some(value) => self.autolimits = value != "false",
        }
        match text("inertiafromgeom") {
            None => {}
            Some("auto") => self.from_shapes = FromShapes::WithoutInertial,
            Some("false") => self.from_shapes = FromShapes::Never,
            Some("true") => self.from_shapes = FromShapes::Always,
            Some(other) => return unknown("inertiafromgeom", other, "auto, false and true"),
        }
        if let Some(groups) = compiler.numbers("inertiagrouprange")? {
            self.mass_groups = groups;
        }
        for name in ["boundmass", "boundinertia", "settotalmass"] {
            if compiler.number(name)?.is_some_and(|v| v > 0.0) {
                return Err(compiler.error(format!(
                    "`{name}` changes the inertias that the file states; remove it, or {WRITE_OUT}; then remove `{name}` from that"
                )));
            }
        }
        match (text("coordinate"), text("balanceinertia")) {
            (Some("global"), _) => Err(compiler
                .error("coordinate=\"global\" is of MuJoCo 2.3 and older; convert the file with that")),
            (_, Some("true")) => Err(compiler
                .error("`balanceinertia` changes inertias that no body has; correct these and remove it")),
            _ => Ok(()),
        }
    }
}

/// The attributes of an element, its class's among them.
type Of<'f, 'x> = dyn Fn(&str) -> Option<&'x str> + 'f;

#[derive(Debug, Clone, Copy)]
pub(super) struct Angles {
    /// An angle's unit in rad.
    pub unit_rad: f64,
    /// The axes of `euler` in their order, from 0, and whether each is fixed (else it turns with the frame).
    pub euler: [(usize, bool); 3],
}

impl Angles {
    /// MuJoCo's defaults: degrees, x y z that turn with the frame.
    pub const DEFAULT: Self =
        Self { unit_rad: std::f64::consts::PI / 180.0, euler: [(0, false), (1, false), (2, false)] };

    /// The order of `eulerseq`, such as `xyz` (turning axes) or `XYZ` (fixed axes).
    pub fn order(text: &str) -> Option<[(usize, bool); 3]> {
        let axes: Option<Vec<(usize, bool)>> = text
            .chars()
            .map(|c| {
                Some((['x', 'y', 'z'].iter().position(|a| *a == c.to_ascii_lowercase())?, c.is_uppercase()))
            })
            .collect();
        axes?.try_into().ok()
    }

    /// The `pos` and the orientation of an element.
    pub fn pose(&self, element: &Element<'_, '_>) -> Result<Pose, RobotError> {
        self.pose_by(element, &|name| element.node.attribute(name))
    }

    /// The same of an element whose attributes are those of `of`.
    pub fn pose_by<'x>(&self, element: &Element<'_, 'x>, of: &Of<'_, 'x>) -> Result<Pose, RobotError> {
        let position: [f64; 3] =
            of("pos").map(|text| element.parsed("pos", text)).transpose()?.unwrap_or_default();
        Ok(Pose { rotation: self.rotation(element, of)?, origin_m: position.into() })
    }

    fn rotation<'x>(&self, element: &Element<'_, 'x>, of: &Of<'_, 'x>) -> Result<Matrix3<f64>, RobotError> {
        const WAYS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];
        let given: Vec<(&str, &str)> = WAYS.into_iter().filter_map(|way| Some((way, of(way)?))).collect();
        let (way, text) = match given[..] {
            [] => return Ok(Matrix3::identity()),
            [given] => given,
            [(first, _), (second, _), ..] => {
                return Err(
                    element.error(format!("`{first}` and `{second}` are two orientations; remove one"))
                );
            }
        };
        let direction = |v: Vector3<f64>| {
            if v.norm() < 1e-10 {
                Err(element.error(format!("`{way}` has no direction")))
            } else {
                Ok(v.normalize())
            }
        };
        Ok(match way {
            "quat" => {
                let [w, x, y, z] = element.parsed(way, text)?;
                let quaternion = Quaternion::new(w, x, y, z);
                if quaternion.norm() < 1e-10 {
                    return Err(element.error("`quat` is zero; it is w x y z of a rotation"));
                }
                UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix().into_inner()
            }
            "axisangle" => {
                let [x, y, z, angle] = element.parsed(way, text)?;
                let axis = direction(Vector3::new(x, y, z))?;
                Rotation3::new(axis * angle * self.unit_rad).into_inner()
            }
            "euler" => {
                let mut rotation = Rotation3::identity();
                for ((axis, fixed), angle) in self.euler.into_iter().zip(element.parsed::<3>(way, text)?) {
                    let mut vector = Vector3::zeros();
                    vector[axis] = angle * self.unit_rad;
                    let turn = Rotation3::new(vector);
                    rotation = if fixed { turn * rotation } else { rotation * turn };
                }
                rotation.into_inner()
            }
            "xyaxes" => {
                let [a, b, c, d, e, f] = element.parsed(way, text)?;
                let x = direction(Vector3::new(a, b, c))?;
                let y = Vector3::new(d, e, f);
                let y = direction(y - x * x.dot(&y))?;
                Matrix3::from_columns(&[x, y, x.cross(&y)])
            }
            _ => z_onto(&direction(element.parsed::<3>(way, text)?.into())?),
        })
    }
}

/// The smallest rotation that takes the z axis to a direction; to the opposite direction half a turn about x.
pub(super) fn z_onto(direction: &Vector3<f64>) -> Matrix3<f64> {
    let turn = Rotation3::rotation_between(&Vector3::z(), direction);
    turn.unwrap_or_else(|| Rotation3::new(Vector3::x() * std::f64::consts::PI)).into_inner()
}
