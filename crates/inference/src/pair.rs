//! The two networks chained, one sample at a time: state in, forces out.

use crate::features::quantise;
use crate::flags::Flags;
use crate::layout::{COLLISION_TAPS, FRICTION_TAPS, WINDOW};
use crate::model::Model;
use crate::network::Stream;
use crate::state::{ContactState, Estimate};

/// A model with the history of both of its networks.
///
/// The collision network gives the square root of the normal force over a power of the deformation; the friction
/// network takes that root and the sliding speed and gives the coefficient of friction. Without contact both forces are
/// exactly 0. An input that is not a finite number gives 0 and starts the history anew.
#[derive(Clone, Debug)]
pub struct Pair<'a> {
    model: Model<'a>,
    collision: Stream<COLLISION_TAPS>,
    friction: Stream<FRICTION_TAPS>,
    seen: u8,
}

impl<'a> Pair<'a> {
    /// Starts with an empty history.
    pub fn new(model: Model<'a>) -> Self {
        Self { model, collision: Stream::default(), friction: Stream::default(), seen: 0 }
    }

    /// Forgets the history: the next [`WINDOW`] - 1 samples are flagged [`Flags::WARMING_UP`].
    pub fn reset(&mut self) {
        self.collision = Stream::default();
        self.friction = Stream::default();
        self.seen = 0;
    }

    /// The model.
    pub fn model(&self) -> &Model<'a> {
        &self.model
    }

    /// Takes one sample and estimates its forces.
    pub fn step(&mut self, state: &ContactState) -> Estimate {
        if !state.is_finite() {
            self.reset();
            return Estimate { flags: Flags::NON_FINITE | Flags::WARMING_UP, ..Estimate::default() };
        }
        let header = self.model.header_ref();
        let column = header.collision_column(state);
        let (raw, clipped_collision) = self.collision.step(self.model.collision(), &quantise(&column.inputs));
        let output = raw.max(0) as f32 * self.model.collision().head.scale();
        let root_force = output * column.root_force_factor;
        let normal_force_n = root_force * root_force;

        let inputs = quantise(&header.friction_column(root_force, state.sliding_speed_m_s));
        let (raw, clipped_friction) = self.friction.step(self.model.friction(), &inputs);
        let coefficient = raw.max(0) as f32 * self.model.friction().head.scale();
        let magnitude = coefficient * normal_force_n;
        let friction_force_n = if state.sliding_speed_m_s > 0.0 {
            -magnitude
        } else if state.sliding_speed_m_s < 0.0 {
            magnitude
        } else {
            0.0
        };

        let saturated = clipped_collision.wrapping_add(clipped_friction);
        self.seen = self.seen.saturating_add(1);
        let flags = column.flags
            | Flags::OUTSIDE_FORCE.when(normal_force_n > header.normal_force_n.high)
            | Flags::SATURATED.when(saturated > 0)
            | Flags::WARMING_UP.when(usize::from(self.seen) < WINDOW);
        Estimate { normal_force_n, friction_force_n, flags, saturated }
    }
}
