"""Measured logs as data frames."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from pintle import _native
from pintle._native import InputError

#: A log: a frame, or the path of a file in a format that ``read_log`` reads.
Log = pd.DataFrame | str | Path


def read_log(path: str | Path, group: str | None = None) -> pd.DataFrame:
    """Reads the columns of numbers of a log: CSV, Parquet, MAT, MDF4, TDMS, HDF5 or xlsx.

    ``attrs["units"]`` has the units by column, ``attrs["format"]`` the format of the file. A file
    whose columns have different lengths has groups; ``group`` selects one.

    Raises:
        InputError: The file cannot be read, or ``group`` is missing or unknown.
    """
    file_format, columns = _native.read_log(str(path))
    groups = sorted({found for _, _, found, _ in columns})
    if group is not None:
        columns = [column for column in columns if column[2] == group]
        if not columns:
            raise InputError(f"{path}: found no group {group!r}; expected one of {groups}")
    if len({len(values) for *_, values in columns}) > 1:
        raise InputError(f"{path}: found columns of different lengths; expected a group of {groups}")
    frame = pd.DataFrame({name: values for name, _, _, values in columns})
    frame.attrs = {"units": {name: unit for name, unit, _, _ in columns}, "format": file_format}
    return frame


def write_log(frame: pd.DataFrame, path: str | Path) -> None:
    """Writes the columns of a frame: Parquet to ``.parquet``, a MAT-file to ``.mat``, else CSV.

    An index with a name becomes a column. Units come from ``frame.attrs["units"]``.

    Raises:
        InputError: A column contains no numbers.
        WorkError: The file cannot be written.
    """
    if frame.index.name is not None and frame.index.name not in frame.columns:
        frame = frame.reset_index()
    units = frame.attrs.get("units", {})
    columns = []
    for name in frame.columns:
        try:
            values = frame[name].to_numpy(dtype=np.float64, na_value=np.nan)
        except (TypeError, ValueError):
            raise InputError(f"{name}: found {frame[name].dtype}; expected a column of numbers") from None
        columns.append((str(name), str(units.get(name, "")), np.ascontiguousarray(values)))
    _native.write_log(str(path), columns)


@contextlib.contextmanager
def as_files(logs: Sequence[Log]) -> Iterator[list[Path]]:
    """Gives logs as files; a frame gets one for the time of the context."""
    with tempfile.TemporaryDirectory(prefix="pintle-") as folder:
        paths = []
        for number, log in enumerate(logs, 1):
            if isinstance(log, pd.DataFrame):
                path = Path(folder) / f"log-{number}.parquet"
                write_log(log, path)
            else:
                path = Path(log)
            paths.append(path)
        yield paths
