"""Runs the checked-in exported network in ONNX Runtime on PyTorch's samples; writes its outputs.

    python run_exported.py golden
"""

import pathlib
import sys

import onnx
import onnxruntime
from safetensors.numpy import load_file

import samples

directory = pathlib.Path(sys.argv[1])
path = directory / "exported-same.onnx"
onnx.checker.check_model(onnx.load(path), full_check=True)
inputs = load_file(directory / "torch_same.safetensors")["inputs"]
(outputs,) = onnxruntime.InferenceSession(path).run(None, {"columns": inputs})
samples.write(directory / "exported-same-onnxruntime.safetensors", inputs, outputs)
