//! A setup as a user has it: a robot, its recordings, and what the experiment states of them.

use std::f64::consts::TAU;

use crate::case::planned;
use crate::effects::{Lacks, Undeclared};
use aurt_rbd::MdhRow;
use aurt_rbd::robots::{KnownRobot, known_robot};
use aurt_simulation::effects::{BristleModel, Effect, Payload};
use aurt_simulation::sensors::{ClockFaults, Instrument};
use aurt_simulation::{
    Controller, Logger, Motion, Random, Robot, Rotors, Scenario, SimulationError, simulate,
};
use aurt_traits::MeasurementUnit;

use super::arms::arm;

/// Where the experiment has the robot's geometry from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Geometry {
    Name(String),
    Urdf,
    Table,
}

/// Units of a recording that are not SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Units {
    pub degrees: bool,
    pub milliseconds: bool,
    pub milliampere: bool,
    /// Positions of motors behind such gears.
    pub gear_ratio: Option<f64>,
}

/// A recording: stamps in s, and of each joint position in rad and measurement in A or Nm.
#[derive(Debug, Clone)]
pub struct Log {
    pub time_s: Vec<f64>,
    pub position_rad: Vec<Vec<f64>>,
    /// Speeds of each joint; empty where they are not logged.
    pub velocity_rad_s: Vec<Vec<f64>>,
    pub measurement: Vec<Vec<f64>>,
    pub units: Units,
    pub validates: bool,
}

/// Columns of a recording; those of positions have their velocities with them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Columns {
    Positions,
    Measurements,
    Both,
}

impl Log {
    /// Quantities, of each joint a series; those that are logged.
    pub fn families(&mut self, of: Columns) -> impl Iterator<Item = &mut Vec<Vec<f64>>> {
        let [moves, measures] = [of != Columns::Measurements, of != Columns::Positions];
        let all = [
            (moves, &mut self.position_rad),
            (moves, &mut self.velocity_rad_s),
            (measures, &mut self.measurement),
        ];
        all.into_iter().filter(|(is, family)| *is && !family.is_empty()).map(|(_, family)| family)
    }
}

#[derive(Debug, Clone)]
pub struct Setup {
    pub geometry: Geometry,
    /// Rows as the table or the URDF file states them.
    pub mdh: Vec<MdhRow>,
    /// Further lines of `[robot]`.
    pub robot_lines: Vec<String>,
    pub gravity_m_s2: [f64; 3],
    pub unit: MeasurementUnit,
    pub constants_nm_per_a: Option<Vec<f64>>,
    pub logs: Vec<Log>,
    pub declared: Units,
    /// `columns` of every recording, where it states them.
    pub columns: Option<[usize; 2]>,
    /// What happens to the text of each file before it is written.
    pub edit: Option<fn(&str) -> String>,
    pub f_dyn_hz: f64,
    pub described: String,
}

impl Setup {
    /// A robot under gravity with currents, as its table states it.
    pub fn of_table(mdh: Vec<MdhRow>, logs: Vec<Log>, f_dyn_hz: f64) -> Self {
        Self {
            geometry: Geometry::Table,
            mdh,
            robot_lines: Vec::new(),
            gravity_m_s2: [0.0, 0.0, -9.81],
            unit: MeasurementUnit::Ampere,
            constants_nm_per_a: None,
            logs,
            declared: Units::default(),
            columns: None,
            edit: None,
            f_dyn_hz,
            described: String::new(),
        }
    }

    /// What `aurt` calls the joints; nothing where it counts them.
    pub fn joint_names(&self) -> Vec<String> {
        match &self.geometry {
            Geometry::Name(name) => known_robot(name).map_or_else(Vec::new, KnownRobot::joint_names),
            Geometry::Urdf => (0..self.mdh.len()).map(|j| format!("joint_{j}")).collect(),
            Geometry::Table => Vec::new(),
        }
    }

    pub fn draw(random: &mut Random) -> Result<Self, SimulationError> {
        let (robot, geometry) = robot(random);
        let motions = Motions::draw(random);
        let rate_hz = if random.chance(0.5) { 100.0 } else { 125.0 };
        let surroundings = Surroundings::draw(&robot, rate_hz, random);
        // A load that one recording of several carries and the experiment does not state.
        let loaded =
            (motions.roles.len() > 1 && random.chance(0.15)).then(|| random.index(motions.roles.len()));
        let mut logs = Vec::new();
        for (k, validates) in motions.roles.iter().enumerate() {
            let motion = motions.motion(random);
            let (seed, trajectory) = planned(&motion, &robot, random)?;
            let mut effects: Vec<Box<dyn Effect>> = Vec::new();
            if loaded == Some(k) {
                effects.push(Box::new(payload(&robot, random)));
            }
            effects.push(Box::new(surroundings.undeclared.clone()));
            let scenario = Scenario {
                controller: surroundings.controller,
                instrument: Some(surroundings.instrument.clone()),
                logger: surroundings.logger,
                effects,
                ..Scenario::new(robot.clone(), trajectory, seed)
            };
            let made = simulate(&scenario)?;
            let columns = |rows: &[f64]| -> Vec<Vec<f64>> {
                (0..made.joints)
                    .map(|j| rows.iter().skip(j).step_by(made.joints).copied().collect())
                    .collect()
            };
            logs.push(Log {
                time_s: made.time_s.clone(),
                position_rad: columns(&made.position_rad),
                velocity_rad_s: Vec::new(),
                measurement: columns(&made.measurement),
                units: Units::default(),
                validates: *validates,
            });
        }
        let is_current = robot.unit == MeasurementUnit::Ampere;
        let constants = robot.drives.iter().map(|d| d.torque_constant_nm_per_a).collect();
        let units = Units {
            degrees: random.chance(0.2),
            milliseconds: random.chance(0.15),
            milliampere: is_current && random.chance(0.15),
            gear_ratio: random.chance(0.1).then(|| robot.drives[0].gear_ratio),
        };
        logs.iter_mut().for_each(|log| log.units = units.clone());
        let described = format!(
            "{:?} {} joints, {} recordings of {:?}{}",
            geometry,
            robot.joints(),
            logs.len(),
            motions.habit,
            if loaded.is_some() { ", one loaded" } else { "" }
        );
        Ok(Self {
            geometry,
            gravity_m_s2: robot.gravity_m_s2,
            unit: robot.unit,
            constants_nm_per_a: (is_current && random.chance(0.7)).then_some(constants),
            declared: units,
            described,
            ..Self::of_table(robot.mdh.clone(), logs, motions.f_dyn_hz(rate_hz, random))
        })
    }

    pub fn joints(&self) -> usize {
        self.mdh.len()
    }

    pub fn files(&self) -> Vec<(String, Vec<u8>)> {
        let mut files = vec![("experiment.toml".to_owned(), self.experiment())];
        match self.geometry {
            Geometry::Name(_) => {}
            Geometry::Urdf => files.push(("robot.urdf".into(), urdf(&self.mdh))),
            Geometry::Table => files.push(("mdh.csv".into(), table(&self.mdh))),
        }
        files.extend(self.logs.iter().enumerate().map(|(k, log)| (file_name(k), self.csv(log))));
        let edited = |text: String| match self.edit {
            Some(edit) => edit(&text),
            None => text,
        };
        files.into_iter().map(|(name, text)| (name, edited(text).into_bytes())).collect()
    }

    fn csv(&self, log: &Log) -> String {
        let quantity = if self.unit == MeasurementUnit::Ampere { "current" } else { "torque" };
        let names = |of: &str, family: &[Vec<f64>]| -> String {
            (0..family.len()).map(|j| format!(",{of}_{j}")).collect()
        };
        let [q, qd] = [names("q", &log.position_rad), names("qd", &log.velocity_rad_s)];
        let mut text = format!("time{q}{qd}{}\n", names(quantity, &log.measurement));
        let time = if log.units.milliseconds { 1e3 } else { 1.0 };
        let degrees = if log.units.degrees { 360.0 / TAU } else { 1.0 };
        let position = degrees * log.units.gear_ratio.unwrap_or(1.0);
        let measurement = if log.units.milliampere { 1e3 } else { 1.0 };
        for (row, t) in log.time_s.iter().enumerate() {
            text.push_str(&format!("{:.6}", t * time));
            let families =
                [(&log.position_rad, position), (&log.velocity_rad_s, 1.0), (&log.measurement, measurement)];
            for (family, factor) in families {
                text.extend(family.iter().map(|series| format!(",{:.7}", series[row] * factor)));
            }
            text.push('\n');
        }
        text
    }

    fn experiment(&self) -> String {
        let geometry = match &self.geometry {
            Geometry::Name(name) => format!("name = \"{name}\""),
            Geometry::Urdf => "urdf = \"robot.urdf\"\ntip = \"tip\"".into(),
            Geometry::Table => "mdh = \"mdh.csv\"".into(),
        };
        let mut lines = vec![
            "schema = 1\n\n[robot]".to_owned(),
            geometry,
            format!("gravity_m_s2 = {:?}", self.gravity_m_s2),
        ];
        lines.extend(self.constants_nm_per_a.iter().map(|k| format!("torque_constants_nm_per_a = {k:?}")));
        lines.extend(self.robot_lines.iter().cloned());
        lines.push(
            "\n[joint_dynamics]\ncoulomb = { model = \"constant\" }\nhysteresis = { model = \"sign\" }\n\
             viscous = { model = \"polynomial\", powers = [1] }\n\n[recordings]"
                .into(),
        );
        let declared = &self.declared;
        let keys = [
            (declared.degrees, "angle = \"deg\"".to_owned()),
            (declared.milliseconds, "time = \"ms\"".to_owned()),
            (declared.milliampere, "current = \"mA\"".to_owned()),
            (declared.gear_ratio.is_some(), format!("gear_ratio = {:?}", declared.gear_ratio.unwrap_or(1.0))),
        ];
        lines.extend(keys.into_iter().filter(|(is, _)| *is).map(|(_, key)| key));
        for (validates, key) in [(false, "calibration"), (true, "validation")] {
            let entries: Vec<String> = (0..self.logs.len())
                .filter(|k| self.logs[*k].validates == validates)
                .map(|k| self.entry(k))
                .collect();
            if !entries.is_empty() {
                lines.push(format!("{key} = [{}]", entries.join(", ")));
            }
        }
        lines.push(format!("\n[preprocess]\nf_dyn_hz = {:?}\n", self.f_dyn_hz));
        lines.join("\n")
    }

    fn entry(&self, log: usize) -> String {
        let file = file_name(log);
        let Some([position, measurement]) = self.columns else { return format!("\"{file}\"") };
        let unit = self.unit.symbol();
        let to = self.joints() - 1;
        format!(
            "{{ file = \"{file}\", unit = \"{unit}\", columns = {{ time = 0, position = [{position}, {}], measurement = \
             [{measurement}, {}] }} }}",
            position + to,
            measurement + to
        )
    }
}

pub fn file_name(log: usize) -> String {
    format!("recording_{}.csv", log + 1)
}

/// A robot known by name, one of a table, or one of a URDF file.
fn robot(random: &mut Random) -> (Robot, Geometry) {
    let known =
        [aurt_simulation::robots::ur5e, aurt_simulation::robots::ur10e, aurt_simulation::robots::panda];
    let (mut robot, geometry) = match random.index(3) {
        0 => {
            let robot = known[random.index(known.len())]();
            let name = robot.name.clone();
            (robot, Geometry::Name(name))
        }
        of => {
            let some = Robot::all();
            let robot = if random.chance(0.5) { some[random.index(some.len())].clone() } else { arm(random) };
            (robot, if of == 1 { Geometry::Table } else { Geometry::Urdf })
        }
    };
    if random.chance(0.8) && robot.name != "two_link" {
        robot.gravity_m_s2 = [0.0, 0.0, -9.81];
    }
    for (link, drive) in robot.links.iter_mut().zip(&mut robot.drives) {
        let heavier = random.between(0.7, 1.4);
        link.mass_kg *= heavier;
        link.inertia_at_com_kg_m2 = link.inertia_at_com_kg_m2.map(|i| i * heavier);
        drive.coulomb_nm *= random.between(0.5, 1.5);
        drive.viscous_nm_s *= random.between(0.5, 1.5);
    }
    robot.unit = if random.chance(0.5) { MeasurementUnit::Ampere } else { MeasurementUnit::NewtonMetre };
    let rotors = if random.chance(0.5) { Rotors::Geared } else { Rotors::InLinks };
    (robot.with_rotors(rotors), geometry)
}

fn payload(robot: &Robot, random: &mut Random) -> Payload {
    let link = robot.joints() - 1;
    let wrist_kg: f64 = robot.links.iter().rev().take(3).map(|l| l.mass_kg).sum();
    let mut side = |low| random.between(low, 0.06);
    let (com_m, edges_m) = ([side(-0.06), side(-0.06), side(0.02)], [side(0.04), side(0.04), side(0.04)]);
    Payload { link, mass_kg: (random.between(0.1, 0.5) * wrist_kg).clamp(0.05, 8.0), com_m, edges_m }
}

/// What a user lets the robot do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Habit {
    Excites,
    /// Moves between poses.
    Works,
    Tracks,
    Mixes,
}

struct Motions {
    roles: Vec<bool>,
    habit: Habit,
    top_hz: f64,
}

impl Motions {
    fn draw(random: &mut Random) -> Self {
        let roles: [&[bool]; 6] = [
            &[false],
            &[false, false],
            &[false, true],
            &[false, false, true],
            &[false, false, false, true],
            &[false, false, false, true, true],
        ];
        let habits = [Habit::Excites, Habit::Excites, Habit::Works, Habit::Tracks, Habit::Mixes];
        Self {
            roles: roles[random.index(roles.len())].to_vec(),
            habit: habits[random.index(habits.len())],
            top_hz: random.between_logs(0.3, 1.0),
        }
    }

    fn motion(&self, random: &mut Random) -> Motion {
        let duration_s = random.between(20.0, 30.0);
        let share = random.between(0.3, 0.75);
        let (harmonics, top_hz) = (4 + random.index(7), self.top_hz * random.between(0.7, 1.0));
        let kind = match self.habit {
            Habit::Excites => 0,
            Habit::Works => 1,
            Habit::Tracks => 2 + random.index(2),
            Habit::Mixes => random.index(4),
        };
        match kind {
            0 => Motion::MultiSine { duration_s, harmonics, top_hz, share },
            1 => Motion::PointToPoint { duration_s, share, rest_s: random.between(0.3, 1.0) },
            2 => Motion::Triangles {
                duration_s,
                speed_rad_s: random.between_logs(0.1, 0.5),
                amplitude_rad: random.between(0.3, 1.0),
            },
            _ => Motion::Sweeps { duration_s, share },
        }
    }

    /// As a user chooses it: several times what the motion has, below what the rate allows.
    fn f_dyn_hz(&self, rate_hz: f64, random: &mut Random) -> f64 {
        ((2.0 * self.top_hz.max(0.5) * random.between(4.0, 8.0)).round() / 2.0).clamp(1.5, 0.06 * rate_hz)
    }
}

/// Controller, sensors, and the friction that no experiment states.
struct Surroundings {
    controller: Controller,
    instrument: Instrument,
    logger: Logger,
    undeclared: Undeclared,
}

impl Surroundings {
    fn draw(robot: &Robot, rate_hz: f64, random: &mut Random) -> Self {
        let controller = Controller {
            bandwidth_hz: random.between_logs(8.0, 40.0),
            damping_ratio: random.between(0.4, 1.0),
            feed_forward: random.between(0.6, 1.0),
            friction_feed_forward: random.between(0.0, 0.8),
            friction_width_rad_s: random.between_logs(5e-4, 0.02),
        };
        let mut instrument = Instrument::of(robot);
        let bits = 12 + random.index(9);
        let noise = [random.between_logs(1e-6, 1e-4), random.between_logs(0.5, 4.0)];
        for (channel, drive) in instrument.channels.iter_mut().zip(&robot.drives) {
            channel.encoder_resolution_rad = TAU / (1_u64 << bits) as f64;
            channel.encoder_noise_rad = noise[0];
            channel.torque_noise_nm *= noise[1];
            channel.gain_error = 0.02 * random.normal();
            channel.offset_nm =
                if random.chance(0.3) { 0.3 * drive.coulomb_nm * random.normal() } else { 0.0 };
        }
        instrument.torque_delay_s = if random.chance(0.5) { random.between(0.0, 0.006) } else { 0.0 };
        let loses = random.chance(0.3);
        let logger = Logger {
            rate_hz,
            clock_jitter_s: random.between(0.0, 0.05) / rate_hz,
            time_decimals: 6,
            faults: ClockFaults { missing_share: if loses { 0.003 } else { 0.0 }, ..ClockFaults::default() },
            ..Logger::default()
        };
        let has = [0.5, 0.5, 0.5, 0.3, 0.4].map(|share| random.chance(share));
        let lacks = robot.drives.iter().map(|drive| {
            let here = |k: usize, size: f64| if has[k] { size } else { 0.0 };
            let most_nm = drive.viscous_nm_s * drive.velocity_limit_rad_s;
            let mut part = |low, high| random.between(low, high);
            Lacks {
                cubic_nm: here(0, part(-0.1, 0.3) * most_nm),
                stribeck_nm: here(1, part(0.0, 0.5) * drive.coulomb_nm),
                stribeck_shape: [part(0.01, 0.15), part(0.5, 2.0)],
                load_coefficient: here(2, part(0.0, 0.1)),
                presliding_rad: here(3, part(3e-3, 1e-2)),
                fall_per_k: here(4, part(0.0, 0.02)),
            }
        });
        let undeclared = Undeclared {
            lacks: lacks.collect(),
            bristles: BristleModel::Lugre,
            time_constants_s: [30.0, 200.0],
        };
        Self { controller, instrument, logger, undeclared }
    }
}

fn table(mdh: &[MdhRow]) -> String {
    let row = |r: &MdhRow| format!("{:?},{:?},{:?}\n", r.alpha_rad, r.a_m, r.d_m);
    "alpha,a,d\n".to_owned() + &mdh.iter().map(row).collect::<String>()
}

/// The geometry as `robot.urdf`: link_0 to link_N, the tip where the last joint is.
fn urdf(mdh: &[MdhRow]) -> String {
    let mut text = String::from("<robot name=\"arm\">\n  <link name=\"base\"/>\n");
    let (mut alpha, mut a_m) = (0.0_f64, 0.0);
    for (j, row) in mdh.iter().enumerate() {
        let parent = if j == 0 { "base".to_owned() } else { format!("link_{}", j - 1) };
        let child = if j + 1 == mdh.len() { "tip".to_owned() } else { format!("link_{j}") };
        let (y, z) = (-alpha.sin() * row.d_m, alpha.cos() * row.d_m);
        text.push_str(&format!(
            "  <link name=\"{child}\"/>\n  <joint name=\"joint_{j}\" type=\"continuous\">\n    <parent link=\"{parent}\"/>\n    \
             <child link=\"{child}\"/>\n    <origin xyz=\"{a_m} {y} {z}\" rpy=\"{alpha} 0 0\"/>\n    <axis xyz=\"0 0 1\"/>\n  \
             </joint>\n"
        ));
        (alpha, a_m) = (row.alpha_rad, row.a_m);
    }
    text + "</robot>\n"
}
