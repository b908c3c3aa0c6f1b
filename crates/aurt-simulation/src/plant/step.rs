//! Steps from event to event: the classical Runge–Kutta method of order four between them; reversals,
//! sticking and break-away located and resolved.

use super::dynamics::{Mode, Plant};
use crate::SimulationError;
use crate::plant::machine::Gear;

/// Accuracy of the times of events, s.
const EVENT_S: f64 = 2e-7;
/// Events within one step after which the rest of it is taken as a whole.
const MOST_EVENTS: usize = 40;
/// Excess over a holding level that rounding explains, relative.
const HOLD_SLACK: f64 = 1e-9;

/// Integrates a [`Plant`].
#[derive(Debug)]
pub(crate) struct Integrator {
    pub time_s: f64,
    pub state: Vec<f64>,
    /// Rates of the state at `time_s`.
    pub rates: Vec<f64>,
    trial: Vec<f64>,
    trial_rates: Vec<f64>,
    k: [Vec<f64>; 3],
    /// Number of evaluations of the rates so far.
    pub evaluations: u64,
    /// Number of events resolved so far.
    pub events: u64,
}

impl Integrator {
    /// Starts at rest or in motion at time 0 with q and q̇; the shafts start where gravity leaves the gears
    /// without twist.
    pub fn new(plant: &mut Plant, q_rad: &[f64], qd_rad_s: &[f64]) -> Result<Self, SimulationError> {
        let n = plant.joints;
        let mut state = vec![0.0; plant.state_len()];
        state[..n].copy_from_slice(q_rad);
        state[n..2 * n].copy_from_slice(qd_rad_s);
        let shafts = plant.compliant.len();
        for (c, j) in plant.compliant.iter().enumerate() {
            state[2 * n + c] = q_rad[*j];
            state[2 * n + shafts + c] = qd_rad_s[*j];
        }
        for contact in 0..plant.modes.len() {
            let velocity = plant.sliding_rad_s(contact, &state);
            if plant.modes[contact] != Mode::Absent && velocity != 0.0 {
                plant.modes[contact] = Mode::Slides(velocity.signum());
            }
        }
        let length = state.len();
        let zeros = || vec![0.0; length];
        let mut integrator = Self {
            time_s: 0.0,
            rates: zeros(),
            trial: zeros(),
            trial_rates: zeros(),
            k: [zeros(), zeros(), zeros()],
            state,
            evaluations: 0,
            events: 0,
        };
        plant.shaft_then_rad.copy_from_slice(q_rad);
        // The drives start with whatever torque the controller asks for, as after a long time.
        plant.then_s = -1e9;
        plant.rates(0.0, &integrator.state, &mut integrator.rates)?;
        plant.drive_then_nm.copy_from_slice(&plant.drive_nm);
        plant.then_s = 0.0;
        integrator.settle(plant)?;
        plant.drive_then_nm.copy_from_slice(&plant.drive_nm);
        Ok(integrator)
    }

    /// Moves on to `end_s`, through every event on the way.
    pub fn advance(&mut self, plant: &mut Plant, end_s: f64) -> Result<(), SimulationError> {
        let mut events = 0;
        loop {
            let span_s = end_s - self.time_s;
            let at_start = margin(plant, &self.state);
            self.attempt(plant, span_s)?;
            let at_end = margin(plant, &self.trial);
            if events >= MOST_EVENTS || at_end >= 0.0 {
                self.accept(plant, end_s);
                if events >= MOST_EVENTS {
                    self.follow_velocities(plant);
                    self.settle(plant)?;
                }
                return Ok(());
            }
            events += 1;
            self.events += 1;
            let after_s = self.locate(plant, at_start, (span_s, at_end))?;
            let time_s = if after_s == span_s { end_s } else { self.time_s + after_s };
            self.resolve(plant);
            self.accept(plant, time_s);
            self.settle(plant)?;
            if time_s >= end_s {
                return Ok(());
            }
        }
    }

    /// The earliest time at which a contact is violated, from above, within [`EVENT_S`]; the step to there is
    /// left as the attempted one. Secants (Illinois) and halvings in turn.
    fn locate(
        &mut self,
        plant: &mut Plant,
        at_start: f64,
        (end_s, at_end): (f64, f64),
    ) -> Result<f64, SimulationError> {
        let (mut before_s, mut before) = (0.0, at_start.max(0.0));
        let (mut after_s, mut after) = (end_s, at_end);
        let mut attempted_s = end_s;
        for turn in 0.. {
            let width_s = after_s - before_s;
            if width_s <= EVENT_S {
                break;
            }
            let secant_s = before_s + width_s * before / (before - after);
            let middle_s = if turn % 3 == 2 { before_s + 0.5 * width_s } else { secant_s };
            // A secant that falls onto an end is moved inwards by the width that is asked for.
            let middle_s = middle_s.clamp(before_s + 0.5 * EVENT_S, after_s - 0.5 * EVENT_S);
            self.attempt(plant, middle_s)?;
            attempted_s = middle_s;
            let value = margin(plant, &self.trial);
            if value < 0.0 {
                (after_s, after) = (middle_s, value);
                before *= 0.5;
            } else {
                (before_s, before) = (middle_s, value);
                after *= 0.5;
            }
        }
        if attempted_s != after_s {
            self.attempt(plant, after_s)?;
        }
        Ok(after_s)
    }

    /// One step of the classical Runge–Kutta method into `trial`, with the rates at its end.
    fn attempt(&mut self, plant: &mut Plant, span_s: f64) -> Result<(), SimulationError> {
        let [k2, k3, k4] = &mut self.k;
        let (half, start) = (0.5 * span_s, self.time_s);
        let combine = |out: &mut Vec<f64>, state: &[f64], rates: &[f64], weight: f64| {
            for ((o, y), r) in out.iter_mut().zip(state).zip(rates) {
                *o = y + weight * r;
            }
        };
        combine(&mut self.trial, &self.state, &self.rates, half);
        plant.rates(start + half, &self.trial, k2)?;
        combine(&mut self.trial, &self.state, k2, half);
        plant.rates(start + half, &self.trial, k3)?;
        combine(&mut self.trial, &self.state, k3, span_s);
        plant.rates(start + span_s, &self.trial, k4)?;
        let sixth = span_s / 6.0;
        for i in 0..self.trial.len() {
            self.trial[i] = self.state[i] + sixth * (self.rates[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
        }
        plant.rates(start + span_s, &self.trial, &mut self.trial_rates)?;
        self.evaluations += 4;
        Ok(())
    }

    /// Changes the modes of the contacts that are violated at the end of the attempted step.
    fn resolve(&mut self, plant: &mut Plant) {
        for contact in 0..plant.modes.len() {
            if contact_margin(plant, contact, &self.trial) >= 0.0 {
                continue;
            }
            match plant.modes[contact] {
                Mode::Slides(_) => {
                    plant.modes[contact] = Mode::Holds;
                    if contact < plant.joints {
                        let velocity = plant.shaft_velocity_index(contact);
                        self.trial[velocity] = 0.0;
                    }
                }
                Mode::Holds => plant.modes[contact] = Mode::Slides(plant.reaction_nm[contact].signum()),
                Mode::Absent => {}
            }
        }
    }

    fn accept(&mut self, plant: &mut Plant, time_s: f64) {
        std::mem::swap(&mut self.state, &mut self.trial);
        std::mem::swap(&mut self.rates, &mut self.trial_rates);
        self.time_s = time_s;
        plant.complete(time_s, &self.state, &self.rates);
    }

    /// Finds modes that agree with the accelerations: a holding contact that bears too much lets go, the
    /// worst one first; one that was let go and is pushed back holds again.
    fn settle(&mut self, plant: &mut Plant) -> Result<(), SimulationError> {
        let contacts = plant.modes.len();
        for _ in 0..4 * contacts + 1 {
            plant.rates(self.time_s, &self.state, &mut self.rates)?;
            self.evaluations += 1;
            let mut worst: Option<(usize, f64)> = None;
            for contact in 0..contacts {
                match plant.modes[contact] {
                    Mode::Absent => {}
                    Mode::Holds => {
                        let excess = plant.reaction_nm[contact].abs()
                            - plant.hold_nm[contact] * (1.0 + HOLD_SLACK)
                            - HOLD_SLACK;
                        if excess > 0.0 && worst.is_none_or(|(_, most)| excess > most) {
                            worst = Some((contact, excess));
                        }
                    }
                    Mode::Slides(direction) => {
                        let velocity = plant.sliding_rad_s(contact, &self.state);
                        let resting = velocity.abs() <= plant.rest_rad_s(contact);
                        if resting && direction * plant.sliding_rad_s2(contact, &self.rates) < 0.0 {
                            plant.modes[contact] = Mode::Holds;
                            worst = None;
                            break;
                        }
                    }
                }
            }
            match worst {
                Some((contact, _)) => {
                    plant.modes[contact] = Mode::Slides(plant.reaction_nm[contact].signum());
                }
                None if self.consistent(plant) => break,
                None => {}
            }
        }
        Ok(())
    }

    /// Whether no contact that slides at rest is pushed back.
    fn consistent(&self, plant: &Plant) -> bool {
        (0..plant.modes.len()).all(|contact| match plant.modes[contact] {
            Mode::Slides(direction) => {
                plant.sliding_rad_s(contact, &self.state).abs() > plant.rest_rad_s(contact)
                    || direction * plant.sliding_rad_s2(contact, &self.rates) >= 0.0
            }
            Mode::Holds | Mode::Absent => true,
        })
    }

    /// Gives every sliding contact the direction in which it moves.
    fn follow_velocities(&self, plant: &mut Plant) {
        for contact in 0..plant.modes.len() {
            let velocity = plant.sliding_rad_s(contact, &self.state);
            if let Mode::Slides(_) = plant.modes[contact]
                && velocity != 0.0
            {
                plant.modes[contact] = Mode::Slides(velocity.signum());
            }
        }
    }
}

/// How far the contact that is nearest to a change of mode is from it; negative beyond it.
fn margin(plant: &Plant, state: &[f64]) -> f64 {
    (0..plant.modes.len()).map(|contact| contact_margin(plant, contact, state)).fold(f64::INFINITY, f64::min)
}

/// The velocity that is left to a sliding contact before it rests, the torque that is left to a holding one
/// before it lets go.
fn contact_margin(plant: &Plant, contact: usize, state: &[f64]) -> f64 {
    match plant.modes[contact] {
        Mode::Absent => f64::INFINITY,
        Mode::Slides(direction) => {
            direction * plant.sliding_rad_s(contact, state) + plant.rest_rad_s(contact)
        }
        Mode::Holds => {
            plant.hold_nm[contact] * (1.0 + HOLD_SLACK) + HOLD_SLACK - plant.reaction_nm[contact].abs()
        }
    }
}

/// The step in s that resolves the plant's fastest rate, a divisor of `sample_s`.
///
/// # Errors
/// [`SimulationError::TooStiff`] below [`SMALLEST_STEP_S`].
pub(crate) fn step_s(plant: &mut Plant, home_rad: &[f64], sample_s: f64) -> Result<f64, SimulationError> {
    let n = plant.joints;
    let mut inertia = vec![0.0; n];
    let (mut unit, mut response) = (vec![0.0; n], vec![0.0; n]);
    let rotors: Vec<f64> = plant
        .machine
        .robot
        .drives
        .iter()
        .zip(&plant.machine.joints)
        .map(|(d, p)| if p.gear == Gear::Rigid { d.rotor_inertia_kg_m2 } else { 0.0 })
        .collect();
    for j in 0..n {
        unit.fill(0.0);
        unit[j] = 1.0;
        plant.arm.response(home_rad, &unit, &rotors, &mut response)?;
        inertia[j] = 1.0 / response[j].max(1e-12);
    }
    let mut fastest = (0.0_f64, String::new());
    let mut note = |rate: f64, what: &str, joint: usize| {
        if rate > fastest.0 {
            fastest = (rate, format!("{what} of joint {joint}"));
        }
    };
    for j in 0..n {
        let physics = &plant.machine.joints[j];
        let rotor = plant.machine.robot.drives[j].rotor_inertia_kg_m2;
        let shaft = match physics.gear {
            Gear::Rigid => inertia[j],
            Gear::Compliant { stiffness_nm_rad, damping_nm_s, .. } => {
                let both = rotor * inertia[j] / (rotor + inertia[j]);
                note((stiffness_nm_rad / both).sqrt(), "the gear", j);
                note(damping_nm_s / both, "the gear's damping", j);
                rotor
            }
        };
        note(physics.viscous.steepest_nm_s() / shaft, "viscous friction", j);
        if let Some(bristle) = &physics.bristle {
            let level = physics.coulomb_nm[0].max(physics.coulomb_nm[1]);
            note((bristle.stiffness_nm_rad(level) / shaft).sqrt(), "presliding stiffness", j);
            note(bristle.damping_nm_s() / shaft, "presliding damping", j);
        }
        let super::dynamics::Command::Track(tracking) = &plant.command;
        note(tracking.rate_per_s(j, shaft), "the control loop", j);
        for torque in &plant.machine.shaft_torques {
            note(torque.rate_per_s(&|i| if i == j { shaft } else { f64::INFINITY }), "an added torque", j);
        }
    }
    let (rate, what) = fastest;
    let wanted = STEP_PER_RATE / rate.max(1e-3);
    let pieces = (sample_s / wanted).ceil().max(1.0);
    let step = sample_s / pieces;
    if step < SMALLEST_STEP_S {
        let error =
            SimulationError::TooStiff { what, rate_per_s: rate, needed_s: step, smallest_s: SMALLEST_STEP_S };
        return Err(error);
    }
    Ok(step)
}

/// Step times fastest rate: the method is stable to 2.8, and at 0.4 its error per unit of time is 1e-4 of
/// the fastest mode's own motion.
const STEP_PER_RATE: f64 = 0.6;
/// Smallest step, s.
pub(crate) const SMALLEST_STEP_S: f64 = 2e-5;
