//! Cycle jumping: the change in one cycle, extrapolated over many, with error control.
//!
//! A jump holds the loads of one cycle for `n` cycles. It is made once in one piece and once in two
//! halves, with the loads computed again between them. Their difference is the error of the jump,
//! and the halves are the result. A jump is repeated with fewer cycles if the error or the change
//! is larger than allowed. Jump cycles in fatigue and wear: Cojocaru and Karlsson, Int. J. Fatigue
//! 28 (2006) 1677; for clearance joints with an adaptive extrapolation: Mukras et al., Wear 268
//! (2010) 643.

/// A system that changes slowly from cycle to cycle.
pub(crate) trait CyclicSystem {
    /// Slow state.
    type State: Clone;
    /// Result of a cycle that determines the change.
    type Loads;
    /// Error.
    type Error: From<TooManyJumps>;

    /// Computes the loads of a cycle at a state.
    ///
    /// # Errors
    ///
    /// The cycle cannot be computed.
    fn loads(&mut self, state: &Self::State, cycle: f64) -> Result<Self::Loads, Self::Error>;

    /// Changes a state by a number of cycles with given loads.
    ///
    /// # Errors
    ///
    /// The change cannot be computed.
    fn advance(
        &self,
        state: &Self::State,
        loads: &Self::Loads,
        cycles: f64,
    ) -> Result<Self::State, Self::Error>;

    /// Largest difference between two states, in the unit of the control.
    fn difference(&self, a: &Self::State, b: &Self::State) -> f64;
}

/// Limits of a jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JumpControl {
    /// Largest change of a jump.
    pub largest_change: f64,
    /// Largest difference between one jump and two halves.
    pub tolerance: f64,
    /// Maximum number of jumps, repeated ones included.
    pub max_jumps: usize,
}

/// The life needs more jumps than allowed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{jumps} jumps reached cycle {cycle:.0} only; expected the end of the life: allow larger jumps")]
pub struct TooManyJumps {
    /// Jumps.
    pub jumps: usize,
    /// Cycle reached.
    pub cycle: f64,
}

/// Largest growth of a jump from one to the next.
const GROWTH: f64 = 3.0;
/// Distance from the limits.
const MARGIN: f64 = 0.9;

/// Runs a system from cycle 0 to an end. `see` gets the first cycle and every accepted one, and
/// ends the life by returning false. A jump of one cycle is accepted in any case.
///
/// # Errors
///
/// The system's errors, and too many jumps.
pub(crate) fn jump_cycles<S: CyclicSystem>(
    system: &mut S,
    start: S::State,
    end: f64,
    control: &JumpControl,
    mut see: impl FnMut(f64, &S::State, &S::Loads) -> bool,
) -> Result<S::State, S::Error> {
    let (mut state, mut cycle, mut jump) = (start, 0.0, 1.0_f64);
    let mut loads = system.loads(&state, cycle)?;
    let mut continues = see(cycle, &state, &loads);
    let mut jumps = 0;
    while continues && cycle < end {
        jumps += 1;
        if jumps > control.max_jumps {
            return Err(TooManyJumps { jumps: control.max_jumps, cycle }.into());
        }
        let length = jump.min(end - cycle);
        let one = system.advance(&state, &loads, length)?;
        let half = system.advance(&state, &loads, 0.5 * length)?;
        let loads_half = system.loads(&half, cycle + 0.5 * length)?;
        let two = system.advance(&half, &loads_half, 0.5 * length)?;
        let error = system.difference(&one, &two) / control.tolerance;
        let change = system.difference(&state, &two) / control.largest_change;
        // The error grows with the square of the length, the change with the length.
        let factor = MARGIN * (1.0 / error.sqrt()).min(1.0 / change);
        jump = (length * factor.clamp(0.1, GROWTH)).max(1.0);
        if error.max(change) > 1.0 && length > 1.0 {
            continue;
        }
        (state, cycle) = (two, cycle + length);
        loads = system.loads(&state, cycle)?;
        continues = see(cycle, &state, &loads);
    }
    Ok(state)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::rc::Rc;

    /// Wear that slows down as the surfaces conform: `h' = r exp(-h/c)`, so `h = c ln(1 + r n/c)`.
    struct RunningIn {
        cycles_computed: usize,
    }

    const RATE: f64 = 1e-9;
    const SCALE: f64 = 1e-5;

    impl CyclicSystem for RunningIn {
        type State = f64;
        type Loads = f64;
        type Error = TooManyJumps;

        fn loads(&mut self, depth: &f64, _: f64) -> Result<f64, TooManyJumps> {
            self.cycles_computed += 1;
            Ok(RATE * (-depth / SCALE).exp())
        }

        fn advance(&self, depth: &f64, rate: &f64, cycles: f64) -> Result<f64, TooManyJumps> {
            Ok(depth + rate * cycles)
        }

        fn difference(&self, a: &f64, b: &f64) -> f64 {
            (a - b).abs()
        }
    }

    fn run(tolerance: f64, largest_change: f64, max_jumps: usize) -> (Result<f64, TooManyJumps>, usize) {
        let mut system = RunningIn { cycles_computed: 0 };
        let control = JumpControl { largest_change, tolerance, max_jumps };
        let end = jump_cycles(&mut system, 0.0, 1e6, &control, |_, _, _| true);
        (end, system.cycles_computed)
    }

    #[test]
    fn a_million_cycles_take_few_cycles_and_have_the_error_of_their_tolerance() {
        let exact = SCALE * (1.0 + RATE * 1e6 / SCALE).ln();
        let error = |tolerance: f64| {
            let (found, computed) = run(tolerance, 1.0, 10_000);
            ((found.unwrap() / exact - 1.0).abs(), computed)
        };
        let [(coarse, few), (fine, many)] = [error(1e-6), error(1e-8)];
        assert!(coarse < 0.1 && fine < 0.01 && fine < 0.2 * coarse, "{coarse} {fine}");
        assert!(few < 100 && many > few && many < 1000, "{few} {many}");
    }

    #[test]
    fn a_jump_is_the_result_of_its_halves() {
        let mut system = RunningIn { cycles_computed: 0 };
        let control = JumpControl { largest_change: 1.0, tolerance: 1.0, max_jumps: 1 };
        let end = jump_cycles(&mut system, 0.0, 1.0, &control, |_, _, _| true).unwrap();
        let halves = 0.5 * RATE * (1.0 + (-0.5 * RATE / SCALE).exp());
        assert!((end / halves - 1.0).abs() < 1e-9, "{end} {halves}");
    }

    #[test]
    fn no_jump_changes_more_than_allowed() {
        let mut system = RunningIn { cycles_computed: 0 };
        let control = JumpControl { largest_change: 1e-6, tolerance: 1.0, max_jumps: 1000 };
        let mut depths = Vec::new();
        let end = jump_cycles(&mut system, 0.0, 1e6, &control, |_, depth, _| {
            depths.push(*depth);
            *depth < 3e-5
        });
        assert!(depths.windows(2).all(|pair| pair[1] - pair[0] <= 1e-6 && pair[1] > pair[0]));
        assert!(depths.len() > 30 && (3e-5..3.2e-5).contains(&end.unwrap()), "ends when the caller ends it");
    }

    #[test]
    fn too_many_jumps_are_an_error_with_the_cycle_reached() {
        let (found, _) = run(1e-12, 1.0, 50);
        let error = found.unwrap_err();
        assert!(error.jumps == 50 && error.cycle > 0.0 && error.cycle < 1e6, "{error}");
    }

    /// Wear that is a thousand times faster under a hard layer. It remembers the error and the
    /// change of the last jump.
    #[derive(Default)]
    struct Breakthrough {
        last: Rc<Cell<[f64; 2]>>,
    }

    const LAYER: f64 = 1e-7;

    impl CyclicSystem for Breakthrough {
        type State = f64;
        type Loads = f64;
        type Error = TooManyJumps;

        fn loads(&mut self, depth: &f64, _: f64) -> Result<f64, TooManyJumps> {
            Ok(if *depth < LAYER { 1e-12 } else { 1e-9 })
        }

        fn advance(&self, depth: &f64, rate: &f64, cycles: f64) -> Result<f64, TooManyJumps> {
            Ok(depth + rate * cycles)
        }

        fn difference(&self, a: &f64, b: &f64) -> f64 {
            let difference = (a - b).abs();
            self.last.set([self.last.get()[1], difference]);
            difference
        }
    }

    #[test]
    fn a_jump_over_a_sudden_change_is_repeated_shorter() {
        for (largest_change, tolerance) in [(2e-7, 1.0), (1.0, 1e-9)] {
            let control = JumpControl { largest_change, tolerance, max_jumps: 1000 };
            let mut system = Breakthrough::default();
            let (last, mut before) = (system.last.clone(), 0.0);
            let see = |cycle, _: &f64, _: &f64| {
                let [error, change] = last.get();
                let is_held = error <= tolerance && change <= largest_change;
                assert!(is_held || cycle - before <= 1.0, "cycle {cycle}: {error} {change}");
                before = cycle;
                true
            };
            let end = jump_cycles(&mut system, 0.0, 1.2e5, &control, see).unwrap();
            let exact = LAYER + 2e4 * 1e-9;
            assert!((end / exact - 1.0).abs() < 0.1, "{end} {exact}");
        }
    }
}
