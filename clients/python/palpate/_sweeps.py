"""Sweeps as ``palpate batch`` makes them, with the runs on any executor."""

import functools
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from .errors import PalpateError, SweepError

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped,unused-ignore]

_Path = Union[str, "os.PathLike[str]"]
#: A sweep as it goes to workers: build, text, name, where its paths start, and the files there.
_Packed = tuple[tuple[str, ...], str, str, str, tuple[tuple[str, Union[bytes, str]], ...]]
#: Of a run: its number, whether it was known, and what it came to.
_Made = tuple[int, bool, str]


class SweepTable(Mapping[str, "NDArray[Any]"]):
    """The results of a sweep: columns by name, as docs/batch.md has them. Rows are runs, in the order of their numbers.

    Numbers are int64 or float64, NaN where there is none; text is an array of objects, None where there is none.
    """

    def __init__(self, rows: "_native.SweepRows", known: int) -> None:
        self._rows, self._columns = rows, rows.columns()
        self.known = known
        """Runs that were taken from the cache."""

    def __getitem__(self, name: str) -> "NDArray[Any]":
        if name not in self._columns:
            raise KeyError(f"this table has no column {name!r}; it has {', '.join(self._columns)}")
        return self._columns[name]

    def __iter__(self) -> "Iterator[str]":
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    @property
    def runs(self) -> int:
        """Number of rows."""
        return len(self["run"])

    @property
    def failed(self) -> int:
        """Runs that failed: their ``error`` says why."""
        return int(np.count_nonzero(self["error"]))

    def to_pandas(self) -> "pandas.DataFrame":
        """The same as a pandas table."""
        import pandas  # type: ignore[import-untyped,unused-ignore]

        return pandas.DataFrame(self._columns)

    def write(self, path: _Path) -> None:
        """Writes a .csv, .json or .parquet file: the one of ``palpate batch -o``, byte for byte."""
        self._rows.write(path)

    def __repr__(self) -> str:
        return f"SweepTable({self.runs} runs, {self.failed} failed, {self.known} known, columns={list(self)})"


def sweep(
    sweep: "Union[_Path, Mapping[str, Any]]",
    map: "Optional[Callable[..., Iterable[Any]]]" = None,
    *,
    chunk: int = 1,
    cache: "Union[bool, _Path]" = True,
    directory: _Path = "",
    timings: bool = False,
) -> SweepTable:
    """Runs a sweep: the same runs and the same table as ``palpate batch``, to the last bit, whoever makes them.

    Parameters
    ----------
    sweep : path, str or dict
        A sweep file, or what is in one: TOML text (of more than one line) or a dictionary.
    map : callable, optional
        ``map(function, tasks)`` of whatever has workers: ``map`` itself, ``Executor.map``, ``multiprocessing.Pool.map`` or
        ``imap``, ``dask.distributed.Client.map``, ``ray.util.multiprocessing.Pool.map``, ``MPIPoolExecutor.map``. Futures are
        waited for. By default a thread for each core of this machine.
    chunk : int
        Runs of a task. Neighbours mostly share a scene, which is then built once.
    cache : bool or path
        Where what runs came to is kept and looked up by workers: the folder of ``palpate batch``, none, or this folder.
    directory : path
        Where paths of a text or dictionary start; by default the current directory.
    timings : bool
        With the wall time of each run, which is not the same twice.

    A run that fails is a row with its ``error``. Tasks and results are plain data, with all files: workers need this package in
    the same build, and nothing else.

    Raises
    ------
    SweepError
        A sweep that cannot be run, in the words of ``palpate batch``; or a map that ended before all runs were back.
    """
    if map is not None and not callable(map):
        method = ": give its method, .map" if hasattr(map, "map") else ""
        raise TypeError(f"map is a function such as Executor.map, not {type(map).__name__}{method}")
    if chunk < 1:
        raise ValueError(f"chunk is {chunk}; a task has at least one run")
    packed = _packed(sweep, directory)
    plan, folder = _opened(packed), _folder(cache)
    runs = range(plan.count)
    tasks = [list(runs[first : first + chunk]) for first in runs[::chunk]]
    # Without a task it has no thread.
    with ThreadPoolExecutor(_native.Sweep.cores()) as threads:
        made = _all(map or threads.map, functools.partial(_make, packed, folder), tasks, runs, folder)
    rows = plan.table([(run, outcome) for run, _, outcome in made], timings)
    return SweepTable(rows, sum(was_known for _, was_known, _ in made))


def _make(packed: _Packed, cache: Optional[str], runs: "list[int]") -> "list[_Made]":
    """Makes runs in the process that calls it."""
    return _opened(packed).make(runs, cache)


@functools.lru_cache(maxsize=4)
def _opened(packed: _Packed) -> "_native.Sweep":
    build, text, name, directory, files = packed
    if build != _native.Sweep.build():
        here = ", ".join(_native.Sweep.build())
        raise SweepError(f"workers need the build of palpate that hands out the runs, {', '.join(build)}; this one is {here}")
    return _native.Sweep(text, name, directory, dict(files))


def _packed(sweep: "Union[_Path, Mapping[str, Any]]", directory: _Path) -> _Packed:
    """The sweep with all files that it needs."""
    name, start = "sweep", os.fspath(directory)
    if isinstance(sweep, Mapping):
        text = _native.toml_text(dict(sweep))
    elif isinstance(sweep, str) and "\n" in sweep:
        text = sweep
    else:
        name = os.fspath(sweep)
        text, start = Path(name).read_text("utf-8"), os.path.dirname(name)
    files = _native.Sweep(text, name, start).files()
    return _native.Sweep.build(), text, name, start, tuple(files.items())


def _folder(cache: "Union[bool, _Path]") -> Optional[str]:
    """Where outcomes are kept."""
    if cache is False:
        return None
    folder = _native.Sweep.user_cache() if cache is True else os.path.abspath(cache)
    if folder is None:
        raise SweepError("no folder for the cache: set HOME or XDG_CACHE_HOME, name one with cache=, or use cache=False")
    os.makedirs(folder, exist_ok=True)
    return os.fspath(folder)


def _all(
    map: "Callable[..., Any]",
    work: "Callable[[list[int]], list[_Made]]",
    tasks: "list[list[int]]",
    runs: range,
    folder: Optional[str],
) -> "list[_Made]":
    """What all runs came to, each once."""
    made: "dict[int, _Made]" = {}
    try:
        for result in map(work, tasks):
            # Of a future, as Dask gives it, the result is waited for.
            for one in result.result() if hasattr(result, "result") else result:
                made[one[0]] = one
    except PalpateError:
        raise
    except Exception as error:
        again = (
            f"those that were made are in {folder}: call sweep again, with a new executor if this one lost a worker"
            if folder
            else "with a cache, a second call would make only the others"
        )
        raise SweepError(
            f"the map ended when {len(made)} of {len(runs)} runs were back: {type(error).__name__}: {error}; {again}"
        ) from error
    if set(made) != set(runs):
        raise SweepError(f"the map gave back {len(made)} runs, not the {len(runs)} of the sweep")
    return list(made.values())
