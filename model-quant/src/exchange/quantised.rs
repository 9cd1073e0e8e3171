//! A network that stands alone in whole numbers: calibrated on its samples, written as layers, run again, measured.

use super::interpreter::Interpreter;
use super::samples::Samples;
use super::scaling::InputScale;
use crate::image::AlignedImage;
use crate::mode::Plan;
use crate::network::Network;
use crate::parameters::{Layer, network as layers_of};
use crate::quantise::QuantiseError;
use inference::ImageError;
use inference::image::write::layers;
use inference::image::{LayerName, LayerShape, Unproven, prove};
use serde::Serialize;

/// Name of the network in messages.
const NAME: &str = "imported";

/// A network in whole numbers.
#[derive(Clone, Debug)]
pub struct Alone {
    /// Its layers, as the engine loads them.
    pub bytes: AlignedImage,
    /// Shapes of its layers, the head last.
    pub shapes: Vec<LayerShape>,
    /// What counts as full scale at its entrance.
    pub scale: InputScale,
    /// The bytes, ready to be run.
    pub interpreter: Interpreter,
}

/// What the whole numbers cost at one output, over the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct OutputError {
    /// Smallest and largest value of the float network.
    pub range: [f64; 2],
    /// Mean absolute difference from the float network.
    pub mean: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Largest absolute difference.
    pub largest: f64,
}

impl OutputError {
    /// A difference over the range of the output, in percent; 0 for an output that does not change.
    pub fn percent(&self, difference: f64) -> f64 {
        let [low, high] = self.range;
        if high > low { 100.0 * difference / (high - low) } else { 0.0 }
    }
}

/// What the whole numbers cost, over the samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cost {
    /// By output.
    pub outputs: Vec<OutputError>,
    /// Inputs that were clipped at full scale.
    pub clipped_inputs: usize,
    /// Activations that were.
    pub clipped_activations: usize,
}

/// Puts a network into whole numbers; the largest activations of the samples tell the scales between the layers.
///
/// # Errors
///
/// Weights that the image cannot hold, a layer whose sums could overflow.
pub fn quantise(
    network: &Network,
    scale: InputScale,
    samples: &Samples,
    plan: Plan,
) -> Result<Alone, QuantiseError> {
    let folded = scale.folded(network);
    let mut largest = vec![0.0_f32; network.shape().convolutions.len()];
    for window in &samples.windows {
        let normal: Vec<f32> =
            scale.counts(window).0.iter().map(|&count| f32::from(count) / f32::from(i16::MAX)).collect();
        for (largest, layer) in largest.iter_mut().zip(folded.activations(&normal)) {
            *largest = layer.iter().fold(*largest, |a, &b| a.max(b));
        }
    }
    let quantised = layers_of(&folded, &largest, plan)?;
    let parts: Vec<_> = quantised.iter().map(Layer::parts).collect();
    let shapes: Vec<LayerShape> = parts.iter().map(|part| part.shape).collect();
    let mut bytes = AlignedImage::zeros(shapes.iter().map(LayerShape::length).sum());
    layers(&parts, bytes.bytes_mut())?;
    prove(&bytes).map_err(named)?;
    let interpreter = Interpreter::new(&bytes, network.shape().padding)?;
    Ok(Alone { bytes, shapes, scale, interpreter })
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

impl Alone {
    /// What a window gives, in the unit of the network's outputs.
    pub fn evaluate(&self, window: &[f32]) -> Vec<f64> {
        let sums = self.interpreter.run(&self.scale.counts(window).0).sums;
        sums.iter().map(|&sum| f64::from(sum) * self.interpreter.scale()).collect()
    }

    /// Compares with the float network over the samples.
    pub fn cost(&self, network: &Network, samples: &Samples) -> Cost {
        let count = samples.windows.len().max(1) as f64;
        let fresh = OutputError { range: [f64::INFINITY, f64::NEG_INFINITY], ..OutputError::default() };
        let mut cost =
            Cost { outputs: vec![fresh; network.shape().outputs], clipped_inputs: 0, clipped_activations: 0 };
        for window in &samples.windows {
            let (counts, clipped) = self.scale.counts(window);
            cost.clipped_inputs += clipped;
            let found = self.interpreter.run(&counts);
            cost.clipped_activations += found.clipped;
            for ((output, exact), sum) in
                cost.outputs.iter_mut().zip(network.evaluate(window)).zip(found.sums)
            {
                let exact = f64::from(exact);
                let error = (f64::from(sum) * self.interpreter.scale() - exact).abs();
                output.range = [output.range[0].min(exact), output.range[1].max(exact)];
                output.mean += error / count;
                output.rms += error * error / count;
                output.largest = output.largest.max(error);
            }
        }
        for output in &mut cost.outputs {
            output.rms = libm::sqrt(output.rms);
        }
        cost
    }
}
