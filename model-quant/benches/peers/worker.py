"""Samples/s of PyTorch or Keras on the reference network, rounds of 3 s.

A round begins with a line on standard input.

Argument: torch (eager), torch-compile, keras (fit) or tensorflow (tf.function). Two threads, batch
1024, f32, Adam, MSE.
"""

import os
import sys
import time

BATCH, ROUND = 1024, 3.0
os.environ.update(OMP_NUM_THREADS="2", TF_NUM_INTRAOP_THREADS="2", TF_CPP_MIN_LOG_LEVEL="3", CUDA_VISIBLE_DEVICES="")


def torch_step(compiled):
    import torch

    torch.set_num_threads(2)
    torch.manual_seed(1)
    conv = torch.nn.Conv1d
    model = torch.nn.Sequential(
        conv(6, 16, 5, padding="same"), torch.nn.ReLU(), conv(16, 32, 5, padding="same"), torch.nn.ReLU(),
        conv(32, 32, 3, padding="same"), torch.nn.ReLU(), torch.nn.Flatten(), torch.nn.Linear(32 * 32, 1),
    )
    if compiled:
        model = torch.compile(model)
    optimiser = torch.optim.Adam(model.parameters(), 1e-3)
    x, y = torch.randn(BATCH, 6, 32), torch.randn(BATCH, 1)

    def step():
        optimiser.zero_grad(set_to_none=True)
        torch.nn.functional.mse_loss(model(x), y).backward()
        optimiser.step()
        return BATCH

    return step


def keras_model():
    import keras

    layers = keras.layers
    conv = lambda outputs, kernel: layers.Conv1D(outputs, kernel, padding="same", activation="relu")
    return keras, keras.Sequential(
        [layers.Input((32, 6)), conv(16, 5), conv(32, 5), conv(32, 3), layers.Flatten(), layers.Dense(1)]
    )


def keras_step():
    import numpy as np

    keras, model = keras_model()
    model.compile("adam", "mse")
    batches = 20
    x = np.random.default_rng(1).normal(size=(batches * BATCH, 32, 6)).astype("f4")
    y = np.random.default_rng(2).normal(size=(batches * BATCH, 1)).astype("f4")

    def step():
        model.fit(x, y, batch_size=BATCH, epochs=1, verbose=0, shuffle=False)
        return batches * BATCH

    return step


def tensorflow_step():
    import tensorflow as tf

    tf.config.threading.set_intra_op_parallelism_threads(2)
    keras, model = keras_model()
    optimiser = keras.optimizers.Adam(1e-3)
    x, y = tf.random.normal((BATCH, 32, 6)), tf.random.normal((BATCH, 1))
    optimiser.build(model.trainable_variables)

    @tf.function
    def learn():
        with tf.GradientTape() as tape:
            loss = tf.reduce_mean((model(x, training=True) - y) ** 2)
        gradients = tape.gradient(loss, model.trainable_variables)
        optimiser.apply_gradients(zip(gradients, model.trainable_variables))

    def step():
        learn()
        return BATCH

    return step


STEPS = {
    "torch": lambda: torch_step(False),
    "torch-compile": lambda: torch_step(True),
    "keras": keras_step,
    "tensorflow": tensorflow_step,
}
step = STEPS[sys.argv[1]]()
for _ in range(5):
    step()
for _ in sys.stdin:
    started, samples = time.perf_counter(), 0
    while time.perf_counter() - started < ROUND:
        samples += step()
    print(round(samples / (time.perf_counter() - started)), flush=True)
