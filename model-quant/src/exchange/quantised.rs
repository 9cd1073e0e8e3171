//! Quantisation of a single imported network: calibration on its samples, encoding, evaluation,
//! error.

use super::input_scale::InputScale;
use super::interpreter::Interpreter;
use super::samples::Samples;
use crate::network::Network;
use crate::quantise::QuantiseError;
use crate::quantise::fixed_point::{Activations, Layer, quantise_layers};
use crate::quantise::image::AlignedImage;
use crate::quantise::mode::{Mode, Plan};
use inference::ImageError;
use inference::image::write::layers;
use inference::image::{LayerName, LayerShape, Unproven, prove};
use serde::Serialize;

/// Name of the network in messages.
const NAME: &str = "imported";

/// A single network in fixed point.
#[derive(Clone, Debug)]
pub(crate) struct QuantisedNetwork {
    /// Its layers, as the engine loads them.
    pub bytes: AlignedImage,
    /// Shapes of its layers, the head last.
    pub shapes: Vec<LayerShape>,
    /// Full scale of its inputs.
    pub scale: InputScale,
    /// Interpreter of the bytes.
    pub interpreter: Interpreter,
}

/// Quantisation error of one output over the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct OutputError {
    /// Smallest and largest value of the float network.
    pub range: [f64; 2],
    /// Mean absolute difference from the float network.
    pub mean: f64,
    /// Root mean square difference.
    pub rms: f64,
    /// Largest absolute difference.
    pub largest: f64,
}

impl OutputError {
    /// A difference in percent of the output's range; 0 for a constant output.
    pub(crate) fn percent(&self, difference: f64) -> f64 {
        let [low, high] = self.range;
        if high > low { 100.0 * difference / (high - low) } else { 0.0 }
    }
}

/// Quantisation error over the samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct QuantisationError {
    /// Error of each output.
    pub outputs: Vec<OutputError>,
    /// Inputs that were clipped at full scale.
    pub clipped_inputs: usize,
    /// Activations that were clipped at full scale.
    pub clipped_activations: usize,
}

/// Quantises a network; the largest activations over the samples set the scales between the layers.
///
/// # Errors
///
/// The image format cannot represent the weights, values exceed f32, or the sums of a layer could
/// overflow.
pub(crate) fn quantise_imported(
    network: &Network,
    scale: InputScale,
    samples: &Samples,
    plan: Plan,
) -> Result<QuantisedNetwork, QuantiseError> {
    let mut folded = scale.folded(network);
    let mut largest = vec![0.0_f32; network.shape().convolutions.len()];
    for window in &samples.windows {
        let normal: Vec<f32> =
            scale.counts(window).0.iter().map(|&count| f32::from(count) / f32::from(i16::MAX)).collect();
        for (largest, layer) in largest.iter_mut().zip(folded.activations(&normal)) {
            *largest = layer.iter().fold(*largest, |a, &b| a.max(b));
        }
    }
    let is_beyond = |values: &[f32]| values.iter().any(|value| !value.is_finite());
    if let Some(slice) = folded.slices().position(is_beyond) {
        return Err(QuantiseError::Infinite { layer: slice / 2, what: "weights" });
    }
    if let Some(layer) = largest.iter().position(|value| !value.is_finite()) {
        return Err(QuantiseError::Infinite { layer, what: "activations" });
    }
    zero_inactive_channels(&mut folded, &largest, plan.mode);
    let quantised = quantise_layers(&folded, &largest, plan)?;
    let parts: Vec<_> = quantised.iter().map(Layer::parts).collect();
    let shapes: Vec<LayerShape> = parts.iter().map(|part| part.shape).collect();
    let mut bytes = AlignedImage::zeros(shapes.iter().map(LayerShape::length).sum());
    layers(&parts, bytes.bytes_mut())?;
    prove(&bytes).map_err(named)?;
    let interpreter = Interpreter::new(&bytes, network.shape().padding)?;
    Ok(QuantisedNetwork { bytes, shapes, scale, interpreter })
}

/// Zeroes the weights of inactive channels, whose output no input can change by half a count. Their
/// steps would be too fine for 32-bit biases and multipliers. If the bias is below half a count,
/// too, ReLU gives 0 for any bias; a bias of minus full scale then has steps that fit.
fn zero_inactive_channels(network: &mut Network, largest: &[f32], mode: Mode) {
    let mut slices = network.slices_mut();
    let mut full_scale = 1.0;
    for &largest in largest {
        let (Some(weights), Some(biases)) = (slices.next(), slices.next()) else { return };
        let format = Activations::up_to(largest, mode);
        let outputs = biases.len();
        for (output, bias) in biases.iter_mut().enumerate() {
            let magnitudes =
                weights.iter().skip(output).step_by(outputs).map(|weight| f64::from(weight.abs()));
            let half_a_count = 0.5 * format.step;
            if magnitudes.sum::<f64>() * full_scale >= half_a_count {
                continue;
            }
            weights.iter_mut().skip(output).step_by(outputs).for_each(|weight| *weight = 0.0);
            if f64::from(*bias) < half_a_count {
                *bias = -(format.step * format.full_scale()) as f32;
            }
        }
        full_scale = format.step * format.full_scale();
    }
}

fn named(unproven: Unproven) -> ImageError {
    let layer = |index| LayerName { network: NAME, index };
    match unproven {
        Unproven::Malformed { .. } => ImageError::TooShort,
        Unproven::Overflow { layer: index, output, largest } => {
            ImageError::Overflow { layer: layer(index), output, largest }
        }
        Unproven::Scale { layer: index } => ImageError::Scale { layer: layer(index) },
    }
}

impl QuantisedNetwork {
    /// Measures the differences from the float network over the samples.
    pub(crate) fn measure_error(&self, network: &Network, samples: &Samples) -> QuantisationError {
        let count = samples.windows.len().max(1) as f64;
        let fresh = OutputError { range: [f64::INFINITY, f64::NEG_INFINITY], ..OutputError::default() };
        let mut error = QuantisationError {
            outputs: vec![fresh; network.shape().outputs],
            clipped_inputs: 0,
            clipped_activations: 0,
        };
        for window in &samples.windows {
            let (counts, clipped) = self.scale.counts(window);
            error.clipped_inputs += clipped;
            let found = self.interpreter.run(&counts);
            error.clipped_activations += found.clipped;
            for ((output, exact), sum) in
                error.outputs.iter_mut().zip(network.evaluate(window)).zip(found.sums)
            {
                let exact = f64::from(exact);
                let difference = (f64::from(sum) * self.interpreter.scale() - exact).abs();
                output.range = [output.range[0].min(exact), output.range[1].max(exact)];
                output.mean += difference / count;
                output.rms += difference * difference / count;
                output.largest = output.largest.max(difference);
            }
        }
        for output in &mut error.outputs {
            output.rms = libm::sqrt(output.rms);
        }
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::data::draw::{Draw, Purpose};
    use crate::network::{ConvolutionShape, Padding, Shape};
    use crate::quantise::mode::Packing;

    fn network() -> Network {
        let convolutions = vec![ConvolutionShape { kernel: 3, outputs: 5 }; 2];
        let shape = Shape { columns: 9, inputs: 3, padding: Padding::Same, convolutions, outputs: 2 };
        Network::start(shape, &mut Draw::new(4, Purpose::Weights, 0))
    }

    fn samples(network: &Network) -> Samples {
        let mut draw = Draw::new(4, Purpose::PeerWindows, 0);
        let windows: Vec<Vec<f32>> =
            (0..64).map(|_| (0..27).map(|_| draw.uniform(-3.0, 3.0) as f32).collect()).collect();
        let outputs = windows.iter().map(|window| network.evaluate(window)).collect();
        Samples { windows, outputs }
    }

    fn error(network: &Network, mode: Mode) -> QuantisationError {
        let samples = samples(network);
        let plan = Plan { mode, packing: Packing::Speed };
        quantise_imported(network, InputScale::from_samples(&samples, 3), &samples, plan)
            .expect("quantised network")
            .measure_error(network, &samples)
    }

    #[test]
    fn more_bits_have_a_smaller_error() {
        let [coarse, middle, fine] =
            [Mode::W8a8, Mode::W8a16, Mode::W16a16].map(|mode| error(&network(), mode));
        for output in 0..2 {
            let rms = |error: &QuantisationError| error.outputs[output].percent(error.outputs[output].rms);
            assert!(rms(&fine) < 0.05 && rms(&fine) < rms(&middle) && rms(&middle) < rms(&coarse));
            assert!(rms(&coarse) < 3.0, "{}", rms(&coarse));
        }
        assert_eq!((fine.clipped_inputs, fine.clipped_activations), (0, 0));
    }

    #[test]
    fn numbers_beyond_f32_are_refused_by_their_layer() {
        let largest = InputScale::given(&[f32::MAX; 3], 3).expect("scale");
        for (layer, factor, scale) in
            [(0, 1e3, largest), (0, 3e38, InputScale::given(&[1.0; 3], 3).expect("scale"))]
        {
            let mut network = network();
            let weights = network.slices_mut().next().expect("weights");
            weights.iter_mut().for_each(|weight| *weight = factor * weight.signum());
            for mode in Mode::ALL {
                let plan = Plan { mode, packing: Packing::Speed };
                let refused = quantise_imported(&network, scale.clone(), &samples(&network), plan)
                    .expect_err("no numbers");
                assert!(refused.to_string().starts_with(&format!("layer {layer}: ")), "{refused}");
                assert!(refused.to_string().contains("exceed the range of f32"), "{refused}");
            }
        }
    }

    #[test]
    fn channels_that_training_gave_up_are_no_obstacle() {
        for (scale, bias) in [(1e-7, 0.5), (1e-7, -0.5), (1e-12, 0.0), (0.0, 0.3)] {
            let mut network = network();
            for layer in [0, 1] {
                if let Some(weights) = network.slices_mut().nth(2 * layer) {
                    weights.iter_mut().skip(1).step_by(5).for_each(|weight| *weight *= scale);
                }
                if let Some(biases) = network.slices_mut().nth(2 * layer + 1) {
                    biases[1] = bias;
                }
            }
            for mode in Mode::ALL {
                let error = error(&network, mode);
                let worst = error.outputs.iter().map(|output| output.percent(output.rms)).fold(0.0, f64::max);
                assert!(worst < 3.0, "{scale} {bias} {mode:?}: {worst} %");
            }
        }
    }
}
