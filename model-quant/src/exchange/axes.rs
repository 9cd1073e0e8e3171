//! Meaning of the axes of a value in an ONNX graph.
//!
//! Frameworks order axes differently and permute them. Keras uses batch x columns x channels, with
//! a further axis of size 1 around every convolution; PyTorch uses batch x channels x columns. With
//! the meaning of each axis known, all of these are the same network.

use super::constants::{Constants, attribute, integer};
use super::error::{OnnxError, node_error};
use super::proto::Node;

/// Meaning of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meaning {
    /// Samples of a batch.
    Batch,
    /// Axis of size 1 without meaning.
    One,
    /// First axis of the input after the batch, while its meaning is unknown: the first convolution
    /// decides it.
    First,
    /// Second axis of the input after the batch.
    Second,
    /// Columns of the window.
    Columns,
    /// Values of a column.
    Channels,
    /// Columns and channels flattened, columns as the outer index.
    ByColumn,
    /// Columns and channels flattened, channels as the outer index.
    ByChannel,
    /// Outputs of a dense layer.
    Dense,
}

impl Meaning {
    /// Returns true if the axis contains everything after the batch.
    pub(crate) const fn is_flat(self) -> bool {
        matches!(self, Self::Dense | Self::ByColumn | Self::ByChannel)
    }
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Axis {
    /// Meaning.
    pub meaning: Meaning,
    /// Size; unused for the batch.
    pub size: usize,
}

impl Axis {
    /// Axis without meaning.
    pub(crate) const ONE: Self = Self { meaning: Meaning::One, size: 1 };
}

/// Resolves an axis index: negative ones count from the end.
fn position(node: &Node, axis: i64, rank: usize) -> Result<usize, OnnxError> {
    let found =
        if axis < 0 { rank.checked_sub(axis.unsigned_abs() as usize) } else { usize::try_from(axis).ok() };
    let inside = found.filter(|&found| found < rank);
    inside.ok_or_else(|| node_error(node, "axis", axis, format!("one of {rank} axes")))
}

/// Axes after `Transpose`.
pub(crate) fn transpose(node: &Node, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let reversed: Vec<i64> = (0..axes.len() as i64).rev().collect();
    let order = attribute(node, "perm").map_or(reversed, |attribute| attribute.ints.clone());
    let mut seen = vec![false; axes.len()];
    for &axis in &order {
        if let Some(seen) = usize::try_from(axis).ok().and_then(|axis| seen.get_mut(axis)) {
            *seen = true;
        }
    }
    if order.len() != axes.len() || seen.contains(&false) {
        return Err(node_error(
            node,
            "perm",
            format!("{order:?}"),
            format!("an order of {} axes", axes.len()),
        ));
    }
    order.iter().map(|&axis| Ok(axes[position(node, axis, axes.len())?])).collect()
}

/// Axis list of `Squeeze` or `Unsqueeze`: an attribute before opset 13, an input since.
fn named(node: &Node, constants: &Constants<'_>) -> Result<Vec<i64>, OnnxError> {
    match attribute(node, "axes") {
        Some(attribute) => Ok(attribute.ints.clone()),
        None => constants.integers(node, 1, "axes"),
    }
}

/// Axes after `Unsqueeze`.
pub(crate) fn unsqueeze(
    node: &Node,
    constants: &Constants<'_>,
    axes: &[Axis],
) -> Result<Vec<Axis>, OnnxError> {
    let named = named(node, constants)?;
    let [axis] = named[..] else { return Err(node_error(node, "axes", format!("{named:?}"), "one axis")) };
    let mut found = axes.to_vec();
    found.insert(position(node, axis, axes.len() + 1)?, Axis::ONE);
    Ok(found)
}

/// Axes after `Squeeze`.
pub(crate) fn squeeze(node: &Node, constants: &Constants<'_>, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let named = named(node, constants)?;
    let gone: Vec<usize> =
        named.iter().map(|&axis| position(node, axis, axes.len())).collect::<Result<_, _>>()?;
    for &place in &gone {
        if axes[place].meaning != Meaning::One {
            return Err(node_error(
                node,
                "axes",
                format!("{named:?}"),
                "only axes of size 1 without meaning",
            ));
        }
    }
    Ok(axes.iter().enumerate().filter(|(place, _)| !gone.contains(place)).map(|(_, axis)| *axis).collect())
}

/// Axes after `Flatten`.
pub(crate) fn flatten(node: &Node, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    match integer(node, "axis", 1) {
        1 => flat(node, axes),
        axis => Err(node_error(node, "axis", axis, 1)),
    }
}

/// Axes after `Reshape`, which may add or remove axes of size 1, or flatten everything after the
/// batch.
pub(crate) fn reshape(node: &Node, constants: &Constants<'_>, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
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
    let mut remaining = axes.iter().filter(|axis| axis.meaning != Meaning::One).peekable();
    let mut found = Vec::new();
    for &size in shape.iter().take(axes.len() + 2) {
        match remaining.peek() {
            Some(axis) if axis.meaning == Meaning::Batch || fits(size, Some(axis.size)) => {
                found.push(**axis);
                remaining.next();
            }
            _ if size == 1 => found.push(Axis::ONE),
            _ => break,
        }
    }
    if found.len() == shape.len()
        && remaining.next().is_none()
        && shape.iter().filter(|&&size| size == -1).count() <= 1
    {
        return Ok(found);
    }
    let sizes: Vec<usize> = axes.iter().skip(1).map(|axis| axis.size).collect();
    let expected = format!("all of {sizes:?} after the batch in one axis, or the same with axes of size 1");
    Err(node_error(node, "shape", format!("{shape:?}"), expected))
}

/// Flattens everything after the batch into one axis.
fn flat(node: &Node, axes: &[Axis]) -> Result<Vec<Axis>, OnnxError> {
    let sized: Vec<Axis> = axes.iter().filter(|axis| axis.meaning != Meaning::One).copied().collect();
    let [batch, remaining @ ..] = &sized[..] else {
        return Err(node_error(node, "input", "no axes", "a batch of windows"));
    };
    let axis = match remaining {
        [only] if only.meaning.is_flat() => *only,
        [a, b] => {
            let meaning = match (a.meaning, b.meaning) {
                (Meaning::Columns, Meaning::Channels) => Meaning::ByColumn,
                (Meaning::Channels, Meaning::Columns) => Meaning::ByChannel,
                _ => {
                    return Err(node_error(
                        node,
                        "input",
                        "no convolution before it",
                        "a convolution before it",
                    ));
                }
            };
            Axis { meaning, size: a.size.saturating_mul(b.size) }
        }
        _ => {
            return Err(node_error(
                node,
                "input",
                format!("{} axes", axes.len()),
                "batch, columns and channels",
            ));
        }
    };
    if batch.meaning != Meaning::Batch {
        return Err(node_error(node, "input", "another axis first", "the batch first"));
    }
    Ok(vec![*batch, axis])
}
