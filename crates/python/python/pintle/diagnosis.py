"""Results about logs: inspection, evaluation, diagnosis."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from pintle.commands import Results
from pintle.logs import Log

if TYPE_CHECKING:
    from pintle.bench import Bench


class Inspection(Results):
    """Judgement of logs before a diagnosis: ``figures`` of ``check.json``."""

    JSON = "check.json"

    @property
    def findings(self) -> pd.DataFrame:
        """Findings, the most severe first."""
        return pd.DataFrame(self.figures["checks"])

    @property
    def channels(self) -> pd.DataFrame:
        """Range, resolution and noise of each channel."""
        return pd.DataFrame(self.figures["channels"])

    @property
    def parameters(self) -> pd.DataFrame:
        """Parameters that the description declares uncertain."""
        return pd.DataFrame(self.figures["parameters"])


class Evaluation(Results):
    """Comparison of a simulation with logs: ``figures`` of ``evaluation.json``, and the report."""

    JSON = "evaluation.json"

    @property
    def channels(self) -> pd.DataFrame:
        """Errors by channel."""
        return pd.DataFrame(self.figures["channels"])


class Diagnosis(Results):
    """Result of a diagnosis: ``figures`` of ``diagnosis.json``, and the report."""

    JSON = "diagnosis.json"

    def __init__(
        self, files: dict[str, bytes], names: dict[str, str], extended: Bench | None
    ) -> None:
        super().__init__(files, names)
        #: Description with calibrated parameters and the causes as effects; none without a cause
        #: and without a calibration.
        self.extended = extended

    @property
    def verdict(self) -> str:
        """``none``, ``named``, ``ambiguous``, ``partial`` or ``unknown``."""
        return str(self.figures["verdict"])

    @property
    def causes(self) -> pd.DataFrame:
        """Parameters of the causes, the main cause first, with unit and 95 % interval."""
        columns = ["effect", "channel", "of", "probability", "parameter", "value", "unit", "low", "high"]
        rows = [
            [
                cause["effect"],
                cause.get("channel"),
                cause.get("of"),
                cause["probability"],
                parameter["name"],
                parameter["value"],
                parameter["unit"],
                *parameter["ci95"],
            ]
            for cause in self.figures["causes"]
            for parameter in cause["parameters"]
        ]
        return pd.DataFrame(rows, columns=columns)

    @property
    def gain(self) -> pd.DataFrame:
        """Error before and after the extension, by channel."""
        return pd.DataFrame(self.figures["gain"])

    def gain_on(self, bench: Bench, *logs: Log) -> pd.DataFrame:
        """Compares the bench before and after on logs that the diagnosis did not see; fits nothing.

        Returns the rms error of each channel with the description as it was and as extended, and
        the noise. Without an extension both are the same.
        """
        before = bench.evaluate(*logs).channels
        after = (self.extended or bench).evaluate(*logs).channels
        columns = ["channel", "unit", "rms", "noise_rms"]
        merged = before[columns].merge(after[["channel", "rms"]], on="channel", suffixes=("_before", "_after"))
        return merged[["channel", "unit", "rms_before", "rms_after", "noise_rms"]]

    def __repr__(self) -> str:
        lines = [f"verdict: {self.verdict}"]
        for cause in self.figures["causes"]:
            place = cause.get("channel") or cause.get("of")
            effect = f"{cause['effect']} of {place}" if place else cause["effect"]
            for p in cause["parameters"]:
                low, high = p["ci95"]
                interval = f"{low:.4g} to {high:.4g}"
                lines.append(f"{effect}: {p['name']} = {p['value']:.4g} {p['unit']} ({interval})")
        return "\n".join(lines)
