//! Padding of a convolution in ONNX: numbers for every axis, or a rule by name.

use super::constant::attribute;
use super::error::{OnnxError, at};
use super::proto::Node;
use crate::network::Padding;

/// Name of a padding.
pub(super) fn named(padding: Padding) -> &'static str {
    match padding {
        Padding::Valid => "'valid'",
        Padding::Same => "'same'",
    }
}

/// The padding of a convolution along its columns, whose axis is at `place`; `None` for a kernel of 1, which has none.
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
            let expected = || format!("{} numbers, 0 beside the columns", 2 * spatial);
            if pads.len() != 2 * spatial {
                return Err(at(node, "pads", format!("{pads:?}"), expected()));
            }
            let (before, behind) = (place - 2, place - 2 + spatial);
            let along = [pads[before], pads[behind]];
            (pads[before], pads[behind]) = (0, 0);
            if pads.iter().any(|&pad| pad != 0) {
                return Err(at(node, "pads", format!("{pads:?}"), expected()));
            }
            along
        }
        "SAME_UPPER" => same,
        "VALID" => [0, 0],
        other => return Err(at(node, "auto_pad", other, "NOTSET, SAME_UPPER or VALID")),
    };
    match along {
        [0, 0] if kernel == 1 => Ok(None),
        [0, 0] => Ok(Some(Padding::Valid)),
        _ if along == same => Ok(Some(Padding::Same)),
        _ => {
            let expected = format!("[0, 0] ('valid') or {same:?} ('same')");
            Err(at(node, "pads along the columns", format!("{along:?}"), expected))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::proto::Attribute;

    fn of(pads: &[i64], rule: &str, spatial: usize, place: usize, kernel: usize) -> Option<Option<Padding>> {
        let ints = Attribute { name: "pads".to_owned(), ints: pads.to_vec(), ..Attribute::default() };
        let text = Attribute { name: "auto_pad".to_owned(), s: rule.into(), ..Attribute::default() };
        let node = Node { attribute: vec![ints, text], ..Node::default() };
        padding(&node, spatial, place, kernel).ok()
    }

    #[test]
    fn zeros_on_both_sides_are_same_and_none_are_valid() {
        assert_eq!(of(&[0, 0], "NOTSET", 1, 2, 3), Some(Some(Padding::Valid)));
        assert_eq!(of(&[1, 1], "", 1, 2, 3), Some(Some(Padding::Same)));
        assert_eq!(of(&[1, 2], "NOTSET", 1, 2, 4), Some(Some(Padding::Same)));
        assert_eq!(of(&[2, 1], "NOTSET", 1, 2, 4), None, "one more zero before is another network");
        assert_eq!(of(&[2, 0], "NOTSET", 1, 2, 3), None, "causal");
        assert_eq!(of(&[0, 0], "NOTSET", 1, 2, 1), Some(None), "a kernel of 1 fits both");
        assert_eq!(of(&[0, 1, 0, 1], "NOTSET", 2, 3, 3), Some(Some(Padding::Same)));
        assert_eq!(of(&[1, 0, 1, 0], "NOTSET", 2, 3, 3), None, "zeros beside the columns");
        assert_eq!(of(&[0], "NOTSET", 1, 2, 3), None);
        assert_eq!(of(&[], "SAME_UPPER", 1, 2, 4), Some(Some(Padding::Same)));
        assert_eq!(of(&[], "SAME_LOWER", 1, 2, 4), None);
    }
}
