//! Shape of a layer as an image declares it.

use super::SHAPE_LENGTH;
use core::fmt;

/// Kind of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerKind {
    /// 1-D convolution with ReLU.
    Convolution,
    /// Dense layer with raw sums.
    Head,
}

/// Storage form of weights, see [`crate::storage`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WeightForm {
    /// 8 bits each.
    Packed,
    /// 16 bits each.
    Wide,
}

/// Shape of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LayerShape {
    /// Kind of the layer.
    pub kind: LayerKind,
    /// Number of columns per output: the kernel's length.
    pub columns: u8,
    /// Number of values in an input column.
    pub inputs: u16,
    /// Number of outputs per position.
    pub outputs: u16,
    /// Width of the inputs in bits: 8 or 16.
    pub input_bits: u8,
    /// Width of the outputs in bits: 8 or 16; 32 for a head.
    pub output_bits: u8,
    /// Storage form of the weights.
    pub form: WeightForm,
}

impl LayerShape {
    /// Returns the bytes in an image.
    pub(crate) const fn to_bytes(self) -> [u8; SHAPE_LENGTH] {
        let [inputs_low, inputs_high] = self.inputs.to_le_bytes();
        let [outputs_low, outputs_high] = self.outputs.to_le_bytes();
        let kind = match self.kind {
            LayerKind::Convolution => 1,
            LayerKind::Head => 2,
        };
        let form = match self.form {
            WeightForm::Packed => 1,
            WeightForm::Wide => 2,
        };
        [
            kind,
            self.columns,
            inputs_low,
            inputs_high,
            outputs_low,
            outputs_high,
            self.input_bits,
            self.output_bits,
            form,
            0,
            0,
            0,
        ]
    }

    /// Parses a shape, if the bytes are one.
    pub const fn from_bytes(bytes: &[u8; SHAPE_LENGTH]) -> Option<Self> {
        let [kind, columns, in_low, in_high, out_low, out_high, input_bits, output_bits, form, 0, 0, 0] =
            *bytes
        else {
            return None;
        };
        let kind = match kind {
            1 => LayerKind::Convolution,
            2 => LayerKind::Head,
            _ => return None,
        };
        let form = match (form, input_bits) {
            (1, 8 | 16) => WeightForm::Packed,
            (2, 16) => WeightForm::Wide,
            _ => return None,
        };
        let inputs = u16::from_le_bytes([in_low, in_high]);
        let outputs = u16::from_le_bytes([out_low, out_high]);
        if columns == 0 || inputs == 0 || outputs == 0 {
            return None;
        }
        Some(Self { kind, columns, inputs, outputs, input_bits, output_bits, form })
    }

    /// Number of inputs of one output.
    pub const fn taps(&self) -> usize {
        (self.columns as usize).wrapping_mul(self.inputs as usize)
    }

    /// Number of weights in four bytes.
    const fn taps_per_group(&self) -> usize {
        match self.form {
            WeightForm::Packed => 4,
            WeightForm::Wide => 2,
        }
    }

    /// Number of groups of weights of one output.
    pub const fn groups(&self) -> usize {
        self.taps().div_ceil(self.taps_per_group())
    }

    /// Bytes of a convolution's multipliers or of a head's scale.
    const fn scale_length(&self) -> usize {
        match self.kind {
            LayerKind::Convolution => (self.outputs as usize).wrapping_mul(4),
            LayerKind::Head => 8,
        }
    }

    /// Bytes of the layer in an image.
    pub const fn length(&self) -> usize {
        let words = (self.outputs as usize).wrapping_mul(self.groups().wrapping_add(1));
        SHAPE_LENGTH.wrapping_add(self.scale_length()).wrapping_add(words.wrapping_mul(4))
    }
}

impl fmt::Display for LayerShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            LayerKind::Convolution => "a convolution",
            LayerKind::Head => "a head",
        };
        let Self { columns, inputs, outputs, input_bits, output_bits, .. } = self;
        write!(
            f,
            "{kind} of {columns} columns, {inputs} inputs ({input_bits} bits), \
             {outputs} outputs ({output_bits} bits)"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_survives_its_bytes() {
        for (kind, form, input_bits, output_bits) in [
            (LayerKind::Convolution, WeightForm::Packed, 8, 8),
            (LayerKind::Convolution, WeightForm::Wide, 16, 16),
            (LayerKind::Head, WeightForm::Packed, 16, 32),
        ] {
            let shape =
                LayerShape { kind, columns: 5, inputs: 300, outputs: 18, input_bits, output_bits, form };
            assert_eq!(LayerShape::from_bytes(&shape.to_bytes()), Some(shape));
        }
        assert_eq!(LayerShape::from_bytes(&[0; SHAPE_LENGTH]), None);
    }
}
