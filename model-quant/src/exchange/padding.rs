//! Padding of a convolution in ONNX: explicit numbers for every axis, or a named rule.

use super::constants::attribute;
use super::error::{OnnxError, node_error};
use super::proto::Node;
use crate::network::Padding;

/// Padding of a convolution along its columns, whose axis is at `place`; `None` for a kernel of 1,
/// which needs none.
pub(super) fn padding(
    node: &Node,
    spatial: usize,
    place: usize,
    kernel: usize,
) -> Result<Option<Padding>, OnnxError> {
    let same = [(kernel as i64 - 1) / 2, kernel as i64 / 2];
    let mut pads = attribute(node, "pads").map_or(vec![0; 2 * spatial], |attribute| attribute.ints.clone());
    let automatic = attribute(node, "auto_pad").map_or("NOTSET".into(), |a| String::from_utf8_lossy(&a.s));
    let along = match &*automatic {
        "NOTSET" | "" => {
            let expected = || format!("{} numbers, 0 on all axes except the columns", 2 * spatial);
            if pads.len() != 2 * spatial {
                return Err(node_error(node, "pads", format!("{pads:?}"), expected()));
            }
            let (before, after) = (place - 2, place - 2 + spatial);
            let along = [pads[before], pads[after]];
            (pads[before], pads[after]) = (0, 0);
            if pads.iter().any(|&pad| pad != 0) {
                return Err(node_error(node, "pads", format!("{pads:?}"), expected()));
            }
            along
        }
        "SAME_UPPER" => same,
        "VALID" => [0, 0],
        other => return Err(node_error(node, "auto_pad", other, "NOTSET, SAME_UPPER or VALID")),
    };
    match along {
        [0, 0] if kernel == 1 => Ok(None),
        [0, 0] => Ok(Some(Padding::Valid)),
        _ if along == same => Ok(Some(Padding::Same)),
        _ => {
            let expected = format!("[0, 0] ('valid') or {same:?} ('same')");
            Err(node_error(node, "pads along the columns", format!("{along:?}"), expected))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::proto::Attribute;

    fn padding_for(
        pads: &[i64],
        rule: &str,
        spatial: usize,
        place: usize,
        kernel: usize,
    ) -> Option<Option<Padding>> {
        let ints = Attribute { name: "pads".to_owned(), ints: pads.to_vec(), ..Attribute::default() };
        let text = Attribute { name: "auto_pad".to_owned(), s: rule.into(), ..Attribute::default() };
        let node = Node { attribute: vec![ints, text], ..Node::default() };
        padding(&node, spatial, place, kernel).ok()
    }

    #[test]
    fn zeros_on_both_sides_are_same_and_none_are_valid() {
        assert_eq!(padding_for(&[0, 0], "NOTSET", 1, 2, 3), Some(Some(Padding::Valid)));
        assert_eq!(padding_for(&[1, 1], "", 1, 2, 3), Some(Some(Padding::Same)));
        assert_eq!(padding_for(&[1, 2], "NOTSET", 1, 2, 4), Some(Some(Padding::Same)));
        assert_eq!(padding_for(&[2, 1], "NOTSET", 1, 2, 4), None, "one more zero before is another network");
        assert_eq!(padding_for(&[2, 0], "NOTSET", 1, 2, 3), None, "causal");
        assert_eq!(padding_for(&[0, 0], "NOTSET", 1, 2, 1), Some(None), "a kernel of 1 fits both");
        assert_eq!(padding_for(&[0, 1, 0, 1], "NOTSET", 2, 3, 3), Some(Some(Padding::Same)));
        assert_eq!(padding_for(&[1, 0, 1, 0], "NOTSET", 2, 3, 3), None, "zeros on another axis");
        assert_eq!(padding_for(&[0], "NOTSET", 1, 2, 3), None);
        assert_eq!(padding_for(&[], "SAME_UPPER", 1, 2, 4), Some(Some(Padding::Same)));
        assert_eq!(padding_for(&[], "SAME_LOWER", 1, 2, 4), None);
    }
}
