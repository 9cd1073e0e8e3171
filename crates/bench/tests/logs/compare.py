"""Compares every channel that `host-sim` reads from MDF and TDMS files with asammdf and npTDMS.

    python compare.py HOST_SIM FILE...

Files with the same content count once. Prints each channel that differs or is missing, and totals.
"""

import hashlib
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import asammdf
import nptdms
import numpy as np
import pyarrow.parquet


def run(program, *arguments):
    return subprocess.run([program, "log", *map(str, arguments)], capture_output=True, text=True)


def column(program, file, name):
    """Values of a column, or `None` if it is refused."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out.parquet"
        if run(program, "convert", file, out, "--column", name).returncode:
            return None
        return pyarrow.parquet.read_table(out).column(0).to_numpy()


def reference(file):
    """Name and values of every channel as the other library reads it."""
    if file.suffix == ".tdms":
        data = nptdms.TdmsFile.read(file)
        return [(c.name, c[:]) for g in data.groups() for c in g.channels() if len(c)]
    data = asammdf.MDF(file)
    found = []
    for index, group in enumerate(data.groups):
        for place, channel in enumerate(group.channels):
            signal = data.get(group=index, index=place)
            values = signal.samples
            if signal.invalidation_bits is not None and values.dtype.kind in "fiu":
                values = np.where(signal.invalidation_bits, np.nan, values.astype(float))
            found.append((channel.name, values))
    return found


def is_same(ours, theirs):
    if ours is None or len(ours) != len(theirs):
        return False
    theirs = theirs.astype(float)
    largest = np.max(np.abs(theirs), where=np.isfinite(theirs), initial=1e-300)
    with np.errstate(invalid="ignore"):
        near = np.abs(ours - theirs) <= 1e-12 * largest
    return bool(np.all((ours == theirs) | near | (np.isnan(ours) & np.isnan(theirs))))


def main(program, files):
    known, same, differ, other = set(), 0, 0, 0
    for file in map(Path, files):
        digest = hashlib.sha256(file.read_bytes()).digest()
        if digest in known:
            continue
        known.add(digest)
        names = [c["name"] for c in json.loads(run(program, "info", file, "--json").stdout)["columns"]]
        for name, values in reference(file):
            if values.dtype.kind not in "fiub" or values.ndim != 1 or not len(values):
                other += 1
                continue
            fitting = [n for n in names if n == name or n.endswith(f"/{name}") or f"/{name}#" in n]
            hit = next((n for n in fitting if is_same(column(program, file, n), values)), None)
            if hit is None:
                differ += 1
                print(f"{file}: {name}: differs or is missing")
            else:
                names.remove(hit)
                same += 1
    print(f"{len(known)} files: {same} channels of numbers equal, {differ} not, {other} without numbers or samples")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
