//! Interface between the integrator and a plant with contacts.

/// Angles at which a contact begins.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// A plant with `N` states and one contact.
pub trait ContactPlant<const N: usize> {
    /// Computes the state derivative: in contact with the latched approach speed in m/s, or in a
    /// gap (`None`) without contact force, even if a trial state of the integrator crosses the
    /// surface. So each phase is smooth up to its event.
    fn derivative(&self, time_s: f64, state: &[f64; N], latched_m_s: Option<f64>, derivative: &mut [f64; N]);
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
    /// Deformation of a contact in m (negative: gap) and its rate in m/s.
    fn slice_deformation(&self, slice: usize, time_s: f64, state: &[f64; N]) -> (f64, f64);
    /// Deformation, rate and force of a contact at once.
    fn slice_contact(&self, slice: usize, time_s: f64, state: &[f64; N], latched_m_s: f64) -> ContactReading;
    /// Crank and contact angle of a contact.
    fn slice_angles(&self, slice: usize, time_s: f64, state: &[f64; N]) -> ContactAngles;
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
        self.derivative(time_s, state, latched_m_s.first().copied().flatten(), derivative);
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
}
