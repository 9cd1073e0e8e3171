//! What the conditioning is told beyond the bench's [`link::Configuration`].
//!
//! Masses, damping and noise are for the prediction by Newton's law and the observer behind it. They need not be exact: with 10 % of error in
//! the masses the force errs by 0.2 % of full scale more, with 30 % in the damping factor by 1 % at most. Without masses the rate rests on the position alone.

use inference::Bearing;
use link::track::MonitorConfiguration;

/// Masses that can be served, g: 1 kg to 4000 t. Outside, the masses count as unknown.
pub const MASS_RANGE_G: core::ops::RangeInclusive<u32> = 1_000..=u32::MAX;

/// Noise of a journal coordinate that can be served, nm: the observer's squares stay within 32 bits.
pub const NOISE_RANGE_NM: core::ops::RangeInclusive<i64> = 10..=8_000;

/// The masses that the contact force moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Masses {
    /// Along y, g: the shaft with what it has to turn when it moves that way, `m + J/R_d^2`.
    pub along_y_g: u32,
    /// Along z, g: the shaft.
    pub along_z_g: u32,
}

/// What the conditioning is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conditioning {
    /// The masses, if they are known.
    pub masses: Option<Masses>,
    /// Damping factor `chi(e)` of the contact law that the network has learnt, thousandths.
    pub damping_per_mille: u32,
    /// One standard deviation of a journal coordinate's noise, nm. What the observer misses by more than that is not noise.
    pub noise_nm: u32,
}

impl Conditioning {
    /// The default: the project's bench (150 kg, 60 kg m2 on a lever of 0.3 m, 0.2 um of noise) and the law of the shipped
    /// networks, `chi = (3/4)(1-e^2) exp(2(1-e))` with restitution 0.4 and 0.8.
    #[must_use]
    pub const fn of_bench(bearing: Bearing) -> Self {
        Self {
            masses: Some(Masses { along_y_g: 816_667, along_z_g: 150_000 }),
            damping_per_mille: match bearing {
                Bearing::Babbitt => 2_092,
                Bearing::Plastic => 403,
            },
            noise_nm: 200,
        }
    }

    /// The same from what the controller is configured with. A lever of 0 or masses out of range leave the masses unknown, a damping factor of 0 that of
    /// the shipped networks.
    #[must_use]
    pub fn of(bearing: Bearing, monitor: &MonitorConfiguration) -> Self {
        let default = Self::of_bench(bearing);
        let lever_um2 = u64::from(monitor.drive_lever_um).wrapping_mul(u64::from(monitor.drive_lever_um));
        let reflected_g = u64::from(monitor.inertia_g_m2)
            .saturating_mul(1_000_000_000_000)
            .checked_div(lever_um2)
            .unwrap_or(u64::MAX);
        let along_y_g = u32::try_from(reflected_g.saturating_add(monitor.mass_g.into())).ok();
        let known = MASS_RANGE_G.contains(&monitor.mass_g);
        Self {
            masses: along_y_g
                .filter(|_| known)
                .map(|along_y_g| Masses { along_y_g, along_z_g: monitor.mass_g }),
            damping_per_mille: match monitor.damping_per_mille {
                0 => default.damping_per_mille,
                given => given,
            },
            noise_nm: monitor.journal_noise_nm.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::configuration::BENCH_B;

    #[test]
    fn the_bench_s_configuration_gives_what_is_assumed_of_the_bench() {
        assert_eq!(
            Conditioning::of(Bearing::Babbitt, &BENCH_B.monitor),
            Conditioning {
                masses: Some(Masses { along_y_g: 816_666, along_z_g: 150_000 }),
                ..Conditioning::of_bench(Bearing::Babbitt)
            }
        );
    }

    #[test]
    fn masses_that_cannot_be_are_unknown() {
        let monitor = BENCH_B.monitor;
        for (drive_lever_um, mass_g) in [(0, 150_000), (300_000, 0), (1, 150_000), (300_000, 999)] {
            let given = MonitorConfiguration { drive_lever_um, mass_g, ..monitor };
            assert_eq!(Conditioning::of(Bearing::Babbitt, &given).masses, None, "{drive_lever_um} {mass_g}");
        }
        let given = MonitorConfiguration { damping_per_mille: 0, ..monitor };
        assert_eq!(Conditioning::of(Bearing::Babbitt, &given).damping_per_mille, 2_092);
    }
}
