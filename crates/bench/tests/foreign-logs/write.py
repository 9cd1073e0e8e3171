"""Writes the logs of this folder with SciPy and PyArrow: files that no code of this project made.

The signal is the same in all: 20 samples at 100 Hz, qm = 10 i - 50 (degrees), torque = 0.5 i.
Run with scipy 1.17 and pyarrow 26 in this folder.
"""
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import scipy.io

i = np.arange(20)
t, qm, torque = 0.01 * i, (10 * i - 50).astype(np.int32), (0.5 * i).astype(np.float32)
data = {"t": t, "qm": qm, "motor": {"torque": torque}}
table = np.column_stack([t, qm, torque]).astype(float)
for name, compressed in [("v6.mat", False), ("v7.mat", True)]:
    scipy.io.savemat(name, {
        "data": data, "table": table, "note": "a comment", "cell": np.array([1, "a"], dtype=object),
        "phasor": np.exp(1j * t), "valid": i > 3,
    }, do_compression=compressed, oned_as="column")
nullable = [None if k == 7 else int(v) for k, v in enumerate(qm)]
columns = pa.table({
    "t": t, "qm": pa.array(nullable, pa.int64()), "torque": torque,
    "label": [f"row {k}" for k in i], "raw": pa.array([[1.0, 2.0]] * 20),
    "motor": pa.array([{"torque": float(v)} for v in torque]),
})
for codec in ["none", "snappy", "gzip", "lz4"]:
    pq.write_table(columns, f"{codec}.parquet", compression=codec, row_group_size=8)
pq.write_table(columns, "zstd.parquet", compression="zstd")
