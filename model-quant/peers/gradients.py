"""Gradients of small networks by PyTorch, for the tests of src/train.

    python peers/gradients.py > peers/gradients.json

Needs torch and numpy. Parameters, windows and targets are multiples of 1/64, so they are exact in
the file; PyTorch computes in float64. Order of the parameters: layer by layer, weights by tap
(column, then input), then output; then biases. The input of the head is its columns, flattened
length x channel. The loss is the mean squared error over all windows and outputs.
"""

import json
import sys

import numpy as np
import torch

SHAPES = [
    dict(columns=12, inputs=3, padding="same", convolutions=[(5, 8), (4, 5)], outputs=2),
    dict(columns=8, inputs=4, padding="valid", convolutions=[(3, 8), (3, 16), (3, 8)], outputs=1),
    dict(columns=10, inputs=6, padding="same", convolutions=[(5, 16), (3, 8)], outputs=1),
]
WINDOWS = 3


def case(shape, draw):
    sixty_fourths = lambda *size: np.clip(np.round(draw.normal(0, 20, size)), -90, 90) / 64
    windows = sixty_fourths(WINDOWS, shape["columns"], shape["inputs"])
    targets = sixty_fourths(WINDOWS, shape["outputs"])
    values, parameters = torch.tensor(windows), []
    columns, inputs = shape["columns"], shape["inputs"]
    for kernel, outputs in shape["convolutions"]:
        weights = torch.tensor(sixty_fourths(kernel, inputs, outputs), requires_grad=True)
        biases = torch.tensor(sixty_fourths(outputs), requires_grad=True)
        parameters += [weights, biases]
        out = torch.nn.functional.conv1d(values.transpose(1, 2), weights.permute(2, 1, 0), biases, padding=shape["padding"])
        values = torch.relu(out).transpose(1, 2)
        inputs, columns = outputs, values.shape[1]
    weights = torch.tensor(sixty_fourths(columns * inputs, shape["outputs"]), requires_grad=True)
    biases = torch.tensor(sixty_fourths(shape["outputs"]), requires_grad=True)
    parameters += [weights, biases]
    found = values.reshape(WINDOWS, -1) @ weights + biases
    loss = torch.mean((found - torch.tensor(targets)) ** 2)
    loss.backward()
    flat = lambda arrays: [round(float(v), 9) for a in arrays for v in np.asarray(a).ravel()]
    convolutions = [dict(kernel=kernel, outputs=outputs) for kernel, outputs in shape["convolutions"]]
    return dict(
        shape={**shape, "convolutions": convolutions},
        windows=flat([windows]),
        targets=flat([targets]),
        parameters=flat([p.detach() for p in parameters]),
        outputs=flat([found.detach()]),
        loss=float(loss),
        gradient=[float(f"{v:.9g}") for p in parameters for v in p.grad.numpy().ravel()],
    )


draw = np.random.default_rng(1)
json.dump(dict(torch=torch.__version__, cases=[case(shape, draw) for shape in SHAPES]), sys.stdout, separators=(",", ":"))
sys.stdout.write("\n")
