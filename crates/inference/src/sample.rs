//! Input of one step.

/// Physical inputs of one sample as integers. On the controller the filter estimates them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Radial clearance `R_B - R_J` in nm.
    pub radial_clearance_nm: u32,
    /// Deformation `d = a - D` in pm; negative values are the width of a gap.
    pub deformation_pm: i32,
    /// Rate `d'` of the deformation in nm/s, positive while approaching.
    pub deformation_rate_nm_s: i32,
    /// Approach speed latched at the onset of the contact, in nm/s; the image's floor is applied
    /// inside.
    pub approach_speed_nm_s: u32,
    /// Relative tangential speed of the contact points in nm/s.
    pub sliding_speed_nm_s: i32,
}

/// Physical inputs of one sample in SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactState {
    /// Radial clearance `R_B - R_J` in m.
    pub radial_clearance_m: f32,
    /// Deformation `d = a - D` in m; negative values are the width of a gap.
    pub deformation_m: f32,
    /// Rate `d'` of the deformation in m/s, positive while approaching.
    pub deformation_rate_m_s: f32,
    /// Approach speed latched at the onset of the contact, in m/s; the image's floor is applied
    /// inside.
    pub approach_speed_m_s: f32,
    /// Relative tangential speed of the contact points in m/s.
    pub sliding_speed_m_s: f32,
}

impl ContactState {
    /// Decides whether every input is finite.
    pub fn is_finite(&self) -> bool {
        self.radial_clearance_m.is_finite()
            && self.deformation_m.is_finite()
            && self.deformation_rate_m_s.is_finite()
            && self.approach_speed_m_s.is_finite()
            && self.sliding_speed_m_s.is_finite()
    }

    /// Decides whether the rate of the deformation and the approach speed fit into a [`Sample`]. If
    /// not, their ratio changes in the conversion.
    pub(crate) fn rates_fit(&self) -> bool {
        let rate_nm_s = scaled(self.deformation_rate_m_s, 1e9);
        // The conversion to integers saturates below 2^31 and 2^32.
        rate_nm_s > -2_147_483_648.0
            && rate_nm_s < 2_147_483_648.0
            && scaled(self.approach_speed_m_s, 1e9) < 4_294_967_296.0
    }

    /// Converts to integers, rounded to nearest. `None` if an input is not finite.
    ///
    /// Values saturate at 2.1 m of clearance, 2.1 mm of deformation, 4.2 m/s of approach and 2.1
    /// m/s of rate and sliding. No image is trained up to these clearances, deformations and
    /// sliding speeds; [`Self::rates_fit`] reports the other two. Negative clearance and approach
    /// speed become 0.
    pub fn sample(&self) -> Option<Sample> {
        self.is_finite().then(|| Sample {
            radial_clearance_nm: rounded(self.radial_clearance_m, 1e9).max(0).cast_unsigned(),
            deformation_pm: rounded(self.deformation_m, 1e12),
            deformation_rate_nm_s: rounded(self.deformation_rate_m_s, 1e9),
            approach_speed_nm_s: scaled(self.approach_speed_m_s, 1e9) as u32,
            sliding_speed_nm_s: rounded(self.sliding_speed_m_s, 1e9),
        })
    }
}

/// Scales a value so that truncation rounds it to nearest, halves away from zero.
fn scaled(value: f32, per_unit: f32) -> f32 {
    let scaled = value * per_unit;
    if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }
}

/// Returns the nearest integer number of units.
fn rounded(value: f32, per_unit: f32) -> i32 {
    scaled(value, per_unit) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn conversion_rounds_saturates_and_refuses() {
        let state = ContactState {
            radial_clearance_m: 0.5e-3,
            deformation_m: -3e-5,
            deformation_rate_m_s: 1e9,
            approach_speed_m_s: -1.0,
            sliding_speed_m_s: 0.1,
        };
        let sample = state.sample().unwrap_or_default();
        assert_eq!(sample.radial_clearance_nm, 500_000);
        assert!((sample.deformation_pm + 30_000_000).abs() <= 2);
        assert_eq!(sample.deformation_rate_nm_s, i32::MAX);
        assert_eq!(sample.approach_speed_nm_s, 0);
        assert!((sample.sliding_speed_nm_s - 100_000_000).abs() <= 8);
        assert!(!state.rates_fit());
        assert_eq!(ContactState { deformation_m: f32::NAN, ..state }.sample(), None);
        let fast = ContactState { deformation_rate_m_s: -2.1, approach_speed_m_s: 4.0, ..state };
        assert!(fast.rates_fit());
        let sample = fast.sample().unwrap_or_default();
        assert!((sample.deformation_rate_nm_s + 2_100_000_000).abs() <= 128);
        assert!(sample.approach_speed_nm_s.abs_diff(4_000_000_000) <= 256);
        assert!(!ContactState { approach_speed_m_s: 4.3, ..fast }.rates_fit());
        assert!(!ContactState { deformation_rate_m_s: -2.2, ..fast }.rates_fit());
    }
}
