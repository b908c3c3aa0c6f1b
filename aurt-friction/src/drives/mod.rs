//! Drives, one a file.

mod current;
mod declare;
mod pd_law;
mod position_servo;
mod torque;
mod voltage;

use aurt_traits::DriveModel;

pub use current::CurrentDrive;
pub use pd_law::PdLaw;
pub use position_servo::PositionServo;
pub use torque::TorqueDrive;
pub use voltage::VoltageDrive;

/// A drive with its explanation.
#[derive(Debug)]
pub struct DriveListing {
    /// The drive with its defaults.
    pub drive: Box<dyn DriveModel>,
    source: &'static str,
    /// The meaning of every number, with its symbol in the equation, in the order of [`DriveModel::parameters`].
    pub meanings: Vec<String>,
}

impl DriveListing {
    /// The explanation of the drive: the module documentation of its file.
    pub fn explanation(&self) -> String {
        let lines = self.source.lines().map_while(|line| line.strip_prefix("//!"));
        lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n")
    }
}

/// Every drive, by name.
pub fn listings() -> Vec<DriveListing> {
    macro_rules! listing {
        ($drive:ty, $file:literal) => {
            DriveListing {
                drive: Box::new(<$drive>::default()),
                source: include_str!($file),
                meanings: <$drive>::meanings(),
            }
        };
    }
    vec![
        listing!(CurrentDrive, "current.rs"),
        listing!(PdLaw, "pd_law.rs"),
        listing!(PositionServo, "position_servo.rs"),
        listing!(TorqueDrive, "torque.rs"),
        listing!(VoltageDrive, "voltage.rs"),
    ]
}

/// Every drive with its defaults, by name.
pub fn all() -> Vec<Box<dyn DriveModel>> {
    listings().into_iter().map(|listing| listing.drive).collect()
}
