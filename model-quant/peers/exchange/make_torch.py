"""Makes the test networks of `model-quant import` with PyTorch.

ONNX by torch.onnx (dynamo), samples by PyTorch itself.

    python make_torch.py OUT
"""

import logging
import pathlib
import sys
import warnings

import numpy
import torch
from torch import nn

import samples

warnings.filterwarnings("ignore")
logging.disable(logging.WARNING)


def relu(*layers):
    return [part for layer in layers for part in (layer, nn.ReLU())]


# Name: columns, features, layers.
ACCEPTED = {
    "torch_shipped": (8, 4, [*relu(nn.Conv1d(4, 16, 3), nn.Conv1d(16, 16, 3), nn.Conv1d(16, 16, 3)),
                             nn.Flatten(), nn.Linear(32, 1)]),
    "torch_same": (12, 6, [*relu(nn.Conv1d(6, 12, 5, padding="same"), nn.Conv1d(12, 7, 4, padding="same")),
                           nn.Flatten(), nn.Linear(84, 3)]),
    "torch_asymmetric": (11, 3, [*relu(nn.Conv1d(3, 5, 4), nn.Conv1d(5, 7, 2)), nn.Dropout(0.5),
                                 nn.Flatten(), nn.Linear(49, 2)]),
    "torch_hidden": (6, 2, [*relu(nn.Conv1d(2, 8, 3, bias=False)), nn.Flatten(), *relu(nn.Linear(32, 10)),
                            nn.Linear(10, 1)]),
}
REFUSED = {
    "torch_stride": (9, 3, [*relu(nn.Conv1d(3, 4, 3, stride=2)), nn.Flatten(), nn.Linear(16, 1)]),
    "torch_dilation": (9, 3, [*relu(nn.Conv1d(3, 4, 3, dilation=2)), nn.Flatten(), nn.Linear(20, 1)]),
    "torch_groups": (9, 4, [*relu(nn.Conv1d(4, 4, 3, groups=2)), nn.Flatten(), nn.Linear(28, 1)]),
    "torch_max_pool": (9, 3, [*relu(nn.Conv1d(3, 4, 2)), nn.MaxPool1d(2), nn.Flatten(), nn.Linear(16, 1)]),
    "torch_sigmoid": (9, 3, [nn.Conv1d(3, 4, 3), nn.Sigmoid(), nn.Flatten(), nn.Linear(28, 1)]),
    "torch_linear": (9, 3, [nn.Conv1d(3, 4, 3), nn.Conv1d(4, 4, 3), nn.ReLU(), nn.Flatten(), nn.Linear(20, 1)]),
    "torch_causal": (9, 3, [nn.ConstantPad1d((2, 0), 0.0), *relu(nn.Conv1d(3, 4, 3)), nn.Flatten(),
                            nn.Linear(36, 1)]),
}


class ColumnsFirst(nn.Module):
    """Takes batch x columns x features, as Keras does, and is exported for one window at a time."""

    def __init__(self):
        super().__init__()
        self.layers = nn.Sequential(*relu(nn.Conv1d(3, 4, 3)), nn.Flatten(), nn.Linear(20, 1))

    def forward(self, columns):
        return self.layers(columns.transpose(1, 2))


class LongShortTermMemory(nn.Module):
    def __init__(self):
        super().__init__()
        self.memory = nn.LSTM(3, 4, batch_first=True)
        self.dense = nn.Linear(4, 1)

    def forward(self, columns):
        return self.dense(self.memory(columns)[0][:, -1])


def start(network, generator):
    """Weights of He's variance, biases that are not zero, the same for every version of PyTorch."""
    with torch.no_grad():
        for parameter in network.parameters():
            deviation = (2.0 / parameter[0].numel()) ** 0.5 if parameter.ndim > 1 else 0.2
            parameter.copy_(torch.from_numpy(generator.normal(0, deviation, parameter.shape)))
    return network.eval()


def export(network, example, path, dynamo=True, one_window=False):
    if one_window:
        kwargs = {}
    elif dynamo:
        kwargs = {"dynamic_shapes": [{0: torch.export.Dim("batch")}]}
    else:
        kwargs = {"dynamic_axes": {"columns": {0: "batch"}}}
    torch.onnx.export(network, (example,), path, dynamo=dynamo, external_data=False, verbose=False,
                      input_names=["columns"], output_names=["outputs"], **kwargs)
    strip(path)


def strip(path):
    """Removes metadata and documentation of nodes and values.

    They differ between two runs, or name local files.
    """
    import onnx
    model = onnx.load(path)
    for part in [model.graph, *model.graph.node, *model.graph.value_info, *model.graph.input, *model.graph.output,
                 *model.graph.initializer]:
        part.ClearField("metadata_props")
        part.ClearField("doc_string")
    onnx.save(model, path)


def main(out):
    out.mkdir(parents=True, exist_ok=True)
    for index, (name, (columns, features, layers)) in enumerate({**ACCEPTED, **REFUSED}.items()):
        generator = numpy.random.default_rng(index)
        network = start(nn.Sequential(*layers), generator)
        columns = samples.inputs(generator, (samples.SAMPLES, columns, features)).transpose(0, 2, 1)
        columns = torch.from_numpy(numpy.ascontiguousarray(columns))
        export(network, columns[:2], out / f"{name}.onnx")
        if name in ACCEPTED:
            with torch.no_grad():
                samples.write(out / f"{name}.safetensors", columns.numpy(), network(columns).numpy())
        if name == "torch_asymmetric":
            # The older exporter, too.
            export(network, columns[:2], out / "torchscript_asymmetric.onnx", dynamo=False)
    generator = numpy.random.default_rng(98)
    network, columns = start(ColumnsFirst(), generator), samples.inputs(generator, (samples.SAMPLES, 7, 3))
    export(network, torch.from_numpy(columns[:1]), out / "torch_columns_first.onnx", one_window=True)
    with torch.no_grad():
        samples.write(out / "torch_columns_first.safetensors", columns, network(torch.from_numpy(columns)).numpy())
    export(start(LongShortTermMemory(), numpy.random.default_rng(99)), torch.zeros(2, 9, 3), out / "torch_lstm.onnx")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
