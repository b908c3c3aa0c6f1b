//! The equations of motion of the machine between two events.

use super::arm::{Arm, LOCKED_KG_M2};
use super::controller::TrackingLoop;
use super::machine::{Gear, Instant, Machine, Stretch};
use crate::error::SimulationError;

/// What a dry contact does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Mode {
    Absent,
    /// It slides in the direction 1 or −1.
    Slides(f64),
    Holds,
}

/// How often the sign of the transmitted loads may be revised in one evaluation.
const LOAD_ITERATIONS: usize = 8;

/// What drives the shafts.
#[derive(Debug)]
pub(crate) enum Command {
    /// A controller that follows a trajectory.
    Track(TrackingLoop),
    /// Torques that stay as they are, Nm.
    Constant(Vec<f64>),
}

/// The machine with its state and working memory.
///
/// The state is (q, q̇, θ, θ̇): N joints, and the shafts of compliant gears. Dry contacts 0..N are the joints',
/// those from N on the coupled rotors'.
#[derive(Debug)]
pub(crate) struct Plant {
    pub machine: Machine,
    pub command: Command,
    pub joints: usize,
    pub arm: Arm,
    /// Joints with compliant gears, in the order of their shafts in the state.
    pub compliant: Vec<usize>,
    pub modes: Vec<Mode>,
    /// Reaction of contacts that hold, Nm.
    pub reaction_nm: Vec<f64>,
    /// Level of dry friction that a holding contact can bear, Nm.
    pub hold_nm: Vec<f64>,
    /// Torque that is taken off each contact beside what its mode does, Nm: zero but while modes are sought.
    pub probe_nm: Vec<f64>,
    /// Torque of the drives at the last evaluation, Nm.
    pub drive_nm: Vec<f64>,
    /// Friction power of each joint at the last evaluation, W.
    pub friction_w: Vec<f64>,
    load_sign: Vec<f64>,
    /// Memory of the joints' bristles and where their shafts were then.
    pub bristles: Vec<Vec<f64>>,
    pub shaft_then_rad: Vec<f64>,
    pub warmth_k: Vec<[f64; 2]>,
    pub warmth_factor: Vec<[f64; 2]>,
    /// Time and drive torque at the last completed step.
    pub then_s: f64,
    pub drive_then_nm: Vec<f64>,
    pub last_qdd_rad_s2: Vec<f64>,
    pub shaft_rad: Vec<f64>,
    pub shaft_rad_s: Vec<f64>,
    pub net_nm: Vec<f64>,
    divisor: Vec<f64>,
    link_nm: Vec<f64>,
    torque_nm: Vec<f64>,
    rotors_kg_m2: Vec<f64>,
    pub qdd_rad_s2: Vec<f64>,
    share: Vec<f64>,
    coupling_response: Vec<Vec<f64>>,
    coupling_nm: Vec<f64>,
    along_nm: Vec<f64>,
}

impl Plant {
    pub fn new(machine: Machine, command: Command) -> Result<Self, SimulationError> {
        let joints = machine.robot.joints();
        let compliant: Vec<usize> = (0..joints).filter(|j| machine.joints[*j].gear != Gear::Rigid).collect();
        let couplings = machine.couplings.len();
        let zeros = || vec![0.0; joints];
        let modes = machine
            .joints
            .iter()
            .map(|physics| if physics.jumps() { Mode::Holds } else { Mode::Absent })
            .chain(
                machine.couplings.iter().map(|c| if c.coulomb_nm > 0.0 { Mode::Holds } else { Mode::Absent }),
            )
            .collect();
        Ok(Self {
            arm: Arm::new(&machine.robot)?,
            bristles: machine
                .joints
                .iter()
                .map(|physics| vec![0.0; physics.bristle.as_ref().map_or(0, |b| b.state_len())])
                .collect(),
            warmth_k: machine
                .joints
                .iter()
                .map(|p| p.warmth.as_ref().map_or([0.0; 2], |w| w.start_k))
                .collect(),
            warmth_factor: vec![[1.0; 2]; joints],
            modes,
            reaction_nm: vec![0.0; joints + couplings],
            hold_nm: vec![0.0; joints + couplings],
            probe_nm: vec![0.0; joints + couplings],
            drive_nm: zeros(),
            friction_w: zeros(),
            load_sign: vec![1.0; joints],
            shaft_then_rad: zeros(),
            then_s: 0.0,
            drive_then_nm: zeros(),
            last_qdd_rad_s2: zeros(),
            shaft_rad: zeros(),
            shaft_rad_s: zeros(),
            net_nm: zeros(),
            divisor: vec![1.0; joints],
            link_nm: zeros(),
            torque_nm: zeros(),
            rotors_kg_m2: zeros(),
            qdd_rad_s2: zeros(),
            share: zeros(),
            coupling_response: vec![zeros(); couplings],
            coupling_nm: zeros(),
            along_nm: zeros(),
            compliant,
            joints,
            command,
            machine,
        })
    }

    pub fn state_len(&self) -> usize {
        2 * (self.joints + self.compliant.len())
    }

    /// What physics may depend on in a state whose shafts have been read.
    pub fn instant<'a>(&'a self, time_s: f64, state: &'a [f64]) -> Instant<'a> {
        let (q_rad, qd_rad_s) = (&state[..self.joints], &state[self.joints..2 * self.joints]);
        let (shaft_rad, shaft_rad_s) = (&self.shaft_rad[..], &self.shaft_rad_s[..]);
        Instant { time_s, shaft_rad, shaft_rad_s, q_rad, qd_rad_s, last_qdd_rad_s2: &self.last_qdd_rad_s2 }
    }

    /// Where the velocity of a joint's shaft stands in the state.
    pub fn shaft_velocity_index(&self, joint: usize) -> usize {
        match self.compliant.iter().position(|c| *c == joint) {
            Some(c) => 2 * self.joints + self.compliant.len() + c,
            None => self.joints + joint,
        }
    }

    /// Writes the shafts' angles and velocities.
    fn read_shafts(&mut self, state: &[f64]) {
        let n = self.joints;
        self.shaft_rad.copy_from_slice(&state[..n]);
        self.shaft_rad_s.copy_from_slice(&state[n..2 * n]);
        for (c, j) in self.compliant.iter().enumerate() {
            self.shaft_rad[*j] = state[2 * n + c];
            self.shaft_rad_s[*j] = state[2 * n + self.compliant.len() + c];
        }
    }

    /// The velocity at which a dry contact slides, rad/s.
    pub fn sliding_rad_s(&self, contact: usize, state: &[f64]) -> f64 {
        if contact < self.joints {
            return state[self.shaft_velocity_index(contact)];
        }
        let rotor = &self.machine.couplings[contact - self.joints];
        rotor.ratios.iter().map(|(j, ratio)| ratio * state[self.shaft_velocity_index(*j)]).sum()
    }

    /// The velocity up to which a dry contact rests. Joints that stop are given no velocity at all, but one that
    /// is at the limit of its friction and kept in place by others moves as far as rounding has it; for coupled
    /// rotors it is the rounding of the sum.
    pub const fn rest_rad_s(&self, contact: usize) -> f64 {
        if contact < self.joints { 1e-9 } else { 1e-7 }
    }

    /// Whether a dry contact rests, whether or not it holds.
    pub fn rests(&self, contact: usize, state: &[f64]) -> bool {
        match self.modes[contact] {
            Mode::Absent => false,
            Mode::Holds => true,
            Mode::Slides(_) => self.sliding_rad_s(contact, state).abs() <= self.rest_rad_s(contact),
        }
    }

    /// The acceleration of a dry contact, given the state's rates.
    pub fn sliding_rad_s2(&self, contact: usize, rates: &[f64]) -> f64 {
        // The state's rates hold accelerations where the state holds velocities.
        self.sliding_rad_s(contact, rates)
    }

    /// The rates of the state at `time_s` in the present modes; fills drive torques, reactions and the levels
    /// that hold.
    pub fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Result<(), SimulationError> {
        let n = self.joints;
        self.read_shafts(state);
        let (q, qd) = (&state[..n], &state[n..2 * n]);
        let at = Instant {
            time_s,
            shaft_rad: &self.shaft_rad,
            shaft_rad_s: &self.shaft_rad_s,
            q_rad: q,
            qd_rad_s: qd,
            last_qdd_rad_s2: &self.last_qdd_rad_s2,
        };
        match &self.command {
            Command::Track(tracking) => tracking.torque_nm(
                time_s,
                at.shaft_rad,
                at.shaft_rad_s,
                (&self.drive_then_nm, time_s - self.then_s),
                &mut self.drive_nm,
            ),
            Command::Constant(torque_nm) => self.drive_nm.copy_from_slice(torque_nm),
        }

        self.link_nm.fill(0.0);
        for torque in &mut self.machine.link_torques {
            torque.add(&at, &mut self.link_nm);
        }
        self.net_nm.fill(0.0);
        for torque in &self.machine.shaft_torques {
            torque.add(&at, &mut self.net_nm);
        }
        for j in 0..n {
            let physics = &self.machine.joints[j];
            let velocity = at.shaft_rad_s[j];
            let [dry, fluid] = self.warmth_factor[j];
            let viscous = fluid * physics.viscous.torque_nm(velocity);
            let mut friction = viscous + self.probe_nm[j];
            self.share[j] = match self.modes[j] {
                Mode::Slides(direction) => {
                    friction += dry * physics.level_nm(j, &at, direction) * direction;
                    direction
                }
                Mode::Holds => 0.0,
                Mode::Absent => match &physics.bristle {
                    Some(bristle) => {
                        let level_nm =
                            dry * physics.level_nm(j, &at, if velocity < 0.0 { -1.0 } else { 1.0 });
                        let way = Stretch {
                            moved_rad: at.shaft_rad[j] - self.shaft_then_rad[j],
                            elapsed_s: time_s - self.then_s,
                            velocity_rad_s: velocity,
                            level_nm,
                        };
                        let [torque, beside] = bristle.torque_nm(&self.bristles[j], way);
                        friction += torque + beside;
                        if level_nm > 0.0 { (torque / level_nm).clamp(-1.0, 1.0) } else { 0.0 }
                    }
                    None => 0.0,
                },
            };
            self.friction_w[j] = friction * velocity;
            self.net_nm[j] = self.drive_nm[j] - friction - self.net_nm[j];
        }
        for (k, rotor) in self.machine.couplings.iter().enumerate() {
            let velocity: f64 = rotor.ratios.iter().map(|(j, r)| r * at.shaft_rad_s[*j]).sum();
            let dry = match self.modes[n + k] {
                Mode::Slides(direction) => rotor.coulomb_nm * direction,
                Mode::Holds | Mode::Absent => 0.0,
            };
            let friction = rotor.viscous_nm_s * velocity + dry + self.probe_nm[n + k];
            for (j, ratio) in &rotor.ratios {
                self.net_nm[*j] -= ratio * friction;
            }
        }
        self.accelerate(state, rates)?;
        self.note_holding_levels(time_s, state);
        // The rates of a joint that holds are zero whatever acts on it.
        let acting = |j: &usize| {
            [self.net_nm[*j], self.qdd_rad_s2[*j], rates[*j], rates[self.shaft_velocity_index(*j)]]
        };
        match (0..n).find(|j| !acting(j).iter().all(|value| value.is_finite())) {
            Some(joint) => Err(self.not_finite(joint, time_s, "torque")),
            None => Ok(()),
        }
    }

    /// What no integration can follow: a torque of a contact that is too large for a number, or no number.
    pub fn not_finite(&self, contact: usize, time_s: f64, what: &str) -> SimulationError {
        let rotor = contact.checked_sub(self.joints).map(|k| &self.machine.couplings[k]);
        let joint = rotor.map_or(contact, |rotor| rotor.ratios.first().map_or(0, |(joint, _)| *joint));
        let reason = format!(
            "its {what} is not finite; a value of the robot, the controller or an effect is far too large or too small"
        );
        SimulationError::Diverged { joint, time_s, reason }
    }

    /// Accelerations from the net torques on the shafts, load-dependent friction solved for.
    ///
    /// A gear with the friction c |τ_J| sgn q̇ needs the torque (1 + c s σ) τ_J, with s the direction of motion
    /// and σ the sign of the load: linear once σ is known. σ is taken from the last evaluation and revised
    /// until it agrees with the result.
    fn accelerate(&mut self, state: &[f64], rates: &mut [f64]) -> Result<(), SimulationError> {
        let n = self.joints;
        for _ in 0..LOAD_ITERATIONS {
            for j in 0..n {
                let physics = &self.machine.joints[j];
                let share = self.share[j];
                let direction = if share < 0.0 { -1.0 } else { 1.0 };
                let coefficient = physics.load_coefficient(direction, self.load_sign[j]);
                self.divisor[j] = 1.0 + coefficient * share * self.load_sign[j];
                let rotor = self.machine.robot.drives[j].rotor_inertia_kg_m2;
                (self.torque_nm[j], self.rotors_kg_m2[j]) = if physics.gear != Gear::Rigid {
                    (self.gear_nm(state, j) + self.link_nm[j], 0.0)
                } else if self.modes[j] == Mode::Holds {
                    (self.net_nm[j] + self.link_nm[j], LOCKED_KG_M2)
                } else {
                    (self.net_nm[j] / self.divisor[j] + self.link_nm[j], rotor / self.divisor[j])
                };
            }
            let (q, qd) = (&state[..n], &state[n..2 * n]);
            self.arm.accelerations(q, qd, &self.torque_nm, &self.rotors_kg_m2, &mut self.qdd_rad_s2)?;
            if !self.machine.couplings.is_empty() {
                self.couple(q)?;
            }
            if !self.revise_load_signs(state) {
                break;
            }
        }
        rates[..n].copy_from_slice(&state[n..2 * n]);
        for j in 0..n {
            let held = self.modes[j] == Mode::Holds && self.machine.joints[j].gear == Gear::Rigid;
            rates[n + j] = if held { 0.0 } else { self.qdd_rad_s2[j] };
        }
        let shafts = self.compliant.len();
        for (c, j) in self.compliant.iter().enumerate() {
            rates[2 * n + c] = state[2 * n + shafts + c];
            let needed = self.divisor[*j] * self.gear_nm(state, *j);
            let rotor = self.machine.robot.drives[*j].rotor_inertia_kg_m2;
            rates[2 * n + shafts + c] =
                if self.modes[*j] == Mode::Holds { 0.0 } else { (self.net_nm[*j] - needed) / rotor };
        }
        Ok(())
    }

    /// The torque that a compliant gear transmits.
    pub fn gear_nm(&self, state: &[f64], joint: usize) -> f64 {
        let n = self.joints;
        let twist = self.shaft_rad[joint] - state[joint];
        let twist_rate = self.shaft_rad_s[joint] - state[n + joint];
        self.machine.joints[joint].gear.torque_nm(twist, twist_rate)
    }

    /// Takes the sign of each transmitted load from the result; whether one that matters has changed.
    fn revise_load_signs(&mut self, state: &[f64]) -> bool {
        let mut changed = false;
        for j in 0..self.joints {
            let physics = &self.machine.joints[j];
            if physics.load_coefficient == [0.0; 2] {
                continue;
            }
            let load = self.load_nm(state, j);
            if load * self.load_sign[j] < 0.0 {
                self.load_sign[j] = -self.load_sign[j];
                changed |= self.share[j] != 0.0;
            }
        }
        changed
    }

    /// The torque that a joint transmits to its link.
    pub fn load_nm(&self, state: &[f64], joint: usize) -> f64 {
        if self.machine.joints[joint].gear != Gear::Rigid {
            return self.gear_nm(state, joint);
        }
        let inertial = self.rotors_kg_m2[joint] * self.qdd_rad_s2[joint];
        self.torque_nm[joint] - inertial - self.link_nm[joint] - self.coupling_nm[joint] / self.divisor[joint]
    }

    /// Adds the coupled rotors: M + Σ I a aᵀ, by the Sherman–Morrison–Woodbury identity.
    fn couple(&mut self, q_rad: &[f64]) -> Result<(), SimulationError> {
        let n = self.joints;
        let count = self.machine.couplings.len();
        let mut system = nalgebra::DMatrix::<f64>::zeros(count, count);
        let mut right = nalgebra::DVector::<f64>::zeros(count);
        for k in 0..count {
            self.along_nm.fill(0.0);
            for (j, ratio) in &self.machine.couplings[k].ratios {
                self.along_nm[*j] += ratio / self.divisor[*j];
            }
            let response = &mut self.coupling_response[k];
            self.arm.response(q_rad, &self.along_nm, &self.rotors_kg_m2, response)?;
        }
        for (k, rotor) in self.machine.couplings.iter().enumerate() {
            let along = |x: &[f64]| rotor.ratios.iter().map(|(j, ratio)| ratio * x[*j]).sum::<f64>();
            for l in 0..count {
                system[(k, l)] = along(&self.coupling_response[l]);
            }
            let inertia = if self.modes[n + k] == Mode::Holds { LOCKED_KG_M2 } else { rotor.inertia_kg_m2 };
            system[(k, k)] += 1.0 / inertia.max(1e-12);
            right[k] = along(&self.qdd_rad_s2);
            // Joints that all hold bear what there is to bear; a rotor between them has nothing to hold.
            if self.modes[n + k] == Mode::Holds
                && rotor.ratios.iter().all(|(j, _)| self.modes[*j] == Mode::Holds)
            {
                system.row_mut(k).fill(0.0);
                system[(k, k)] = 1.0;
                right[k] = 0.0;
            }
        }
        let Some(torque) = system.lu().solve(&right) else {
            return Ok(());
        };
        self.coupling_nm.fill(0.0);
        for k in 0..count {
            if self.modes[n + k] == Mode::Holds {
                self.reaction_nm[n + k] = torque[k];
            }
            for (j, ratio) in &self.machine.couplings[k].ratios {
                self.coupling_nm[*j] += ratio * torque[k];
            }
            for (a, r) in self.qdd_rad_s2.iter_mut().zip(&self.coupling_response[k]) {
                *a -= torque[k] * r;
            }
        }
        Ok(())
    }

    /// Makes the present evaluation the start of the next step.
    pub fn complete(&mut self, time_s: f64, state: &[f64], rates: &[f64]) {
        let n = self.joints;
        self.read_shafts(state);
        let dt_s = time_s - self.then_s;
        for j in 0..n {
            let velocity = self.shaft_rad_s[j];
            let physics = &self.machine.joints[j];
            if let Some(bristle) = &physics.bristle {
                let at = self.instant(time_s, state);
                let direction = if velocity < 0.0 { -1.0 } else { 1.0 };
                let way = Stretch {
                    moved_rad: self.shaft_rad[j] - self.shaft_then_rad[j],
                    elapsed_s: dt_s,
                    velocity_rad_s: velocity,
                    level_nm: self.warmth_factor[j][0] * physics.level_nm(j, &at, direction),
                };
                bristle.advance(&mut self.bristles[j], way);
            }
            if let Some(warmth) = &physics.warmth {
                self.warmth_k[j] = warmth.advance(self.warmth_k[j], self.friction_w[j], dt_s);
                self.warmth_factor[j] = warmth.factors(self.warmth_k[j][0]);
            }
        }
        self.then_s = time_s;
        self.shaft_then_rad.copy_from_slice(&self.shaft_rad);
        self.drive_then_nm.copy_from_slice(&self.drive_nm);
        self.last_qdd_rad_s2.copy_from_slice(&rates[n..2 * n]);
    }
}
