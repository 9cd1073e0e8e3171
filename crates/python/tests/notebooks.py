"""Executes notebooks, and compares what their cells print with what is stored in them.

    python notebooks.py FOLDER            # executes and compares
    python notebooks.py --write FOLDER    # executes and stores

Pictures are drawn again, but not compared.
"""

import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient


def texts(cell):
    """What a cell printed and returned as text."""
    found = []
    for output in cell.get("outputs", []):
        if output.output_type == "stream" and output.name == "stdout":
            found.append(output.text)
        elif output.output_type in ("execute_result", "display_data"):
            if "image/png" not in output.data:
                found.append(output.data.get("text/plain", ""))
    return "".join(found).strip()


def execute(path, is_written):
    """Executes a notebook and returns the differences."""
    stored = nbformat.read(path, as_version=4)
    notebook = nbformat.read(path, as_version=4)
    started = time.monotonic()
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(path.parent)}}).execute()
    if is_written:
        for cell in notebook.cells:
            cell.metadata.pop("execution", None)
        notebook.metadata.pop("widgets", None)
        nbformat.write(notebook, path)
        return []
    found = [
        f"{path.name}, cell {number}: found\n{texts(now)}\nexpected\n{texts(before)}"
        for number, (before, now) in enumerate(zip(stored.cells, notebook.cells), 1)
        if texts(before) != texts(now)
    ]
    print(f"{path.name}: {len(notebook.cells)} cells in {time.monotonic() - started:.0f} s")
    return found


def main(arguments):
    is_written = "--write" in arguments
    (folder,) = [word for word in arguments if word != "--write"]
    paths = sorted(Path(folder).glob("*.ipynb"))
    found = [text for path in paths for text in execute(path, is_written)]
    print("\n".join(found))
    return 1 if found or not paths else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
