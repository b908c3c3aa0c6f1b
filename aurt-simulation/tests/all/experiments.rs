//! Textbook experiments on the simulator's own friction: what tests assert and pictures show.

use aurt_simulation::plant::{
    Bristle, DryTerm, Instant, LinearViscous, Machine, Release, ShaftTorque, Stretch, TRACE_STEP_S,
};
use aurt_simulation::{Robot, SimulationError, robots};

/// A curve of (x, y) points.
pub type Curve = Vec<[f64; 2]>;

/// Torque of a bristle along a path from turning point to turning point, in steps of `step_rad` at the speed
/// `speed_rad_s`, under a constant level of dry friction: (position, torque).
pub fn along(
    bristle: &dyn Bristle,
    level_nm: f64,
    turning_points_rad: &[f64],
    step_rad: f64,
    speed_rad_s: f64,
) -> Curve {
    let mut state = vec![0.0; bristle.state_len()];
    let mut curve = vec![[0.0, 0.0]];
    let mut position = 0.0;
    for target in turning_points_rad {
        let steps = ((target - position) / step_rad).abs().ceil().max(1.0);
        let moved_rad = (target - position) / steps;
        for _ in 0..steps as usize {
            let way = Stretch {
                moved_rad,
                elapsed_s: moved_rad.abs() / speed_rad_s,
                velocity_rad_s: speed_rad_s.copysign(moved_rad),
                level_nm,
            };
            let [dry, beside] = bristle.torque_nm(&state, way);
            bristle.advance(&mut state, way);
            position += moved_rad;
            curve.push([position, dry + beside]);
        }
    }
    curve
}

/// Stribeck's curve in the usual form, excess · exp(−(v/v_S)²).
#[derive(Debug)]
struct Stribeck {
    excess_nm: f64,
    velocity_rad_s: f64,
}

impl DryTerm for Stribeck {
    fn level_nm(&self, joint: usize, at: &Instant<'_>, _direction: f64) -> f64 {
        self.excess_nm * (-(at.shaft_rad_s[joint] / self.velocity_rad_s).powi(2)).exp()
    }
}

/// A torque that grows with time, or that of a spring whose other end moves.
#[derive(Debug)]
enum Pull {
    Ramp { rate_nm_s: f64 },
    Spring { stiffness_nm_rad: f64, speed_rad_s: f64 },
}

impl Pull {
    fn torque_nm(&self, time_s: f64, position_rad: f64) -> f64 {
        match self {
            Self::Ramp { rate_nm_s } => rate_nm_s * time_s,
            Self::Spring { stiffness_nm_rad, speed_rad_s } => {
                stiffness_nm_rad * (speed_rad_s * time_s - position_rad)
            }
        }
    }
}

impl ShaftTorque for Pull {
    fn add(&self, at: &Instant<'_>, opposing_nm: &mut [f64]) {
        opposing_nm[0] -= self.torque_nm(at.time_s, at.shaft_rad[0]);
    }
}

/// The standard example of Canudas de Wit et al. (1995), table 1: unit inertia, F_C = 1, F_S = 1.5,
/// v_S = 0.001, F_v = 0.4.
pub const COULOMB_NM: f64 = 1.0;
/// F_S of it.
pub const STATIC_NM: f64 = 1.5;

/// A wheel of unit inertia without gravity, with that friction and the given bristle.
fn wheel(bristle: Box<dyn Bristle>) -> Machine {
    let mut robot: Robot = robots::two_link();
    robot.mdh.truncate(1);
    robot.links.truncate(1);
    robot.drives.truncate(1);
    robot.gravity_m_s2 = [0.0; 3];
    robot.links[0].com_m = [0.0; 3];
    robot.links[0].inertia_at_com_kg_m2 = [0.5, 0.0, 0.0, 0.5, 0.0, 0.9];
    robot.drives[0].rotor_inertia_kg_m2 = 0.1;
    robot.drives[0].coulomb_nm = COULOMB_NM;
    let mut machine = Machine::new(&robot);
    let joint = &mut machine.joints[0];
    joint.viscous = Box::new(LinearViscous(0.4));
    joint.dry_terms.push(Box::new(Stribeck { excess_nm: STATIC_NM - COULOMB_NM, velocity_rad_s: 1e-3 }));
    joint.bristle = Some(bristle);
    machine
}

fn released(machine: Machine, duration_s: f64) -> Result<aurt_simulation::Traces, SimulationError> {
    Release {
        start_rad: vec![0.0],
        start_rad_s: vec![0.0],
        torque_nm: vec![0.0],
        duration_s,
        steps: Some(20),
    }
    .run(machine)
}

/// The torque at which the wheel breaks away, i.e. friction at its largest, under a torque that grows at the
/// given rate, Nm.
pub fn break_away_nm(bristle: Box<dyn Bristle>, rate_nm_s: f64) -> Result<f64, SimulationError> {
    let mut machine = wheel(bristle);
    machine.shaft_torques.push(Box::new(Pull::Ramp { rate_nm_s }));
    let traces = released(machine, 1.2 * STATIC_NM / rate_nm_s)?;
    let friction = |k: usize| rate_nm_s * traces.time_s(k) - traces.acceleration_rad_s2[k];
    // Viscous friction grows beyond any bound once the wheel is off.
    let begins = (0..traces.samples).find(|k| traces.velocity_rad_s[*k] > 0.05).unwrap_or(traces.samples);
    Ok((0..begins).map(friction).fold(0.0, f64::max))
}

/// The wheel drawn by a spring (2 Nm/rad) whose other end moves at 0.1 rad/s: time with position, velocity and
/// friction torque.
pub fn stick_slip(
    bristle: Box<dyn Bristle>,
    duration_s: f64,
) -> Result<(Curve, Curve, Curve), SimulationError> {
    let mut machine = wheel(bristle);
    let (stiffness_nm_rad, speed_rad_s) = (2.0, 0.1);
    machine.shaft_torques.push(Box::new(Pull::Spring { stiffness_nm_rad, speed_rad_s }));
    let traces = released(machine, duration_s)?;
    let pull = Pull::Spring { stiffness_nm_rad, speed_rad_s };
    let (mut position, mut velocity, mut friction) = (Curve::new(), Curve::new(), Curve::new());
    for k in 0..traces.samples {
        let time_s = k as f64 * TRACE_STEP_S;
        position.push([time_s, traces.position_rad[k]]);
        velocity.push([time_s, traces.velocity_rad_s[k]]);
        friction
            .push([time_s, pull.torque_nm(time_s, traces.position_rad[k]) - traces.acceleration_rad_s2[k]]);
    }
    Ok((position, velocity, friction))
}
