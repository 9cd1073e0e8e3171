//! Interface between the integrator and a plant with contacts.

use serde::{Deserialize, Serialize};

/// Angles at which a contact begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactAngles {
    /// Angle of the crank, rad.
    pub crank_rad: f64,
    /// Direction from the bearing's centre to the point of contact, rad from the plant's first
    /// axis.
    pub contact_rad: f64,
}

/// A contact at one state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactReading {
    /// Deformation in m, negative in a gap.
    pub depth_m: f64,
    /// Its rate in m/s.
    pub rate_m_s: f64,
    /// Normal force in N.
    pub force_n: f64,
}

/// Motion of a contact along its surface. With a friction law that sticks, each kind is smooth up
/// to its end, which the integrator locates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub enum Slip {
    /// Friction is a function of the state.
    #[default]
    Smooth,
    /// Sliding.
    Sliding {
        /// Sign of the sliding speed, -1 or 1.
        direction: f64,
        /// Static excess of the coefficient at the break-away, for a law that remembers it.
        excess: f64,
    },
    /// Within a band of speeds that counts as standstill, under more than the break-away force.
    BreakingAway {
        /// Direction of the motion that friction opposes, -1 or 1.
        direction: f64,
    },
    /// Standstill: friction balances the other forces.
    Sticking {
        /// Time of its beginning in s.
        since_s: f64,
        /// Static excess of the coefficient at that time, for a law that remembers it.
        excess: f64,
    },
}

impl Slip {
    /// Returns whether the contact sticks.
    pub(crate) const fn is_sticking(&self) -> bool {
        matches!(self, Self::Sticking { .. })
    }
}

/// A contact that touches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Approach speed in m/s, latched at onset.
    pub latched_m_s: f64,
    /// Motion along the surface.
    pub slip: Slip,
}

/// A plant with `N` states and one contact.
pub trait ContactPlant<const N: usize> {
    /// Computes the state derivative: in contact with its latch and slip, or in a gap (`None`)
    /// without contact force, even if a trial state of the integrator crosses the surface. So each
    /// phase is smooth up to its event.
    fn derivative(&self, time_s: f64, state: &[f64; N], touch: Option<Touch>, derivative: &mut [f64; N]);
    /// Deformation in m (negative: gap) and its rate in m/s.
    fn deformation(&self, time_s: f64, state: &[f64; N]) -> (f64, f64);
    /// Normal contact force in N.
    fn normal_force_n(&self, time_s: f64, state: &[f64; N], latched_m_s: f64) -> f64 {
        self.contact(time_s, state, latched_m_s).force_n
    }
    /// Deformation, rate and force at once.
    fn contact(&self, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading;
    /// Crank and contact angle.
    fn angles(&self, time_s: f64, state: &[f64; N]) -> ContactAngles;
    /// Returns whether the slip of a contact has ended at a state. Without a friction law that
    /// sticks there is nothing to end.
    fn has_slip_ended(&self, _time_s: f64, _state: &[f64; N], _touch: Touch) -> bool {
        false
    }
    /// Returns the slip that follows an onset (after [`Slip::Smooth`]) or the end of another slip.
    /// Corrects the state where the new slip begins at standstill.
    fn next_slip(&self, _time_s: f64, _state: &mut [f64; N], _touch: Touch) -> Slip {
        Slip::Smooth
    }
}

/// A plant with `N` states and a fixed number of contacts, each with its own latch.
pub(crate) trait SlicedPlant<const N: usize> {
    /// Number of contacts.
    fn slices(&self) -> usize;
    /// Computes the state derivative with the latched approach speed of each contact, `None` in a
    /// gap; see [`ContactPlant`].
    fn sliced_derivative(
        &self,
        time_s: f64,
        state: &[f64; N],
        latched_m_s: &[Option<f64>],
        derivative: &mut [f64; N],
    );
    /// Computes the state derivative as [`Self::sliced_derivative`], with the slip of each contact.
    fn slipping_derivative(
        &self,
        time_s: f64,
        state: &[f64; N],
        (latched_m_s, _): (&[Option<f64>], &[Slip]),
        derivative: &mut [f64; N],
    ) {
        self.sliced_derivative(time_s, state, latched_m_s, derivative);
    }
    /// Deformation of a contact in m (negative: gap) and its rate in m/s.
    fn slice_deformation(&self, slice: usize, time_s: f64, state: &[f64; N]) -> (f64, f64);
    /// Deformation, rate and force of a contact at once.
    fn slice_contact(&self, slice: usize, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading;
    /// Crank and contact angle of a contact.
    fn slice_angles(&self, slice: usize, time_s: f64, state: &[f64; N]) -> ContactAngles;
    /// Returns whether the slip of a contact has ended; see [`ContactPlant::has_slip_ended`].
    fn has_slice_slip_ended(&self, _: usize, _time_s: f64, _state: &[f64; N], _touch: Touch) -> bool {
        false
    }
    /// Returns the slip that follows; see [`ContactPlant::next_slip`].
    fn next_slice_slip(&self, _: usize, _time_s: f64, _state: &mut [f64; N], _touch: Touch) -> Slip {
        Slip::Smooth
    }
    /// Time after `time_s` at which the derivative next changes by itself; infinite if it never
    /// does.
    fn next_change_s(&self, _time_s: f64) -> f64 {
        f64::INFINITY
    }
    /// Changes the derivative, at the start and at each of these times.
    fn change(&self, _time_s: f64, _state: &[f64; N], _latched_m_s: &[Option<f64>]) {}
}

impl<P: ContactPlant<N>, const N: usize> SlicedPlant<N> for P {
    fn slices(&self) -> usize {
        1
    }

    fn sliced_derivative(
        &self,
        time_s: f64,
        state: &[f64; N],
        latched_m_s: &[Option<f64>],
        derivative: &mut [f64; N],
    ) {
        self.slipping_derivative(time_s, state, (latched_m_s, &[]), derivative);
    }

    fn slipping_derivative(
        &self,
        time_s: f64,
        state: &[f64; N],
        (latched_m_s, slips): (&[Option<f64>], &[Slip]),
        derivative: &mut [f64; N],
    ) {
        let slip = slips.first().copied().unwrap_or_default();
        let latched = latched_m_s.first().copied().flatten();
        let touch = latched.map(|latched_m_s| Touch { latched_m_s, slip });
        self.derivative(time_s, state, touch, derivative);
    }

    fn slice_deformation(&self, _: usize, time_s: f64, state: &[f64; N]) -> (f64, f64) {
        self.deformation(time_s, state)
    }

    fn slice_contact(&self, _: usize, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading {
        self.contact(time_s, state, latched_m_s)
    }

    fn slice_angles(&self, _: usize, time_s: f64, state: &[f64; N]) -> ContactAngles {
        self.angles(time_s, state)
    }
    fn has_slice_slip_ended(&self, _: usize, time_s: f64, state: &[f64; N], touch: Touch) -> bool {
        self.has_slip_ended(time_s, state, touch)
    }

    fn next_slice_slip(&self, _: usize, time_s: f64, state: &mut [f64; N], touch: Touch) -> Slip {
        self.next_slip(time_s, state, touch)
    }
}
