//! Rudder servo of the transmission bench; its equations are in `plants::transmission::servo`.

use crate::schema::{HUGE, section};

section! {
    /// Rudder servo in closed loop. The described motion of the drive is its order; a controller, a
    /// valve and a cylinder with an oil column move the fork. The flow does not depend on the
    /// pressure, and the cylinder does not leak.
    Servo {
        /// Opening of the valve per position error of the fork; 1 is fully open.
        kp: f64 [1e-9, HUGE, "1/m"],
        /// Opening per integral of the position error.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        ki: f64 [0.0, HUGE, "1/(m s)"],
        /// Reduction of the opening per speed of the fork.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        kd: f64 [0.0, HUGE, "s/m"],
        /// Speed of the cylinder with a fully open valve: flow gain over piston area.
        full_speed_m_s: f64 [1e-9, 1e3],
        /// Time constant of the valve's first-order lag; 0: none.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        valve_lag_s: f64 [0.0, 1e3],
        /// Share of the valve's opening around 0 that passes no flow.
        #[serde(default, skip_serializing_if = "crate::description::is_zero")]
        dead_band: f64 [0.0, 0.9],
        /// Compliance of the oil column: its length over bulk modulus and area.
        compliance_m_n: f64 [1e-10, 1e-3, "m/N"],
    }
}
