"""Recordings: columns of ticks as arrays, nets at any tick, replays."""

import json
import os
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from .errors import RecordingError, RecordingWarning

if TYPE_CHECKING:
    import pandas  # type: ignore[import-untyped,unused-ignore]

#: Columns of each tool, in the order of tables, and of the loop.
_TOOL_COLUMNS, _LOOP_COLUMNS = _native.RecordingFile.column_names()
_AXES = {2: "uv", 3: "xyz", 6: ("vx", "vy", "vz", "wx", "wy", "wz"), 7: ("x", "y", "z", "qx", "qy", "qz", "qw")}


@dataclass(frozen=True)
class ReplayReport:
    """What a replay found when nothing differed."""

    ticks_matched: int
    """Ticks whose every output and state hash were equal by bits."""
    nets_matched: int
    """Nets that were compared."""
    complete: bool
    """The recording was finished, lost nothing, and every tick could be reached."""
    same_build: bool
    """Recorded by this very build."""
    session_hash: str
    """Hash of all ticks, hexadecimal."""
    realtime_factor: float
    """Simulated over wall time."""
    details: "dict[str, Any]"
    """All of ``palpate replay --json``."""


class Ticks:
    """Columns of a tool; each is read from the file when it is first asked for, and kept.

    Rows are ticks. ``force``, ``torque``, ``contact_force``, ``contact_torque`` (ticks, 3) N and N·m; ``depth`` (ticks,)
    m; ``proxy`` (ticks, 7); ``energy``, ``dissipated`` (ticks,) J; ``error_n`` (ticks,) N, how far
    the force may be off, NaN in older files; ``pose`` (ticks, 7) and ``velocity`` (ticks, 6) as applied in the tick, NaN where none was new; ``contact_point``, ``contact_normal`` (ticks, 3) of the deepest
    contact, NaN without; ``pose_seq``, ``flags``, ``contact_count`` (ticks,); and the other quantities of tools that ``dir`` lists.
    """

    def __init__(self, file: "_native.RecordingFile", tool: int, checked: "Callable[[], None]") -> None:
        self._file, self._tool, self._checked = file, tool, checked
        self._known: dict[str, NDArray[Any]] = {}

    def read(self, *names: str, first: Optional[int] = None, last: Optional[int] = None) -> "dict[str, NDArray[Any]]":
        """Several columns in one pass over the file; of the ticks ``first`` to ``last`` only, where given."""
        columns = self._file.columns(self._tool, list(names), first, last)
        self._checked()
        if first is None and last is None:
            self._known.update(columns)
        return {name: columns[name] for name in names}

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name.startswith("_") or name not in _TOOL_COLUMNS + _LOOP_COLUMNS:
            raise AttributeError(f"a recording has no column {name!r}; it has {', '.join(_TOOL_COLUMNS)}")
        if name not in self._known:
            self.read(name)
        return self._known[name]

    def __dir__(self) -> "list[str]":
        return ["read", *_TOOL_COLUMNS, *_LOOP_COLUMNS]


class _ByTool(Mapping[str, Ticks]):
    def __init__(self, recording: "Recording") -> None:
        self._recording = recording
        self._known: dict[str, Ticks] = {}

    def __getitem__(self, tool: str) -> Ticks:
        tools = self._recording.tools
        if tool not in tools:
            raise KeyError(f"this recording has no tool {tool!r}; it has {', '.join(map(repr, tools))}")
        if tool not in self._known:
            file = self._recording._file
            self._known[tool] = Ticks(file, tools.index(tool), self._recording._tell_damage)
        return self._known[tool]

    def __iter__(self) -> Iterator[str]:
        return iter(self._recording.tools)

    def __len__(self) -> int:
        return len(self._recording.tools)


class Recording:
    """A recording, opened: what it holds is read when it is asked for. Made by :func:`palpate.open`."""

    def __init__(self, path: "Union[str, os.PathLike[str]]") -> None:
        self._told = False
        self._open(Path(path))

    def _open(self, path: Path) -> None:
        self._file = _native.RecordingFile(path)
        self._ticks = _ByTool(self)
        self._loop: Optional[Ticks] = None
        self._tell_damage()

    def _tell_damage(self) -> None:
        reason = self.cut_short
        if reason is not None and not self._told:
            self._told = True
            warnings.warn(f"{self.path}: not whole: {reason}; the rest is used", RecordingWarning, stacklevel=4)

    @property
    def path(self) -> Path:
        """The file."""
        return Path(self._file.path)

    @property
    def tools(self) -> "list[str]":
        """Ids of tools."""
        return self._file.tools

    @property
    def bodies(self) -> "list[str]":
        """Ids of bodies."""
        return self._file.bodies

    @property
    def dt(self) -> float:
        """Length of a tick, s."""
        return self._file.dt_ns * 1e-9

    @property
    def metadata(self) -> "dict[str, str]":
        """Metadata: build, scene, clock, target…; and how it ended."""
        return {**self._file.run, **{f"end.{key}": value for key, value in self._file.end.items()}}

    @property
    def cut_short(self) -> Optional[str]:
        """Why the file is not whole, as far as is known; damage inside shows when it is read."""
        return self._file.cut_short

    @property
    def whole(self) -> bool:
        """Finished without a loss, and nothing found damaged so far."""
        return self._file.whole

    def __len__(self) -> int:
        return self._file.tick_count

    @property
    def ticks(self) -> "Mapping[str, Ticks]":
        """Columns by tool: ``recording.ticks["ball"].force``."""
        return self._ticks

    def _column(self, name: str) -> NDArray[Any]:
        if self._loop is None:
            self._loop = Ticks(self._file, 0, self._tell_damage)
        column: NDArray[Any] = getattr(self._loop, name)
        return column

    @property
    def tick(self) -> NDArray[np.uint64]:
        """(ticks,) numbers."""
        return self._column("tick")

    @property
    def time(self) -> NDArray[np.float64]:
        """(ticks,) simulated time, s."""
        time: NDArray[np.float64] = self.tick.astype(np.float64) * self.dt
        return time

    @property
    def hash(self) -> NDArray[np.uint64]:
        """(ticks,) hash of the state after each tick."""
        return self._column("hash")

    def scene(self) -> "_native.Scene":
        """The scene, as built."""
        return _native.Scene._of(
            self._file.scene_text, self._file.effective_scene, self._file.run.get("scene", "scene")
        )

    def events(self) -> "list[tuple[int, str, str]]":
        """Tick, kind and words of each event."""
        return self._file.events()

    def net_ticks(self, body: str) -> NDArray[np.uint64]:
        """Ticks at which the net of a body was recorded."""
        self._body(body)
        return self._file.net_ticks(body)

    def surface(self, body: str, tick: int) -> "_native.Surface":
        """The surface of a body after any tick: recorded, or replayed to and proved by the recorded hash."""
        self._body(body)
        return self._file.surface(body, tick)

    def net(self, body: str, tick: int) -> NDArray[np.float64]:
        """The control net of a body after any tick, (nu, nv, 3) m."""
        return self.surface(body, tick).points

    def _body(self, body: str) -> None:
        if body not in self.bodies:
            raise KeyError(f"this recording has no body {body!r}; it has {', '.join(map(repr, self.bodies))}")

    def info(self, *, check: bool = False) -> "dict[str, Any]":
        """A summary (``palpate info --json``); with ``check`` computed from every tick."""
        told: dict[str, Any] = json.loads(self._file.info_json(check))
        return told

    def to_pandas(self, columns: Optional[Sequence[str]] = None) -> "pandas.DataFrame":
        """A table with a row for each tick: time, hash, and for each tool its columns, such as ``ball.force.x``."""
        import pandas  # type: ignore[import-untyped,unused-ignore]

        names = list(columns) if columns is not None else list(_TOOL_COLUMNS)
        table: dict[str, Any] = {}
        for number, tool in enumerate(self.tools):
            ticks = self.ticks[tool]
            wanted = [name for name in names if name not in ticks._known]
            wanted += ["tick", "hash"] if number == 0 else []
            read = ticks.read(*wanted) if wanted else {}
            if number == 0:
                table["hash"] = read["hash"]
                index = pandas.Index(read["tick"], name="tick")
                table = {"time": read["tick"] * self.dt, **table}
            for name in names:
                values = ticks._known[name]
                if values.ndim == 1:
                    table[f"{tool}.{name}"] = values
                else:
                    for axis, label in enumerate(_AXES[values.shape[1]]):
                        table[f"{tool}.{name}.{label}"] = values[:, axis]
        if not self.tools:
            raise RecordingError(f"{self.path}: a recording without tools has no table")
        return pandas.DataFrame(table, index=index)

    def replay(
        self, *, first: int = 0, last: Optional[int] = None, jobs: Optional[int] = None, progress: bool = False
    ) -> ReplayReport:
        """Passes the recorded poses and commands to this build's step and compares every bit.

        Parameters
        ----------
        first, last
            Ticks; by default all.
        jobs
            Threads; results do not depend on it.
        progress
            Show a bar, where tqdm is installed.

        Raises
        ------
        DivergedError
            With the first tick that differs and both values.
        RecordingError
            The recording cannot be replayed.
        """
        with _bar(progress) as report:
            details = json.loads(self._file.replay(first, last, jobs, report))
        complete = details["clean"] and details["gaps"] == 0 and details["ticks_unreached"] == 0
        return ReplayReport(
            details["ticks_matched"],
            details["nets_matched"],
            complete,
            details["same_build"],
            details["session_hash"],
            details["realtime_factor"],
            details,
        )

    def refresh(self) -> int:
        """Reads on in a file that grows; returns how many ticks came. Columns are read anew afterwards."""
        before = len(self)
        self._told = True  # Said once: such a file is never whole.
        self._open(self.path)
        return len(self) - before

    def show(self, width: int = 960, height: int = 640) -> Any:
        """The recording on a page, inside a notebook."""
        from ._notebook import _show_recording

        return _show_recording(self, width, height)

    def to_html(self, path: "Union[str, os.PathLike[str]]", *, max_bytes: int = 16_000_000) -> int:
        """Writes one page that opens from disk; returns one in how many ticks it has."""
        return _native.to_html(self.path, Path(path), max_bytes)

    def __repr__(self) -> str:
        return f"Recording({str(self.path)!r}, {len(self)} ticks, tools={self.tools})"


class _bar:
    """A progress bar of tqdm, where it is wanted and there."""

    def __init__(self, wanted: bool) -> None:
        self._bar: Any = None
        if wanted:
            try:
                from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
            except ImportError:
                return
            self._bar = tqdm(unit="ticks", desc="replay")

    def __enter__(self) -> "Optional[Callable[[int, int], None]]":
        if self._bar is None:
            return None

        def report(done: int, all: int) -> None:
            self._bar.total = all
            self._bar.update(done - self._bar.n)

        return report

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()


def open(path: "Union[str, os.PathLike[str]]") -> Recording:
    """Opens a recording. A file that is not whole is opened with a :class:`palpate.RecordingWarning`.

    Raises
    ------
    FileNotFoundError
        No such file.
    RecordingError
        Not a recording, or of a format that this version does not read.
    """
    return Recording(path)


def figures(recording: "Union[Recording, str, os.PathLike[str]]") -> "dict[str, Any]":
    """Peak and RMS force, depth, energy and contact of a recording, simulated again by this build."""
    opened = recording if isinstance(recording, Recording) else Recording(recording)
    told: dict[str, Any] = json.loads(opened._file.figures_json())
    return told
