#!/usr/bin/env python3
"""Runs the networks of the shipped images in ONNX Runtime and in LiteRT (formerly TensorFlow Lite).

Reads windows.bin (in this folder) and the images in crates/inference/models; writes
onnxruntime.bin and litert.bin. Formats: README.md. The images are read here a second time,
independently of the Rust code. Use:

    python3 -m venv venv && venv/bin/pip install -r requirements.txt && venv/bin/python peers.py

ONNX Runtime: QLinearConv has no 16-bit activations, so the graph is written in integer operations:
windows unfolded, MatMul, Add, Max with 0, Mul by the multiplier, Add of a half, Div by 2^32 (floor,
as nothing is negative), Min with full scale, all in int64. Its sums must be those of the Rust code,
bit for bit.

LiteRT: CONV_2D with int16 activations, int8 weights per channel, int64 biases (its scheme "16x8")
and the scales of the image, in the reference kernels. A scale is a float there and the rounding
differs, so activations may differ by counts. Its last activations go through the head in integers
here: LiteRT would cut the output to 16 bits.
"""

import struct
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
MODELS = HERE.parent.parent / "crates" / "inference" / "models"
BEARINGS = ["babbitt", "plastic"]


def read_layer(data, at):
    """One layer of an image: weights as [output, column, input], and where the next one begins."""
    kind, columns, inputs, outputs, in_bits, out_bits, form = struct.unpack_from("<BBHHBBB", data, at)
    at += 12
    take = lambda kind, count, at: (np.frombuffer(data, kind, count, at).astype(np.int64), at + 4 * count)
    layer = {"columns": columns, "inputs": inputs, "outputs": outputs, "in_bits": in_bits, "out_bits": out_bits}
    if kind == 1:
        layer["biases"], layer["multipliers"] = (np.zeros(outputs, np.int64) for _ in range(2))
    else:
        scale, at = take("<u4", 2, at)
        layer["scale"] = float(scale[0]) / 2.0 ** float(scale[1])
        layer["biases"], at = take("<i4", outputs, at)
    taps = columns * inputs
    order = [0, 1] if form == 2 else [0, 2, 1, 3] if in_bits == 16 else [0, 1, 2, 3]
    groups = -(-taps // len(order))
    weights = np.zeros((outputs, groups * len(order)), np.int64)
    places = [(b, b + 4) for b in range(0, outputs // 4 * 4, 4)] + [(o, o + 1) for o in range(outputs // 4 * 4, outputs)]
    for low, high in places:
        if kind == 1:
            layer["biases"][low:high], at = take("<i4", high - low, at)
        for group in range(groups):
            for output in range(low, high):
                values = struct.unpack_from("<2h" if form == 2 else "<4b", data, at)
                at += 4
                for value, tap in zip(values, order):
                    weights[output, group * len(order) + tap] = value
        if kind == 1:
            layer["multipliers"][low:high], at = take("<i4", high - low, at)
    layer["weights"] = weights[:, :taps].reshape(outputs, columns, inputs)
    return layer, at


def read_image(path):
    """Layers of both networks and the checksum."""
    data = path.read_bytes()
    assert data[:8] == b"PINTLEM\n" and struct.unpack_from("<H", data, 8) == (3,), path
    at, networks = 64, []
    for _ in range(2):
        layers = []
        while True:
            layer, at = read_layer(data, at)
            layers.append(layer)
            if "scale" in layer:
                break
        networks.append(layers)
    assert at == len(data) - 4, path
    return networks, struct.unpack_from("<I", data, at)[0]


def read_windows(path):
    """Per network: checksum of its image and windows as [window, column, input]."""
    data = path.read_bytes()
    assert data[:8] == b"PINTLEW\n" and struct.unpack_from("<I", data, 8) == (1,), path
    (count,), at, networks = struct.unpack_from("<I", data, 12), 16, []
    for _ in range(count):
        checksum, columns, inputs, random, rows = struct.unpack_from("<5I", data, at)
        at += 20
        shape = (random + rows, columns, inputs)
        networks.append((checksum, np.frombuffer(data, "<i2", int(np.prod(shape)), at).reshape(shape)))
        at += 2 * int(np.prod(shape))
    assert at == len(data), path
    return networks


def run_onnxruntime(layers, windows):
    """Sums of the head, everything in integers."""
    import onnxruntime
    from onnx import TensorProto, checker, helper, numpy_helper

    nodes, constants = [], {}

    def constant(value):
        name = f"c{len(constants)}"
        constants[name] = numpy_helper.from_array(np.asarray(value, np.int64), name)
        return name

    def node(kind, inputs, **attributes):
        name = f"v{len(nodes)}"
        nodes.append(helper.make_node(kind, inputs, [name], **attributes))
        return name

    value, columns = "windows", windows.shape[1]
    for layer in layers:
        positions = columns - layer["columns"] + 1
        taps = [
            node("Slice", [value, constant([tap]), constant([tap + positions]), constant([1])])
            for tap in range(layer["columns"])
        ]
        unfolded = node("Concat", taps, axis=2)
        matrix = layer["weights"].reshape(layer["outputs"], -1).T
        value = node("Add", [node("MatMul", [unfolded, constant(matrix)]), constant(layer["biases"])])
        if "multipliers" in layer:
            value = node("Max", [value, constant(0)])
            value = node("Mul", [value, constant(layer["multipliers"])])
            value = node("Div", [node("Add", [value, constant(1 << 31)]), constant(1 << 32)])
            value = node("Min", [value, constant((1 << (layer["out_bits"] - 1)) - 1)])
        columns = positions
    graph = helper.make_graph(
        nodes,
        "network",
        [helper.make_tensor_value_info("windows", TensorProto.INT64, windows.shape)],
        [helper.make_tensor_value_info(value, TensorProto.INT64, [len(windows), columns, 1])],
        list(constants.values()),
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    checker.check_model(model)
    session = onnxruntime.InferenceSession(model.SerializeToString(), providers=["CPUExecutionProvider"])
    (sums,) = session.run(None, {"windows": windows.astype(np.int64)})
    return sums.reshape(len(windows))


def litert_model(layers, count, columns):
    """A flatbuffer of the convolutions with the scales of the image."""
    import flatbuffers
    from ai_edge_litert import schema_py_generated as schema

    model, graph = schema.ModelT(), schema.SubGraphT()
    model.version, model.subgraphs, model.buffers = 3, [graph], [schema.BufferT()]
    graph.tensors, graph.operators, graph.name = [], [], "network"
    code = schema.OperatorCodeT()
    code.builtinCode = code.deprecatedBuiltinCode = schema.BuiltinOperator.CONV_2D
    code.version = 5
    model.operatorCodes = [code]

    def tensor(name, shape, kind, scales, data=None, axis=0):
        made, quantisation = schema.TensorT(), schema.QuantizationParametersT()
        quantisation.scale, quantisation.zeroPoint = list(scales), [0] * len(scales)
        quantisation.quantizedDimension = axis
        made.name, made.shape, made.type, made.quantization = name, list(shape), kind, quantisation
        if data is not None:
            buffer = schema.BufferT()
            buffer.data = list(data.tobytes())
            model.buffers.append(buffer)
            made.buffer = len(model.buffers) - 1
        graph.tensors.append(made)
        return len(graph.tensors) - 1

    # Only ratios of scales matter: an activation's step is 1, a weight's step is its channel's
    # factor.
    types = schema.TensorType
    value = tensor("windows", (count, 1, columns, layers[0]["inputs"]), types.INT16, [1.0])
    graph.inputs = [value]
    for index, layer in enumerate(layers):
        columns -= layer["columns"] - 1
        factors = layer["multipliers"] / 2.0**32
        weights = layer["weights"].astype(np.int8)
        shape = (layer["outputs"], 1, layer["columns"], layer["inputs"])
        kernel = tensor(f"weights {index}", shape, types.INT8, factors, weights)
        bias = tensor(f"biases {index}", (layer["outputs"],), types.INT64, factors, layer["biases"])
        output = tensor(f"outputs {index}", (count, 1, columns, layer["outputs"]), types.INT16, [1.0])
        operator, options = schema.OperatorT(), schema.Conv2DOptionsT()
        options.padding, options.strideW, options.strideH = schema.Padding.VALID, 1, 1
        options.dilationWFactor = options.dilationHFactor = 1
        options.fusedActivationFunction = schema.ActivationFunctionType.RELU
        operator.inputs, operator.outputs = [value, kernel, bias], [output]
        operator.builtinOptionsType, operator.builtinOptions = schema.BuiltinOptions.Conv2DOptions, options
        graph.operators.append(operator)
        value = output
    graph.outputs = [value]
    builder = flatbuffers.Builder(1 << 16)
    builder.Finish(model.Pack(builder), b"TFL3")
    return bytes(builder.Output())


def run_litert(layers, windows):
    """Sums of the head over the last activations of LiteRT.

    Also returns the largest difference of an activation per layer.
    """
    from ai_edge_litert.interpreter import Interpreter, OpResolverType

    *convolutions, head = layers
    value = windows
    # Layer by layer on the exact inputs, to see what one layer's rounding does.
    largest, exact = [], windows.astype(np.int64)
    for layer in convolutions:
        found = run_convolutions(Interpreter, OpResolverType, [layer], exact.astype(np.int16))
        exact = convolve(layer, exact)
        largest.append(int(np.abs(found - exact).max()))
    value = run_convolutions(Interpreter, OpResolverType, convolutions, windows)
    sums = np.einsum("nki,oki->no", value[:, -head["columns"] :], head["weights"]) + head["biases"]
    return sums.reshape(len(windows)), largest


def run_convolutions(interpreter_type, resolver, layers, windows):
    """Activations after some convolutions in LiteRT's reference kernels."""
    count, columns, _ = windows.shape
    interpreter = interpreter_type(
        model_content=litert_model(layers, count, columns),
        experimental_op_resolver_type=resolver.BUILTIN_REF,
    )
    interpreter.allocate_tensors()
    interpreter.set_tensor(interpreter.get_input_details()[0]["index"], windows[:, None])
    interpreter.invoke()
    return interpreter.get_tensor(interpreter.get_output_details()[0]["index"])[:, 0].astype(np.int64)


def convolve(layer, values):
    """One convolution as the image defines it, for the comparison layer by layer."""
    positions = values.shape[1] - layer["columns"] + 1
    windows = np.stack([values[:, at : at + layer["columns"]] for at in range(positions)], axis=1)
    sums = np.einsum("npki,oki->npo", windows, layer["weights"]) + layer["biases"]
    scaled = (np.maximum(sums, 0) * layer["multipliers"] + (1 << 31)) >> 32
    return np.minimum(scaled, (1 << (layer["out_bits"] - 1)) - 1)


def write_results(path, name, results):
    """A file of results."""
    data = b"PINTLER\n" + struct.pack("<II", 1, len(results)) + name.encode().ljust(48, b"\0")
    for checksum, sums in results:
        assert np.abs(sums).max() < 1 << 31
        data += struct.pack("<I", checksum) + sums.astype("<i4").tobytes()
    path.write_bytes(data)
    print(f"wrote {path.name}: {name}, {len(data)} bytes")


def main():
    windows = read_windows(HERE / "windows.bin")
    networks = []
    for bearing in BEARINGS:
        layers, checksum = read_image(MODELS / f"{bearing}.pintle")
        networks += [(bearing, name, checksum, network) for name, network in zip(["collision", "friction"], layers)]
    onnx, litert = [], []
    for (bearing, name, checksum, layers), (expected, inputs) in zip(networks, windows, strict=True):
        if checksum != expected:
            sys.exit(f"windows.bin: made for image {expected:08x}, {bearing} is {checksum:08x}: "
                     "run `model-quant verify --windows model-quant/peers/windows.bin`")
        onnx.append((checksum, run_onnxruntime(layers, inputs)))
        sums, largest = run_litert(layers, inputs)
        litert.append((checksum, sums))
        print(f"{bearing} {name}: activations of LiteRT differ by at most {largest} counts, layer by layer on equal inputs")
    write_results(HERE / "onnxruntime.bin", f"ONNX Runtime {version('onnxruntime')}", onnx)
    write_results(HERE / "litert.bin", f"LiteRT {version('ai-edge-litert')} 16x8", litert)


if __name__ == "__main__":
    main()
