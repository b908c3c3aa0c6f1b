//! How laboratories differ: sensors, servos, clocks, motions, and what whoever writes the experiment chooses.

use std::f64::consts::TAU;

use super::super::layout::{Role, Slot, planned};
use super::noise::equivalent_nm;
use aurt_simulation::plant::Controller;
use aurt_simulation::robots::Robot;
use aurt_simulation::sensors::{ClockFaults, DriveRipple, Instrument, Logger, NoiseMemory};
use aurt_simulation::trajectory::Motion;
use aurt_simulation::{Random, SimulationError};

/// Rows per second that loggers are usually set to, Hz; a few are set to something else between 100 and 1000.
const USUAL_RATES_HZ: [f64; 5] = [100.0, 125.0, 250.0, 500.0, 1000.0];
/// Shortest recording with moves between poses, s: slow arms need some 5 s for a move.
const POSES_FROM_S: f64 = 16.0;
/// Noise over the usual from which a user filters lower.
const NOISY: f64 = 2.0;
/// Lowest f_dyn over the motion's highest frequency, and in Hz, that a user filters down to.
const LOWEST_F_DYN: (f64, f64) = (2.0, 1.5);
/// Highest f_dyn over the sampling rate: a tenth is the most that preprocessing takes.
const HIGHEST_F_DYN: f64 = 0.06;
/// Largest amplitude of the drives' ripple over the noise of [`equivalent_nm`].
const LARGEST_RIPPLE: f64 = 0.12;

/// Servos of 5–60 Hz, damped by 0.3–1, that know part of the arm's weight and little of its friction: every reversal
/// shakes them.
pub(super) fn controller(random: &mut Random) -> Controller {
    Controller {
        bandwidth_hz: random.between_logs(5.0, 60.0),
        damping_ratio: random.between(0.3, 1.0),
        feed_forward: random.between(0.6, 1.0),
        friction_feed_forward: random.between(0.0, 0.8),
        friction_width_rad_s: random.between_logs(5e-4, 0.02),
    }
}

/// 100–1000 rows per second, jitter of 0–6 % of the period, up to 0.5 % of the rows lost, stamps to the microsecond.
pub(super) fn logger(random: &mut Random) -> Logger {
    let usual = USUAL_RATES_HZ[random.index(USUAL_RATES_HZ.len())];
    let other = random.between_logs(100.0, 1000.0);
    let rate_hz = if random.chance(0.7) { usual } else { other };
    let jitter = random.between(0.0, 0.06);
    let missing_share = random.between(0.0, 0.005);
    let loses = random.chance(0.6);
    Logger {
        rate_hz,
        clock_jitter_s: jitter / rate_hz,
        time_decimals: 6,
        faults: ClockFaults {
            missing_share: if loses { missing_share } else { 0.0 },
            ..ClockFaults::default()
        },
        ..Logger::default()
    }
}

/// Encoders of 12–20 bit a turn with noise of 1e-6–1e-4 rad; current noise of half to twice the robot's own, with a
/// tenth to a half of it remembered for 10 ms to 1 s.
pub(super) fn instrument(robot: &Robot, random: &mut Random) -> Instrument {
    let mut instrument = Instrument::of(robot);
    let bits = 12 + random.index(9);
    let encoder_noise_rad = random.between_logs(1e-6, 1e-4);
    let (level, time_constant_s) = (random.between_logs(0.5, 2.0), random.between_logs(0.01, 1.0));
    let remembered = random.between(0.1, 0.5);
    for channel in &mut instrument.channels {
        channel.encoder_resolution_rad = TAU / (1_u64 << bits) as f64;
        channel.encoder_noise_rad = encoder_noise_rad;
        channel.torque_noise_nm *= level * random.between(0.8, 1.2);
        channel.memory = NoiseMemory { deviation_nm: remembered * channel.torque_noise_nm, time_constant_s };
    }
    instrument
}

/// Ripple of the commutation, once or twice a motor's revolution, small against the noise.
pub(super) fn add_ripple(instrument: &mut Instrument, robot: &Robot, random: &mut Random) {
    for (channel, drive) in instrument.channels.iter_mut().zip(&robot.drives) {
        channel.ripple = DriveRipple {
            amplitude_nm: random.between(0.02, LARGEST_RIPPLE) * drive.torque_noise_nm,
            order: drive.gear_ratio * (1 + random.index(2)) as f64,
            phase_rad: random.between(0.0, TAU),
        };
    }
}

/// f_dyn as a user chooses it: several times what the motion has, below what the rate allows, and lower where the
/// encoders' noise would drown everything; in steps of half a hertz.
pub(super) fn f_dyn_hz(
    robot: &Robot,
    instrument: &Instrument,
    rate_hz: f64,
    top_hz: f64,
    random: &mut Random,
) -> Result<f64, SimulationError> {
    let highest_hz = HIGHEST_F_DYN * rate_hz;
    let lowest_hz = ((2.0 * LOWEST_F_DYN.0 * top_hz).ceil() / 2.0).max(LOWEST_F_DYN.1).min(highest_hz);
    let halves = |hz: f64| ((2.0 * hz).round() / 2.0).clamp(lowest_hz, highest_hz);
    let mut chosen_hz = halves(top_hz * random.between(4.0, 8.0));
    loop {
        let noise = equivalent_nm(robot, instrument, rate_hz, chosen_hz)?;
        let over = noise.iter().zip(&robot.drives).map(|(n, d)| n / d.torque_noise_nm.max(1e-9));
        let worst = over.fold(0.0, f64::max);
        if worst <= NOISY || chosen_hz <= lowest_hz {
            return Ok(chosen_hz);
        }
        chosen_hz = (chosen_hz - 0.5).max(lowest_hz);
    }
}

/// One to five recordings of 10–60 s, two or more where something is to have changed, and the highest frequency that
/// their motions ask for. With few there is nothing to validate with.
pub(super) fn slots(
    robot: &Robot,
    later: bool,
    random: &mut Random,
) -> Result<(Vec<Slot>, f64), SimulationError> {
    use Role::{Calibration as C, Target as T, Validation as V};
    let roles: &[Role] = if later {
        [&[C, T][..], &[C, C, T], &[C, T, V], &[C, C, T, V], &[C, C, T, T, V]][random.index(5)]
    } else {
        [&[C][..], &[C, C], &[C, V], &[C, C, V], &[C, C, C, V], &[C, C, C, V, V]][random.index(6)]
    };
    let top_hz = random.between_logs(0.4, 2.0);
    // Some only ever let their arm swing, some only let it work; most do both.
    let habit = random.index(4);
    let slots = roles
        .iter()
        .map(|role| {
            let duration_s = random.between_logs(10.0, 60.0);
            let share = random.between(0.4, 0.75);
            let harmonics = 4 + random.index(9);
            let rest_s = random.between(0.3, 1.5);
            let top_hz = top_hz * random.between(0.7, 1.0);
            let other = random.index(3);
            let kind = [0, 1, other, other][habit];
            let motion = match kind {
                1 if duration_s >= POSES_FROM_S => Motion::PointToPoint { duration_s, share, rest_s },
                2 if duration_s >= 1.5 * POSES_FROM_S => {
                    Motion::Mixed { duration_s, harmonics, top_hz, share, rest_s }
                }
                _ => Motion::MultiSine { duration_s, harmonics, top_hz, share },
            };
            let (seed, trajectory) = planned(&motion, robot, random)?;
            Ok(Slot { role: *role, trajectory, affected: !later || *role != C, seed })
        })
        .collect::<Result<_, SimulationError>>()?;
    // Moves between poses take a second or two, and their torque has harmonics of that.
    Ok((slots, top_hz.max(0.7)))
}

#[cfg(test)]
mod tests {
    use super::super::noise::BAND_PER_F_DYN;
    use super::*;
    use aurt_simulation::robots;

    /// Ranges are used from end to end, and what a user chooses can be preprocessed.
    #[test]
    fn laboratories_differ() {
        let robot = robots::ur5e();
        let (mut rates, mut chosen, mut steps) = (Vec::new(), Vec::new(), Vec::new());
        for seed in 0..200 {
            let mut random = Random::new(seed);
            controller(&mut random).validate().unwrap();
            let logger = logger(&mut random);
            logger.validate().unwrap();
            assert!((100.0..=1000.0).contains(&logger.rate_hz));
            assert!((0.0..=0.06).contains(&(logger.clock_jitter_s * logger.rate_hz)));
            let instrument = instrument(&robot, &mut random);
            instrument.validate().unwrap();
            let f_dyn_hz = f_dyn_hz(&robot, &instrument, logger.rate_hz, 1.0, &mut random).unwrap();
            assert!(f_dyn_hz < 0.1 * logger.rate_hz && f_dyn_hz >= LOWEST_F_DYN.1, "{f_dyn_hz}");
            assert!(BAND_PER_F_DYN * f_dyn_hz < 0.5 * logger.rate_hz);
            rates.push(logger.rate_hz);
            chosen.push(f_dyn_hz);
            steps.push(instrument.channels[0].encoder_resolution_rad);
        }
        let distinct = |values: &mut Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.dedup();
            values.len()
        };
        assert!(distinct(&mut rates) > 40 && distinct(&mut steps) == 9 && distinct(&mut chosen) > 6);
    }

    #[test]
    fn recordings_are_one_to_five_of_10_to_60_s() {
        let robot = robots::two_link();
        let mut counts = [0; 6];
        for seed in 0..60 {
            let later = seed % 2 == 0;
            let (slots, _) = slots(&robot, later, &mut Random::new(seed)).unwrap();
            counts[slots.len()] += 1;
            assert!(slots.iter().all(|s| (10.0..=60.0).contains(&s.trajectory.duration_s())));
            assert_eq!(slots.iter().any(|s| s.role == Role::Target), later);
            assert!(slots.iter().any(|s| s.role == Role::Calibration));
        }
        assert!(counts[1..].iter().all(|c| *c > 0), "{counts:?}");
    }
}
