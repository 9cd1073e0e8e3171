"""Native part of the package."""

from collections.abc import Callable, Sequence
from typing import Any, TypeAlias, final

import numpy as np
import numpy.typing as npt

__all__ = [
    "Controller",
    "InputError",
    "Networks",
    "WorkError",
    "call_host_sim",
    "change_description",
    "channels",
    "contact_forces",
    "open_description",
    "package",
    "parse_description",
    "presets",
    "quantise",
    "read_log",
    "read_samples",
    "run_host_sim",
    "run_model_quant",
    "train",
    "verify",
    "write_log",
]

_Numbers: TypeAlias = npt.NDArray[np.float64]

class InputError(ValueError):
    """The input is wrong; the text names file or field, what was found and what was expected."""

class WorkError(RuntimeError):
    """The work failed."""

def call_host_sim(arguments: Sequence[str]) -> str: ...
def run_host_sim(arguments: Sequence[str]) -> int: ...
def run_model_quant(arguments: Sequence[str]) -> int: ...
def presets() -> list[str]: ...
def open_description(name_or_file: str) -> tuple[str, str]: ...
def parse_description(text: str, file: str) -> tuple[str, str]: ...
def change_description(
    text: str, changes: Sequence[tuple[str, Any]]
) -> tuple[str, str]: ...
def contact_forces(
    text: str,
    deformation_m: _Numbers,
    rate_m_s: _Numbers,
    approach_m_s: _Numbers,
    sliding_m_s: _Numbers,
) -> tuple[_Numbers, _Numbers]: ...
def read_log(path: str) -> tuple[str, list[tuple[str, str, str, _Numbers]]]: ...
def channels() -> list[tuple[str, str]]: ...
def read_samples(
    path: str, description: str
) -> tuple[float, npt.NDArray[np.uint32], list[tuple[str, _Numbers]]]: ...
def write_log(path: str, columns: Sequence[tuple[str, str, _Numbers]]) -> None: ...
def train(
    material_name: str,
    rows: int,
    epochs: int,
    grid_epochs: int,
    seed: int,
    report: Callable[[str, int], Any] | None,
) -> tuple[bytes, str]: ...
def quantise(checkpoint: bytes, mode: str) -> bytes: ...
def verify(image: bytes, checkpoint: bytes) -> str: ...
def package(
    images: Sequence[bytes], version: int, board: str | None, key: str | None
) -> bytes: ...

@final
class Networks:
    def __new__(cls, image: bytes) -> Networks: ...
    @staticmethod
    def shipped(material: str) -> Networks: ...
    @property
    def image(self) -> bytes: ...
    @property
    def material(self) -> str: ...
    @property
    def ranges(self) -> list[tuple[str, tuple[float, float]]]: ...
    def forces(
        self,
        radial_clearance_m: _Numbers,
        deformation_m: _Numbers,
        rate_m_s: _Numbers,
        approach_m_s: _Numbers,
        sliding_m_s: _Numbers,
        is_series: bool,
    ) -> tuple[_Numbers, _Numbers, npt.NDArray[np.bool_]]: ...

@final
class Controller:
    @staticmethod
    def native() -> Controller: ...
    @staticmethod
    def emulated(elf: str | None, link_key: str | None) -> Controller: ...
    @staticmethod
    def attached(port: str, link_key: str | None) -> Controller: ...
    def update(self, package: bytes) -> int: ...
    def configure(self, description: str, period_s: float, contact: str) -> None: ...
    def estimate(
        self,
        numbers: npt.NDArray[np.uint32],
        journal_y_m: _Numbers,
        journal_z_m: _Numbers,
        shaft_angle_rad: _Numbers,
        load_force_n: _Numbers,
    ) -> tuple[list[tuple[str, npt.NDArray[np.float32]]], npt.NDArray[np.uint32], str]: ...
    def stop(self) -> tuple[str, str]: ...
    @property
    def name(self) -> str: ...
