//! `payload`: a body on a link, carried by all joints before it.
//!
//! # Equation
//! τ_j = Σ_p Y_j,p(q, q̇, q̈) π_p over the inertial parameters p of the link: a body fixed to a link adds its own
//! parameters, in the link's frame, to the link's.
//!
//! # Parameters
//! | key | unit | meaning |
//! |---|---|---|
//! | `link` | – | link that carries the body, of all links, those of joints that follow others too; of a chain the last unless given |
//! | `parameters` | – | which of `XX XY XZ YY YZ ZZ mX mY mZ m` are columns; all ten unless given |
//!
//! # Columns
//! | name | unit | column |
//! |---|---|---|
//! | `XX_<link>` … `ZZ_<link>` | kg m² | inertia about the origin of the link's frame |
//! | `mX_<link>`, `mY_<link>`, `mZ_<link>` | kg m | first moments; divided by `m`, the centre of mass |
//! | `m_<link>` | kg | mass |
//!
//! # Use when
//! A load was put on the flange after the calibration, with the calibrated coefficients held fixed. If the bodies
//! of the robot are fitted in the same go, their last link takes the payload up exactly. In amperes a mass scales
//! with the drives' gains. Light loads excite `m`, `mX`, `mY`, `mZ` alone: list these.
//!
//! # Source
//! Khalil, Gautier, Lemoine (2007), *Identification of the payload inertial parameters of industrial
//! manipulators*.

use aurt_traits::{
    ArmSeries, ArmTerm, Columns, ModelError, Parameter, RegressorTile, Result, register_model,
};
use serde::{Deserialize, Serialize};

use crate::shape::verdict;

/// Entries below this share of what they are sums of are rounding: a body that does not turn (on a link whose direction a
/// parallelogram keeps) or turns about the vertical leaves 1e-15, and a column of that would have a size of its own after scaling.
const ROUNDING: f64 = 1e-12;

/// A standard inertial parameter of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "the variants are the symbols that the module's table explains")]
pub enum Inertial {
    XX,
    XY,
    XZ,
    YY,
    YZ,
    ZZ,
    #[serde(rename = "mX")]
    MX,
    #[serde(rename = "mY")]
    MY,
    #[serde(rename = "mZ")]
    MZ,
    #[serde(rename = "m")]
    M,
}

impl Inertial {
    /// All ten, in the order of a rigid body's standard parameters.
    pub const ALL: [Self; 10] =
        [Self::XX, Self::XY, Self::XZ, Self::YY, Self::YZ, Self::ZZ, Self::MX, Self::MY, Self::MZ, Self::M];

    const fn symbol(self) -> &'static str {
        ["XX", "XY", "XZ", "YY", "YZ", "ZZ", "mX", "mY", "mZ", "m"][self as usize]
    }

    const fn unit(self) -> &'static str {
        match self {
            Self::M => "kg",
            Self::MX | Self::MY | Self::MZ => "kg m",
            _ => "kg m^2",
        }
    }
}

/// A body on a link.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// Link that carries the body, counted from 0; of a chain the last unless given. Trees have no last link.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link: Option<usize>,
    /// Inertial parameters that are columns; all ten unless given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameters: Option<Vec<Inertial>>,
}

impl Payload {
    fn link(&self, robot_joints: usize) -> usize {
        self.link.unwrap_or_else(|| robot_joints.saturating_sub(1))
    }

    fn parameters(&self) -> &[Inertial] {
        self.parameters.as_deref().unwrap_or(&Inertial::ALL)
    }
}

register_model! {
    slot: ArmTerm,
    name: "payload",
    summary: "a body on a link, carried by all joints before it",
    equation: "τ_j = Σ_p Y_j,p π_p over the ten inertial parameters of the link",
    use_when: "a load was put on the arm after its calibration; hold the calibrated coefficients fixed",
    source: "Khalil, Gautier, Lemoine (2007)",
    example: r#"{ model = "payload", parameters = ["mX", "mY", "mZ", "m"] }"#,
}

#[typetag::serde(name = "payload")]
impl ArmTerm for Payload {
    declares_term! { "payload", invariants: [EvenInLoad, ContinuousInVelocity, Memoryless] }

    fn joints(&self, robot_joints: usize) -> Vec<usize> {
        (0..robot_joints.min(self.link(robot_joints) + 1)).collect()
    }

    fn columns(&self, robot_joints: usize) -> Vec<Parameter> {
        let link = self.link(robot_joints);
        self.parameters().iter().map(|p| Parameter::new(format!("{}_{link}", p.symbol()), p.unit())).collect()
    }

    fn is_load(&self) -> bool {
        true
    }

    fn validate(&self, robot_joints: usize) -> Result<(), Vec<ModelError>> {
        self.validate_on(robot_joints, robot_joints)
    }

    fn validate_on(&self, _robot_joints: usize, links: usize) -> Result<(), Vec<ModelError>> {
        let mut complaints = Vec::new();
        let mut complain = |parameter: &str, reason: String| {
            complaints.push(ModelError::parameter("payload", parameter, reason));
        };
        if let Some(link) = self.link.filter(|link| *link >= links) {
            let last = links.saturating_sub(1);
            complain("link", format!("must lie between 0 and {last} (links count from 0), is {link}"));
        }
        let parameters = self.parameters();
        if parameters.is_empty() {
            complain("parameters", "must not be empty; leave the key out for all ten".into());
        }
        for (k, p) in parameters.iter().enumerate() {
            if parameters[..k].contains(p) {
                complain("parameters", format!("must be distinct, contain {} twice", p.symbol()));
            }
        }
        verdict(complaints)
    }

    /// One variable, the number of the rigid body's standard parameters, which is asked for once per series.
    fn state_len(&self, _robot_joints: usize) -> usize {
        1
    }

    fn initial_state(&self, first: &ArmSeries<'_>) -> Vec<f64> {
        vec![first.rigid_body.standard_parameters().len() as f64]
    }

    fn evaluate(&self, series: &ArmSeries<'_>, state: &mut [f64], out: &mut Columns<'_>) -> Result {
        let joints = series.motion.joints();
        let (standard, each) = (state[0] as usize, Inertial::ALL.len());
        let links = standard / each;
        // Where joints follow others there are more links than joints that move on their own: the last is still the last.
        let link = self.link.unwrap_or_else(|| links.saturating_sub(1));
        if standard != each * links || link >= links {
            return Err(ModelError::evaluation(
                "payload",
                format!(
                    "it needs a rigid body with {each} inertial parameters per link, {} in all, but this one has \
                     {standard}, and no link {link}",
                    each * joints
                ),
            ));
        }
        let loads = |joint: usize| (0..each).any(|k| series.rigid_body.loads(each * link + k, joint));
        if self.link.is_none()
            && let Some(joint) = (0..joints).find(|joint| !loads(*joint))
        {
            let reason = format!(
                "the robot is a tree, and its last link {link} does not load joint {joint}; say with `link` which one \
                 carries the body"
            );
            return Err(ModelError::evaluation("payload", reason));
        }
        if let Some(joint) = (link + 1..joints).find(|joint| loads(*joint)) {
            let reason = format!(
                "link {link} loads joint {joint}, which comes after it, by joints that follow others"
            );
            return Err(ModelError::evaluation("payload", reason));
        }
        let parameters = self.parameters();
        let mut destination = vec![RegressorTile::UNWANTED; joints * standard];
        for column in 0..out.columns() {
            out.column_mut(column).fill(0.0);
        }
        for joint in 0..joints.min(link + 1) {
            for (k, p) in parameters.iter().enumerate() {
                let index = Inertial::ALL.len() * link + *p as usize;
                if series.rigid_body.loads(index, joint) {
                    destination[joint * standard + index] = (joint * parameters.len() + k) as u32;
                }
            }
        }
        let (samples, (data, stride)) = (out.samples(), out.raw_mut());
        let mut tile = RegressorTile::new(&destination, standard, samples, stride, data);
        series.rigid_body.evaluate(series.motion, &mut tile);
        let scale = scale(series);
        for column in 0..out.columns() {
            let values = out.column_mut(column).iter_mut().zip(&scale);
            values
                .filter(|(value, scale)| value.abs() <= ROUNDING * **scale)
                .for_each(|(value, _)| *value = 0.0);
        }
        Ok(())
    }
}

/// The size of what columns are sums of, at each sample: accelerations of bodies a metre from the axes, per m/s².
fn scale(series: &ArmSeries<'_>) -> Vec<f64> {
    let motion = series.motion;
    let gravity: f64 = series.rigid_body.gravity_m_s2().iter().map(|g| g.abs()).sum();
    let sum = |of: &dyn Fn(usize) -> f64| (0..motion.joints()).map(of).sum::<f64>();
    let at = |k: usize| {
        let velocity = sum(&|j| motion.velocity_rad_s(j)[k].abs());
        gravity + sum(&|j| motion.acceleration_rad_s2(j)[k].abs()) + velocity * velocity
    };
    (0..motion.samples()).map(at).collect()
}
