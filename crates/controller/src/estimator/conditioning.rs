//! Parameters of the conditioning beyond the bench's [`link::BenchConfiguration`].
//!
//! Masses, damping and noise are used by the prediction (Newton's law) and its observer. They need
//! not be exact: an error of 10 % in the masses adds a force error of 0.2 % of full scale, 30 % in
//! the dissipation factor adds at most 1 %. Without masses the rate depends on the position alone.

use inference::BearingMaterial;
use link::track::MonitorConfiguration;

/// Masses that can be served, g: 1 kg to 4000 t. Outside, the masses count as unknown.
pub const MASS_RANGE_G: core::ops::RangeInclusive<u32> = 1_000..=u32::MAX;

/// Noise of a journal coordinate that can be served, nm: the observer's squares fit into 32 bits.
pub const NOISE_RANGE_NM: core::ops::RangeInclusive<u32> = 10..=8_000;

/// The masses that the contact force moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Masses {
    /// Along y, g: the shaft and the inertia that turns with it, `m + J/R_d^2`.
    pub along_y_g: u32,
    /// Along z, g: the shaft.
    pub along_z_g: u32,
}

impl Masses {
    /// Masses of a shaft of `mass_g` whose inertia acts on a drive lever. None with a lever of 0 or
    /// out of [`MASS_RANGE_G`].
    fn from_shaft(mass_g: u32, inertia_g_m2: u32, drive_lever_um: u32) -> Option<Self> {
        let lever_um2 = u64::from(drive_lever_um).wrapping_mul(u64::from(drive_lever_um));
        let reflected_g = u64::from(inertia_g_m2).saturating_mul(1_000_000_000_000).checked_div(lever_um2)?;
        let along_y_g = u32::try_from(reflected_g.saturating_add(mass_g.into())).ok()?;
        MASS_RANGE_G.contains(&mass_g).then_some(Self { along_y_g, along_z_g: mass_g })
    }
}

/// Parameters of the conditioning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conditioning {
    /// The masses, if they are known.
    pub masses: Option<Masses>,
    /// Dissipation factor `chi(e)` of the contact law that the network has learnt, thousandths.
    pub damping_per_mille: u32,
    /// Standard deviation of a journal coordinate's noise, nm. A larger innovation of the observer
    /// is not noise.
    pub noise_nm: u32,
}

impl Conditioning {
    /// The default: the project's bench (150 kg, 60 kg m2 on a lever of 0.3 m, 0.2 um of noise) and
    /// the contact law of the shipped networks, `chi = (3/4)(1-e^2) exp(2(1-e))` with restitution
    /// 0.4 and 0.8.
    #[must_use]
    pub fn for_bearing(bearing: BearingMaterial) -> Self {
        Self {
            masses: Masses::from_shaft(150_000, 60_000, 300_000),
            damping_per_mille: bearing.damping_per_mille(),
            noise_nm: 200,
        }
    }

    /// Converts the configuration. With a lever of 0 or masses out of range the masses are unknown.
    #[must_use]
    pub fn from_monitor(monitor: &MonitorConfiguration) -> Self {
        Self {
            masses: Masses::from_shaft(monitor.mass_g, monitor.inertia_g_m2, monitor.drive_lever_um),
            damping_per_mille: monitor.damping_per_mille,
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
            Conditioning::from_monitor(&BENCH_B.monitor),
            Conditioning::for_bearing(BearingMaterial::Babbitt)
        );
        let masses = Masses { along_y_g: 816_666, along_z_g: 150_000 };
        assert_eq!(Conditioning::for_bearing(BearingMaterial::Plastic).masses, Some(masses));
    }

    #[test]
    fn masses_that_cannot_be_are_unknown() {
        let monitor = BENCH_B.monitor;
        for (drive_lever_um, mass_g) in [(0, 150_000), (300_000, 0), (1, 150_000), (300_000, 999)] {
            let given = MonitorConfiguration { drive_lever_um, mass_g, ..monitor };
            assert_eq!(Conditioning::from_monitor(&given).masses, None, "{drive_lever_um} {mass_g}");
        }
    }
}
