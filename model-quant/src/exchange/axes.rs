//! What the axes of a value mean on its way through a graph.
//!
//! Frameworks order axes differently and move them around (Keras: batch x columns x channels, with a further axis of size 1
//! around every convolution; PyTorch: batch x channels x columns). Following the meaning of each axis makes all of these the
//! same network.

use super::constant::{Constants, attribute, integer};
use super::error::{OnnxError, at};
use super::proto::Node;

/// Meaning of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// Samples.
    Batch,
    /// An axis of size 1 without meaning.
    One,
    /// First axis of the input behind the batch, before a convolution has told which it is.
    First,
    /// Second axis of the input behind the batch.
    Second,
    /// Columns of the window.
    Columns,
    /// Values of a column.
    Channels,
    /// Columns and channels in one, columns outside.
    ByColumn,
    /// Columns and channels in one, channels outside.
    ByChannel,
    /// Outputs of a dense layer.
    Dense,
}

impl Meaning {
    /// Whether the axis has everything behind the batch.
    pub const fn is_flat(self) -> bool {
        matches!(self, Self::Dense | Self::ByColumn | Self::ByChannel)
    }
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// Meaning.
    pub meaning: Meaning,
    /// Size; of no interest for the batch.
    pub size: usize,
}

impl Axis {
    /// An axis without meaning.
    pub const ONE: Self = Self { meaning: Meaning::One, size: 1 };
}

/// Counts an axis from the front: negative ones are counted from the end.
fn position(node: &Node, axis: i64, rank: usize) -> Result<usize, OnnxError> {
    let found =
        if axis < 0 { rank.checked_sub(axis.unsigned_abs() as usize) } else { usize::try_from(axis).ok() };
    let inside = found.filter(|&found| found < rank);
    inside.ok_or_else(|| at(node, "axis", axis, format!("one of {rank} axes")))
}

/// Axes of `Transpose`.
pub fn transpose(node: &Node, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let reversed: Vec<i64> = (0..axes.len() as i64).rev().collect();
    let order = attribute(node, "perm").map_or(reversed, |attribute| attribute.ints.clone());
    let mut seen = vec![false; axes.len()];
    for &axis in &order {
        if let Some(seen) = usize::try_from(axis).ok().and_then(|axis| seen.get_mut(axis)) {
            *seen = true;
        }
    }
    if order.len() != axes.len() || seen.contains(&false) {
        return Err(at(node, "perm", format!("{order:?}"), format!("an order of {} axes", axes.len())));
    }
    order.iter().map(|&axis| Ok(axes[position(node, axis, axes.len())?])).collect()
}

/// The axes that `Squeeze` or `Unsqueeze` names: an attribute before opset 13, an input since.
fn named(node: &Node, constants: &Constants<'_>) -> Result<Vec<i64>, OnnxError> {
    match attribute(node, "axes") {
        Some(attribute) => Ok(attribute.ints.clone()),
        None => constants.integers(node, 1, "axes"),
    }
}

/// Axes of `Unsqueeze`.
pub fn unsqueeze(node: &Node, constants: &Constants<'_>, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let named = named(node, constants)?;
    let [axis] = named[..] else { return Err(at(node, "axes", format!("{named:?}"), "one axis")) };
    let mut found = axes.to_vec();
    found.insert(position(node, axis, axes.len() + 1)?, Axis::ONE);
    Ok(found)
}

/// Axes of `Squeeze`.
pub fn squeeze(node: &Node, constants: &Constants<'_>, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let named = named(node, constants)?;
    let gone: Vec<usize> =
        named.iter().map(|&axis| position(node, axis, axes.len())).collect::<Result<_, _>>()?;
    for &place in &gone {
        if axes[place].meaning != Meaning::One {
            return Err(at(node, "axes", format!("{named:?}"), "only axes of size 1 without meaning"));
        }
    }
    Ok(axes.iter().enumerate().filter(|(place, _)| !gone.contains(place)).map(|(_, axis)| *axis).collect())
}

/// Axes of `Flatten`.
pub fn flatten(node: &Node, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    match integer(node, "axis", 1) {
        1 => flat(node, axes),
        axis => Err(at(node, "axis", axis, 1)),
    }
}

/// Axes of `Reshape`: axes of size 1 come and go, or everything behind the batch becomes one axis.
pub fn reshape(node: &Node, constants: &Constants<'_>, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let shape = constants.integers(node, 1, "shape")?;
    let count: Option<usize> =
        axes.iter().skip(1).try_fold(1usize, |count, axis| count.checked_mul(axis.size));
    let rows = if integer(node, "allowzero", 0) == 0 { &[-1, 0, 1][..] } else { &[-1, 1] };
    let fits = |size: i64, expected: Option<usize>| size == -1 || usize::try_from(size).ok() == expected;
    if let [batch, all] = shape[..]
        && fits(all, count)
        && (rows.contains(&batch) || batch > 0 && all == -1)
    {
        return flat(node, axes);
    }
    let mut rest = axes.iter().filter(|axis| axis.meaning != Meaning::One).peekable();
    let mut found = Vec::new();
    for &size in shape.iter().take(axes.len() + 2) {
        match rest.peek() {
            Some(axis) if axis.meaning == Meaning::Batch || fits(size, Some(axis.size)) => {
                found.push(**axis);
                rest.next();
            }
            _ if size == 1 => found.push(Axis::ONE),
            _ => break,
        }
    }
    if found.len() == shape.len()
        && rest.next().is_none()
        && shape.iter().filter(|&&size| size == -1).count() <= 1
    {
        return Ok(found);
    }
    let sizes: Vec<usize> = axes.iter().skip(1).map(|axis| axis.size).collect();
    let expected = format!("all of {sizes:?} behind the batch in one axis, or the same with axes of size 1");
    Err(at(node, "shape", format!("{shape:?}"), expected))
}

/// Everything behind the batch in one axis.
fn flat(node: &Node, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let kept: Vec<Axis> = axes.iter().filter(|axis| axis.meaning != Meaning::One).copied().collect();
    let [batch, rest @ ..] = &kept[..] else {
        return Err(at(node, "input", "no axes", "a batch of windows"));
    };
    let axis = match rest {
        [only] if only.meaning.is_flat() => *only,
        [a, b] => {
            let meaning = match (a.meaning, b.meaning) {
                (Meaning::Columns, Meaning::Channels) => Meaning::ByColumn,
                (Meaning::Channels, Meaning::Columns) => Meaning::ByChannel,
                _ => return Err(at(node, "input", "no convolution before it", "a convolution before it")),
            };
            Axis { meaning, size: a.size.saturating_mul(b.size) }
        }
        _ => return Err(at(node, "input", format!("{} axes", axes.len()), "batch, columns and channels")),
    };
    if batch.meaning != Meaning::Batch {
        return Err(at(node, "input", "another axis first", "the batch first"));
    }
    Ok(vec![*batch, axis])
}
