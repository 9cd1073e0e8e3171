"""Makes the test networks of `model-quant import` with Keras.

ONNX by tf2onnx and by Keras' own export, samples by Keras.

    python make_keras.py OUT
"""

import os
import pathlib
import sys

os.environ["TF_CPP_MIN_LOG_LEVEL"] = "3"
os.environ["CUDA_VISIBLE_DEVICES"] = ""

import keras
import numpy
import tensorflow
import tf2onnx
from keras import layers

import samples


def convolution(outputs, kernel, **kwargs):
    return layers.Conv1D(outputs, kernel, activation="relu", **kwargs)


# Name: columns, features, layers.
ACCEPTED = {
    "keras_reference": (32, 6, [convolution(16, 5, padding="same"), convolution(32, 5, padding="same"),
                                convolution(32, 3, padding="same"), layers.Flatten(), layers.Dense(1)]),
    "keras_valid": (10, 3, [convolution(6, 4), layers.Dropout(0.5), layers.Conv1D(5, 2), layers.ReLU(),
                            layers.Flatten(), layers.Dense(2)]),
    "keras_even": (9, 2, [convolution(5, 4, padding="same"), convolution(3, 1, padding="same"),
                          layers.Flatten(), layers.Dense(3)]),
    "keras_hidden": (6, 4, [convolution(8, 3, use_bias=False), layers.Flatten(), layers.Dense(7, activation="relu"),
                            layers.Dense(1)]),
}
REFUSED = {
    "keras_max_pool": (8, 3, [convolution(4, 3), layers.MaxPooling1D(2), layers.Flatten(), layers.Dense(1)]),
    "keras_stride": (8, 3, [convolution(4, 3, strides=2), layers.Flatten(), layers.Dense(1)]),
    "keras_sigmoid": (8, 3, [convolution(4, 3), layers.Flatten(), layers.Dense(1, activation="sigmoid")]),
    "keras_causal": (8, 3, [convolution(4, 3, padding="causal"), layers.Flatten(), layers.Dense(1)]),
    "keras_lstm": (8, 3, [layers.LSTM(4), layers.Dense(1)]),
    "keras_dense_per_column": (8, 3, [convolution(4, 3), layers.Dense(2), layers.Flatten(), layers.Dense(1)]),
}


def start(network, generator):
    """Weights of He's variance, biases that are not zero, the same for every version of Keras."""
    network.set_weights([
        generator.normal(0, (2.0 / numpy.prod(w.shape[:-1])) ** 0.5 if w.ndim > 1 else 0.2, w.shape)
        for w in network.get_weights()
    ])
    return network


def main(out):
    out.mkdir(parents=True, exist_ok=True)
    for index, (name, (columns, features, parts)) in enumerate({**ACCEPTED, **REFUSED}.items()):
        generator = numpy.random.default_rng(100 + index)
        network = start(keras.Sequential([keras.Input((columns, features), name="columns"), *parts]), generator)
        signature = [tensorflow.TensorSpec((None, columns, features), tensorflow.float32, name="columns")]
        function = tensorflow.function(network, input_signature=signature)
        tf2onnx.convert.from_function(function, input_signature=signature, opset=18,
                                      output_path=str(out / f"{name}.onnx"))
        if name in ACCEPTED:
            x = samples.inputs(generator, (samples.SAMPLES, columns, features))
            samples.write(out / f"{name}.safetensors", x, network(x).numpy())
        if name == "keras_valid":
            network.export(str(out / "keras_export_valid.onnx"), format="onnx", verbose=False)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
