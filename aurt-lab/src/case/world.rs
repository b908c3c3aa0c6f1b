use serde::{Deserialize, Serialize};

/// A world: dynamics, controller, instruments and habits of recording. Laboratories differ in all four, and a diagnosis
/// that is right in one of them may be wrong in the next.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum World {
    /// Our own simulator with white noise, an even clock and an experiment that lacks nothing but what is concealed.
    #[default]
    Clean,
    /// Our own simulator as laboratories are: coloured noise, coarse encoders, clocks that jitter, motors that warm up, and
    /// an experiment that is slightly wrong everywhere.
    Rough,
    /// Another engine's integrator, contacts, friction and actuators.
    Mujoco,
    /// Recordings of a real robot to which an effect was added.
    Injected,
    /// Servo arms that record commands and positions, without torques.
    Servo,
}

impl World {
    /// All, in the order of tables.
    pub const ALL: [Self; 5] = [Self::Clean, Self::Rough, Self::Mujoco, Self::Injected, Self::Servo];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Rough => "rough",
            Self::Mujoco => "mujoco",
            Self::Injected => "injected",
            Self::Servo => "servo",
        }
    }

    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|world| world.name() == name)
    }
}
