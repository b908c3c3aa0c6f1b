//! Drives, one a file.

mod current;
mod declare;
mod pd_law;
mod position_servo;
mod torque;
mod voltage;

pub use current::CurrentDrive;
pub use pd_law::PdLaw;
pub use position_servo::PositionServo;
pub use torque::TorqueDrive;
pub use voltage::VoltageDrive;

/// Every drive with its defaults, by name.
#[must_use]
pub fn all() -> Vec<Box<dyn aurt_traits::DriveModel>> {
    vec![
        Box::new(CurrentDrive::default()),
        Box::new(PdLaw::default()),
        Box::new(PositionServo::default()),
        Box::new(TorqueDrive::default()),
        Box::new(VoltageDrive::default()),
    ]
}
