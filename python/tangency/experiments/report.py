"""What an experiment leaves behind: tables as CSV, figures, and a page that says how they were made."""

from __future__ import annotations

import csv
import os
import platform
import time
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

__all__ = ["Report"]

PACKAGES = ("tangency", "numpy", "torch", "gymnasium", "ale-py", "opencv-python-headless")


class Report:
    """A folder with a page, its figures and its tables."""

    def __init__(self, folder: Path, name: str, command: str) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder, self.name, self.command = folder, name, command
        self._started = time.monotonic()

    def table(self, name: str, rows: Iterable[Mapping[str, Any]]) -> Path:
        """Writes rows with the same keys as `name`.csv."""
        rows = list(rows)
        file = self.folder / f"{name}.csv"
        with file.open("w", newline="", encoding="utf-8") as out:
            writer = csv.DictWriter(out, fieldnames=list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
        return file

    def figure(self, name: str, figure: Figure) -> Path:
        """Saves a figure as `name`.svg, the same bytes for the same figure."""
        import matplotlib

        file = self.folder / f"{name}.svg"
        with matplotlib.rc_context({"svg.hashsalt": name, "svg.fonttype": "none"}):
            figure.savefig(file, bbox_inches="tight", metadata={"Date": None})
        return file

    def page(self, paragraphs: Sequence[str]) -> Path:
        """Writes the page: the paragraphs, and how all of it was made."""
        minutes = (time.monotonic() - self._started) / 60.0
        made = (
            f"Made by `{self.command}` in {minutes:.1f} minutes on {os.cpu_count()} cores "
            f"({platform.machine()}, Python {platform.python_version()}; {_versions()})."
        )
        file = self.folder / "README.md"
        file.write_text("\n\n".join([f"# {self.name}", *paragraphs, made]) + "\n", encoding="utf-8")
        return file


def markdown_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """Rows with the same keys as a table of a page."""
    keys = list(rows[0])
    lines = ["| " + " | ".join(keys) + " |", "|" + "---|" * len(keys)]
    lines += ["| " + " | ".join(str(row[key]) for key in keys) + " |" for row in rows]
    return "\n".join(lines)


def _versions() -> str:
    found = []
    for package in PACKAGES:
        try:
            found.append(f"{package} {version(package)}")
        except ModuleNotFoundError:
            continue
    return ", ".join(found)
