//! Rudder servo in closed loop: order, controller, valve, cylinder with an oil column.
//!
//! ```text
//! e = w - x_f,  u_c = kp e + ki int(e) - kd x_f'  within -1 to 1      controller
//! T u' = u_c - u                                                     valve with lag
//! q = 0 for |u| <= b, else (u - sign(u) b)/(1 - b)                    overlap of its edges
//! x_c' = v q                                                         flow of the cylinder
//! P = k (x_c - x_f) + c (x_c' - x_f')                                oil column
//! ```
//!
//! `w` is the order: the described motion of the drive. `x_f` is the position of the fork, the
//! feedback. `x_c` is where the fork would be without compression of the oil. While `u_c` is
//! limited, an integral that would raise it further is held. The flow does not depend on the
//! pressure, and the cylinder does not leak (H. E. Merritt, Hydraulic Control Systems, 1967).

use super::geometry::Geometry;
use super::{STATES, State, Transmission};
use crate::description::{Servo, TransmissionBench};
use crate::integrate::{ContactAngles, ContactPlant, ContactReading, Slip, Tolerances, Touch};
use crate::plants::transmission::{BearingForces, Snapshot};
use crate::signals::Motion;

/// Number of states with a servo: those of the bench, then `x_c`, `u` and the integral.
pub(crate) const SERVO_STATES: usize = STATES + 3;

/// States of the bench with its servo.
pub(crate) type ServoState = [f64; SERVO_STATES];

impl Servo {
    /// Opening that passes flow, -1 to 1, at a position of the valve.
    fn flow(&self, valve: f64) -> f64 {
        let beyond = (valve.abs() - self.dead_band).max(0.0) / (1.0 - self.dead_band);
        valve.signum() * beyond
    }

    /// Rates of `x_c`, `u` and the integral under an order, for a motion of the fork.
    fn rates(&self, order: &Motion, fork: &Motion, [_, valve, integral]: [f64; 3]) -> [f64; 3] {
        let error = order.value - fork.value;
        let wanted = self.kp * error + self.ki * integral - self.kd * fork.rate;
        let command = wanted.clamp(-1.0, 1.0);
        let is_held = wanted != command && (wanted - command) * error > 0.0;
        let position = if self.valve_lag_s > 0.0 { valve.clamp(-1.0, 1.0) } else { command };
        let valve_rate = if self.valve_lag_s > 0.0 { (command - valve) / self.valve_lag_s } else { 0.0 };
        [
            self.full_speed_m_s * self.flow(position),
            valve_rate,
            if is_held || self.ki == 0.0 { 0.0 } else { error },
        ]
    }
}

/// The bench with the servo of its description, ready for integration.
pub(crate) struct ServoPlant<'a> {
    plant: &'a Transmission,
    servo: Servo,
}

impl<'a> ServoPlant<'a> {
    /// Adds the servo of a description to its plant; none without a servo.
    pub(crate) fn new(bench: &TransmissionBench, plant: &'a Transmission) -> Option<Self> {
        Some(Self { plant, servo: bench.servo.clone()? })
    }

    /// Bench at standstill on its order, with a closed valve.
    pub(crate) fn initial_state(&self, time_s: f64) -> ServoState {
        let mut bench = self.plant.initial_state(time_s);
        bench[5] = 0.0;
        let mut state = [0.0; SERVO_STATES];
        state[..STATES].copy_from_slice(&bench);
        state[STATES] = self.plant.drive_motion(time_s).value;
        state
    }

    /// Error control as that of the bench, whose norm is a mean over fewer states.
    pub(crate) fn tolerances(&self, relative: f64) -> Tolerances<SERVO_STATES> {
        let bench = self.plant.tolerances(relative);
        let share = (STATES as f64 / SERVO_STATES as f64).sqrt();
        let own = [1e-2, 1e-1, 1e-2].map(|size| size * bench.relative);
        let mut absolute = [f64::INFINITY; SERVO_STATES];
        for (place, size) in absolute.iter_mut().zip(bench.absolute.iter().chain(&own)) {
            *place = size * share;
        }
        Tolerances { relative: bench.relative * share, absolute, largest_step_s: bench.largest_step_s }
    }

    /// States of the bench among those with the servo.
    pub(crate) fn bench_state(state: &ServoState) -> State {
        std::array::from_fn(|i| state[i])
    }

    /// Motion of the fork, without its acceleration.
    fn fork(&self, s: &State) -> Motion {
        let (sin, cos) = s[4].sin_cos();
        let lever_m = self.plant.drive_lever_m;
        Motion { value: s[0] + lever_m * sin, rate: s[2] + lever_m * cos * s[5], acceleration: 0.0 }
    }

    /// Rates of the servo's own states.
    fn servo_rates(&self, time_s: f64, state: &ServoState) -> [f64; 3] {
        let own = [state[STATES], state[STATES + 1], state[STATES + 2]];
        self.servo.rates(&self.plant.drive_motion(time_s), &self.fork(&Self::bench_state(state)), own)
    }

    /// Geometry of the bench on the servo's cylinder.
    fn geometry(&self, time_s: f64, state: &ServoState, bench: &State) -> Geometry {
        let rate = self.servo_rates(time_s, state)[0];
        let drive = Motion { value: state[STATES], rate, acceleration: 0.0 };
        Geometry { drive, ..self.plant.geometry(time_s, bench) }
    }

    /// Rates of all states, and the force of the fork.
    fn all_rates(
        &self,
        time_s: f64,
        state: &ServoState,
        touch: Option<Touch>,
    ) -> (ServoState, f64, BearingForces) {
        let bench = Self::bench_state(state);
        let own = self.servo_rates(time_s, state);
        let g = self.geometry(time_s, state, &bench);
        let mut rates = [0.0; STATES];
        let (fork_n, forces) = self.plant.rates::<true>(time_s, &bench, &g, touch, &mut rates);
        let mut all = [0.0; SERVO_STATES];
        for (place, rate) in all.iter_mut().zip(rates.iter().chain(&own)) {
            *place = *rate;
        }
        (all, fork_n, forces)
    }

    /// All quantities at a state. The motion of the drive is that of the fork: where a sensor at
    /// the cylinder measures it.
    pub(crate) fn snapshot(&self, time_s: f64, state: &ServoState, touch: Touch) -> Snapshot {
        let bench = Self::bench_state(state);
        let (depth_m, _) = self.plant.deformation(time_s, &bench);
        let (rates, drive_force_n, forces) = self.all_rates(time_s, state, (depth_m > 0.0).then_some(touch));
        let (sin, cos) = bench[4].sin_cos();
        let lever_m = self.plant.drive_lever_m;
        let acceleration = rates[2] + lever_m * (cos * rates[5] - sin * bench[5] * bench[5]);
        let drive = Motion { acceleration, ..self.fork(&bench) };
        Snapshot { drive_force_n, drive, ..self.plant.snapshot(time_s, &bench, touch.latched_m_s, forces) }
    }
}

impl ContactPlant<SERVO_STATES> for ServoPlant<'_> {
    fn derivative(&self, time_s: f64, state: &ServoState, touch: Option<Touch>, derivative: &mut ServoState) {
        (*derivative, ..) = self.all_rates(time_s, state, touch);
    }

    fn deformation(&self, time_s: f64, state: &ServoState) -> (f64, f64) {
        self.plant.deformation(time_s, &Self::bench_state(state))
    }

    fn contact(&self, time_s: f64, state: &ServoState, latched_m_s: f64) -> ContactReading {
        self.plant.contact(time_s, &Self::bench_state(state), latched_m_s)
    }

    fn angles(&self, time_s: f64, state: &ServoState) -> ContactAngles {
        self.plant.angles(time_s, &Self::bench_state(state))
    }

    fn has_slip_ended(&self, time_s: f64, state: &ServoState, touch: Touch) -> bool {
        let bench = Self::bench_state(state);
        self.plant.has_slip_ended_at(time_s, &bench, &self.geometry(time_s, state, &bench), touch)
    }

    fn next_slip(&self, time_s: f64, state: &mut ServoState, touch: Touch) -> Slip {
        let mut bench = Self::bench_state(state);
        let g = self.geometry(time_s, state, &bench);
        let slip = self.plant.next_slip_at(time_s, &mut bench, &g, touch);
        state[..STATES].copy_from_slice(&bench);
        slip
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn servo() -> Servo {
        Servo {
            kp: 10.0,
            ki: 0.0,
            kd: 0.0,
            full_speed_m_s: 0.2,
            valve_lag_s: 0.05,
            dead_band: 0.0,
            compliance_m_n: 5e-8,
        }
    }

    /// Position at the end of a step of the order with rigid oil, by small steps.
    fn response(servo: &Servo, order: f64, end_s: f64) -> f64 {
        let order = Motion { value: order, ..Motion::default() };
        let (step_s, mut own) = (1e-4, [0.0; 3]);
        let rates =
            |own: [f64; 3]| servo.rates(&order, &Motion { value: own[0], rate: 0.0, acceleration: 0.0 }, own);
        for _ in 0..(end_s / step_s).round() as usize {
            let first = rates(own);
            let middle = std::array::from_fn(|i| own[i] + 0.5 * step_s * first[i]);
            let second = rates(middle);
            own = std::array::from_fn(|i| own[i] + step_s * second[i]);
        }
        own[0]
    }

    #[test]
    fn a_proportional_servo_responds_as_an_integrator_in_closed_loop() {
        // x' = v kp (w - x): a first-order lag of 0.5 s.
        let servo = Servo { valve_lag_s: 0.0, ..servo() };
        for t in [0.1, 0.5, 1.0, 2.0] {
            let expected = 0.01 * (1.0 - (-t / 0.5_f64).exp());
            assert!((response(&servo, 0.01, t) / expected - 1.0).abs() < 1e-6, "{t}");
        }
    }

    #[test]
    fn the_lag_of_the_valve_makes_it_second_order() {
        // T x'' + x' + a x = a w, with T = 0.05 s and a = v kp = 2/s: two real roots.
        let (lag_s, gain) = (0.05_f64, 2.0);
        let root = (1.0 - 4.0 * lag_s * gain).sqrt();
        let (slow, fast) = ((1.0 - root) / (2.0 * lag_s), (1.0 + root) / (2.0 * lag_s));
        for t in [0.05_f64, 0.2, 0.7, 2.0] {
            let decay = (fast * (-slow * t).exp() - slow * (-fast * t).exp()) / (fast - slow);
            let found = response(&servo(), 0.01, t);
            assert!((found / (0.01 * (1.0 - decay)) - 1.0).abs() < 1e-5, "{t}: {found}");
        }
    }

    #[test]
    fn a_dead_band_leaves_an_error_and_a_full_valve_limits_the_speed() {
        let servo = Servo { dead_band: 0.05, ..servo() };
        let error = 0.01 - response(&servo, 0.01, 30.0);
        assert!((error / (0.05 / 10.0) - 1.0).abs() < 1e-3, "{error}");
        // An error of 1 m opens the valve fully: 0.2 m/s, less the lag of the valve.
        let far = response(&Servo { dead_band: 0.0, ..servo }, 1.0, 1.0);
        assert!((far - 0.2 * (1.0 - 0.05)).abs() < 1e-4, "{far}");
    }

    #[test]
    fn a_derivative_opposes_the_speed_of_the_fork() {
        let servo = Servo { kd: 2.0, valve_lag_s: 0.0, ..servo() };
        let moving = Motion { value: 0.3, rate: 0.1, acceleration: 0.0 };
        let order = Motion { value: 0.3, ..Motion::default() };
        let [speed_m_s, ..] = servo.rates(&order, &moving, [0.3, 0.0, 0.0]);
        assert!((speed_m_s + 0.2 * 2.0 * 0.1).abs() < 1e-15, "{speed_m_s}");
    }

    #[test]
    fn an_integral_removes_the_error_of_a_steady_disturbance_and_is_held_at_the_limit() {
        let servo = Servo { ki: 5.0, ..servo() };
        let order = Motion { value: 1.0, ..Motion::default() };
        let at_limit = servo.rates(&order, &Motion::default(), [0.0, 1.0, 0.1]);
        assert_eq!(at_limit[2], 0.0, "the valve is fully open");
        let near = servo.rates(&order, &Motion { value: 0.95, ..Motion::default() }, [0.95, 0.0, 0.0]);
        assert!((near[2] - 0.05).abs() < 1e-12);
    }
}
