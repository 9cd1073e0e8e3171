"""Commands of ``host-sim`` in this process, with their results in memory."""

from __future__ import annotations

import contextlib
import html
import io
import tempfile
from collections.abc import Iterator
from json import loads
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pintle import _native
from pintle._native import InputError, WorkError

REPORT = "report.html"


def command(*words: str | Path, json: bool = False, **options: Any) -> Any:
    """Runs a command of ``host-sim``: ``command("sweep", "clearance", out="out/sweep")``.

    A keyword is an option: ``dropout_share=0.01`` is ``--dropout-share=0.01``. ``True`` stands for
    an option without a value, ``None`` and ``False`` leave it out, a list gives several values.

    Args:
        words: The command and its arguments.
        json: Return the result as Python objects; else the text of the command, mostly empty.
        options: Options of the command; ``quiet`` unless ``verbose`` is given.

    Raises:
        InputError: An argument or a file is wrong.
        WorkError: The work failed.
    """
    if not words:
        raise InputError("command: found no word; expected a command of host-sim")
    options.setdefault("quiet", not options.get("verbose"))
    written = [str(word) for word in words]
    output = _native.call_host_sim(written + _options({**options, "json": json}))
    return loads(output) if json else output


def _options(options: dict[str, Any]) -> list[str]:
    words: list[str] = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or isinstance(value, (bool, np.bool_)):
            words += [option] if value else []
        elif isinstance(value, (list, tuple)):
            words += [option, *(str(entry) for entry in value)]
        else:
            words.append(f"{option}={value}")
    return words


def read_csv(text: str) -> pd.DataFrame:
    """Reads a table with its numbers to the last bit, which older versions of pandas round."""
    exact = {} if pd.__version__ >= "3" else {"float_precision": "round_trip"}
    frame: pd.DataFrame = pd.read_csv(io.StringIO(text), **exact)  # type: ignore[call-overload]
    return frame


class Results:
    """Files of a result, in memory.

    The names and contents are those that the command writes to a folder.
    """

    #: File with the figures.
    JSON = ""

    def __init__(self, files: dict[str, bytes], names: dict[str, str]) -> None:
        self._files = files
        text = files[self.JSON].decode()
        #: Figures by name. The origin names temporary files, the other figures name logs by number.
        self.figures: dict[str, Any] = loads(_renamed(text, names))
        self.figures["provenance"] = loads(text)["provenance"]

    @property
    def files(self) -> list[str]:
        """Names of the files."""
        return sorted(self._files)

    def text(self, name: str) -> str:
        """Content of a file.

        Raises:
            KeyError: The result has no such file; a run without controller has no estimates.
        """
        if name not in self._files:
            raise KeyError(f"{name}: this result has {', '.join(self.files)}")
        return self._files[name].decode()

    def table(self, name: str) -> pd.DataFrame:
        """Content of a file in CSV."""
        return read_csv(self.text(name))

    def save(self, folder: str | Path) -> None:
        """Writes all files to a folder."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in self._files.items():
            (folder / name).write_bytes(content)

    @property
    def report(self) -> str:
        """Report as a page that needs no network."""
        return self.text(REPORT)

    def show(self, height: int = 640) -> Any:
        """Report as an element of a notebook; needs IPython."""
        from IPython.display import HTML

        page = html.escape(self.report)
        return HTML(  # type: ignore[no-untyped-call]
            f'<iframe srcdoc="{page}" style="width:100%;height:{height}px;border:0"></iframe>'
        )


def collect(
    *words: str | Path, description: str, names: dict[str, str] | None = None, **options: Any
) -> tuple[dict[str, bytes], dict[str, str]]:
    """Runs a command on a description. Returns the files that it writes, and names for paths.

    ``names`` are those of the logs' files.
    """
    for name in ("bench", "json", "out", "quiet", "verbose"):
        if name in options:
            raise InputError(f"{name}: found the option; expected none, as results stay in memory")
    with tempfile.TemporaryDirectory(prefix="pintle-") as folder:
        bench, written = Path(folder) / "bench.toml", Path(folder) / "result"
        bench.write_text(description, encoding="utf-8")
        names = {**(names or {}), str(bench): "bench"}
        with renamed_errors(names):
            command(*words, bench=bench, out=written, **options)
        return {path.name: path.read_bytes() for path in sorted(written.iterdir())}, names


@contextlib.contextmanager
def renamed_errors(names: dict[str, str]) -> Iterator[None]:
    """Replaces the paths of temporary files in messages."""
    try:
        yield
    except (InputError, WorkError) as error:
        raise type(error)(_renamed(str(error), names)) from None


def _renamed(text: str, names: dict[str, str]) -> str:
    for path, name in names.items():
        text = text.replace(path, name)
    return text
