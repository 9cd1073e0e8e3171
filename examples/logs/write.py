"""Writes servo-axis.mat and servo-axis.parquet: a measured axis as other programs save it.

SciPy 1.17, PyArrow 26. A motor turns an inertia of 0.8 kg m2 back and forth. Logged are the time in
ms, the motor's position in degrees and its current; the torque constant is 0.25 N m/A. The axis has
6 N m of dry friction, as its description states, and 2 N m s/rad of viscous friction, which the
description lacks.
"""
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

rng = np.random.default_rng(1)
t = np.arange(800) / 100.0
w, amplitude = np.pi, np.radians(30.0)
angle = amplitude * (1.0 - np.cos(w * t))
speed = amplitude * w * np.sin(w * t)
torque = 0.8 * amplitude * w**2 * np.cos(w * t) + 6.0 * np.tanh(speed / 0.02) + 2.0 * speed
data = {
    "time": 1e3 * t,
    "qm": np.degrees(angle) + rng.normal(0.0, 1e-3, t.size),
    "current": (torque + rng.normal(0.0, 0.05, t.size)) / 0.25,
}
scipy.io.savemat("servo-axis.mat", {"data": data}, do_compression=True, oned_as="column")
rows = pa.array([dict(zip(data, row)) for row in zip(*data.values())])
pq.write_table(pa.table({"data": rows}), "servo-axis.parquet", compression="snappy")
