//! Which dry contacts hold at one instant, and which slide.
//!
//! Contacts at rest take the friction torques r that leave the least motion: with the accelerations a(r) = a₀ − A r
//! of the contacts, r minimises ½ rᵀ A r − a₀ᵀ r within the levels of friction (Coulomb's law as a complementarity
//! problem; Pang and Trinkle, *Complementarity formulations and existence of solutions of dynamic multi-rigid-body
//! contact problems with Coulomb friction*, Math. Programming 1996). A is symmetric and not negative, so there is
//! always a solution, and its accelerations are the only ones. A contact strictly within its level holds, one at
//! its level slides or is about to.

use nalgebra::{DMatrix, DVector};

use super::arm::LOCKED_KG_M2;
use super::dynamics::{Mode, Plant};
use super::machine::Gear;
use crate::error::SimulationError;

/// Excess over a level that rounding explains, relative and in Nm.
const SLACK: f64 = 1e-9;
/// How often levels that depend on the load are brought up to date.
const LOAD_PASSES: usize = 30;
/// Passes over several rotors whose torque their joints take over.
const RELIEFS: usize = 30;
/// Sweeps over the contacts at rest, and the change of friction, relative to the largest, at which they end.
const SWEEPS: (usize, f64) = (2000, 1e-13);

impl Plant {
    /// What a contact can still bear before it lets go, Nm; negative if it bears too much.
    pub fn spare_nm(&self, contact: usize) -> f64 {
        self.hold_nm[contact] * (1.0 + SLACK) + SLACK - self.reaction_nm[contact].abs()
    }

    /// Stops a contact: a joint by its own velocity, a coupled rotor by that of one of its joints that moves.
    pub fn stop(&self, contact: usize, state: &mut [f64]) {
        if contact < self.joints {
            state[self.shaft_velocity_index(contact)] = 0.0;
            return;
        }
        let left = self.sliding_rad_s(contact, state);
        let rotor = &self.machine.couplings[contact - self.joints];
        let moving =
            rotor.ratios.iter().find(|(joint, ratio)| self.modes[*joint] != Mode::Holds && *ratio != 0.0);
        if let Some((joint, ratio)) = moving {
            state[self.shaft_velocity_index(*joint)] -= left / ratio;
        }
    }

    /// Gives the contacts at rest modes that agree with each other and with the accelerations, and writes the
    /// rates. Returns how many evaluations of the rates that took: one if all can hold, else about as many as
    /// contacts rest.
    pub fn settle(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Result<u64, SimulationError> {
        let resting: Vec<usize> = (0..self.modes.len()).filter(|c| self.rests(*c, state)).collect();
        self.set_modes(&resting, |_| Mode::Holds);
        self.rates(time_s, state, rates)?;
        let mut evaluations = 1;
        if resting.iter().all(|contact| self.spare_nm(*contact) >= 0.0) {
            return Ok(evaluations);
        }
        let mut levels = self.levels_at_rest(&resting, time_s, state)?;
        let (free, yielding) = self.yielding(&resting, &levels, time_s, state, rates)?;
        evaluations += 1 + resting.len() as u64;
        let loaded = self.machine.joints.iter().any(|joint| joint.load_coefficient != [0.0; 2]);
        let mut modes = Vec::new();
        for pass in 0..LOAD_PASSES {
            let mut friction = friction_at_rest(&free, &yielding, &levels);
            self.relieve_rotors(&resting, &levels, &mut friction);
            let left = &free - &yielding * &friction;
            let found: Vec<Mode> =
                (0..resting.len()).map(|k| mode_under(friction[k], levels[k], left[k])).collect();
            let same = found == modes;
            modes = found;
            self.set_modes(&resting, |k| modes[k]);
            self.rates(time_s, state, rates)?;
            evaluations += 1;
            let now = self.levels_at_rest(&resting, time_s, state)?;
            let close = |a: &f64, b: &f64| (a - b).abs() <= SLACK * a.abs();
            let settled = now.iter().flatten().zip(levels.iter().flatten()).all(|(a, b)| close(a, b));
            levels = if pass < LOAD_PASSES / 2 {
                now
            } else {
                // Levels and loads that chase each other meet in the middle.
                let middle = |(a, b): (&[f64; 2], &[f64; 2])| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])];
                levels.iter().zip(&now).map(middle).collect()
            };
            if settled && (same || !loaded) {
                break;
            }
        }
        // Where load and friction chase each other, what is pushed back holds.
        for _ in 0..resting.len() {
            let scale = 1e-9 * free.amax().max(1.0);
            let back = |contact: &&usize| match self.modes[**contact] {
                Mode::Slides(direction) => direction * self.sliding_rad_s2(**contact, rates) < -scale,
                Mode::Holds | Mode::Absent => false,
            };
            let Some(contact) = resting.iter().find(back).copied() else { break };
            self.modes[contact] = Mode::Holds;
            self.rates(time_s, state, rates)?;
            evaluations += 1;
        }
        Ok(evaluations)
    }

    /// Where a rotor and all its joints rest, it is open who bears how much. The joints bear what they can.
    fn relieve_rotors(&self, resting: &[usize], levels: &[[f64; 2]], friction: &mut DVector<f64>) {
        let rotors: Vec<usize> = (0..resting.len()).filter(|k| resting[*k] >= self.joints).collect();
        // What relieves one rotor may make room for another.
        for _ in 0..RELIEFS.min(rotors.len() * rotors.len()) {
            for k in &rotors {
                self.relieve_rotor(*k, resting, levels, friction);
            }
        }
    }

    fn relieve_rotor(&self, k: usize, resting: &[usize], levels: &[[f64; 2]], friction: &mut DVector<f64>) {
        let rotor = &self.machine.couplings[resting[k] - self.joints];
        let place = |joint: &usize| resting.iter().position(|c| c == joint);
        let placed = |(joint, ratio): &(usize, f64)| place(joint).map(|place| (place, *ratio));
        let Some(shares) = rotor.ratios.iter().map(placed).collect::<Option<Vec<(usize, f64)>>>() else {
            return;
        };
        // How much of the rotor's torque its joints can take over before one of them is at its level.
        let direction = friction[k].signum();
        let mut most = friction[k].abs();
        for (place, ratio) in shares.iter().filter(|(_, ratio)| *ratio != 0.0) {
            let [low, high] = levels[*place];
            let room = if ratio * direction > 0.0 { high - friction[*place] } else { low + friction[*place] };
            most = most.min(room.max(0.0) / ratio.abs());
        }
        friction[k] -= direction * most;
        for (place, ratio) in shares {
            friction[place] += ratio * direction * most;
        }
    }

    fn set_modes(&mut self, contacts: &[usize], mode: impl Fn(usize) -> Mode) {
        for (k, contact) in contacts.iter().enumerate() {
            self.modes[*contact] = mode(k);
        }
    }

    /// a₀ and A of the contacts at rest: their accelerations without friction, and what friction takes off them.
    fn yielding(
        &mut self,
        resting: &[usize],
        levels: &[[f64; 2]],
        time_s: f64,
        state: &[f64],
        rates: &mut [f64],
    ) -> Result<(DVector<f64>, DMatrix<f64>), SimulationError> {
        let count = resting.len();
        self.set_modes(resting, |_| Mode::Absent);
        self.rates(time_s, state, rates)?;
        let free = DVector::from_fn(count, |k, _| self.sliding_rad_s2(resting[k], rates));
        let mut yielding = DMatrix::zeros(count, count);
        for (l, contact) in resting.iter().enumerate() {
            // A probe of the size of the level: the difference keeps its digits.
            let probe_nm = levels[l][1].max(1e-3);
            self.probe_nm[*contact] = probe_nm;
            let evaluated = self.rates(time_s, state, rates);
            self.probe_nm[*contact] = 0.0;
            evaluated?;
            for (k, other) in resting.iter().enumerate() {
                yielding[(k, l)] = (free[k] - self.sliding_rad_s2(*other, rates)) / probe_nm;
            }
        }
        Ok((free, yielding))
    }

    /// The levels of friction of all contacts at rest.
    fn levels_at_rest(
        &self,
        resting: &[usize],
        time_s: f64,
        state: &[f64],
    ) -> Result<Vec<[f64; 2]>, SimulationError> {
        let finite = |contact: &usize| {
            let levels = self.levels_nm(*contact, time_s, state);
            let fine = levels.iter().all(|level| level.is_finite());
            fine.then_some(levels).ok_or_else(|| self.not_finite(*contact, time_s, "friction"))
        };
        resting.iter().map(finite).collect()
    }

    /// The levels of friction of a contact at rest against motion in the negative and the positive direction, Nm,
    /// under the present load.
    fn levels_nm(&self, contact: usize, time_s: f64, state: &[f64]) -> [f64; 2] {
        let n = self.joints;
        if contact >= n {
            return [self.machine.couplings[contact - n].coulomb_nm; 2];
        }
        let at = self.instant(time_s, state);
        let physics = &self.machine.joints[contact];
        let load = self.load_nm(state, contact);
        [-1.0, 1.0].map(|direction| {
            self.warmth_factor[contact][0] * physics.level_nm(contact, &at, direction)
                + physics.load_coefficient(direction, load) * load.abs()
        })
    }

    /// Notes the reactions of contacts that hold, and what they can bear.
    pub fn note_holding_levels(&mut self, time_s: f64, state: &[f64]) {
        let n = self.joints;
        for j in 0..n {
            if self.modes[j] != Mode::Holds {
                continue;
            }
            self.reaction_nm[j] = if self.machine.joints[j].gear == Gear::Rigid {
                LOCKED_KG_M2 * self.qdd_rad_s2[j]
            } else {
                self.net_nm[j] - self.gear_nm(state, j)
            };
            let levels = self.levels_nm(j, time_s, state);
            self.hold_nm[j] = levels[usize::from(self.reaction_nm[j] >= 0.0)];
        }
        for (k, rotor) in self.machine.couplings.iter().enumerate() {
            self.hold_nm[n + k] = rotor.coulomb_nm;
        }
    }
}

/// The friction r of contacts at rest with the accelerations `free` − `yielding` r, within the levels, by
/// projected Gauss–Seidel sweeps.
fn friction_at_rest(free: &DVector<f64>, yielding: &DMatrix<f64>, levels: &[[f64; 2]]) -> DVector<f64> {
    let count = levels.len();
    let mut friction = DVector::<f64>::zeros(count);
    let mut left = free.clone();
    let (most, enough) = SWEEPS;
    for _ in 0..most {
        let mut change = 0.0_f64;
        for k in 0..count {
            let [low, high] = levels[k];
            let wanted = friction[k] + left[k] / yielding[(k, k)].max(1e-300);
            let step = wanted.clamp(-low, high) - friction[k];
            if step != 0.0 {
                friction[k] += step;
                left.axpy(-step, &yielding.column(k), 1.0);
                change = change.max(step.abs());
            }
        }
        if change <= enough * friction.amax() {
            break;
        }
    }
    friction
}

/// The mode of a contact under a friction torque between its levels; `left_rad_s2` is what is left of its
/// acceleration.
fn mode_under(friction_nm: f64, [low, high]: [f64; 2], left_rad_s2: f64) -> Mode {
    let slack = SLACK * (low + high);
    match (friction_nm <= slack - low, friction_nm >= high - slack) {
        (true, true) => Mode::Slides(if left_rad_s2 < 0.0 { -1.0 } else { 1.0 }),
        (true, false) => Mode::Slides(-1.0),
        (false, true) => Mode::Slides(1.0),
        (false, false) => Mode::Holds,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::dynamics::Command;
    use crate::plant::{CoupledRotor, Machine};
    use crate::random::Random;
    use crate::robots;

    fn state_at_rest(q_rad: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; 2 * q_rad.len()];
        state[..q_rad.len()].copy_from_slice(q_rad);
        state
    }

    /// Coulomb's law at every contact: within its level it does not move, at its level it is not pushed back.
    fn assert_coulomb(plant: &Plant, state: &[f64], rates: &[f64]) {
        let scale = 1e-6 * (1.0 + rates.iter().fold(0.0_f64, |m, r| m.max(r.abs())));
        for contact in 0..plant.modes.len() {
            match plant.modes[contact] {
                Mode::Holds => {
                    let level = plant.hold_nm[contact];
                    assert!(
                        plant.reaction_nm[contact].abs() <= level * (1.0 + 1e-6) + 1e-7,
                        "{contact}: {} {:?}",
                        plant.reaction_nm[contact],
                        plant.modes
                    );
                    assert!(plant.sliding_rad_s2(contact, rates).abs() < scale, "{contact} creeps");
                }
                Mode::Slides(direction) => {
                    assert_eq!(plant.sliding_rad_s(contact, state), 0.0);
                    assert!(
                        direction * plant.sliding_rad_s2(contact, rates) > -scale,
                        "{contact} is pushed back"
                    );
                }
                Mode::Absent => panic!("{contact} is gone"),
            }
        }
    }

    /// A UR10e under random torques, with random levels of friction and rotors that turn with two joints.
    fn random_plant(random: &mut Random, load_coefficient: f64) -> (Plant, Vec<f64>) {
        let mut robot = robots::ur10e();
        for drive in &mut robot.drives {
            drive.coulomb_nm *= random.between(0.02, 2.0);
            drive.load_coefficient = load_coefficient;
        }
        let mut machine = Machine::new(&robot);
        // Two at most, on joints of their own or with one in common.
        for first in [0, 3].iter().take(random.index(3)) {
            let joint = first + random.index(2);
            machine.couplings.push(CoupledRotor {
                ratios: vec![(joint, 1.0), (joint + 1, random.sign() * random.between(0.3, 1.5))],
                inertia_kg_m2: random.between(0.0, 0.1),
                viscous_nm_s: 0.5,
                coulomb_nm: random.between(0.2, 10.0),
            });
        }
        if random.chance(0.5) {
            machine.robot.gravity_m_s2 = [0.0; 3];
        }
        let size = libm::exp(random.between(-5.0, 0.7));
        let torque =
            robot.drives.iter().map(|d| size * random.between(-0.3, 0.3) * d.torque_limit_nm).collect();
        let q: Vec<f64> = robot.drives.iter().map(|d| d.home_rad + random.between(-1.0, 1.0)).collect();
        (Plant::new(machine, Command::Constant(torque)).unwrap(), state_at_rest(&q))
    }

    #[test]
    fn friction_at_rest_obeys_coulombs_law() {
        let mut kinds = [0; 3];
        for seed in 0..400 {
            let mut random = Random::labelled(seed, "contacts");
            let (mut plant, state) = random_plant(&mut random, 0.0);
            let mut rates = vec![0.0; state.len()];
            let evaluations = plant.settle(0.0, &state, &mut rates).unwrap();
            assert!(evaluations <= 4 + plant.modes.len() as u64, "{evaluations} evaluations");
            assert_coulomb(&plant, &state, &rates);
            let holding = plant.modes.iter().filter(|m| **m == Mode::Holds).count();
            kinds[if holding == 0 {
                0
            } else if holding == plant.modes.len() {
                2
            } else {
                1
            }] += 1;
        }
        // All can hold, all can slide, and there is everything between.
        assert!(kinds.iter().all(|k| *k > 20), "{kinds:?}");
    }

    #[test]
    fn the_same_with_friction_that_grows_with_the_load() {
        for seed in 0..200 {
            let mut random = Random::labelled(seed, "loaded contacts");
            let (mut plant, state) = random_plant(&mut random, 0.15);
            let mut rates = vec![0.0; state.len()];
            let evaluations = plant.settle(0.0, &state, &mut rates).unwrap();
            assert!(evaluations <= 35 + plant.modes.len() as u64, "{evaluations} evaluations");
            assert_coulomb(&plant, &state, &rates);
        }
    }

    /// Two joints that rest by themselves leave a rotor between them nothing to hold; where they need its help,
    /// it helps.
    #[test]
    fn a_coupled_rotor_helps_only_where_it_has_to() {
        let mut robot = robots::two_link();
        robot.gravity_m_s2 = [0.0; 3];
        let settled = |torque: [f64; 2], coulomb_nm: f64| {
            let mut machine = Machine::new(&robot);
            machine.couplings.push(CoupledRotor {
                ratios: vec![(0, 1.0), (1, 1.0)],
                inertia_kg_m2: 0.01,
                viscous_nm_s: 0.0,
                coulomb_nm,
            });
            let mut plant = Plant::new(machine, Command::Constant(torque.to_vec())).unwrap();
            let state = state_at_rest(&[0.3, 0.4]);
            let mut rates = vec![0.0; 4];
            plant.settle(0.0, &state, &mut rates).unwrap();
            assert_coulomb(&plant, &state, &rates);
            (plant, rates)
        };
        let [first, second] = [robot.drives[0].coulomb_nm, robot.drives[1].coulomb_nm];
        let (plant, _) = settled([0.9 * first, -0.9 * second], 5.0);
        assert_eq!(plant.reaction_nm[2], 0.0);
        // Joint 1 alone would let go; the rotor bears what is too much, as joint 0 can bear the rotor's share.
        let (plant, rates) = settled([0.0, second + 2.0], 5.0);
        assert!((plant.reaction_nm[2] - 2.0).abs() < 1e-6, "{:?}", plant.reaction_nm);
        assert!(rates[2].abs() < 1e-9 && rates[3].abs() < 1e-9, "{rates:?}");
        // A rotor that can bear less lets it go.
        let (_, rates) = settled([0.0, second + 2.0], 1.5);
        assert!(rates[3] > 0.1, "{rates:?}");
    }
}
