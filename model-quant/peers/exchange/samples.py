"""Writes input and output samples of a network as `model-quant import --samples` reads them."""

import numpy
from safetensors.numpy import save_file

SAMPLES = 32


def inputs(generator, shape):
    """Samples of columns whose features have different ranges: feature c reaches 2^(c % 3 - 1)."""
    batch, columns, features = shape
    reach = 2.0 ** (numpy.arange(features) % 3 - 1)
    return (generator.uniform(-1, 1, (batch, columns, features)) * reach).astype(numpy.float32)


def write(path, inputs, outputs):
    """`inputs` has the axes of the ONNX file's input, `outputs` is samples x outputs."""
    tensors = {"inputs": inputs, "outputs": outputs}
    save_file({name: numpy.ascontiguousarray(x, dtype=numpy.float32) for name, x in tensors.items()}, path)
