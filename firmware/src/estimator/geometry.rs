//! From the journal's position and motion to the contact's, and from its forces back to the bench's axes.
//!
//! `a` is the journal's distance from the bearing's centre, `n = (y, z)/a` points to the contact, `t = (n_z, -n_y)` is the direction in
//! which the journal slides when the shaft turns forward (from +z towards +y). Positions in nm, speeds in m/s: f32 keeps a tenth of a nanometre at a millimetre.

/// The contact's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactFrame {
    /// Distance `a` of the journal from the centre, nm.
    pub distance_nm: f32,
    /// `n` along y.
    pub normal_y: f32,
    /// `n` along z.
    pub normal_z: f32,
}

impl ContactFrame {
    /// The frame at a journal position. At the very centre the normal is taken along +y; there is no contact there.
    #[must_use]
    pub fn at(y_nm: f32, z_nm: f32) -> Self {
        let distance_nm = libm::sqrtf(y_nm * y_nm + z_nm * z_nm);
        if distance_nm > 0.0 {
            Self { distance_nm, normal_y: y_nm / distance_nm, normal_z: z_nm / distance_nm }
        } else {
            Self { distance_nm: 0.0, normal_y: 1.0, normal_z: 0.0 }
        }
    }

    /// `t . v`: the journal's part of the sliding speed.
    #[must_use]
    pub fn tangential_speed(&self, y_m_s: f32, z_m_s: f32) -> f32 {
        self.normal_z * y_m_s - self.normal_y * z_m_s
    }

    /// Force of the bearing on the journal: `-F_n n + F_f t`, along y and z.
    #[must_use]
    pub fn force(&self, normal_n: f32, friction_n: f32) -> (f32, f32) {
        (
            friction_n * self.normal_z - normal_n * self.normal_y,
            -(friction_n * self.normal_y + normal_n * self.normal_z),
        )
    }

    /// Angle of `n` from +y towards +z, rad.
    #[must_use]
    pub fn angle_rad(&self) -> f32 {
        libm::atan2f(self.normal_z, self.normal_y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::FRAC_PI_2;

    #[test]
    fn at_the_bottom_forward_shaft_rotation_slides_backwards_along_y() {
        let frame = ContactFrame::at(0.0, -500_000.0);
        assert_eq!((frame.normal_y, frame.normal_z, frame.distance_nm), (0.0, -1.0, 500_000.0));
        assert_eq!(frame.tangential_speed(1.0, 0.0), -1.0);
        assert_eq!(frame.angle_rad(), -FRAC_PI_2);
        // Friction opposing forward sliding (negative) pushes the journal along +y; the bearing pushes it up.
        assert_eq!(frame.force(1000.0, -100.0), (100.0, 1000.0));
    }

    #[test]
    fn force_components_keep_the_size() {
        for (y, z) in [(3e5, 4e5), (-1e5, 2e5), (1.0, -7e5)] {
            let (force_y, force_z) = ContactFrame::at(y, z).force(3000.0, 400.0);
            let size = (force_y * force_y + force_z * force_z).sqrt();
            assert!((size - (3000.0_f32.powi(2) + 400.0_f32.powi(2)).sqrt()).abs() < 1e-2, "{size}");
        }
    }

    #[test]
    fn the_centre_is_no_division_by_zero() {
        let frame = ContactFrame::at(0.0, 0.0);
        assert!(frame.force(0.0, 0.0) == (0.0, 0.0) && frame.angle_rad() == 0.0);
    }
}
