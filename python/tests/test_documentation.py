"""Every name is documented, the types are those of the native half, and examples run."""

from __future__ import annotations

import doctest
import importlib.util
import inspect
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest

import tangency
import tangency.lcp_physics
from conftest import ROOT

MODULES = [tangency, tangency.lcp_physics]
for extra, name in [("torch", "torch"), ("jax", "jax"), ("gymnasium", "gym"), ("matplotlib", "plot")]:
    if importlib.util.find_spec(extra):
        MODULES.append(importlib.import_module(f"tangency.{name}"))


def public() -> Iterator[tuple[str, Any]]:
    """Every public name, and every public member of a class."""
    for module in MODULES:
        for name in module.__all__:
            value = getattr(module, name)
            yield f"{module.__name__}.{name}", value
            if inspect.isclass(value):
                for member, item in sorted(vars(value).items(), key=lambda pair: pair[0]):  # in no order of its own
                    kinds = (staticmethod, classmethod)
                    told = callable(item) or inspect.isdatadescriptor(item) or isinstance(item, kinds)
                    if told and not member.startswith("_"):
                        yield f"{module.__name__}.{name}.{member}", getattr(value, member)


NAMED = dict(public())
NATIVE = [name for name, value in NAMED.items() if inspect.isbuiltin(value) or inspect.ismethoddescriptor(value)]


@pytest.mark.parametrize("name", NAMED)
def test_every_name_has_a_docstring(name: str) -> None:
    assert (NAMED[name].__doc__ or "").strip(), f"{name} has no documentation"


@pytest.mark.parametrize("name", NATIVE)
def test_every_parameter_is_documented(name: str) -> None:
    """In the native half, in the style of NumPy; nothing is documented that there is not."""
    value = NAMED[name]
    parameters = [name for name in inspect.signature(value).parameters if name != "self"]
    text = inspect.getdoc(value) or ""
    section = re.search(r"\nParameters\n-+\n(.*?)(?=\n\w+\n-+\n|\Z)", text, re.S)
    heads = re.findall(r"^(\w[\w, ]*) : ", section.group(1), re.M) if section else []
    assert [part for head in heads for part in head.split(", ")] == parameters


def test_the_types_are_those_of_the_native_half() -> None:
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "tangency._native"]
    environment = {**os.environ, "MYPYPATH": str(ROOT / "python")}
    found = subprocess.run(command, env=environment, cwd=ROOT, capture_output=True, text=True, timeout=300)
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.parametrize("module", MODULES, ids=lambda module: str(module.__name__))
def test_examples_of_modules(module: Any) -> None:
    failed, tried = doctest.testmod(module)
    assert tried > 0
    assert failed == 0


@pytest.mark.parametrize("name", ["docs/python.md", "docs/migration-lcp-physics.md", "README.md"])
def test_examples_of_pages(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    text = (ROOT / name).read_text(encoding="utf-8")
    blocks = list(re.finditer(r"^```python\n(.*?)^```", text, re.S | re.M))
    assert blocks
    names: dict[str, Any] = {"__name__": "page"}
    for block in blocks:
        line = text.count("\n", 0, block.start(1))
        exec(compile("\n" * line + block.group(1), name, "exec"), names)


@pytest.mark.parametrize("extra", ["torch", "jax", "gymnasium", "ray", "matplotlib"])
@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning")  # of the frameworks
def test_examples_of_the_frameworks(extra: str, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip(extra)
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.setenv("RAY_AUTH_MODE", "disabled")
    text = (ROOT / "docs" / "python-frameworks.md").read_text(encoding="utf-8")
    blocks = re.findall(rf"^```python {extra}\n(.*?)^```", text, re.S | re.M)
    assert blocks
    names: dict[str, Any] = {"__name__": "__main__"}  # so that functions travel to other processes by value
    for block in blocks:
        exec(block, names)
