//! The robots that simulations and proofs use.
//!
//! Geometry is that of the public tables; inertial parameters, friction and sensors are plausible values with
//! their sources in the files beside this one. They describe *a* robot of that kind, not any one machine.

use aurt_rbd::{ChainDynamics, JointKind, LinkBody, MdhRow, MdhRows, MdhTable, SerialChain, inconsistencies};
use aurt_traits::MeasurementUnit;
use serde::{Deserialize, Serialize};

use crate::error::{Complaints, SimulationError};

/// A robot as it is built: geometry, bodies, drives and what its limits and sensors are.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// Name, as plans spell it.
    pub name: String,
    /// Modified Denavit–Hartenberg rows in the reading [`MdhRows::Next`].
    pub mdh: Vec<MdhRow>,
    /// Gravitational acceleration in the base frame, m/s².
    pub gravity_m_s2: [f64; 3],
    /// The links, without the rotors of their drives.
    pub links: Vec<LinkBody>,
    /// The drives, one per joint.
    pub drives: Vec<Drive>,
    /// What the robot's logger writes: motor currents, or joint torques.
    pub unit: MeasurementUnit,
}

/// A joint's motor, gear, friction, limits and sensors; torques and speeds on the joint's side of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Motor revolutions per joint revolution.
    pub gear_ratio: f64,
    /// Rotor inertia as the joint feels it, kg m².
    pub rotor_inertia_kg_m2: f64,
    /// Joint torque per motor current, Nm/A.
    pub torque_constant_nm_per_a: f64,
    /// Coulomb friction, Nm.
    pub coulomb_nm: f64,
    /// Viscous friction, Nm s/rad.
    pub viscous_nm_s: f64,
    /// Dry friction per transmitted torque, Nm/Nm.
    pub load_coefficient: f64,
    /// Stiffness of the gear, Nm/rad; a simulation is rigid unless an effect makes it elastic.
    pub gear_stiffness_nm_rad: f64,
    /// Smallest and largest joint angle, rad.
    pub position_limit_rad: [f64; 2],
    /// Largest speed, rad/s.
    pub velocity_limit_rad_s: f64,
    /// Largest acceleration, rad/s².
    pub acceleration_limit_rad_s2: f64,
    /// Largest drive torque, Nm.
    pub torque_limit_nm: f64,
    /// Largest rate of the drive torque, Nm/s.
    pub torque_rate_limit_nm_s: f64,
    /// Angle around which trajectories are laid, rad.
    pub home_rad: f64,
    /// Encoder step, rad.
    pub encoder_resolution_rad: f64,
    /// Standard deviation of the encoder's noise, rad.
    pub encoder_noise_rad: f64,
    /// Standard deviation of the noise of the measured torque, Nm (a current's noise times its constant).
    pub torque_noise_nm: f64,
}

/// What a joint's motion has to stay within.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionLimits {
    /// Smallest and largest angle, rad.
    pub position_rad: [f64; 2],
    /// Largest speed, rad/s.
    pub velocity_rad_s: f64,
    /// Largest acceleration, rad/s².
    pub acceleration_rad_s2: f64,
}

/// Where the inertia of the rotors acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rotors {
    /// As rotor inertia I_a q̈ of geared motors. An experiment needs the arm term `rotor_inertia` to fit it.
    Geared,
    /// As discs that turn with their links (drives without gears): part of the links' inertial parameters,
    /// so that rigid bodies and friction alone describe the robot.
    InLinks,
}

impl Robot {
    pub fn named(name: &str) -> Result<Self, SimulationError> {
        Self::all().into_iter().find(|robot| robot.name == name).ok_or_else(|| {
            SimulationError::UnknownRobot {
                name: name.to_owned(),
                known: Self::all().into_iter().map(|robot| robot.name).collect(),
            }
        })
    }

    /// All robots of this crate, smallest first.
    pub fn all() -> Vec<Self> {
        vec![two_link(), ur5e(), ur10e(), tx40(), panda()]
    }

    /// A robot of which only geometry and limits are known: enough to plan motions for it, and no more. Its links
    /// are balls of 1 kg, its torque limits endless for practical purposes.
    pub fn of_geometry(
        name: &str,
        mdh: Vec<MdhRow>,
        gravity_m_s2: [f64; 3],
        limits: &[MotionLimits],
    ) -> Self {
        let balls = vec![[1.0, 0.0, 0.0, 0.0, 4e-3, 0.0, 0.0, 4e-3, 0.0, 4e-3]; mdh.len()];
        let drive = |limits: &MotionLimits| Drive {
            gear_ratio: 1.0,
            rotor_inertia_kg_m2: 0.0,
            torque_constant_nm_per_a: 1.0,
            coulomb_nm: 0.0,
            viscous_nm_s: 0.0,
            load_coefficient: 0.0,
            gear_stiffness_nm_rad: 1e5,
            position_limit_rad: limits.position_rad,
            velocity_limit_rad_s: limits.velocity_rad_s,
            acceleration_limit_rad_s2: limits.acceleration_rad_s2,
            torque_limit_nm: 1e9,
            torque_rate_limit_nm_s: 1e12,
            home_rad: 0.5 * (limits.position_rad[0] + limits.position_rad[1]),
            encoder_resolution_rad: 0.0,
            encoder_noise_rad: 0.0,
            torque_noise_nm: 0.0,
        };
        Self {
            name: name.into(),
            links: bodies(&balls),
            mdh,
            gravity_m_s2,
            drives: limits.iter().map(drive).collect(),
            unit: MeasurementUnit::NewtonMetre,
        }
    }

    /// A robot of which nothing but the limits is known, for motions whose rigid bodies are elsewhere
    /// ([`excite`](crate::trajectory::excite)).
    pub fn of_limits(name: &str, limits: &[MotionLimits]) -> Self {
        let (kind, [alpha_rad, a_m, d_m, theta_offset_rad]) = (JointKind::Revolute, [0.0; 4]);
        let row = MdhRow { kind, alpha_rad, a_m, d_m, theta_offset_rad, sign: 1.0 };
        Self::of_geometry(name, vec![row; limits.len()], [0.0; 3], limits)
    }

    pub fn joints(&self) -> usize {
        self.drives.len()
    }

    /// The kinematic chain under the robot's gravity.
    pub fn chain(&self) -> Result<SerialChain, SimulationError> {
        let table = MdhTable { rows: self.mdh.clone(), reading: MdhRows::Next };
        Ok(SerialChain::from_mdh(&table, self.gravity_m_s2)?)
    }

    /// The links' 10 N standard inertial parameters {XX XY XZ YY YZ ZZ mX mY mZ m}.
    pub fn standard_parameters(&self) -> Vec<f64> {
        self.links.iter().flat_map(LinkBody::standard_parameters).collect()
    }

    /// What each link's joint alone would have to accelerate at home, the other joints free and without any
    /// rotor: 1/(M⁻¹)_jj, kg m².
    pub fn link_inertia_kg_m2(&self) -> Result<Vec<f64>, SimulationError> {
        let n = self.joints();
        let home: Vec<f64> = self.drives.iter().map(|d| d.home_rad).collect();
        let mut mass = vec![0.0; n * n];
        ChainDynamics::new(self.chain()?, &self.standard_parameters())?.mass_matrix(&home, &mut mass);
        let inverse =
            nalgebra::DMatrix::from_row_slice(n, n, &mass).cholesky().map(|factor| factor.inverse());
        Ok((0..n).map(|j| inverse.as_ref().map_or(0.0, |m| 1.0 / m[(j, j)])).collect())
    }

    /// The robot with its rotors geared, or as discs of its links: a thin disc about the joint's axis at
    /// the link's centre of mass, of inertia (I/2, I/2, I), and no rotor inertia.
    #[must_use]
    pub fn with_rotors(mut self, rotors: Rotors) -> Self {
        if rotors == Rotors::InLinks {
            for (link, drive) in self.links.iter_mut().zip(&mut self.drives) {
                let disc = std::mem::take(&mut drive.rotor_inertia_kg_m2);
                link.inertia_at_com_kg_m2[0] += 0.5 * disc;
                link.inertia_at_com_kg_m2[3] += 0.5 * disc;
                link.inertia_at_com_kg_m2[5] += disc;
            }
        }
        self
    }

    /// The geometry as `mdh.csv`: header `alpha,a,d`, row j with the alpha and a that lead on to joint j + 1.
    pub fn mdh_csv(&self) -> String {
        let mut text = String::from("alpha,a,d\n");
        for row in &self.mdh {
            let quarter = row.alpha_rad / std::f64::consts::FRAC_PI_2;
            let alpha = match quarter {
                0.0 => "0".to_owned(),
                1.0 => "pi/2".to_owned(),
                -1.0 => "-pi/2".to_owned(),
                _ => row.alpha_rad.to_string(),
            };
            text.push_str(&format!("{alpha},{},{}\n", row.a_m, row.d_m));
        }
        text
    }

    /// Checks that everything is as a real robot's can be.
    ///
    /// # Errors
    /// Every complaint: counts, bodies that cannot exist, negative friction, noise or limits.
    pub fn validate(&self) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        for (what, found) in [("links", self.links.len()), ("rows of geometry", self.mdh.len())] {
            if found != self.joints() {
                let what = format!("{}: {what}", self.name);
                complaints.0.push(SimulationError::Count { what, expected: self.joints(), found });
            }
        }
        for complaint in inconsistencies(&self.standard_parameters()) {
            let robot = self.name.clone();
            complaints.0.push(SimulationError::Body { robot, reason: complaint.to_string() });
        }
        for (j, drive) in self.drives.iter().enumerate() {
            let name = |what: &str| format!("{what} of joint {j}");
            complaints.positive(name("gear ratio"), drive.gear_ratio);
            complaints.positive(name("torque constant"), drive.torque_constant_nm_per_a);
            complaints.positive(name("gear stiffness"), drive.gear_stiffness_nm_rad);
            complaints.not_negative(name("rotor inertia"), drive.rotor_inertia_kg_m2);
            complaints.not_negative(name("Coulomb friction"), drive.coulomb_nm);
            complaints.not_negative(name("viscous friction"), drive.viscous_nm_s);
            complaints.within(name("load coefficient"), drive.load_coefficient, 0.0, 0.9);
            complaints.positive(name("velocity limit"), drive.velocity_limit_rad_s);
            complaints.positive(name("acceleration limit"), drive.acceleration_limit_rad_s2);
            complaints.positive(name("torque limit"), drive.torque_limit_nm);
            complaints.positive(name("torque rate limit"), drive.torque_rate_limit_nm_s);
            complaints.not_negative(name("encoder resolution"), drive.encoder_resolution_rad);
            complaints.not_negative(name("encoder noise"), drive.encoder_noise_rad);
            complaints.not_negative(name("torque noise"), drive.torque_noise_nm);
            let [low, high] = drive.position_limit_rad;
            complaints.within(name("home angle"), drive.home_rad, low, high);
        }
        complaints.finish()
    }
}

/// A robot as its file describes it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotFile {
    unit: MeasurementUnit,
    gravity_m_s2: [f64; 3],
    /// The geometry as [`Robot::mdh_csv`] writes it.
    mdh: String,
    /// The links, for [`bodies`].
    links: Vec<[f64; 10]>,
    /// The fields of [`Drive`], each a list over joints.
    drives: toml::Table,
}

impl RobotFile {
    fn read(name: &str, text: &str) -> Result<Robot, Box<dyn std::error::Error>> {
        let Self { unit, gravity_m_s2, mdh, links, drives } = toml::from_str(text)?;
        let mdh = MdhTable::parse(&mdh, name, MdhRows::Next)?.rows;
        let fields_of = |j: usize| drives.iter().map(move |(key, joints)| (key.clone(), joints[j].clone()));
        let drives = (0..mdh.len()).map(|j| fields_of(j).collect::<toml::Table>().try_into());
        let drives = drives.collect::<Result<_, _>>()?;
        Ok(Robot { name: name.into(), gravity_m_s2, links: bodies(&links), drives, mdh, unit })
    }
}

/// Declares robots, each by the file of its name.
macro_rules! described {
    ($($(#[$doc:meta])* $name:ident)+) => {
        $(
            $(#[$doc])*
            pub fn $name() -> Robot {
                // The file is part of the program, and a test reads it.
                RobotFile::read(stringify!($name), include_str!(concat!(stringify!($name), ".toml"))).expect("a robot")
            }
        )+
    };
}

described! {
    /// A Franka Emika Panda, upright; seven joints, little friction, joint torques from its logger.
    panda
    /// Two rods of 1 m that turn about parallel horizontal axes; torques in Nm.
    two_link
    /// A Stäubli TX40: light, fast, stiff gears of low ratio, dominant friction; its logger writes joint torques.
    tx40
    /// A Universal Robots UR10e, upright; its logger writes motor currents.
    ur10e
    /// A Universal Robots UR5e on a slanted base (gravity 0, 6.937, −6.937 m/s² as in the AURT paper); its logger
    /// writes motor currents.
    ur5e
}

/// Bodies, each from mass, centre of mass and inertia {XX XY XZ YY YZ ZZ} about it.
fn bodies(rows: &[[f64; 10]]) -> Vec<LinkBody> {
    let body = |&[mass_kg, x, y, z, xx, xy, xz, yy, yz, zz]: &[f64; 10]| LinkBody {
        mass_kg,
        com_m: [x, y, z],
        inertia_at_com_kg_m2: [xx, xy, xz, yy, yz, zz],
    };
    rows.iter().map(body).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_robot_is_one() {
        for robot in Robot::all() {
            robot.validate().unwrap();
            let in_links = robot.clone().with_rotors(Rotors::InLinks);
            in_links.validate().unwrap();
            assert!(in_links.drives.iter().all(|d| d.rotor_inertia_kg_m2 == 0.0));
            assert_eq!(Robot::named(&robot.name).unwrap(), robot);
        }
        assert!(Robot::named("ur11").unwrap_err().to_string().contains("ur10e"));
    }

    #[test]
    fn geometry_survives_its_file() {
        for robot in Robot::all() {
            let table = MdhTable::parse(&robot.mdh_csv(), "mdh.csv", MdhRows::Next).unwrap();
            assert_eq!(table.rows, robot.mdh);
        }
    }

    #[test]
    fn impossible_robots_are_refused_with_reasons() {
        let mut robot = ur10e();
        robot.links[2].mass_kg = -1.0;
        robot.drives[1].coulomb_nm = -3.0;
        robot.drives[4].torque_noise_nm = f64::NAN;
        let text = robot.validate().unwrap_err().to_string();
        for part in ["link 2", "Coulomb friction of joint 1", "torque noise of joint 4"] {
            assert!(text.contains(part), "{text}");
        }
    }
}
