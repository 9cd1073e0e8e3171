//! One tick: a sensor sample becomes an estimate of the contact's forces.
//!
//! Checks ([`Plausibility`]) -> direction ([`ContactFrame`]) -> window fits of y, z, distance and angle ([`Window`]) -> deformation
//! and its rate -> onset ([`Latch`]) -> sliding speed -> networks ([`inference::Pair`]) -> force components, torque, flags.
//!
//! The distance has a window of its own: the journal swings along the clearance circle at 100 mm/s and more while its distance
//! from the centre changes by less than 1 mm/s. A rate taken as the projection of two Cartesian slopes would mistake a
//! fiftieth of the former for the latter.
//!
//! The contact's direction is that of the newest raw sample: at half a millimetre 0.2 um of noise turn it by 0.4 mrad, a
//! parabola through a swing of 60 Hz by 28 mrad. The deformation is fitted, at the newest sample (no delay at constant
//! acceleration); how well the rate follows the journal is told in [`window`]. The swing's part of the sliding speed errs by up to 9,
//! 19, 31 % of its peak at 30, 45, 60 Hz and 1 rad either way: near its turns the friction's sign is uncertain. Until the
//! window is full (3.6 ms) after a start, a gap or a jump, the newest raw position is used and
//! the rates are 0: flagged, not guessed.

mod geometry;
mod latch;
mod plausibility;
mod setup;
pub mod window;

use inference::{ContactState, Flags, Model, Pair};
use link::{Configuration, EstimateFrame, Refusal, SensorFrame};

pub use geometry::ContactFrame;
pub use latch::Latch;
pub use plausibility::{Findings, Limits, MAX_DEFORMATION_NM, Plausibility, STUCK_SAMPLES, SwingLimit};
pub use setup::{
    CLEARANCE_RANGE_NM, JOURNAL_RADIUS_RANGE_NM, LATCH_FLOOR_RANGE_UM_S, SAMPLE_PERIOD_RANGE_US, image_cause,
};
pub use window::{WINDOW, Window};

use crate::flags::{ONSET_NOT_SEEN, WINDOW_FILLING};
use plausibility::DISCONTINUITY;
use setup::Setup;
use window::Fit;

/// Fixed-point steps of the distance: finer than f32 resolves it at a millimetre, and far from overflow (at 5 mm: 2^27).
const DISTANCE_STEPS_PER_NM: f32 = 16.0;

/// The estimator of one bench.
#[derive(Clone, Debug)]
pub struct Estimator {
    setup: Setup,
    plausibility: Plausibility,
    journal_y: Window,
    journal_z: Window,
    distance: Window,
    shaft_angle: Window,
    filled: usize,
    latch: Latch,
    pair: Pair<'static>,
    state: ContactState,
}

impl Estimator {
    /// Creates the estimator for a bench from a model image.
    ///
    /// # Errors
    ///
    /// A value of the configuration is out of range, or the image is damaged or made for another bearing.
    pub fn new(image: &'static [u8], configuration: Configuration) -> Result<Self, Refusal> {
        let (setup, model) = Setup::new(image, configuration)?;
        Ok(Self {
            plausibility: Plausibility::new(
                configuration.radial_clearance_nm,
                configuration.sample_period_us,
            ),
            journal_y: Window::default(),
            journal_z: Window::default(),
            distance: Window::default(),
            shaft_angle: Window::default(),
            filled: 0,
            latch: Latch::new(setup.latch_floor_m_s, setup.unseen_approach_m_s),
            pair: Pair::new(model),
            state: ContactState::default(),
            setup,
        })
    }

    /// The watch over the samples: what was found in the last one.
    #[must_use]
    pub const fn plausibility(&self) -> &Plausibility {
        &self.plausibility
    }

    /// The watch over the samples, to be given its limits and what the drivers say of the next one.
    pub const fn plausibility_mut(&mut self) -> &mut Plausibility {
        &mut self.plausibility
    }

    /// The contact as the networks saw it at the last tick: what another law is to be held against.
    #[must_use]
    pub const fn state(&self) -> ContactState {
        self.state
    }

    /// Goes on with another model of the same bearing from the next sample on. The networks' history starts anew; the conditioning and
    /// the latch, which do not depend on the model, go on.
    pub fn switch(&mut self, model: Model<'static>) {
        self.pair.switch(model);
    }

    /// Takes one sample and estimates. The tick count of the result is 0; whoever can measure it fills it in.
    pub fn step(&mut self, frame: &SensorFrame) -> EstimateFrame {
        let mut flags = self.plausibility.check(frame);
        if flags.intersects(DISCONTINUITY) {
            self.filled = 0;
            self.latch.reset();
            self.pair.reset();
        }
        let contact = ContactFrame::at(frame.journal_y_nm as f32, frame.journal_z_nm as f32);
        let distance = (contact.distance_nm * DISTANCE_STEPS_PER_NM) as i32;
        self.distance.push(distance);
        self.journal_y.push(frame.journal_y_nm);
        self.journal_z.push(frame.journal_z_nm);
        self.shaft_angle.push(frame.shaft_angle_nrad);
        self.filled = self.filled.saturating_add(1).min(WINDOW);
        let full = self.filled == WINDOW;
        flags |= WINDOW_FILLING.when(!full);

        let fit = |window: &Window| if full { window.fit() } else { Fit { correction: 0.0, slope: 0.0 } };
        let (y, z, angle) = (fit(&self.journal_y), fit(&self.journal_z), fit(&self.shaft_angle));
        let radial = fit(&self.distance);
        let (y_m_s, z_m_s) = (y.slope * self.setup.per_sample_to_m_s, z.slope * self.setup.per_sample_to_m_s);
        let shaft_speed_rad_s = angle.slope * self.setup.per_sample_to_m_s;
        let distance_nm = (distance as f32 + radial.correction) / DISTANCE_STEPS_PER_NM;
        let deformation_m = (distance_nm - self.setup.radial_clearance_nm) * 1e-9;
        let deformation_rate_m_s = radial.slope / DISTANCE_STEPS_PER_NM * self.setup.per_sample_to_m_s;
        let (approach_speed_m_s, onset_seen) =
            self.latch.update(deformation_m, full.then_some(deformation_rate_m_s));
        flags |= ONSET_NOT_SEEN.when(!onset_seen);

        let state = ContactState {
            radial_clearance_m: self.setup.radial_clearance_m,
            deformation_m,
            deformation_rate_m_s,
            approach_speed_m_s,
            sliding_speed_m_s: shaft_speed_rad_s * self.setup.journal_radius_m
                + contact.tangential_speed(y_m_s, z_m_s),
        };
        self.state = state;
        let estimate = self.pair.push(&state);
        let (force_y_n, force_z_n) = contact.force(estimate.normal_force_n(), estimate.friction_force_n());
        EstimateFrame {
            sequence: frame.sequence,
            time_us: frame.time_us,
            normal_force_n: estimate.normal_force_n(),
            force_y_n,
            force_z_n,
            friction_torque_nm: estimate.friction_force_n() * self.setup.journal_radius_m,
            deformation_m,
            contact_angle_rad: contact.angle_rad(),
            flags: (flags | estimate.flags).bits(),
            saturated: estimate.saturated,
            instruction_ticks: 0,
        }
    }
}

/// The flags of an estimate as a set.
#[must_use]
pub const fn flags_of(estimate: &EstimateFrame) -> Flags {
    Flags::from_bits(estimate.flags)
}
