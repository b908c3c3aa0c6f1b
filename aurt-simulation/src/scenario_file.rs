//! Scenarios as TOML files.

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use crate::effects::{Effect, read_effect};
use crate::error::{Complaints, SimulationError};
use crate::plant::Controller;
use crate::robots::{Robot, Rotors};
use crate::scenario::Scenario;
use crate::sensors::Logger;
use crate::trajectory::Motion;

/// A scenario as a file says it: one of the included robots, perhaps changed, its motion, and what else is in it.
///
/// ```
/// let scenario = aurt_simulation::ScenarioFile::parse(r#"
///     robot = "ur10e"
///     seed = 7
///     [motion]
///     kind = "multi_sine"
///     duration_s = 5.0
///     harmonics = 5
///     top_hz = 0.8
///     share = 0.5
///     [logger]
///     rate_hz = 125
///     [[link]]
///     index = 5
///     mass_kg = 1.9
///     [[effect]]
///     name = "current_offset"
///     joints = [2]
///     offset_nm = [3.0]
/// "#, "scenario.toml")?.scenario()?;
/// assert_eq!(scenario.robot.links[5].mass_kg, 1.9);
/// # Ok::<(), aurt_simulation::SimulationError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioFile {
    pub robot: String,
    /// Where its rotors' inertia is; geared unless said.
    pub rotors: Option<Rotors>,
    /// Seed of motion and noise.
    pub seed: u64,
    /// What the robot is asked to do.
    pub motion: Motion,
    /// How it is driven.
    #[serde(default)]
    pub controller: Controller,
    #[serde(default)]
    pub logger: Logger,
    /// How its links differ from the included robot's.
    #[serde(default, rename = "link")]
    pub links: Vec<LinkChange>,
    /// How its drives differ.
    #[serde(default, rename = "drive")]
    pub drives: Vec<DriveChange>,
    /// Effects: `name`, and the fields of an effect of that identifier.
    #[serde(default, rename = "effect")]
    pub effects: Vec<toml::Table>,
}

/// A link that differs.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinkChange {
    pub index: usize,
    pub mass_kg: Option<f64>,
    /// Centre of mass in the link's frame, m.
    pub com_m: Option<[f64; 3]>,
    /// Inertia {XX XY XZ YY YZ ZZ} about the centre of mass, kg m².
    pub inertia_at_com_kg_m2: Option<[f64; 6]>,
}

/// A drive that differs; units as in [`crate::robots::Drive`].
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the fields are those of `Drive`")]
pub struct DriveChange {
    pub joint: usize,
    pub rotor_inertia_kg_m2: Option<f64>,
    pub torque_constant_nm_per_a: Option<f64>,
    pub coulomb_nm: Option<f64>,
    pub viscous_nm_s: Option<f64>,
    pub load_coefficient: Option<f64>,
    pub home_rad: Option<f64>,
    pub encoder_resolution_rad: Option<f64>,
    pub encoder_noise_rad: Option<f64>,
    pub torque_noise_nm: Option<f64>,
}

impl ScenarioFile {
    /// Reads a scenario; `path` is what errors call it.
    ///
    /// # Errors
    /// [`SimulationError::Unreadable`] with the place of what is wrong.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, SimulationError> {
        let path = path.as_ref();
        SimulationError::refuse_tables(path, text)?;
        toml::from_str(text).map_err(|error| SimulationError::syntax(path, text, &error))
    }

    /// Reads a scenario from a file, planned and checked.
    ///
    /// # Errors
    /// As [`Self::parse`] and [`Self::scenario`], with the place of the table that is wrong; a file that cannot be read.
    pub fn read_scenario(path: impl AsRef<Path>) -> Result<Scenario, SimulationError> {
        let path = path.as_ref();
        let text = SimulationError::text_of(path)?;
        let mut scenario = Self::parse(&text, path)?;
        if let (Motion::Recorded { file }, Some(folder)) = (&mut scenario.motion, path.parent()) {
            *file = folder.join(&*file);
        }
        scenario.planned().map_err(|(table, index, error)| {
            let reason = error.to_string();
            SimulationError::at(path, &text, Places::of(&text).begin(table, index), reason)
        })
    }

    /// The scenario, planned and checked.
    pub fn scenario(&self) -> Result<Scenario, SimulationError> {
        self.planned().map_err(|(_, _, error)| error)
    }

    fn changed(&self) -> Result<Robot, Wrong> {
        let named = Robot::named(&self.robot).map_err(|error| ("robot", 0, error))?;
        let mut robot = named.with_rotors(self.rotors.unwrap_or(Rotors::Geared));
        for (k, change) in self.links.iter().enumerate() {
            let mut complaints = Complaints::default();
            complaints.part("`[[link]]`".into(), "link", change.index, (&robot.name, robot.links.len()));
            complaints.finish().map_err(|error| ("link", k, error))?;
            let link = &mut robot.links[change.index];
            set(&mut link.mass_kg, change.mass_kg);
            set(&mut link.com_m, change.com_m);
            set(&mut link.inertia_at_com_kg_m2, change.inertia_at_com_kg_m2);
            robot.validate().map_err(|error| ("link", k, error))?;
        }
        for (k, change) in self.drives.iter().enumerate() {
            let mut complaints = Complaints::default();
            complaints.part("`[[drive]]`".into(), "joint", change.joint, (&robot.name, robot.drives.len()));
            complaints.finish().map_err(|error| ("drive", k, error))?;
            let drive = &mut robot.drives[change.joint];
            set(&mut drive.rotor_inertia_kg_m2, change.rotor_inertia_kg_m2);
            set(&mut drive.torque_constant_nm_per_a, change.torque_constant_nm_per_a);
            set(&mut drive.coulomb_nm, change.coulomb_nm);
            set(&mut drive.viscous_nm_s, change.viscous_nm_s);
            set(&mut drive.load_coefficient, change.load_coefficient);
            set(&mut drive.home_rad, change.home_rad);
            set(&mut drive.encoder_resolution_rad, change.encoder_resolution_rad);
            set(&mut drive.encoder_noise_rad, change.encoder_noise_rad);
            set(&mut drive.torque_noise_nm, change.torque_noise_nm);
            robot.validate().map_err(|error| ("drive", k, error))?;
        }
        robot.validate().map_err(|error| ("robot", 0, error))?;
        Ok(robot)
    }

    fn planned(&self) -> Result<Scenario, Wrong> {
        let robot = self.changed()?;
        self.logger.validate().map_err(|error| ("logger", 0, error))?;
        self.controller.validate().map_err(|error| ("controller", 0, error))?;
        let trajectory = self.motion.plan(&robot, self.seed).map_err(|error| ("motion", 0, error))?;
        let mut scenario = Scenario::new(robot, trajectory, self.seed);
        scenario.controller = self.controller;
        scenario.logger = self.logger;
        for (k, effect) in self.effects.iter().enumerate() {
            let effect = effect_of(effect).and_then(|effect| {
                effect.validate(&scenario.robot)?;
                Ok(effect)
            });
            scenario.effects.push(effect.map_err(|error| ("effect", k, error))?);
        }
        Ok(scenario)
    }
}

/// What cannot be, with the key and the place in its list of the table that says it.
type Wrong = (&'static str, usize, SimulationError);

fn effect_of(table: &toml::Table) -> Result<Box<dyn Effect>, SimulationError> {
    let mut fields = serde_json::to_value(table).unwrap_or_default();
    let name = fields.as_object_mut().and_then(|fields| fields.remove("name"));
    let Some(name) = name.as_ref().and_then(|name| name.as_str()) else {
        return Err(SimulationError::unreadable(
            "`[[effect]]`",
            "it needs a `name`, the identifier of an effect",
        ));
    };
    read_effect(name, fields)
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Places {
    robot: Option<Spanned<toml::Value>>,
    motion: Option<Spanned<toml::Value>>,
    controller: Option<Spanned<toml::Value>>,
    logger: Option<Spanned<toml::Value>>,
    link: Vec<Spanned<toml::Value>>,
    drive: Vec<Spanned<toml::Value>>,
    effect: Vec<Spanned<toml::Value>>,
}

impl Places {
    fn of(text: &str) -> Self {
        toml::from_str(text).unwrap_or_default()
    }

    /// The byte at which a table begins; 0 if it is not written.
    fn begin(&self, table: &str, index: usize) -> usize {
        let found = match table {
            "robot" => self.robot.as_ref(),
            "motion" => self.motion.as_ref(),
            "controller" => self.controller.as_ref(),
            "logger" => self.logger.as_ref(),
            "link" => self.link.get(index),
            "drive" => self.drive.get(index),
            _ => self.effect.get(index),
        };
        found.map_or(0, |value| value.span().start)
    }
}

fn set<T>(value: &mut T, changed: Option<T>) {
    if let Some(changed) = changed {
        *value = changed;
    }
}
