/// A motion to be executed: rows at increasing times, series as `[joint][sample]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlannedMotion {
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// Time since the motion began, s.
    pub time_s: Vec<f64>,
    /// Positions, rad or m.
    pub position_rad: Vec<Vec<f64>>,
    /// Velocities, rad/s or m/s.
    pub velocity_rad_s: Vec<Vec<f64>>,
    /// Accelerations, rad/s² or m/s².
    pub acceleration_rad_s2: Vec<Vec<f64>>,
}
