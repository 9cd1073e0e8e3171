//! Animated sketch of a mechanism's run for its report: the bodies as lines through their points,
//! the forces of the clearance joints on their journals as arrows.
//!
//! An SVG and at most [`MAX_FRAMES`] frames, which the script of the page plays. Where the reader
//! prefers reduced motion it waits for the button. Without scripts the start is shown.

use bench::description::{JointKind, JointSection, MechanismBench};
use bench::plants::mechanism::Snapshot;
use std::fmt::Write;

/// Maximum number of frames.
const MAX_FRAMES: usize = 240;
/// Length of the largest force's arrow relative to the width of the sketch.
const ARROW_SHARE: f64 = 0.2;
/// Margin around the bodies relative to their extent.
const MARGIN: f64 = 0.15;

/// Points of a body in its own axes, in m: ends of a bar, then its joints.
fn points_of(bench: &MechanismBench, index: usize, start: &[f64; 3]) -> Vec<[f64; 2]> {
    let Some(body) = bench.body.get(index) else { return Vec::new() };
    let own = |joint: &&JointSection| joint.first == body.name || joint.second == body.name;
    let of_joint = |joint: &JointSection| match joint.to_m {
        Some(end_m) if joint.second == body.name => end_m,
        _ => joint.at_m,
    };
    let ends = [body.from_m, body.to_m].into_iter().flatten();
    let mut all: Vec<[f64; 2]> = ends.chain(bench.joint.iter().filter(own).map(of_joint)).collect();
    all.dedup();
    let (sin, cos) = start[2].sin_cos();
    let local = |[x, y]: [f64; 2]| {
        let (x, y) = (x - start[0], y - start[1]);
        [cos * x + sin * y, cos * y - sin * x]
    };
    all.into_iter().map(local).collect()
}

/// A point of a body in the axes of the ground.
fn placed([x, y, angle]: [f64; 3], [along, across]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    [x + cos * along - sin * across, y + sin * along + cos * across]
}

/// Clearance joints: index of the contact, index of the journal's body or none for the ground, and
/// the journal's centre in the axes of that body.
fn journals(bench: &MechanismBench, first: &Snapshot) -> Vec<(usize, Option<usize>, [f64; 2])> {
    let mut contact = 0;
    let mut all = Vec::new();
    for joint in &bench.joint {
        if joint.kind == JointKind::Clearance {
            let body = bench.body.iter().position(|body| body.name == joint.second);
            let start = body.and_then(|body| first.bodies.get(body)).map_or([0.0; 3], |s| s.position);
            let (sin, cos) = start[2].sin_cos();
            let [x, y] = [0, 1].map(|k| joint.at_m[k] + joint.offset_m[k] - start[k]);
            all.push((contact, body, [cos * x + sin * y, cos * y - sin * x]));
        }
        contact += joint.contacts();
    }
    all
}

/// A number with four significant digits of the sketch's extent.
fn short(value: f64, extent: f64) -> String {
    let digits = (4.0 - extent.max(1e-9).log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{value:.digits$}")
}

/// Joins values as a JSON array.
fn array(values: impl Iterator<Item = String>) -> String {
    format!("[{}]", values.collect::<Vec<_>>().join(","))
}

/// Picture of the start, and the frames as JSON.
pub(crate) struct Sketch {
    pub(crate) svg: String,
    pub(crate) frames: String,
}

/// Draws the sketch; none for a run without samples.
pub(crate) fn sketch(bench: &MechanismBench, samples: &[Snapshot]) -> Option<Sketch> {
    let first = samples.first()?;
    let every = samples.len().div_ceil(MAX_FRAMES).max(1);
    let frames: Vec<&Snapshot> = samples.iter().step_by(every).collect();
    let starts = first.bodies.iter().map(|body| body.position);
    let points: Vec<Vec<[f64; 2]>> = starts.enumerate().map(|(i, at)| points_of(bench, i, &at)).collect();
    let everywhere = frames.iter().flat_map(|s| {
        s.bodies.iter().zip(&points).flat_map(|(body, own)| {
            std::iter::once([0.0; 2]).chain(own.iter().copied()).map(|point| placed(body.position, point))
        })
    });
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in everywhere {
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
    }
    let extent = (high[0] - low[0]).max(high[1] - low[1]).max(1e-6);
    let margin = MARGIN * extent;
    let size = [0, 1].map(|k| high[k] - low[k] + 2.0 * margin);
    let n = |value: f64| short(value, extent);
    let mut svg = format!(
        "<svg viewBox=\"{} {} {} {}\" role=\"img\" aria-label=\"Sketch of the mechanism\" \
         style=\"width:100%;max-height:28rem\"><defs><marker id=\"head\" viewBox=\"0 0 8 8\" \
         refX=\"7\" refY=\"4\" markerWidth=\"7\" markerHeight=\"7\" orient=\"auto\">\
         <path d=\"M0 0 8 4 0 8z\" fill=\"#d55e00\"/></marker></defs>\
         <g transform=\"scale(1,-1)\" fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\">",
        n(low[0] - margin),
        n(-high[1] - margin),
        n(size[0]),
        n(size[1])
    );
    for (own, body) in points.iter().zip(&first.bodies) {
        let line: Vec<String> = own.iter().map(|[x, y]| format!("{},{}", n(*x), n(*y))).collect();
        let [x, y, angle] = body.position;
        // Writing to a text cannot fail.
        let _ = write!(
            svg,
            "<g data-body transform=\"translate({} {}) rotate({:.3})\"><polyline points=\"{}\" \
             stroke=\"#000000\" stroke-width=\"3\" vector-effect=\"non-scaling-stroke\"/><circle \
             r=\"{}\" fill=\"#000000\"/></g>",
            n(x),
            n(y),
            angle.to_degrees(),
            line.join(" "),
            n(0.008 * extent)
        );
    }
    let journals = journals(bench, first);
    for _ in &journals {
        svg.push_str(
            "<line data-force stroke=\"#d55e00\" stroke-width=\"2\" marker-end=\"url(#head)\" \
             vector-effect=\"non-scaling-stroke\"/>",
        );
    }
    svg.push_str("</g></svg>");
    let bodies = array(frames.iter().map(|s| {
        array(s.bodies.iter().map(|body| {
            let [x, y, angle] = body.position;
            format!("[{},{},{:.3}]", n(x), n(y), angle.to_degrees())
        }))
    }));
    let forces = arrows(&frames, &journals, ARROW_SHARE * size[0], extent);
    let times = array(frames.iter().map(|s| format!("{:.6}", s.time_s)));
    let frames = format!("{{\"times\":{times},\"bodies\":{bodies},\"forces\":{forces}}}");
    Some(Sketch { svg, frames })
}

/// Both ends of every arrow in every frame.
fn arrows(
    frames: &[&Snapshot],
    journals: &[(usize, Option<usize>, [f64; 2])],
    longest_m: f64,
    extent: f64,
) -> String {
    let force = |s: &Snapshot, contact: usize| {
        s.contacts.get(contact).map_or([0.0; 2], |c| {
            let [x, y] = c.offset_m;
            let distance_m = x.hypot(y).max(f64::MIN_POSITIVE);
            let n = [x / distance_m, y / distance_m];
            [-c.normal_n * n[0] - c.friction_n * n[1], -c.normal_n * n[1] + c.friction_n * n[0]]
        })
    };
    let sizes = frames.iter().flat_map(|s| journals.iter().map(move |j| force(s, j.0)));
    let largest_n = sizes.map(|[x, y]| x.hypot(y)).fold(0.0, f64::max);
    let scale = if largest_n > 0.0 { longest_m / largest_n } else { 0.0 };
    array(frames.iter().map(|s| {
        array(journals.iter().map(|(contact, body, local)| {
            let at = body.and_then(|body| s.bodies.get(body)).map_or([0.0; 3], |b| b.position);
            let ([x, y], [fx, fy]) = (placed(at, *local), force(s, *contact));
            let ends = [x, y, x + scale * fx, y + scale * fy];
            array(ends.into_iter().map(|value| short(value, extent)))
        }))
    }))
}
