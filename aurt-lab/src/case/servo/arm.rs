//! A small arm of servos, and its description.

use std::fmt::Write as _;

use aurt_rbd::{ChainDynamics, INERTIAL_PARAMETERS, Joint, LinkBody, Placement, RbdError, SerialChain};
use aurt_simulation::Random;

pub(super) const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];
/// How far off the description's masses and inertias are, as a share, and its centres of mass, in m.
const WRONG: (f64, f64, f64) = (0.01, 0.05, 0.001);

#[derive(Debug, Clone, Copy)]
pub(super) struct Servo {
    pub gain_nm_per_rad: f64,
    /// Back-EMF and viscous friction.
    pub damping_nm_s_per_rad: f64,
    pub delay_s: f64,
    pub dead_band_rad: f64,
    pub speed_limit_rad_s: f64,
    pub torque_limit_nm: f64,
    pub rotor_inertia_kg_m2: f64,
    pub coulomb_nm: f64,
    pub coulomb_per_load: f64,
    pub static_nm: f64,
    pub stribeck_velocity_rad_s: f64,
    /// Half the play between the joint and its encoder.
    pub play_rad: f64,
}

/// A link and where its joint sits on the link before.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    pub translation_m: [f64; 3],
    pub roll_rad: f64,
    pub length_m: f64,
    pub body: LinkBody,
}

/// An arm: a turning base, then joints in a vertical plane.
#[derive(Debug, Clone)]
pub(super) struct ServoArm {
    pub links: Vec<Link>,
    pub servos: Vec<Servo>,
    /// A point at the end of the last link.
    pub payload_kg: f64,
    /// What the torques of all servos together take of the supply, as a share for every Nm.
    pub sag_per_nm: f64,
}

impl ServoArm {
    /// An arm of two to four servos of one kind.
    pub fn draw(random: &mut Random) -> Self {
        let joints = 2 + random.index(3);
        let mut links: Vec<Link> = Vec::new();
        for j in 0..joints {
            let length_m = if j == 0 { 0.05 } else { random.between(0.09, 0.15) };
            let mass_kg = random.between(0.08, 0.16);
            let middle = length_m * random.between(0.4, 0.6);
            let bend = mass_kg * length_m * length_m / 12.0;
            let (com_m, inertia_at_com_kg_m2) = if j == 0 {
                ([0.0, 0.0, middle], [bend, 0.0, 0.0, bend, 0.0, 4e-5])
            } else {
                ([middle, 0.0, 0.0], [2e-5, 0.0, 0.0, bend, 0.0, bend])
            };
            links.push(Link {
                translation_m: match (j, links.last()) {
                    (0, _) | (_, None) => [0.0; 3],
                    (1, Some(base)) => [0.0, 0.0, base.length_m],
                    (_, Some(before)) => [before.length_m, 0.0, 0.0],
                },
                roll_rad: if j == 1 { std::f64::consts::FRAC_PI_2 } else { 0.0 },
                length_m,
                body: LinkBody { mass_kg, com_m, inertia_at_com_kg_m2 },
            });
        }
        let kind = Servo {
            gain_nm_per_rad: random.between(9.0, 13.0),
            damping_nm_s_per_rad: random.between(0.3, 0.6),
            delay_s: random.between(0.015, 0.035),
            dead_band_rad: 0.0,
            speed_limit_rad_s: f64::INFINITY,
            torque_limit_nm: f64::INFINITY,
            rotor_inertia_kg_m2: random.between(0.005, 0.012),
            coulomb_nm: random.between(0.04, 0.08),
            coulomb_per_load: 0.0,
            static_nm: 0.0,
            stribeck_velocity_rad_s: random.between(0.03, 0.08),
            play_rad: 0.0,
        };
        let servos = (0..joints)
            .map(|_| Servo {
                gain_nm_per_rad: kind.gain_nm_per_rad * random.between(0.9, 1.1),
                damping_nm_s_per_rad: kind.damping_nm_s_per_rad * random.between(0.85, 1.15),
                rotor_inertia_kg_m2: kind.rotor_inertia_kg_m2 * random.between(0.9, 1.1),
                coulomb_nm: kind.coulomb_nm * random.between(0.7, 1.3),
                ..kind
            })
            .collect();
        Self { links, servos, payload_kg: 0.0, sag_per_nm: 0.0 }
    }

    /// Its rigid bodies, rotors and payload.
    pub fn dynamics(&self) -> Result<ChainDynamics, RbdError> {
        let place = |l: &Link| Placement::from_roll_pitch_yaw(l.translation_m, [l.roll_rad, 0.0, 0.0]);
        let chain =
            SerialChain::new(self.links.iter().map(|l| Joint::revolute(place(l))).collect(), GRAVITY_M_S2)?;
        let mut standard: Vec<f64> = self.links.iter().flat_map(|l| l.body.standard_parameters()).collect();
        if let Some(last) = self.links.last() {
            let point = LinkBody {
                mass_kg: self.payload_kg,
                com_m: [last.length_m, 0.0, 0.0],
                inertia_at_com_kg_m2: [0.0; 6],
            };
            let begin = standard.len() - INERTIAL_PARAMETERS;
            standard[begin..].iter_mut().zip(point.standard_parameters()).for_each(|(s, p)| *s += p);
        }
        let rotors: Vec<f64> = self.servos.iter().map(|s| s.rotor_inertia_kg_m2).collect();
        ChainDynamics::new(chain, &standard)?.with_rotor_inertia(&rotors)
    }

    /// The links as their description states them: slightly wrong, and without the payload.
    pub fn urdf(&self, random: &mut Random) -> String {
        let mut text = "<robot name=\"arm\">\n  <link name=\"base\"/>\n".to_owned();
        for (j, link) in self.links.iter().enumerate() {
            let mut off = |share: f64| 1.0 + share * random.between(-1.0, 1.0);
            let mass_kg = link.body.mass_kg * off(WRONG.0);
            let [xx, .., yy, _, zz] = link.body.inertia_at_com_kg_m2;
            let [xx, yy, zz] = [xx, yy, zz].map(|i| i * off(WRONG.1));
            let [x, y, z] = link.body.com_m.map(|c| c + WRONG.2 * random.between(-1.0, 1.0));
            let [tx, ty, tz] = link.translation_m;
            let parent = if j == 0 { "base".to_owned() } else { format!("link_{}", j - 1) };
            let _ = write!(
                text,
                "  <link name=\"link_{j}\"><inertial><origin xyz=\"{x} {y} {z}\"/><mass value=\"{mass_kg}\"/>\n    \
                 <inertia ixx=\"{xx}\" ixy=\"0\" ixz=\"0\" iyy=\"{yy}\" iyz=\"0\" izz=\"{zz}\"/></inertial></link>\n  \
                 <joint name=\"joint_{j}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"link_{j}\"/>\n    \
                 <origin xyz=\"{tx} {ty} {tz}\" rpy=\"{} 0 0\"/><axis xyz=\"0 0 1\"/>\n    \
                 <limit lower=\"-3.1\" upper=\"3.1\" effort=\"10\" velocity=\"10\"/></joint>\n",
                link.roll_rad,
            );
        }
        text + "</robot>\n"
    }
}
