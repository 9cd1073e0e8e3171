"""Controllers: the firmware's code in this process, in the emulator, or on a board."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from pintle import _native
from pintle._native import InputError
from pintle.commands import read_csv

if TYPE_CHECKING:
    from pintle.bench import Bench

#: Channels of a sample.
CHANNELS = ("journal_y_m", "journal_z_m", "shaft_angle_rad", "load_force_n")


@dataclass(frozen=True)
class Estimates:
    """Estimates of a log."""

    #: One row for every sample: forces and torque with their standard deviations, clearance,
    #: factors, the forces of networks and law, and the columns of ``estimates.csv`` beside.
    samples: pd.DataFrame
    #: Impacts as the controller recorded them.
    impacts: pd.DataFrame
    #: Counters of the controller.
    counters: dict[str, Any]


class Controller:
    """A controller in lockstep: one estimate for every sample.

    ``bench.estimate`` takes one. For samples as they come, ``configure`` it and call ``estimate``
    with the next ones.
    """

    def __init__(self, native: _native.Controller) -> None:
        self._controller = native

    @classmethod
    def native(cls) -> Controller:
        """The firmware's code in this process, with the shipped networks."""
        return cls(_native.Controller.native())

    @classmethod
    def emulated(cls, elf: str | Path | None = None) -> Controller:
        """The firmware's image in the emulator; by default the one that the workspace built."""
        return cls(_native.Controller.emulated(None if elf is None else str(elf)))

    @classmethod
    def attached(cls, port: str | Path) -> Controller:
        """A board on a serial port."""
        return cls(_native.Controller.attached(str(port)))

    def __repr__(self) -> str:
        return f"<Controller {self._controller.name}>"

    def update(self, package: bytes) -> int:
        """Sends a signed package of networks and returns the number of bytes sent.

        Raises:
            InputError: The package is none, or the controller is the native one.
            WorkError: The controller refuses the package.
        """
        return self._controller.update(package)

    def configure(self, bench: Bench, period_s: float = 1e-4, contact: str = "network") -> None:
        """Configures the controller for a bench and starts an estimation."""
        self._controller.configure(bench.text, period_s, contact)

    def estimate(self, samples: pd.DataFrame) -> pd.DataFrame:
        """Estimates the next samples; columns as for ``Bench.estimate``, without time."""
        return self._estimate(samples)[0]

    def stop(self) -> dict[str, Any]:
        """Ends the estimation and returns the controller's counters."""
        counters: dict[str, Any] = json.loads(self._controller.stop())
        return counters

    def estimate_log(self, description: str, log: pd.DataFrame, contact: str) -> Estimates:
        """Estimates a complete log."""
        time_s = _time(log)
        self._controller.configure(description, _period(time_s), contact)
        samples, ended = self._estimate(log)
        counters = self.stop()
        samples.index = pd.Index(time_s, name="t_s")
        tables = [read_csv(text) for text in (ended, self._controller.take_impacts())]
        filled = [table for table in tables if len(table)] or tables[:1]
        return Estimates(samples, pd.concat(filled, ignore_index=True), counters)

    def _estimate(self, samples: pd.DataFrame) -> tuple[pd.DataFrame, str]:
        missing = [name for name in CHANNELS if name not in samples.columns]
        if missing:
            raise InputError(f"log: found no column {', '.join(missing)}; expected {', '.join(CHANNELS)}")
        arrays = (samples[name].to_numpy(dtype=np.float64) for name in CHANNELS)
        contiguous = (np.ascontiguousarray(array) for array in arrays)
        columns, flags, ended = self._controller.estimate(*contiguous)
        return pd.DataFrame({**dict(columns), "flags": flags}, index=samples.index), ended


def _time(log: pd.DataFrame) -> np.ndarray:
    if "t_s" in log.columns:
        return log["t_s"].to_numpy(dtype=np.float64)
    if log.index.name == "t_s":
        return log.index.to_numpy(dtype=np.float64)
    raise InputError("log: found neither a column nor an index `t_s`; expected the time in s")


def _period(time_s: np.ndarray) -> float:
    """Median interval in s, rounded to microseconds."""
    if len(time_s) < 2:
        raise InputError(f"log: found {len(time_s)} samples; expected at least 2")
    return round(float(np.median(np.diff(time_s))) * 1e6) * 1e-6
