"""Networks of a bearing: evaluation on arrays, training, quantisation, packing."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from pintle import _native
from pintle.bench import flattened


class Networks:
    """Collision and friction network of a model image, with the integer code of the controller.

    Raises:
        InputError: The bytes are no model image.
    """

    def __init__(self, image: bytes) -> None:
        self._networks = _native.Networks(image)

    @classmethod
    def shipped(cls, material: str = "babbitt") -> Networks:
        """Networks that the package contains for a bearing material."""
        return cls(_native.Networks.shipped(material).image)

    @classmethod
    def open(cls, path: str | Path) -> Networks:
        """Reads a model image."""
        return cls(Path(path).read_bytes())

    def __reduce__(self) -> tuple[type[Networks], tuple[bytes]]:
        return Networks, (self.image,)

    @property
    def image(self) -> bytes:
        """Model image."""
        return self._networks.image

    @property
    def material(self) -> str:
        """Bearing material."""
        return self._networks.material

    @property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Ranges of the training, lowest and highest value."""
        return dict(self._networks.ranges)

    def forces(
        self,
        deformation_m: npt.ArrayLike,
        rate_m_s: npt.ArrayLike = 0.0,
        approach_m_s: npt.ArrayLike = 0.0,
        sliding_m_s: npt.ArrayLike = 0.0,
        radial_clearance_m: npt.ArrayLike = 0.5e-3,
        *,
        series: bool = False,
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
        """Normal and friction force in N, and whether a state is outside the training range.

        A state that is not finite has no force (NaN) and is outside.

        Arguments as for ``Bench.contact_forces``. With ``series`` the elements are consecutive
        samples; else each stands for itself, after a history of the same state.
        """
        shape, (clearance, deformation, rate, approach, sliding) = flattened(
            radial_clearance_m, deformation_m, rate_m_s, approach_m_s, sliding_m_s
        )
        normal_n, friction_n, is_outside = self._networks.forces(
            clearance, deformation, rate, approach, sliding, series
        )
        return normal_n.reshape(shape), friction_n.reshape(shape), is_outside.reshape(shape)


@dataclass(frozen=True)
class Checkpoint:
    """Trained networks in floating point."""

    #: File as ``model-quant train`` writes it.
    data: bytes = field(repr=False)
    #: Errors after each epoch, in units of the target's rms; empty if the checkpoint was read.
    history: pd.DataFrame = field(default_factory=pd.DataFrame, repr=False)

    @classmethod
    def open(cls, path: str | Path) -> Checkpoint:
        """Reads a checkpoint."""
        return cls(Path(path).read_bytes())

    def quantise(self, mode: str = "w8a16") -> Networks:
        """Converts to integers; ``w8a16``, ``w8a8`` or ``w16a16`` are the widths in bits."""
        return Networks(_native.quantise(self.data, mode))

    def verify(self, networks: Networks) -> pd.DataFrame:
        """Compares networks with this checkpoint and with the laws, on rows without training."""
        return pd.DataFrame(json.loads(_native.verify(networks.image, self.data)))


def train(
    material: str = "babbitt",
    *,
    rows: int = 1 << 18,
    epochs: int = 120,
    grid_epochs: int = 200,
    seed: int = 2,
    report: Callable[[str, int], Any] | None = None,
) -> Checkpoint:
    """Trains both networks of a bearing material from its laws.

    The default gives the shipped checkpoint, in minutes; the same arguments give the same bytes.

    Args:
        material: Bearing material.
        rows: Rows of the training set.
        epochs: Epochs with free weights.
        grid_epochs: Epochs in which the weights move to the 8-bit grid.
        seed: Seed of every random draw.
        report: Called with the name of the network and the epoch after every epoch; its
            exception ends the training.
    """
    data, history = _native.train(material, rows, epochs, grid_epochs, seed, report)
    return Checkpoint(data, pd.DataFrame(json.loads(history)["epochs"]))


def package(
    networks: Sequence[Networks], version: int, *, board: str | None = None, key: str | None = None
) -> bytes:
    """Packs networks, at most one pair for each bearing material, and signs the package.

    Args:
        networks: The networks.
        version: Version, from 1. A controller accepts only one above every version that was
            installed before, by at most 100,000,000.
        board: Board that the package is for; by default that of the emulator.
        key: Secret key as text, as ``model-quant key`` writes it; by default the published
            development key, which is for tests only.
    """
    return _native.package([pair.image for pair in networks], version, board, key)
