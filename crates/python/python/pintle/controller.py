"""Controllers: the firmware's code in this process, in the emulator, or on a board."""

from __future__ import annotations

import json
from collections.abc import Container
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from pintle import _native
from pintle._native import InputError
from pintle.commands import read_csv
from pintle.logs import check_units, numbers

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


def _path(path: str | Path | None) -> str | None:
    return None if path is None else str(path)


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
    def emulated(cls, elf: str | Path | None = None, link_key: str | Path | None = None) -> Controller:
        """The firmware's image in the emulator.

        The default is what ``cargo xtask firmware`` built below ``CARGO_TARGET_DIR``, or below
        ``target`` in the current folder. ``link_key`` is the file of the key that the firmware was
        built with, if it has one.
        """
        return cls(_native.Controller.emulated(_path(elf), _path(link_key)))

    @classmethod
    def attached(cls, port: str | Path, link_key: str | Path | None = None) -> Controller:
        """A board on a serial port.

        ``link_key`` is the file of the key that its firmware was built with, if it has one.
        """
        return cls(_native.Controller.attached(str(port), _path(link_key)))

    def __repr__(self) -> str:
        return f"<Controller {self._controller.name}>"

    def update(self, package: bytes) -> int:
        """Sends a signed package of networks and returns the number of bytes sent.

        Raises:
            InputError: The package is none, the controller is the native one, or it estimates.
            WorkError: The controller refuses the package.
        """
        return self._controller.update(package)

    def configure(self, bench: Bench, period_s: float = 1e-4, contact: str = "network") -> None:
        """Configures the controller for a bench and starts an estimation."""
        self._controller.configure(bench.text, period_s, contact)

    def estimate(self, samples: pd.DataFrame) -> pd.DataFrame:
        """Estimates the next samples: channels of ``CHANNELS`` as columns, one row a period."""
        _check_channels(samples.columns)
        check_units(samples)
        channels = {name: numbers(samples[name], name) for name in CHANNELS}
        count = np.arange(len(samples), dtype=np.uint32)
        return pd.DataFrame(self._estimate(count, channels)[0], index=samples.index)

    def stop(self) -> dict[str, Any]:
        """Ends the estimation and returns the controller's counters."""
        counters: dict[str, Any] = json.loads(self._controller.stop()[0])
        return counters

    def estimate_log(
        self,
        description: str,
        contact: str,
        period_s: float,
        count: npt.NDArray[np.uint32],
        channels: dict[str, npt.NDArray[np.float64]],
    ) -> Estimates:
        """Estimates a complete log by its channels, ``t_s`` included, and its samples' numbers."""
        _check_channels(channels)
        self._controller.configure(description, period_s, contact)
        columns, ended = self._estimate(count, channels)
        counters, open_ended = self._controller.stop()
        tables = [read_csv(text) for text in (ended, open_ended)]
        filled = [table for table in tables if len(table)] or tables[:1]
        samples = pd.DataFrame(columns, index=pd.Index(channels["t_s"], name="t_s"))
        return Estimates(samples, pd.concat(filled, ignore_index=True), json.loads(counters))

    def _estimate(
        self, count: npt.NDArray[np.uint32], channels: dict[str, npt.NDArray[np.float64]]
    ) -> tuple[dict[str, npt.NDArray[Any]], str]:
        columns, flags, ended = self._controller.estimate(count, *(channels[name] for name in CHANNELS))
        return {**dict(columns), "flags": flags}, ended


def _check_channels(found: Container[str]) -> None:
    missing = [name for name in CHANNELS if name not in found]
    if missing:
        raise InputError(f"log: found no column {', '.join(missing)}; expected {', '.join(CHANNELS)}")
