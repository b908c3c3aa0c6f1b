//! Drives that are nothing but their numbers.

/// A drive that is a structure of [`drive_numbers!`](aurt_traits::drive_numbers), under a name.
macro_rules! drive {
    ($drive:ty, $name:literal, $command:ident, $signal:ident, $initial:expr, $torque:expr) => {
        #[typetag::serde(name = $name)]
        impl aurt_traits::DriveModel for $drive {
            fn name(&self) -> &str {
                $name
            }
            fn command(&self) -> aurt_traits::Command {
                aurt_traits::Command::$command
            }
            fn usual_signal(&self) -> aurt_traits::CommandSignal {
                aurt_traits::CommandSignal::$signal
            }
            fn parameters(&self) -> Vec<aurt_traits::DriveParameter> {
                self.numbers()
            }
            fn set_parameters(&mut self, values: &[f64]) {
                self.set_numbers(values);
            }
            fn initial_state(&self, command: f64) -> Vec<aurt_traits::Jet> {
                ($initial)(command)
            }
            fn torque(
                &self,
                parameters: &[aurt_traits::Jet],
                input: &aurt_traits::DriveInput<'_>,
                state: &mut [aurt_traits::Jet],
            ) -> aurt_traits::DriveTorque {
                $torque(parameters, input, state)
            }
            fn boxed_clone(&self) -> Box<dyn aurt_traits::DriveModel> {
                Box::new(*self)
            }
        }
    };
}

pub(crate) use drive;
