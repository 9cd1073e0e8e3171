"""Commands of ``host-sim`` in this process, with their results in memory."""

from __future__ import annotations

import html
import io
import json
import tempfile
from pathlib import Path
from typing import Any

import pandas as pd

from pintle import _native

REPORT = "report.html"


def command(*words: str | Path, **options: Any) -> None:
    """Runs a command of ``host-sim``: ``command("sweep", "clearance", out="out/sweep")``.

    A keyword is an option: ``dropout_share=0.01`` is ``--dropout-share 0.01``. ``True`` stands for
    an option without a value, ``None`` and ``False`` leave it out, a list gives several values. One
    command runs at a time.

    Raises:
        InputError: An argument or a file is wrong.
        WorkError: The work failed.
    """
    _native.call_host_sim([*(str(word) for word in words), *_options(options)])


def _options(options: dict[str, Any]) -> list[str]:
    words: list[str] = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, (list, tuple)):
            words += [option, *(str(entry) for entry in value)]
        else:
            words += [option, str(value)]
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

    def __init__(self, files: dict[str, bytes]) -> None:
        self._files = files
        self.figures: dict[str, Any] = json.loads(files[self.JSON])

    @property
    def files(self) -> list[str]:
        """Names of the files."""
        return sorted(self._files)

    def text(self, name: str) -> str:
        """Content of a file."""
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


def collect(*words: str | Path, description: str, **options: Any) -> dict[str, bytes]:
    """Runs a command on a description, and returns the files that it writes."""
    with tempfile.TemporaryDirectory(prefix="pintle-") as name:
        folder = Path(name)
        bench = folder / "bench.toml"
        bench.write_text(description, encoding="utf-8")
        written = folder / "result"
        command(*words, bench=bench, out=written, **options)
        return {path.name: path.read_bytes() for path in sorted(written.iterdir())}
