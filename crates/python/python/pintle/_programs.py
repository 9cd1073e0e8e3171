"""Entry points of the programs that the package installs."""

import signal
import sys
from collections.abc import Callable, Sequence

from pintle import _native


def host_sim() -> int:
    """Runs ``host-sim`` with the arguments of the process."""
    return _run(_native.run_host_sim)


def model_quant() -> int:
    """Runs ``model-quant`` with the arguments of the process."""
    return _run(_native.run_model_quant)


def _run(program: Callable[[Sequence[str]], int]) -> int:
    # A program ends at control-C; Python would wait for the native call.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return program(sys.argv)
