//! Text for the impacts that a controller recorded.

use link::{ImpactEnd, ImpactRecord};

/// Time of a record in s.
pub(crate) fn seconds(us: u32) -> f64 {
    f64::from(us) * 1e-6
}

/// Word for the end of a record.
pub(crate) const fn end(end: ImpactEnd) -> &'static str {
    match end {
        ImpactEnd::Separation => "separation",
        ImpactEnd::Settled => "settled",
        ImpactEnd::Interrupted => "interrupted",
    }
}

/// Describes a record in one line.
pub(crate) fn line(r: &ImpactRecord) -> String {
    let ratio = r.speed_ratio().map(|value| format!(", speed ratio {value:.2}")).unwrap_or_default();
    format!(
        "impact {} at {:.4} s: peak {:.0} +- {:.0} N, {:.2} ms, {:.3} J{ratio}, {}",
        r.number,
        seconds(r.onset_us),
        r.peak_force_n,
        r.peak_force_sd_n,
        f64::from(r.duration_us) * 1e-3,
        r.energy_lost_j,
        end(r.end)
    )
}
