//! Start of a run: gap under the journal and the speed at which it lands.

use crate::description::Range;
use crate::schema::{TINY, section};
use contact::GRAVITY_M_S2;

/// Gap at the start as a share of the radial clearance, unless it is described.
const GAP_SHARE: f64 = 1e-3;

section! {
    /// Start of a run: the journal drops onto the bottom of the bearing. The speed at which it
    /// lands is the latched approach speed until the contact is lost for the first time.
    Start {
        /// Gap under the journal, at most the radial clearance. Default: what the landing speed
        /// needs from standstill, else a thousandth of the clearance.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        gap_m: Option<f64> [TINY, 1.0],
        /// Speed of landing, at least that of a free fall through the gap. Default: a free fall.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        landing_speed_m_s: Option<f64> [1e-9, 10.0],
    }
}

/// Journal at the start.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StartState {
    /// Gap under it as a share of the radial clearance.
    pub(crate) gap_share: f64,
    /// Downward speed in m/s.
    pub(crate) speed_m_s: f64,
}

impl Start {
    /// Ranges that depend on the clearance and on each other.
    pub(super) fn ranges(&self, clearance_m: f64) -> Vec<Range> {
        let fall_m_s = |gap_m: f64| (2.0 * GRAVITY_M_S2 * gap_m).sqrt();
        let gap = self.gap_m.map(|gap_m| ("start.gap_m", gap_m, TINY, clearance_m));
        let landing = self.landing_speed_m_s.map(|landing| {
            let (min, max) = match self.gap_m {
                Some(gap_m) => (fall_m_s(gap_m), 10.0),
                None => (1e-9, fall_m_s(clearance_m)),
            };
            ("start.landing_speed_m_s", landing, min, max)
        });
        gap.into_iter().chain(landing).collect()
    }

    /// Gap in m, if the section determines it.
    fn gap_m(&self) -> Option<f64> {
        self.gap_m.or_else(|| self.landing_speed_m_s.map(|speed| speed * speed / (2.0 * GRAVITY_M_S2)))
    }
}

/// Journal at the start of a run in a bearing with a radial clearance.
pub(super) fn state(start: Option<&Start>, clearance_m: f64) -> StartState {
    let gap_m = start.and_then(Start::gap_m);
    let gap_share = gap_m.map_or(GAP_SHARE, |gap_m| (gap_m / clearance_m).min(1.0));
    let both = start.and_then(|start| start.gap_m.and(start.landing_speed_m_s));
    let fall = 2.0 * GRAVITY_M_S2 * gap_share * clearance_m;
    let speed_m_s = both.map_or(0.0, |landing| (landing * landing - fall).max(0.0).sqrt());
    StartState { gap_share, speed_m_s }
}

#[cfg(test)]
mod tests {
    use crate::description::TransmissionBench;
    use crate::{Bench, PRESETS};

    fn with_start(lines: &str) -> Result<TransmissionBench, String> {
        let (_, text) = PRESETS[0];
        let text = text.replace("[logging]", &format!("[start]\n{lines}\n[logging]"));
        let bench = Bench::parse("x", &text).map_err(|error| error.to_string())?;
        TransmissionBench::from_bench(bench, "x").map_err(|error| error.to_string())
    }

    #[test]
    fn a_landing_speed_alone_sets_the_gap_of_a_free_fall() {
        let start = with_start("landing_speed_m_s = 0.02").unwrap().start_state();
        let gap_m = start.gap_share * 0.5e-3;
        assert!((gap_m - 0.02 * 0.02 / (2.0 * 9.81)).abs() < 1e-7 && start.speed_m_s == 0.0, "{gap_m}");
    }

    #[test]
    fn a_start_that_no_fall_allows_is_refused() {
        let error = with_start("gap_m = 1e-3").unwrap_err();
        assert_eq!(error, "x: line 45: start.gap_m is 0.001; expected 1e-12 to 5e-4 m");
        let error = with_start("gap_m = 1e-4\nlanding_speed_m_s = 0.01").unwrap_err();
        assert!(error.contains("start.landing_speed_m_s is 0.01; expected 0.04"), "{error}");
        let error = with_start("landing_speed_m_s = 0.2").unwrap_err();
        assert!(error.contains("start.landing_speed_m_s is 0.2; expected 1e-9 to 0.09"), "{error}");
    }
}
