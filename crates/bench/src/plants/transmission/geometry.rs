//! Geometry of the transmission bench at one state: crank, contact, sliding.

use super::{ContactView, State, Transmission};
use crate::signals::Motion;

/// Maximum sine of the crank angle under a rigid drive: the slide jams at 1.
pub(crate) const MAX_SINE: f64 = 0.9999;

/// Geometry at one state; computed once and used by laws and equations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Geometry {
    /// Normal of the contact.
    pub(super) ny: f64,
    pub(super) nz: f64,
    /// Deformation in m and its rate.
    pub(super) depth_m: f64,
    pub(super) rate_m_s: f64,
    /// Change of the deformation of an oval journal, m per angle of the contact relative to the
    /// shaft. `across` is that over the distance of the centres: the share of the normal force
    /// across `n`.
    pub(super) oval_m: f64,
    pub(super) across: f64,
    /// Rate of the distance of the centres, m/s.
    pub(super) radial_m_s: f64,
    /// Crank.
    pub(super) sin: f64,
    pub(super) cos: f64,
    pub(super) speed_rad_s: f64,
    /// Sliding speed.
    pub(super) sliding_m_s: f64,
    /// Motion of the drive cylinder that the fork follows.
    pub(super) drive: Motion,
}

impl Geometry {
    /// Angle of the crank.
    pub(super) fn angle_rad(&self) -> f64 {
        self.sin.asin()
    }
}

impl Transmission {
    /// Motion of the drive cylinder that the fork follows.
    pub(super) fn drive_motion(&self, time_s: f64) -> Motion {
        self.drive.at(time_s - self.extension.drive_lag_s)
    }

    pub(crate) fn geometry(&self, time_s: f64, s: &State) -> Geometry {
        let drive = self.drive_motion(time_s);
        let (sin, cos, speed_rad_s) = if self.compliance.is_some() {
            let (sin, cos) = s[4].sin_cos();
            (sin, cos, s[5])
        } else {
            let sin = ((drive.value - s[0]) / self.drive_lever_m).clamp(-MAX_SINE, MAX_SINE);
            let cos = (1.0 - sin * sin).sqrt();
            (sin, cos, (drive.rate - s[2]) / (self.drive_lever_m * cos))
        };
        let distance = (s[0] * s[0] + s[1] * s[1]).sqrt();
        let (ny, nz) = if distance > 0.0 { (s[0] / distance, s[1] / distance) } else { (0.0, 0.0) };
        let radial_m_s = ny * s[2] + nz * s[3];
        let mut g = Geometry {
            ny,
            nz,
            depth_m: distance - self.radial_clearance_m,
            rate_m_s: radial_m_s,
            oval_m: 0.0,
            across: 0.0,
            radial_m_s,
            sin,
            cos,
            speed_rad_s,
            sliding_m_s: speed_rad_s * self.journal_radius_m + nz * s[2] - ny * s[3],
            drive,
        };
        let [cosine, sine] = self.extension.out_of_round_m;
        if (cosine != 0.0 || sine != 0.0) && distance > 0.0 {
            let (s2, c2) = (2.0 * (nz.atan2(ny) - g.angle_rad())).sin_cos();
            g.depth_m += cosine * c2 + sine * s2;
            g.oval_m = 2.0 * (sine * c2 - cosine * s2);
            g.across = g.oval_m / distance;
            let turning = (ny * s[3] - nz * s[2]) / distance;
            g.rate_m_s += g.oval_m * (turning - speed_rad_s);
        }
        g
    }

    /// Contact at a state; `latched_m_s` is the latch of the integrator.
    pub(crate) fn view(&self, g: &Geometry, latched_m_s: f64) -> ContactView {
        ContactView {
            radial_clearance_m: self.radial_clearance_m,
            deformation_m: g.depth_m,
            rate_m_s: g.rate_m_s,
            latched_m_s,
            sliding_speed_m_s: g.sliding_m_s,
        }
    }
}
