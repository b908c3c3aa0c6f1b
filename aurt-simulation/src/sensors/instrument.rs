use serde::{Deserialize, Serialize};

use super::current::{DriveRipple, NoiseMemory};
use crate::error::{Complaints, SimulationError};
use crate::robots::Robot;

/// The sensors of one joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// Encoder step, rad; 0 for none.
    pub encoder_resolution_rad: f64,
    /// Standard deviation of the encoder's white noise, rad.
    pub encoder_noise_rad: f64,
    /// Constant that the measured angle has too much, rad.
    #[serde(default)]
    pub encoder_offset_rad: f64,
    /// Standard deviation of the white noise of the measured torque, Nm.
    pub torque_noise_nm: f64,
    /// Noise with memory of the measured torque, beside the white one.
    #[serde(default)]
    pub memory: NoiseMemory,
    /// Ripple of the drive in the measured torque.
    #[serde(default)]
    pub ripple: DriveRipple,
    /// e: the drive's real torque constant is (1 + e) times the stated one, so the measured torque is
    /// 1/(1 + e) times the real one.
    pub gain_error: f64,
    /// Constant that the measured torque has too much, Nm.
    pub offset_nm: f64,
    /// Magnitude at which the measured torque is cut off, Nm; infinite for none.
    pub saturation_nm: f64,
    /// Joint torque per motor current that is stated, Nm/A.
    pub torque_constant_nm_per_a: f64,
}

/// The sensors of all joints.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instrument {
    pub channels: Vec<Channel>,
    /// How much later than the position the torque is measured that stands in the same row: the row of time t
    /// holds q(t) and u(t − delay), s; may be negative.
    pub torque_delay_s: f64,
}

impl Instrument {
    /// The robot's own sensors, without error but noise and resolution.
    pub fn of(robot: &Robot) -> Self {
        let channels = robot
            .drives
            .iter()
            .map(|drive| Channel {
                encoder_resolution_rad: drive.encoder_resolution_rad,
                encoder_noise_rad: drive.encoder_noise_rad,
                encoder_offset_rad: 0.0,
                torque_noise_nm: drive.torque_noise_nm,
                memory: NoiseMemory::default(),
                ripple: DriveRipple::default(),
                gain_error: 0.0,
                offset_nm: 0.0,
                saturation_nm: f64::INFINITY,
                torque_constant_nm_per_a: drive.torque_constant_nm_per_a,
            })
            .collect();
        Self { channels, torque_delay_s: 0.0 }
    }

    /// Sensors without noise and with endless resolution.
    pub fn ideal(robot: &Robot) -> Self {
        let mut instrument = Self::of(robot);
        for channel in &mut instrument.channels {
            channel.encoder_resolution_rad = 0.0;
            channel.encoder_noise_rad = 0.0;
            channel.torque_noise_nm = 0.0;
            channel.memory = NoiseMemory::default();
            channel.ripple = DriveRipple::default();
        }
        instrument
    }

    /// What the sensors would show of a drive torque if they had no noise, Nm.
    pub fn noise_free_nm(&self, joint: usize, torque_nm: f64) -> f64 {
        let channel = &self.channels[joint];
        let limit = channel.saturation_nm;
        (torque_nm / (1.0 + channel.gain_error) + channel.offset_nm).clamp(-limit, limit)
    }

    pub fn validate(&self) -> Result<(), SimulationError> {
        let mut complaints = Complaints::default();
        complaints.within("delay of the torque in s", self.torque_delay_s, -0.5, 0.5);
        for (j, channel) in self.channels.iter().enumerate() {
            let name = |what: &str| format!("{what} of joint {j}");
            complaints.not_negative(name("encoder resolution"), channel.encoder_resolution_rad);
            complaints.not_negative(name("encoder noise"), channel.encoder_noise_rad);
            complaints.within(name("encoder offset"), channel.encoder_offset_rad, -7.0, 7.0);
            complaints.not_negative(name("torque noise"), channel.torque_noise_nm);
            complaints.not_negative(name("torque noise with memory"), channel.memory.deviation_nm);
            complaints
                .not_negative(name("time constant of the torque noise"), channel.memory.time_constant_s);
            complaints.not_negative(name("ripple of the drive"), channel.ripple.amplitude_nm);
            complaints.within(name("gain error"), channel.gain_error, -0.9, 9.0);
            complaints.within(name("torque offset"), channel.offset_nm, -1e4, 1e4);
            complaints.positive(name("torque constant"), channel.torque_constant_nm_per_a);
            let positive = channel.saturation_nm > 0.0;
            if !positive {
                complaints.0.push(SimulationError::value(
                    name("saturation"),
                    channel.saturation_nm,
                    "it must be positive",
                ));
            }
        }
        complaints.finish()
    }
}
