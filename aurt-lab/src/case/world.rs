words! {
    /// A world: dynamics, controller, instruments and habits of recording. Laboratories differ in all four, and a diagnosis
    /// that is right in one of them may be wrong in the next.
    #[derive(Default)]
    World {
        /// Our own simulator with white noise, an even clock and an experiment that lacks nothing but what is concealed.
        #[default]
        Clean = "clean",
        /// Our own simulator as laboratories are: coloured noise, coarse encoders, clocks that jitter, motors that warm up, and
        /// an experiment that is slightly wrong everywhere.
        Rough = "rough",
        /// Another engine's integrator, contacts, friction and actuators.
        Mujoco = "mujoco",
        /// Recordings of a real robot to which an effect was added.
        Injected = "injected",
        /// Servo arms that record commands and positions, without torques.
        Servo = "servo",
    }
}

impl World {
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|world| world.name() == name)
    }
}
