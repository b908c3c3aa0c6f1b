//! `<compiler>`: how the file is to be read.

use roxmltree::Node;

use super::orientation::Angles;
use crate::robots::RobotError;
use crate::robots::element::{Element, Source};

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
