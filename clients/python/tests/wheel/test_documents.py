"""Documents: the ten lines of the README, the guide, docstrings, and the examples."""

import doctest
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import palpate as pp

from .conftest import ROOT

EXAMPLES = ROOT / "clients" / "python" / "examples"


def blocks(document: Path) -> "list[tuple[int, str, str]]":
    """Line, words after the fence and text of each Python block."""
    text = document.read_text("utf-8")
    found = re.finditer(r"^```python([^\n]*)\n(.*?)^```", text, re.M | re.S)
    return [(text.count("\n", 0, match.start()) + 1, match[1].strip(), match[2]) for match in found]


def test_the_readmes_ten_lines_run_as_a_doctest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    (example,) = [text for _, _, text in blocks(ROOT / "README.md") if ">>> import palpate" in text]
    parsed = doctest.DocTestParser().get_doctest(example, {}, "README.md", "README.md", 0)
    assert len(parsed.examples) >= 5
    told: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(parsed, out=told.append)
    assert not told, "".join(told)


def test_docstrings_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    failures, count = doctest.testmod(pp, optionflags=doctest.ELLIPSIS)
    assert failures == 0 and count > 0


DOCUMENTS = sorted([*(ROOT / "docs").glob("*.md"), ROOT / "clients" / "python" / "README.md"])


@pytest.mark.parametrize("document", [d for d in DOCUMENTS if blocks(d)], ids=lambda d: d.name)
def test_every_block_of_a_document_runs(document: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # One after the other in one place, as a reader would; blocks marked "no_run" need what is not here, and
    # "messages" are run without the wheel by tests/daemon/readmes.rs.
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    (tmp_path / "session.mcap").symlink_to(ROOT / "recordings" / "golden" / "rigid-teardrop-press.mcap")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names: dict[str, Any] = {}
    ran = 0
    for line, words, text in blocks(document):
        if "no_run" in words or "messages" in words:
            compile(text, f"{document.name}:{line}", "exec")
            continue
        missing = [name for name in re.findall(r"needs=(\w+)", words) if not _there(name)]
        if missing:
            print(f"{document.name}:{line} skipped: {missing} is not installed")
            continue
        try:
            exec(compile("\n" * line + text, document.name, "exec"), names)
        except Exception as error:
            raise AssertionError(f"{document.name}, block of line {line}: {error!r}") from error
        ran += 1
    if document.name == "python.md":
        assert ran >= 6


def _there(name: str) -> bool:
    import importlib.util

    return importlib.util.find_spec(name) is not None


RUNS: "dict[str, tuple[list[str], list[str], str]]" = {
    # Arguments, packages, and what the last line says.
    "press_and_plot.py": (["--ticks", "300", "-o", "press.svg"], ["matplotlib"], r"peak force [\d.]+ N at [\d.]+ mm"),
    "stiffness_map.py": (["--grid", "4", "-o", "map.csv"], [], r"stiffest [\d.]+ N/m, softest [\d.]+ N/m"),
    "sweep_map.py": (["--quick"], [], r"same table from all: True"),
    "sweep.py": (["--count", "3", "--ticks", "120"], [], r"force grows with E: True"),
    "gym_random.py": (["--steps", "12"], ["gymnasium"], r"12 steps, mean reward -[\d.]+, same again: True"),
    "client_test.py": ([], ["pytest"], r"2 passed"),
    "recording_to_pandas.py": ([], ["pandas"], r"peak force [\d.]+ N at [\d.]+ s"),
    "fit_and_touch.py": ([], [], r"fitted to [\d.e-]+ m, touched with [\d.]+ N"),
    "jitter.py": (["--seconds", "2"], [], r"answered [\d.]+ % of ticks"),
    "bench.py": (["--quick"], [], r"wrote nothing"),
}


def test_each_example_is_listed() -> None:
    own = {file.name for file in EXAMPLES.glob("*.py")} - {"press.py", "read_recording.py"}
    assert own == set(RUNS)


@pytest.mark.parametrize("name", sorted(RUNS))
def test_the_example_runs(name: str, tmp_path: Path) -> None:
    arguments, packages, last = RUNS[name]
    for package in packages:
        pytest.importorskip(package)
    start = ["-m", "pytest", "-q", "-p", "no:cacheprovider"] if name == "client_test.py" else []
    if start and not _plugin():
        start += ["-p", "palpate.pytest_plugin"]
    run = subprocess.run(
        [sys.executable, *start, str(EXAMPLES / name), *arguments],
        capture_output=True, text=True, timeout=400, cwd=tmp_path, env={**os.environ, "MPLBACKEND": "Agg"},
    )  # fmt: skip
    print(run.stdout)
    assert run.returncode == 0, run.stdout + run.stderr
    assert re.search(last, run.stdout.strip().splitlines()[-1]), run.stdout


def _plugin() -> bool:
    import importlib.metadata

    found = importlib.metadata.entry_points()
    named = found.select(group="pytest11") if hasattr(found, "select") else found.get("pytest11", [])
    return any(entry.name == "palpate" for entry in named)
