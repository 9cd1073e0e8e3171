"""Contact force in a sliding bearing with clearance.

The package contains Pintle's laws, bench and mechanism runs, the estimator of the controller, the
diagnosis of measured logs, and the training of the networks. Quantities are in SI units; columns of
tables have the unit in their name or in ``frame.attrs["units"]``.
"""

from importlib.metadata import version

from pintle._native import InputError, WorkError
from pintle.bench import Bench, Run, laws, presets
from pintle.commands import command
from pintle.controller import Controller, Estimates
from pintle.diagnosis import Diagnosis, Evaluation, Inspection
from pintle.logs import read_log, write_log
from pintle.networks import Checkpoint, Networks, package, train

__version__ = version("pintle")

__all__ = [
    "Bench",
    "Checkpoint",
    "Controller",
    "Diagnosis",
    "Estimates",
    "Evaluation",
    "InputError",
    "Inspection",
    "Networks",
    "Run",
    "WorkError",
    "command",
    "laws",
    "package",
    "presets",
    "read_log",
    "train",
    "write_log",
]
