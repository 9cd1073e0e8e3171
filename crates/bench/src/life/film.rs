//! Film of a finite journal bearing: Reynolds' equation with cavitation, solved once into a table.
//!
//! In the frame of the line of centres, with the angle `t` from the widest gap, `H = 1 + e cos t`
//! and the axial coordinate `z` over the length:
//!
//! ```text
//! d/dt(H^3 dP/dt) + (R/L)^2 d/dz(H^3 dP/dz) = V cos(t + a),   p = 12 eta (R/c)^2 P
//! V cos a = de/dt,   V sin a = e (w/2 - g')
//! ```
//!
//! with the shaft's speed `w` and the rate `g'` of the line of centres. Rotation and squeeze are
//! one velocity of size `V` and direction `a`, so forces are a table over `e` and `a` (impedance
//! method: Booker, J. Basic Eng. 87 (1965) 537; Childs, Moes and van Leeuwen, J. Lubr. Technol. 99
//! (1977) 198). Cavitation is Reynolds' condition, `P >= 0` with a free boundary, by projected
//! over-relaxation (Christopherson, Proc. Inst. Mech. Eng. 146 (1941) 126). It does not conserve
//! mass at the onset of the film. The ends are at ambient pressure; the film is isothermal,
//! laminar and of constant viscosity, which for grease is that of its base oil at the film's shear.

use std::f64::consts::{PI, TAU};

/// Cavitation of the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cavitation {
    /// None: the film carries tension. For comparison with closed forms.
    None,
    /// Pressure at least ambient, with a free boundary.
    Free,
    /// The same, with a groove at the widest gap: the film begins there (Raimondi and Boyd).
    Grooved,
}

/// Reynolds' equation of one bearing on a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reynolds {
    /// Length over diameter.
    pub slenderness: f64,
    /// Cavitation.
    pub cavitation: Cavitation,
    /// Cells around the circumference.
    pub around: usize,
    /// Cells along half of the length.
    pub along: usize,
}

/// Force of the film on the journal over `12 eta V (R/c)^2 R L`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmForce {
    /// Along the eccentricity, outwards.
    pub radial: f64,
    /// Across, towards growing angles.
    pub tangential: f64,
}

/// Change of the pressure, relative to the largest one, that ends the iteration.
const CONVERGED: f64 = 1e-7;
/// Sweeps at most. The table needs some hundreds.
const MAX_SWEEPS: usize = 20_000;

impl Reynolds {
    /// Grid of the table.
    pub(crate) fn tabulated(slenderness: f64) -> Self {
        Self { slenderness, cavitation: Cavitation::Free, around: 240, along: 8 }
    }

    /// Solves for an eccentricity from 0 to below 1 and a direction of the velocity in rad.
    pub fn force(&self, eccentricity: f64, direction_rad: f64) -> FilmForce {
        let (around, along) = (self.around, self.along);
        let (step, depth) = (TAU / around as f64, 0.5 / along as f64);
        let cubed = |angle: f64| (1.0 + eccentricity * angle.cos()).powi(3);
        // Cells lie between the widest gap and the next one, so that a groove is at a face.
        let middle = |i: usize| (i as f64 + 0.5) * step;
        let faces: Vec<f64> = (0..=around).map(|i| cubed(i as f64 * step) / (step * step)).collect();
        let axial = 1.0 / (4.0 * self.slenderness * self.slenderness * depth * depth);
        let columns: Vec<Column> = (0..around)
            .map(|i| {
                // A groove is half a cell away and has no pressure.
                let factor = |face: usize| match self.cavitation {
                    Cavitation::Grooved if face.is_multiple_of(around) => (2.0, 0.0),
                    _ => (1.0, 1.0),
                };
                let (left, right) = (factor(i), factor(i + 1));
                Column {
                    left: faces[i] * left.1,
                    right: faces[i + 1] * right.1,
                    along: cubed(middle(i)) * axial,
                    around: faces[i] * left.0 + faces[i + 1] * right.0,
                    source: (middle(i) + direction_rad).cos(),
                }
            })
            .collect();
        let pressure = self.relax(&columns);
        let mut force = FilmForce::default();
        for (i, row) in pressure.chunks(along).enumerate() {
            let total = row.iter().sum::<f64>() * 2.0 * depth * step;
            // The eccentricity points to the narrowest gap, at a half turn.
            force.radial += total * middle(i).cos();
            force.tangential += total * middle(i).sin();
        }
        force
    }

    /// Relaxes the pressure, cell by cell along the length and column by column around.
    fn relax(&self, columns: &[Column]) -> Vec<f64> {
        let (around, along) = (self.around, self.along);
        let over = 2.0 / (1.0 + PI / (2.0 * along as f64).max(self.slenderness * around as f64 / 3.0));
        let mut pressure = vec![0.0; around * along];
        for _ in 0..MAX_SWEEPS {
            let (mut largest, mut change) = (0.0_f64, 0.0_f64);
            for (i, column) in columns.iter().enumerate() {
                let (before, after) = ((i + around - 1) % around * along, (i + 1) % around * along);
                for j in 0..along {
                    let at = i * along + j;
                    // Symmetric at the middle of the length, ambient at the end.
                    let inner = if j > 0 { pressure[at - 1] } else { 0.0 };
                    let outer = if j + 1 < along { pressure[at + 1] } else { 0.0 };
                    let links = f64::from(u8::from(j > 0)) + if j + 1 < along { 1.0 } else { 2.0 };
                    let inflow = column.left * pressure[before + j]
                        + column.right * pressure[after + j]
                        + column.along * (inner + outer)
                        - column.source;
                    let balanced = inflow / (column.around + column.along * links);
                    let mut next = pressure[at] + over * (balanced - pressure[at]);
                    if self.cavitation != Cavitation::None {
                        next = next.max(0.0);
                    }
                    change = change.max((next - pressure[at]).abs());
                    largest = largest.max(next.abs());
                    pressure[at] = next;
                }
            }
            if change <= CONVERGED * largest {
                break;
            }
        }
        pressure
    }
}

/// Coefficients of a column of cells along the length.
struct Column {
    left: f64,
    right: f64,
    along: f64,
    around: f64,
    source: f64,
}

/// Eccentricities of the table; closer where the film is thin.
const ECCENTRICITIES: [f64; 15] =
    [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.93, 0.95, 0.97, 0.98];
/// Directions of the table from approach (0) over rotation to separation (pi).
const DIRECTIONS: usize = 25;

/// Forces of a film over eccentricity and direction.
#[derive(Clone, Debug)]
pub struct FilmTable {
    rows: Vec<[FilmForce; DIRECTIONS]>,
}

/// Factor that flattens the growth of the force towards a thin film.
fn flattening(eccentricity: f64) -> f64 {
    (1.0 - eccentricity * eccentricity).powi(2)
}

impl FilmTable {
    /// Solves for all eccentricities and directions.
    pub fn new(slenderness: f64) -> Self {
        let grid = Reynolds::tabulated(slenderness);
        let row = |eccentricity: &f64| {
            std::array::from_fn(|i| {
                let force = grid.force(*eccentricity, PI * i as f64 / (DIRECTIONS - 1) as f64);
                force.times(flattening(*eccentricity))
            })
        };
        Self { rows: ECCENTRICITIES.iter().map(row).collect() }
    }

    /// Force at an eccentricity and a direction in rad. Beyond the table it grows by the power of
    /// `1 - e^2` of the last two rows.
    pub fn force(&self, eccentricity: f64, direction_rad: f64) -> FilmForce {
        let [.., before, last] = ECCENTRICITIES;
        let inside = self.interpolated(eccentricity.min(last), direction_rad);
        if eccentricity <= last {
            return inside;
        }
        let rest = |e: f64| 1.0 - e * e;
        let growth = inside.size() / self.interpolated(before, direction_rad).size();
        let power = growth.ln() / (rest(before) / rest(last)).ln();
        inside.times((rest(last) / rest(eccentricity)).powf(power))
    }

    fn interpolated(&self, eccentricity: f64, direction_rad: f64) -> FilmForce {
        let turned = direction_rad.rem_euclid(TAU);
        let (direction, side) = if turned > PI { (TAU - turned, -1.0) } else { (turned, 1.0) };
        let (row, share) = place(&ECCENTRICITIES, eccentricity.max(0.0));
        let column = direction / PI * (DIRECTIONS - 1) as f64;
        let left = (column as usize).min(DIRECTIONS - 2);
        let along = |row: usize| self.rows[row][left].mixed(&self.rows[row][left + 1], column - left as f64);
        let force = along(row).mixed(&along(row + 1), share).times(1.0 / flattening(eccentricity));
        FilmForce { tangential: side * force.tangential, ..force }
    }
}

/// Interval of an ascending list and the place in it.
fn place(values: &[f64], value: f64) -> (usize, f64) {
    let interval = values.partition_point(|v| *v <= value).clamp(1, values.len() - 1) - 1;
    (interval, (value - values[interval]) / (values[interval + 1] - values[interval]))
}

impl FilmForce {
    fn times(self, factor: f64) -> Self {
        Self { radial: factor * self.radial, tangential: factor * self.tangential }
    }

    fn mixed(&self, other: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + share * (b - a);
        Self { radial: mix(self.radial, other.radial), tangential: mix(self.tangential, other.tangential) }
    }

    /// Size of the force.
    pub fn size(&self) -> f64 {
        self.radial.hypot(self.tangential)
    }
}

/// Lubricant film in series with a dry contact.
///
/// The film thins under load until the roughness touches at `min_film_m`. It carries what it can at
/// this thickness, and the dry contact carries the remainder.
#[derive(Clone, Debug)]
pub(crate) struct MixedFilm {
    /// Table for the bearing's length over its diameter.
    pub table: FilmTable,
    /// Viscosity, Pa s.
    pub viscosity_pa_s: f64,
    /// Film thickness at which the surfaces touch, m.
    pub min_film_m: f64,
    /// Bearing radius, m.
    pub radius_m: f64,
    /// Bearing length, m.
    pub length_m: f64,
}

impl MixedFilm {
    /// Largest force in N that the film carries at a clearance in m and an entraining speed `w/2 -
    /// g'` in rad/s.
    pub(crate) fn capacity_n(&self, clearance_m: f64, entrainment_rad_s: f64) -> f64 {
        let eccentricity = (1.0 - self.min_film_m / clearance_m).max(0.0);
        let rate = eccentricity * entrainment_rad_s.abs();
        let slope = self.radius_m / clearance_m;
        let scale = 12.0 * self.viscosity_pa_s * rate * slope * slope * self.radius_m * self.length_m;
        scale * self.table.force(eccentricity, PI / 2.0).size()
    }

    /// Share of a normal force in N that the film carries, 0 to 1.
    pub(crate) fn share(&self, force_n: f64, clearance_m: f64, entrainment_rad_s: f64) -> f64 {
        let capacity_n = self.capacity_n(clearance_m, entrainment_rad_s);
        if capacity_n >= force_n { 1.0 } else { capacity_n / force_n }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solve(slenderness: f64, cavitation: Cavitation, eccentricity: f64) -> FilmForce {
        let grid = Reynolds { slenderness, cavitation, around: 180, along: 12 };
        grid.force(eccentricity, PI / 2.0)
    }

    /// Sommerfeld number `eta N (R/c)^2/P` of a steady force: `1/(6 pi e w)`.
    fn sommerfeld(eccentricity: f64, force: &FilmForce) -> f64 {
        1.0 / (6.0 * PI * eccentricity * force.size())
    }

    /// Angle between load and line of centres in degrees.
    fn attitude_deg(force: &FilmForce) -> f64 {
        force.tangential.abs().atan2(-force.radial).to_degrees()
    }

    /// Sommerfeld 1904, no cavitation: `w = pi/((2 + e^2) sqrt(1 - e^2)) * 2/1` across the line of
    /// centres; the load is `12 pi eta U L (R/c)^2 e/((2 + e^2) sqrt(1 - e^2))`.
    #[test]
    fn a_long_bearing_has_sommerfelds_force() {
        for eccentricity in [0.3, 0.6] {
            let force = solve(40.0, Cavitation::None, eccentricity);
            let root = f64::sqrt(1.0 - eccentricity * eccentricity);
            let expected = 2.0 * PI / ((2.0 + eccentricity * eccentricity) * root);
            let ratio = force.tangential.abs() / expected;
            assert!((ratio - 1.0).abs() < 0.02 && force.radial.abs() < 1e-3 * expected, "{force:?} {ratio}");
        }
    }

    /// DuBois and Ocvirk, NACA 1157 (1953): half film, load `eta U L^3 e/(4 c^2 (1 - e^2)^2)
    /// sqrt(16 e^2 + pi^2 (1 - e^2))`, attitude `tan = pi sqrt(1 - e^2)/(4 e)`.
    #[test]
    fn a_short_bearing_has_ocvirks_force() {
        let slenderness = 0.05;
        for eccentricity in [0.2, 0.5, 0.8] {
            let force = solve(slenderness, Cavitation::Free, eccentricity);
            let rest = 1.0 - eccentricity * eccentricity;
            let root = (16.0 * eccentricity * eccentricity + PI * PI * rest).sqrt();
            let expected = slenderness * slenderness * root / (6.0 * rest * rest);
            assert!((force.size() / expected - 1.0).abs() < 0.02, "{} {expected}", force.size());
            let attitude = (PI * rest.sqrt()).atan2(4.0 * eccentricity).to_degrees();
            assert!((attitude_deg(&force) - attitude).abs() < 0.7, "{} {attitude}", attitude_deg(&force));
        }
    }

    /// Raimondi and Boyd, ASLE Trans. 1 (1958) 194, part III: full bearing with the film from the
    /// widest gap on. Friction variable `2 pi^2 S/sqrt(1 - e^2) + (e/2) sin(attitude)`.
    #[test]
    fn finite_bearings_agree_with_the_table_of_raimondi_and_boyd() {
        for (slenderness, eccentricity, number, attitude, friction) in [
            (1.0, 0.2, 0.631, 74.02, 12.8),
            (1.0, 0.4, 0.264, 63.10, 5.79),
            (1.0, 0.6, 0.121, 50.58, 3.22),
            (1.0, 0.8, 0.0446, 36.24, 1.70),
            (0.5, 0.6, 0.319, 48.14, 8.10),
            (0.5, 0.8, 0.0923, 33.31, 3.26),
        ] {
            let force = solve(slenderness, Cavitation::Grooved, eccentricity);
            let (found, angle) = (sommerfeld(eccentricity, &force), attitude_deg(&force));
            assert!((found / number - 1.0).abs() < 0.02, "{slenderness} {eccentricity}: {found} {number}");
            assert!((angle - attitude).abs() < 0.6, "{slenderness} {eccentricity}: {angle} {attitude}");
            let root = f64::sqrt(1.0 - eccentricity * eccentricity);
            let variable = 2.0 * PI * PI * found / root + 0.5 * eccentricity * angle.to_radians().sin();
            assert!((variable / friction - 1.0).abs() < 0.02, "{variable} {friction}");
        }
    }

    /// Pure squeeze of a long bearing without cavitation: `12 pi eta L (R/c)^3 c e'/(1 -
    /// e^2)^(3/2)` against the motion (Pinkus and Sternlicht 1961).
    #[test]
    fn a_squeezed_long_bearing_has_its_closed_form() {
        let grid = Reynolds { slenderness: 40.0, cavitation: Cavitation::None, around: 180, along: 12 };
        for eccentricity in [0.3, 0.7] {
            let force = grid.force(eccentricity, 0.0);
            let expected = PI / (1.0 - eccentricity * eccentricity).powf(1.5);
            assert!((-force.radial / expected - 1.0).abs() < 0.02, "{force:?} {expected}");
            assert!(force.tangential.abs() < 1e-6 * expected);
        }
    }

    #[test]
    fn the_table_equals_the_equation_between_its_nodes() {
        let table = FilmTable::new(1.0);
        let grid = Reynolds::tabulated(1.0);
        for (eccentricity, direction) in [(0.55, 0.9), (0.84, 1.6), (0.935, 2.0), (0.84, -1.6)] {
            let (found, exact) = (table.force(eccentricity, direction), grid.force(eccentricity, direction));
            let error = (found.radial - exact.radial).hypot(found.tangential - exact.tangential);
            assert!(error < 0.05 * exact.size(), "{eccentricity} {direction}: {found:?} {exact:?}");
        }
        let fine = Reynolds { around: 1440, ..grid }.force(0.99, PI / 2.0).size();
        let beyond = table.force(0.99, PI / 2.0).size();
        assert!((beyond / fine - 1.0).abs() < 0.1, "{beyond} {fine}");
        let approaching = table.force(0.9, 0.0);
        assert!(approaching.radial < 0.0 && table.force(0.9, PI).size() < 0.1 * approaching.size());
    }

    #[test]
    fn film_and_dry_contact_share_the_force_at_the_least_thickness() {
        let film = MixedFilm {
            table: FilmTable::new(1.0),
            viscosity_pa_s: 0.1,
            min_film_m: 50e-6,
            radius_m: 0.07,
            length_m: 0.14,
        };
        // Eccentricity 0.9 at 0.5 mm: Sommerfeld number 0.0188 of Raimondi and Boyd.
        let turns_s = 2.0 / TAU;
        let expected_n = 0.1 * turns_s * (0.07_f64 / 0.5e-3).powi(2) * 2.0 * 0.07 * 0.14 / 0.0188;
        let capacity_n = film.capacity_n(0.5e-3, 1.0);
        assert!((capacity_n / expected_n - 1.0).abs() < 0.05, "{capacity_n} {expected_n}");
        assert_eq!(film.share(0.5 * capacity_n, 0.5e-3, -1.0), 1.0);
        assert!((film.share(4.0 * capacity_n, 0.5e-3, 1.0) - 0.25).abs() < 1e-12);
        assert_eq!(film.share(1e3, 0.5e-3, 0.0), 0.0);
    }
}
