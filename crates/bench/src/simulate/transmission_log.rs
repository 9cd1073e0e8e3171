//! Logs of the transmission bench: recording, and simulation under the inputs of a log.

use super::respond::{Inputs, LoggedPlant, Response, Truth, mean_step_s, refined, smooth_load};
use super::{DEFAULT_TOLERANCE, snapshots};
use crate::description::{PlantDescription, TransmissionBench};
use crate::integrate::IntegrationError;
use crate::log::{LogError, MeasuredLog};
use crate::plants::transmission::Snapshot;
use crate::signals::{Channel, Profile};

/// Number of simulated intervals per sample.
pub(super) const FINENESS: usize = 8;

/// Half window in s of the polynomial that smooths a drive displacement with its velocity.
const DRIVE_HALF_WINDOW_S: f64 = 0.010;

/// Reading of a channel in a state of the bench.
pub type ChannelReading = (Channel, fn(&Snapshot) -> f64);

/// Channels of the transmission bench's log.
pub const CHANNELS: &[ChannelReading] = &[
    (Channel::DriveDisplacement, |s| s.drive.value),
    (Channel::DriveVelocity, |s| s.drive.rate),
    (Channel::LoadForce, |s| s.load_force_n),
    (Channel::ShaftAngle, |s| s.angle_rad),
    (Channel::ShaftSpeed, |s| s.speed_rad_s),
    (Channel::JournalY, |s| s.y_m),
    (Channel::JournalZ, |s| s.z_m),
    (Channel::BearingForceY, |s| s.force_y_n),
    (Channel::BearingForceZ, |s| s.force_z_n),
    (Channel::FrictionTorque, |s| s.friction_torque_nm),
    (Channel::DriveForce, |s| s.drive_force_n),
];

impl LoggedPlant for TransmissionBench {
    fn inputs(&self, log: &MeasuredLog) -> Result<Inputs, LogError> {
        let displacement = log.need(Channel::DriveDisplacement)?;
        let velocity = log.channels.get(&Channel::DriveVelocity).map(Vec::as_slice);
        let load = smooth_load(&log.time_s, log.need(Channel::LoadForce)?);
        let half_s = DRIVE_HALF_WINDOW_S.max(4.0 * mean_step_s(&log.time_s));
        let drive = Profile::through(&log.time_s, displacement, velocity, half_s, 4);
        Ok(Inputs::from_profiles(log, self.outputs(log), (drive, load), FINENESS))
    }

    fn respond(&self, inputs: &Inputs, _: bool) -> Result<Truth, IntegrationError> {
        let end_s = inputs.time_s.last().copied().unwrap_or_default();
        let profiles = (inputs.drive.clone(), inputs.load.clone());
        // A log has the motion of the fork, and not the order of a servo.
        let samples = snapshots(&self.without_servo(), profiles, end_s, &inputs.fine_s, DEFAULT_TOLERANCE)?;
        Ok(Truth { outputs: outputs_from(&samples, &inputs.outputs), fineness: inputs.fineness })
    }

    fn run(&self) -> Result<(Vec<f64>, Truth), IntegrationError> {
        let fine_s = refined(&self.sample_times_s(self.logging.sample_rate_hz), FINENESS);
        let profiles = (self.drive_profile(), self.load_profile());
        let samples = snapshots(self, profiles, self.duration_s(), &fine_s, DEFAULT_TOLERANCE)?;
        Ok((fine_s, Truth { outputs: all_outputs_from(&samples), fineness: FINENESS }))
    }
}

/// True outputs of a run on the given channels. Channels that the bench does not have are left out.
pub(super) fn outputs_from(samples: &[Snapshot], channels: &[Channel]) -> Response {
    let wanted = CHANNELS.iter().filter(|(channel, _)| channels.contains(channel));
    wanted.map(|(channel, read)| (*channel, samples.iter().map(read).collect())).collect()
}

/// True outputs of a run on every channel.
pub(super) fn all_outputs_from(samples: &[Snapshot]) -> Response {
    CHANNELS.iter().map(|(channel, read)| (*channel, samples.iter().map(read).collect())).collect()
}
