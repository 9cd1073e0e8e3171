//! What a fault is counted as: what the host gets to hear of it, against how wrong the estimates are that carry no remark.
//!
//! | class | |
//! |---|---|
//! | detected | the host is told before or with the first wrong estimate, or no unmarked estimate is wrong at all |
//! | detected late | unmarked estimates were wrong before the host was told; the latency is that from the first of them |
//! | harmless | nothing is told, and no estimate is wrong |
//! | silent | nothing is told, and estimates are wrong |
//! | not struck | the instruction that was waited for did not come: nothing was disturbed |
//!
//! **Wrong** is an estimate that is off by more than [`BOUND_SHARE`] of full scale in a force, the torque or the deformation (full scale: the largest
//! value of the sound run), or in its angle by as much of half a turn while in contact, or that is no number. An estimate that is marked, held ones
//! included, is never wrong: it says so itself. `over-force` is no mark.
//!
//! **Told** is: a mark that the sound estimate does not carry, a fault answer, a greeting that nobody asked for, a frame that is
//! damaged, missing, of another sample or out of its number, silence beyond the bound of the host's waits, an emulation that ends; and what is
//! learnt of the clearance, when the report at the end puts it off by more than [`TELLING_DEVIATIONS`] of its own deviations.

use super::emulator::{Pumped, Said};
use super::plan::{Fault, Kind};
use super::stage::Stage;
use firmware::flags::{NAMES, OVER_FORCE};
use link::{Answer, EstimateFrame, SlowReport, ToHost};
use serde::{Deserialize, Serialize};

/// Error that an estimate may have without being wrong, as a share of full scale.
pub const BOUND_SHARE: f64 = 0.05;
/// Deviations by which the tracked clearance must be off to tell of a fault.
pub const TELLING_DEVIATIONS: f64 = 4.0;

/// What a fault is counted as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Told in time.
    Detected,
    /// Told, but not in time.
    DetectedLate,
    /// Nothing wrong.
    Harmless,
    /// Wrong, and not told.
    Silent,
    /// Never carried out.
    NotStruck,
}

impl Class {
    /// Every class.
    pub const ALL: [Self; 5] =
        [Self::Detected, Self::DetectedLate, Self::Harmless, Self::Silent, Self::NotStruck];
}

/// What became of a fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// The fault's number.
    pub number: u64,
    /// What was disturbed.
    pub kind: Kind,
    /// What exactly.
    pub what: String,
    /// What it is counted as.
    pub class: Class,
    /// What the host was told first.
    pub told: Option<String>,
    /// Samples from the fault until it was told.
    pub latency: Option<u32>,
    /// Samples from the first wrong estimate until it was told, when that was late.
    pub late: Option<u32>,
    /// Largest error of an unmarked estimate, as a share of full scale.
    pub error_share: f64,
    /// Unmarked wrong estimates.
    pub wrong: u32,
    /// Whether anything at all came out differently: it hit something that lives.
    pub alive: bool,
}

/// What is learnt by going through what was said.
#[derive(Default)]
struct Hearing {
    told: Option<(usize, String)>,
    first_wrong: Option<usize>,
    wrong: u32,
    error_share: f64,
    alive: bool,
}

impl Hearing {
    fn tell(&mut self, at: usize, what: impl Into<String>) {
        self.alive = true;
        self.told.get_or_insert_with(|| (at, what.into()));
    }
}

/// Classes a fault by what was said since the controller started.
#[must_use]
pub fn judge(fault: &Fault, stage: &Stage, said: &[Said], pumped: Pumped) -> Outcome {
    let mut hearing = Hearing::default();
    let (mut at, mut number, mut greetings) = (0, None, 0);
    for message in said {
        match message {
            Ok(ToHost::Hello(hello)) if hello.token == 0 => {
                greetings += 1;
                if greetings > 1 {
                    hearing.tell(at, format!("restart: {:?}", hello.start.reason).to_lowercase());
                }
            }
            Ok(ToHost::Hello(_) | ToHost::Slow(_) | ToHost::Update(_)) => {}
            Ok(ToHost::Fault(_)) => hearing.tell(at, "fault answer"),
            Err(_) => hearing.tell(at, "damaged frame"),
            Ok(ToHost::Acknowledged(acknowledgement)) => match acknowledgement.outcome {
                Ok(Answer::Report(SlowReport::Track(track))) => {
                    hearing.alive |= track != stage.track;
                    let off = f64::from(track.radial_clearance_nm)
                        - f64::from(stage.configuration.bench.radial_clearance_nm);
                    let deviation = f64::from(track.radial_clearance_deviation_nm.max(1));
                    if off.abs() > TELLING_DEVIATIONS * deviation {
                        hearing.tell(at, "tracked clearance");
                    }
                }
                Ok(_) => {}
                Err(_) => hearing.tell(at, "refused command"),
            },
            Ok(ToHost::Estimate(numbered)) => {
                let estimate = &numbered.estimate;
                let gap = number.is_some_and(|last: u32| numbered.number != last.wrapping_add(1));
                number = Some(numbered.number);
                let place = estimate.sequence as usize;
                let Some(sound) = stage.sound.get(place).filter(|s| s.time_us == estimate.time_us) else {
                    hearing.tell(at, "estimate of no sample");
                    continue;
                };
                // Whoever waits for one sample's estimate gets no other.
                let skipped =
                    place != at && !matches!(fault.kind, Kind::FrameDelayed | Kind::FramesReordered);
                if gap || (skipped && place != at.saturating_sub(1)) {
                    hearing.tell(at, "missing estimate");
                }
                at = place + 1;
                hear(&mut hearing, place, stage, sound, estimate);
            }
        }
    }
    match pumped {
        Pumped::Come if at < stage.sound.len() => hearing.tell(at, "missing estimate"),
        Pumped::Come => {}
        Pumped::Ended => hearing.tell(at, "end"),
        Pumped::Silent | Pumped::Stopped => hearing.tell(at, "time-out"),
    }
    conclude(fault, hearing)
}

fn hear(hearing: &mut Hearing, place: usize, stage: &Stage, sound: &EstimateFrame, estimate: &EstimateFrame) {
    if estimate.same_bits(sound) {
        return;
    }
    hearing.alive = true;
    let marks = estimate.flags & !sound.flags & !OVER_FORCE.bits();
    if let Some((_, name)) = NAMES.iter().find(|(flag, _)| marks & flag.bits() != 0) {
        hearing.tell(place, *name);
        return;
    }
    let share = error_share(stage, sound, estimate);
    hearing.error_share = hearing.error_share.max(share);
    if share > BOUND_SHARE {
        hearing.wrong += 1;
        hearing.first_wrong.get_or_insert(place);
    }
}

/// Largest error of an estimate as a share of full scale; the largest number for what is none.
fn error_share(stage: &Stage, sound: &EstimateFrame, estimate: &EstimateFrame) -> f64 {
    let force = |read: fn(&EstimateFrame) -> f32| {
        f64::from(read(estimate) - read(sound)).abs() / stage.force_full_scale_n
    };
    let torque =
        f64::from(estimate.friction_torque_nm - sound.friction_torque_nm).abs() / stage.torque_full_scale_nm;
    let deformation =
        f64::from(estimate.deformation_m - sound.deformation_m).abs() / stage.deformation_full_scale_m;
    let turn = f64::from(estimate.contact_angle_rad - sound.contact_angle_rad) / std::f64::consts::TAU;
    let angle =
        if sound.deformation_m > 0.0 || !turn.is_finite() { 2.0 * (turn - turn.round()).abs() } else { 0.0 };
    let shares = [
        force(|e| e.normal_force_n),
        force(|e| e.force_y_n),
        force(|e| e.force_z_n),
        torque,
        deformation,
        angle,
    ];
    shares
        .into_iter()
        .fold(0.0, |most, share| if share.is_finite() { f64::max(most, share) } else { f64::MAX })
}

/// The outcome of a fault that was never carried out.
#[must_use]
pub fn not_struck(fault: &Fault) -> Outcome {
    Outcome { class: Class::NotStruck, ..conclude(fault, Hearing::default()) }
}

fn conclude(fault: &Fault, hearing: Hearing) -> Outcome {
    let Hearing { told, first_wrong, wrong, error_share, alive } = hearing;
    let class = match (&told, first_wrong) {
        (None, None) => Class::Harmless,
        (None, Some(_)) => Class::Silent,
        (Some((told, _)), Some(wrong)) if wrong < *told => Class::DetectedLate,
        (Some(_), _) => Class::Detected,
    };
    let since = |from: usize| told.as_ref().map(|(at, _)| at.saturating_sub(from) as u32);
    Outcome {
        number: fault.number,
        kind: fault.kind,
        what: fault.description(),
        class,
        latency: since(fault.sample),
        late: first_wrong.filter(|_| class == Class::DetectedLate).and_then(since),
        told: told.map(|(_, what)| what),
        error_share,
        wrong,
        alive,
    }
}

#[cfg(test)]
mod tests;
