"""Bench descriptions: their laws, runs and records, and what is done with logs of the bench."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from pintle import _native
from pintle.commands import Results, collect, command, renamed_errors
from pintle.controller import Controller, Estimates
from pintle.diagnosis import Diagnosis, Evaluation, Inspection
from pintle.logs import Log, as_files, read_log

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


def presets() -> list[str]:
    """Names of the benches that the package contains."""
    return _native.presets()


def laws() -> pd.DataFrame:
    """Every contact and friction law: field of a description, name, description, range, source."""
    return pd.DataFrame(command("laws", json=True)["laws"])


class Run(Results):
    """Result of a run: ``figures`` of ``run.json``, tables and report."""

    JSON = "run.json"

    @property
    def log(self) -> pd.DataFrame:
        """What the bench's sensors recorded; of a mechanism or slider-crank its true states."""
        return self.table("log.csv")

    @property
    def impacts(self) -> pd.DataFrame:
        """Every period in contact."""
        return self.table("impacts.csv")

    @property
    def estimates(self) -> pd.DataFrame:
        """One estimate of the controller for every sample."""
        return self.table("estimates.csv")

    @property
    def estimated_impacts(self) -> pd.DataFrame:
        """Impacts as the controller recorded them."""
        return self.table("estimated_impacts.csv")


class Bench:
    """Bench description: a preset, a file, or a text in TOML.

    A description does not change; ``replace`` returns a new one.

    Raises:
        InputError: The description is wrong; the text lists every wrong entry.
    """

    def __init__(self, name_or_file: str | Path = "bench-b") -> None:
        self._text, self._plant = _native.open_description(os.fspath(name_or_file))

    @classmethod
    def from_text(cls, text: str, folder: str | Path = ".") -> Bench:
        """Reads a description in TOML; ``folder`` is that of the files which it names."""
        bench = cls.__new__(cls)
        file = os.fspath(Path(folder) / "description")
        bench._text, bench._plant = _native.parse_description(text, file)
        return bench

    @property
    def text(self) -> str:
        """Complete description in TOML."""
        return self._text

    @property
    def plant(self) -> str:
        """Name of the plant."""
        return self._plant

    def __repr__(self) -> str:
        return f"<Bench with plant {self._plant}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Bench) and self._text == other._text

    def __hash__(self) -> int:
        return hash(self._text)

    def replace(self, changes: Mapping[str, Any]) -> Bench:
        """Returns the description with other entries.

        A key is the path of an entry with dots: ``{"bearing.radial_clearance_m": 1e-3}``. An entry
        of a list is in brackets, by its ``name`` or its number from 1: ``body[crank].mass_kg``. A
        value is a number, text, truth value, list or dict; ``None`` removes the entry.
        """
        bench = Bench.__new__(Bench)
        plain = [(path, _plain(value)) for path, value in changes.items()]
        bench._text, bench._plant = _native.change_description(self._text, plain)
        return bench

    def with_effect(self, name: str, **parameters: float | str) -> Bench:
        """Returns the description with one more effect: ``with_effect("drive-lag", lag_s=1e-3)``.

        ``docs/effects.md`` has the effects with their parameters.
        """
        effects = tomllib.loads(self._text).get("effects", [])
        return self.replace({"effects": [*effects, {"name": name, **parameters}]})

    def contact_forces(
        self,
        deformation_m: npt.ArrayLike,
        rate_m_s: npt.ArrayLike = 0.0,
        approach_m_s: npt.ArrayLike = 0.0,
        sliding_m_s: npt.ArrayLike = 0.0,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Normal and friction force of the description's laws in N, for arrays of any one shape.

        Args:
            deformation_m: Depth of the contact, negative in a gap.
            rate_m_s: Its rate.
            approach_m_s: Approach speed at the onset of the contact.
            sliding_m_s: Sliding speed; friction has the opposite sign. A law with a state is in its
                steady state. A state that is not finite has no force (NaN).

        Raises:
            InputError: The plant is not ``transmission-bench``.
        """
        shape, state = flattened(deformation_m, rate_m_s, approach_m_s, sliding_m_s)
        normal_n, friction_n = _native.contact_forces(self._text, *state)
        return normal_n.reshape(shape), friction_n.reshape(shape)

    def run(
        self,
        *,
        force: str | None = None,
        controller: str | None = None,
        contact: str | None = None,
        seed: int | None = None,
        step_us: float | None = None,
        elf: str | Path | None = None,
        **options: Any,
    ) -> Run:
        """Runs the bench; of a transmission bench with the controller's estimator in the loop.

        Args:
            force: Source of the contact force: ``law``, ``held-law``, ``float-net`` or
                ``quantised-net``.
            controller: ``native``, ``emulated``, ``attached`` or ``none``.
            contact: Contact in the estimate: ``network`` or ``law``.
            seed: Seed of the sensors' noise.
            step_us: Time over which the networks' force is held.
            elf: Firmware of the emulated controller.
            options: Other options of ``host-sim run``, such as ``cycles=3`` or
                ``dropout_share=0.01``.
        """
        options |= {"force": force, "controller": controller, "contact": contact, "seed": seed}
        return Run(*collect("run", description=self._text, step_us=step_us, elf=elf, **options))

    def record(self, seed: int = 1, **options: Any) -> pd.DataFrame:
        """Simulates a log as the bench's sensors would record it.

        ``options`` are those of ``host-sim record``, such as ``cycles=5``. A mechanism needs
        ``[[measured]]``; the slider-crank has no log.
        """
        with tempfile.TemporaryDirectory(prefix="pintle-") as folder:
            bench, log = Path(folder) / "bench.toml", Path(folder) / "log.parquet"
            bench.write_text(self._text, encoding="utf-8")
            with renamed_errors({str(bench): "bench"}):
                command("record", bench=bench, seed=seed, out=log, **options)
            return read_log(log)

    def estimate(
        self, log: Log, *, contact: str = "network", controller: Controller | None = None
    ) -> Estimates:
        """Estimates the contact of a log with the controller's code.

        Args:
            log: Time, ``journal_y_m``, ``journal_z_m``, ``shaft_angle_rad`` and ``load_force_n`` at
                one interval of 50 us to 1 ms, rounded to microseconds. A missing reading is marked
                for the controller, which notices a missing row.
            contact: ``network`` or ``law``.
            controller: A controller; by default the code in this process.
        """
        controller = Controller.native() if controller is None else controller
        with as_files([log], self._text) as ([path], names), renamed_errors(names):
            period_s, numbers, channels = _native.read_samples(str(path), self._text)
        return controller.estimate_log(self._text, contact, period_s, numbers, dict(channels))

    def check(self, *logs: Log) -> Inspection:
        """Judges logs before a diagnosis: quality, units, parameters that they do not show."""
        with as_files(logs, self._text) as (paths, names):
            return Inspection(*collect("check", *paths, description=self._text, names=names))

    def evaluate(self, *logs: Log) -> Evaluation:
        """Simulates the bench under the inputs of logs and compares; fits nothing."""
        with as_files(logs, self._text) as (paths, names):
            return Evaluation(*collect("evaluate", *paths, description=self._text, names=names))

    def diagnose(self, *logs: Log, held_out: Sequence[Log] = ()) -> Diagnosis:
        """Finds what the simulation gets wrong in logs, names the cause and measures the gain.

        Args:
            logs: Logs of this bench, with the columns that its description names.
            held_out: Logs on which nothing is fitted; without them a part of each log is held out.
        """
        with as_files([*logs, *held_out], self._text) as (paths, names):
            given, kept = paths[: len(logs)], paths[len(logs) :]
            files, names = collect(
                "diagnose", *given, description=self._text, names=names, held_out=kept or None
            )
        extended = files.get("extended-bench.toml")
        return Diagnosis(files, names, Bench.from_text(extended.decode()) if extended else None)


def _plain(value: Any) -> Any:
    """Converts numbers of numpy."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    return value.item() if isinstance(value, np.generic) else value


def flattened(*arrays: npt.ArrayLike) -> tuple[tuple[int, ...], list[npt.NDArray[np.float64]]]:
    """Returns the common shape of arrays, and each in that shape as one dimension.

    Masked elements are NaN.
    """
    plain = (np.ma.filled(np.ma.asarray(array, dtype=np.float64), np.nan) for array in arrays)
    common = np.broadcast_arrays(*plain)
    return common[0].shape, [np.ascontiguousarray(array).reshape(-1) for array in common]
