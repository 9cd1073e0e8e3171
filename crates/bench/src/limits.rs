//! What each plant leaves out, as sentences that a report can print.

/// A plant's omissions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Plant, as a description or this crate names it.
    pub plant: &'static str,
    /// What its model leaves out, one sentence each.
    pub sentences: &'static [&'static str],
}

/// The omissions of every plant.
pub const LIMITS: &[Limits] = &[
    Limits {
        plant: "transmission-bench",
        sentences: &[
            "The shaft moves in its plane and does not tilt: edge loading is left to the two-plane bench.",
            "Levers, shaft and frame are rigid; their bending is not modelled.",
            "The bearing runs dry: no film of lubricant, no squeeze film, no seal unless an effect adds it.",
            "The clearance circle is round and does not wear during a run.",
            "Contact is one point of the circle with a force law; pressure around the arc is not resolved.",
            "The damping of sustained contact is that of the last onset, by the latched approach speed and its floor.",
            "Temperature is constant: friction and clearance do not follow it.",
            "The load cylinder gives its force whatever it moves, frictionless unless the description says otherwise.",
            "With play in the fork, the damping of a hydraulic column in series is left out.",
        ],
    },
    Limits {
        plant: "two-plane",
        sentences: &[
            "Levers, shaft and frame are rigid; the shaft tilts but does not bend.",
            "Drive and load act at fixed offsets along the shaft, without moments of their own; the tilt is small.",
            "Slices of the bearing do not support each other: the bearing body is an elastic foundation.",
            "The ends of the bearing are as stiff as its middle.",
            "Gyroscopic moments of the slow shaft are left out.",
            "The drive is rigid: no hydraulic column, no play in the fork.",
            "The controller sees the journal in the bearing's middle only: of contact at the ends it knows nothing.",
            "As on the planar bench: dry, round, no wear during a run, constant temperature.",
        ],
    },
    Limits {
        plant: "friction-rig",
        sentences: &[
            "The motion is given: the axis cannot stick, slip or shake by itself.",
            "The friction of the surfaces is a stated truth set in the shape of published curves, not a measurement.",
            "The load is the same over the whole surface; wear and temperature are left out.",
            "Below the width of its sign the force rises with speed instead of with displacement.",
        ],
    },
    Limits {
        plant: "slider-crank",
        sentences: &[
            "The crank's speed is prescribed; the drive does not feel the impacts.",
            "One clearance joint, without friction; every other joint is ideal.",
            "No gravity; rod and slider are rigid.",
            "Beyond about two revolutions trajectories decorrelate: only statistics can be compared.",
        ],
    },
    Limits {
        plant: "multibody",
        sentences: &[
            "Ideal joints without friction or clearance; rigid bodies in the plane.",
            "Constraints hold to the integrator's tolerance, not exactly.",
        ],
    },
];

/// What a plant leaves out; empty for an unknown name.
pub fn limits(plant: &str) -> &'static [&'static str] {
    LIMITS.iter().find(|l| l.plant == plant).map_or(&[], |l| l.sentences)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_plant_of_a_description_says_what_it_leaves_out() {
        for plant in ["transmission-bench", "two-plane", "friction-rig", "slider-crank", "multibody"] {
            assert!(limits(plant).len() >= 2, "{plant}");
            assert!(limits(plant).iter().all(|s| s.ends_with('.') && s.len() < 130), "{plant}");
        }
        assert!(limits("teapot").is_empty());
    }
}
