//! The points of a sweep: one bench each, checked before the first run.

use super::specification::{MAX_RUNS, Sampling, Specification, Values, between};
use crate::cli::error::CliError;
use bench::description::TransmissionBench;
use bench::{BearingMaterial, Bench};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// One point of a sweep.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Values in the order of the specification's parameters.
    pub(crate) values: Vec<f64>,
    /// The bench with its effects applied.
    pub(crate) bench: TransmissionBench,
}

/// Returns all points of a sweep in a fixed order: the last parameter changes fastest, the bearing
/// slowest.
pub(crate) fn points(
    file: &str,
    specification: &Specification,
    base: &Bench,
) -> Result<Vec<Point>, CliError> {
    let base = TransmissionBench::from_bench(base.clone(), &format!("{file}: bench"))?;
    let bearings = if specification.bearings.is_empty() {
        vec![None]
    } else {
        specification.bearings.iter().copied().map(Some).collect()
    };
    let tuples = values(file, specification)?;
    let total = tuples.len().saturating_mul(bearings.len());
    if total > MAX_RUNS {
        return Err(too_many(file, total));
    }
    let mut points = Vec::with_capacity(total);
    for bearing in bearings {
        for values in &tuples {
            let bench = bench(file, specification, &base, bearing, values, points.len())?;
            points.push(Point { values: values.clone(), bench });
        }
    }
    Ok(points)
}

fn too_many(file: &str, found: usize) -> CliError {
    CliError::Input(format!("{file}: found {found} runs; expected at most {MAX_RUNS}"))
}

fn values(file: &str, specification: &Specification) -> Result<Vec<Vec<f64>>, CliError> {
    let each: Vec<Values> = specification
        .parameters
        .iter()
        .map(|p| {
            p.values(specification.sampling).map_err(|(found, expected)| {
                CliError::Input(format!("{file}: parameters.{}: found {found}; expected {expected}", p.path))
            })
        })
        .collect::<Result<_, _>>()?;
    if specification.sampling == Sampling::Random {
        let count = specification.count.unwrap_or_default();
        return Ok((0..count as u64).map(|index| draw(&each, specification.seed, index)).collect());
    }
    let mut tuples: Vec<Vec<f64>> = vec![Vec::new()];
    for values in each {
        let Values::List(list) = values else { continue };
        if tuples.len().saturating_mul(list.len()) > MAX_RUNS {
            return Err(too_many(file, tuples.len().saturating_mul(list.len())));
        }
        let longer = |tuple: &Vec<f64>| {
            let tuple = tuple.clone();
            list.iter().map(move |v| tuple.iter().copied().chain([*v]).collect()).collect::<Vec<Vec<f64>>>()
        };
        tuples = tuples.iter().flat_map(longer).collect();
    }
    Ok(tuples)
}

/// One random point, from its own stream: it does not depend on how many others there are.
fn draw(each: &[Values], seed: u64, index: u64) -> Vec<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index);
    each.iter()
        .map(|values| {
            let share = (rng.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
            match values {
                Values::List(list) => {
                    let place = (share * list.len() as f64) as usize;
                    list.get(place).copied().unwrap_or_default()
                }
                Values::Between { from, to, scale } => between(*from, *to, *scale, share),
            }
        })
        .collect()
}

fn bench(
    file: &str,
    specification: &Specification,
    base: &TransmissionBench,
    bearing: Option<BearingMaterial>,
    values: &[f64],
    index: usize,
) -> Result<TransmissionBench, CliError> {
    let mut bench = base.clone();
    if let Some(bearing) = bearing {
        bench.set_material(bearing);
    }
    let mut bench = Bench::from(bench);
    let fixed = specification.fixed.iter().map(|(path, value)| (("fixed", path), *value));
    let varied = specification.parameters.iter().map(|p| ("parameters", &p.path)).zip(values.iter().copied());
    for ((table, path), value) in fixed.chain(varied) {
        let Some(place) = bench.parameter_mut(path) else {
            return Err(CliError::Input(format!(
                "{file}: {table}.{path}: found no such parameter; expected a dotted name of the bench \
                 description, such as shaft.mass_kg"
            )));
        };
        *place = value;
    }
    let run = format!("{file}: run {index}");
    Ok(TransmissionBench::from_bench(bench.checked(&run)?.resolved(), &run)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sweep(text: &str) -> Result<Vec<Point>, CliError> {
        let specification = Specification::parse("s.toml", text)?;
        points("s.toml", &specification, &Bench::open(&specification.bench)?)
    }

    #[test]
    fn a_grid_has_every_combination_in_order() {
        let points = sweep(
            "bearings = [\"babbitt\", \"plastic\"]\n[fixed]\n\"load.force_n\" = 5e3\n[[parameters]]\npath = \
             \"shaft.mass_kg\"\nvalues = [100, 200]\n[[parameters]]\npath = \"bearing.radial_clearance_m\"\n\
             values = \
             [1e-4, 5e-4]",
        )
        .unwrap();
        let found: Vec<_> = points
            .iter()
            .map(|p| {
                (p.bench.bearing.material.name(), p.bench.shaft.mass_kg, p.bench.bearing.radial_clearance_m)
            })
            .collect();
        let both = |m| [(m, 100.0, 1e-4), (m, 100.0, 5e-4), (m, 200.0, 1e-4), (m, 200.0, 5e-4)];
        assert_eq!(found, [both("babbitt"), both("plastic")].concat());
        assert!(points.iter().all(|p| p.bench.load.force_n == 5e3));
    }

    #[test]
    fn random_points_stay_in_range_and_do_not_depend_on_their_number() {
        let text = |count: u32, seed: u32| {
            format!(
                "sampling = \"random\"\ncount = {count}\nseed = {seed}\n[[parameters]]\npath = \
                 \"bearing.radial_clearance_m\"\nrange = {{ from = 1e-4, to = 1e-3, scale = \"log\" }}\n\
                 [[parameters]]\npath = \"shaft.mass_kg\"\nvalues = [100, 150]"
            )
        };
        let values = |count, seed| {
            sweep(&text(count, seed)).unwrap().into_iter().map(|p| p.values).collect::<Vec<_>>()
        };
        let (short, long) = (values(5, 1), values(50, 1));
        assert_eq!(short, long[..5]);
        assert_ne!(long, values(50, 2));
        assert!(long.iter().all(|v| (1e-4..=1e-3).contains(&v[0]) && (v[1] == 100.0 || v[1] == 150.0)));
        assert!(long.iter().any(|v| v[1] == 100.0) && long.iter().any(|v| v[1] == 150.0));
    }

    #[test]
    fn a_path_or_a_value_that_the_bench_does_not_take_is_refused_before_any_run() {
        let error = |text: &str| sweep(text).unwrap_err().to_string();
        let found = error("[[parameters]]\npath = \"shaft.colour\"\nvalues = [1]");
        assert!(found.contains("parameters.shaft.colour: found no such parameter"), "{found}");
        let found = error("[[parameters]]\npath = \"bearing.radial_clearance_m\"\nvalues = [1e-4, 0.5]");
        assert!(found.starts_with("s.toml: run 1: "), "{found}");
        assert!(found.contains("bearing.radial_clearance_m is 0.5; expected"), "{found}");
        let found = error("bench = \"friction-rig\"\n[[parameters]]\npath = \"axis.inertia\"\nvalues = [1]");
        assert!(found.contains("expected `transmission-bench`"), "{found}");
        let wide = "range = { from = 1, to = 2, count = 1000 }\n";
        let found = error(&format!(
            "[[parameters]]\npath = \"shaft.mass_kg\"\n{wide}[[parameters]]\npath = \"shaft.inertia_kg_m2\"\n\
             {wide}"
        ));
        assert!(found.contains("found 1000000 runs; expected at most 100000"), "{found}");
    }
}
