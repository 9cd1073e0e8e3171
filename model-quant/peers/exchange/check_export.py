"""Compares the files of `model-quant export` in ONNX Runtime and PyTorch with their samples.

    python check_export.py DIRECTORY
"""

import pathlib
import sys

import numpy
import onnx
import onnxruntime
import torch
from safetensors.numpy import load_file
from safetensors.torch import load_file as load_torch

# Largest difference over the largest output: f32 sums in another order.
TOLERANCE = 2e-6


def compare(name, runtime, found, expected):
    difference = numpy.abs(found - expected).max() / numpy.abs(expected).max()
    print(f"{name}: {runtime} is off by {difference:.1e} of the largest output over {len(expected)} windows")
    return difference <= TOLERANCE


def torch_network(weights, prefix):
    """The network with the weights of a safetensors file, by their names."""
    names = sorted({key.split(".")[1] for key in weights if key.startswith(f"{prefix}.")})
    layers = []
    for name in names:
        weight, bias = weights[f"{prefix}.{name}.weight"], weights[f"{prefix}.{name}.bias"]
        if name == "head":
            layers += [torch.nn.Flatten(), torch.nn.Linear(weight.shape[1], weight.shape[0])]
        else:
            layers += [torch.nn.Conv1d(weight.shape[1], weight.shape[0], weight.shape[2]), torch.nn.ReLU()]
        layer = layers[-1] if name == "head" else layers[-2]
        layer.load_state_dict({"weight": weight, "bias": bias})
    return torch.nn.Sequential(*layers)


def main(directory):
    good = True
    for path in sorted(directory.glob("*.onnx")):
        onnx.checker.check_model(onnx.load(path), full_check=True)
        samples = load_file(path.with_name(f"{path.stem}-samples.safetensors"))
        session = onnxruntime.InferenceSession(path)
        (found,) = session.run(None, {"columns": samples["inputs"]})
        good &= compare(path.stem, "ONNX Runtime", found, samples["outputs"])
        bearing, _, network = path.stem.partition("-")
        weights = load_torch(directory / f"{bearing}.safetensors")
        with torch.no_grad():
            found = torch_network(weights, network)(torch.from_numpy(samples["inputs"])).numpy()
        good &= compare(path.stem, "PyTorch", found, samples["outputs"])
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
