"""Measured logs as data frames."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt
import pandas as pd

from pintle import _native
from pintle._native import InputError

#: A log: a frame, or the path of a file in a format that ``read_log`` reads.
Log: TypeAlias = pd.DataFrame | str | Path

#: Endings of the files that are written.
ENDINGS = (".csv", ".txt", ".parquet", ".mat")


def read_log(path: str | Path, group: str | None = None) -> pd.DataFrame:
    """Reads the columns of numbers of a log: CSV, Parquet, MAT, MDF4, TDMS, MCAP, HDF5 or xlsx.

    ``attrs["units"]`` has the units by column, ``attrs["format"]`` the format of the file. A file
    whose columns have different lengths has groups; ``group`` selects one.

    Raises:
        InputError: The file cannot be read, or ``group`` is missing or unknown.
    """
    file_format, columns = _native.read_log(os.fspath(path))
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

    An index with a name becomes a column. Units come from ``frame.attrs["units"]``. CSV has no
    infinite numbers.

    Raises:
        InputError: A column contains no numbers, or the ending or the index is another one.
        WorkError: The file cannot be written.
    """
    if Path(path).suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: expected a file that ends in {', '.join(ENDINGS)}")
    frame = with_index(frame)
    units = frame.attrs.get("units", {})
    columns = [
        (str(name), str(units.get(name, "")), numbers(frame[name], str(name)))
        for name in frame.columns
    ]
    _native.write_log(os.fspath(path), columns)


def with_index(frame: pd.DataFrame) -> pd.DataFrame:
    """Returns the frame with a named index as a column."""
    if not isinstance(frame, pd.DataFrame):
        raise InputError(f"log: found {type(frame).__name__}; expected a data frame")
    if isinstance(frame.index, pd.MultiIndex):
        raise InputError("log: found an index of several levels; expected one, or columns")
    if not frame.columns.is_unique:
        twice = frame.columns[frame.columns.duplicated()][0]
        raise InputError(f"{twice}: found two columns of this name; expected one")
    if frame.index.name is None or frame.index.name in frame.columns:
        return frame
    return frame.reset_index()


def _is_text(column: pd.Series[Any]) -> bool:
    is_category = isinstance(column.dtype, pd.CategoricalDtype)
    return is_category or pd.api.types.is_string_dtype(column) or column.dtype == object


def numbers(column: pd.Series[Any], name: str) -> npt.NDArray[np.float64]:
    """Returns the numbers of a column; missing ones are NaN."""
    kind = column.dtype
    if not pd.api.types.is_numeric_dtype(kind) or pd.api.types.is_complex_dtype(kind):
        expected = "numbers; of times, the seconds since the start"
        raise InputError(f"{name}: found {kind}; expected {expected}")
    return np.ascontiguousarray(column.to_numpy(dtype=np.float64, na_value=np.nan))


def check_units(frame: pd.DataFrame) -> None:
    """Refuses a channel whose unit is not that of its name."""
    units = frame.attrs.get("units", {})
    for name, unit in [("t_s", "s"), *_native.channels()]:
        found = str(units.get(name, ""))
        if name in frame.columns and _plain(found) not in ("", _plain(unit)):
            raise InputError(
                f"{name}: found the unit {found}; expected {unit}: convert it, or name another column "
                f"in [columns] of the description"
            )


def _plain(unit: str) -> str:
    """Unit without the signs of a product."""
    return unit.translate(dict.fromkeys(map(ord, " *.·")))


@contextlib.contextmanager
def as_files(logs: Sequence[Log], description: str) -> Iterator[tuple[list[Path], dict[str, str]]]:
    """Gives logs as files, with names for the temporary ones.

    A frame gets a file for the time of the context, without its columns of texts. Its units count
    unless the description has ``[columns]``.
    """
    if not logs:
        raise InputError("logs: found none; expected at least one")
    with tempfile.TemporaryDirectory(prefix="pintle-") as folder:
        paths, names = [], {}
        for number, log in enumerate(logs, 1):
            if isinstance(log, (str, os.PathLike)):
                paths.append(Path(os.path.abspath(log)))
                continue
            path = Path(folder) / f"log-{number}.parquet"
            frame = with_index(log)
            if "[columns" not in description:
                check_units(frame)
            write_log(frame.drop(columns=[name for name in frame if _is_text(frame[name])]), path)
            paths.append(path)
            names[str(path)] = f"log {number}"
        yield paths, names
