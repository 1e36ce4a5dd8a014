"""Daemons of one's own: children of this process that end with it."""

import atexit
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import weakref
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Optional, Union

from . import _native
from ._client import Session
from .errors import DaemonError

#: Daemons that run, to be ended with the interpreter.
_running: "weakref.WeakSet[Daemon]" = weakref.WeakSet()
_spawner: "Optional[ThreadPoolExecutor]" = None
_spawner_pid = 0

#: Tries to get a free port that nobody else takes in between.
_TRIES = 5
#: Bytes of stderr that an exception shows.
_LAST_WORDS = 4000


class Daemon(Session):
    """A daemon of this process and a session with it. Made by :func:`serve`."""

    def __init__(
        self,
        process: "subprocess.Popen[bytes]",
        link: "_native.Link",
        endpoint: str,
        record: Optional[Path],
        files: "tempfile.TemporaryDirectory[str]",
    ) -> None:
        super().__init__(link, self)
        self._process = process
        self._files = files
        self._owner = os.getpid()
        self._ended = False
        #: Where it listens.
        self.endpoint = endpoint
        #: The recording, if one is made. It is complete after :meth:`stop`.
        self.record = record
        _running.add(self)

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def words(self) -> str:
        """What it wrote to stderr so far."""
        return _words(Path(self._files.name))

    def check(self) -> None:
        """Raises :class:`palpate.DaemonError` with its last words when it has ended by itself."""
        code = self._process.poll()
        if code is not None and not self._ended:
            raise _died(code, self.words())

    def stop(self, timeout: float = 30.0) -> int:
        """Ends it: forces fade, the recording is finished. Returns its exit code.

        Raises
        ------
        DaemonError
            It had ended by itself, did not end in time (it is killed then), or its recording has losses.
        """
        if self._ended or os.getpid() != self._owner:
            return self._process.returncode or 0
        died = self._process.poll()
        self._ended = True
        _running.discard(self)
        if died is None:
            self._process.send_signal(signal.SIGTERM)
        # Given back before the daemon is waited for: a tool in lockstep keeps nobody waiting.
        super().close()
        try:
            code = self._process.wait(timeout)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
            raise DaemonError(f"the daemon did not end within {timeout} s and was killed: {self.words()}") from None
        words = self.words()
        self._files.cleanup()
        if died is not None:
            raise _died(died, words)
        if code != 0:
            raise _died(code, words)
        return code

    def close(self) -> None:
        """As :meth:`stop`."""
        self.stop()

    def __enter__(self) -> "Daemon":
        return self

    def __exit__(self, *raised: object) -> None:
        try:
            self.stop()
        except DaemonError:
            # What went wrong inside says more.
            if raised[0] is None:
                raise


def _died(code: int, words: str) -> DaemonError:
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    error = DaemonError(f"the daemon ended ({how}): {words.strip() or 'it said nothing'}")
    error.code, error.words = code, words
    return error


def _words(directory: Path) -> str:
    try:
        return (directory / "stderr").read_bytes()[-_LAST_WORDS:].decode("utf-8", "replace")
    except OSError:
        return ""


def _stop_all() -> None:
    for daemon in list(_running):
        if daemon._owner == os.getpid():
            daemon._process.kill() if daemon._process.poll() is None else None
            daemon._process.wait()


atexit.register(_stop_all)


def _spawn(arguments: "list[str]", stderr: Any) -> "subprocess.Popen[bytes]":
    """Starts a child that ends when the thread that started it ends (Linux: PR_SET_PDEATHSIG is by thread)."""
    global _spawner, _spawner_pid

    def start() -> "subprocess.Popen[bytes]":
        level = os.environ.get("RUST_LOG") or "warn,palpate=info"
        return subprocess.Popen(
            arguments,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=stderr,
            # Ctrl-C is for this process, which ends its daemons in order.
            start_new_session=True,
            # Whatever else is said, the line that the sockets are open.
            env={**os.environ, "RUST_LOG": f"{level},palpate::cli::serve=info"},
        )

    if threading.current_thread() is threading.main_thread():
        return start()
    if _spawner is None or _spawner_pid != os.getpid():
        _spawner, _spawner_pid = ThreadPoolExecutor(1, "palpate-spawner"), os.getpid()
    return _spawner.submit(start).result()


def _free_endpoint() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"tcp/127.0.0.1:{probe.getsockname()[1]}"


def serve(
    scene: "Union[str, os.PathLike[str], Mapping[str, Any], _native.Scene]",
    *,
    clock: Optional[str] = None,
    record: "Optional[Union[str, os.PathLike[str]]]" = None,
    listen: Optional[str] = None,
    instance: str = "default",
    http: Optional[str] = None,
    arguments: Sequence[str] = (),
    timeout: float = 30.0,
) -> Daemon:
    """Starts a daemon as a child process and connects to it.

    Parameters
    ----------
    scene
        A scene file, a :class:`palpate.Scene`, or a dictionary.
    clock
        ``realtime`` or ``lockstep``; by default what the scene says.
    record
        Record to this file from the first tick on. It must not exist.
    listen
        Zenoh endpoint; by default a free port on loopback.
    instance
        Instance name.
    http
        Address of a page, for example ``127.0.0.1:8080``, or ``127.0.0.1:0`` for any port.
    arguments
        More arguments of ``palpate serve``.
    timeout
        How long to wait until it answers, s.

    Raises
    ------
    SceneError
        The scene has problems.
    DaemonError
        It ended at once, for example because the port is in use, with its last words.
    """
    last: Optional[DaemonError] = None
    for _ in range(1 if listen else _TRIES):
        try:
            return _serve(scene, clock, record, listen or _free_endpoint(), instance, http, arguments, timeout)
        except DaemonError as error:
            # Another process took the port in between.
            if listen or "cannot listen" not in error.words:
                raise
            last = error
    assert last is not None
    raise last


def _serve(
    scene: Any,
    clock: Optional[str],
    record: Any,
    endpoint: str,
    instance: str,
    http: Optional[str],
    more: Sequence[str],
    timeout: float,
) -> Daemon:
    files = tempfile.TemporaryDirectory(prefix="palpate-")
    directory = Path(files.name)
    if isinstance(scene, (str, os.PathLike)):
        # Built here first: its problems become an exception with a list.
        _native.Scene.load(scene)
        path = Path(scene)
    else:
        built = scene if isinstance(scene, _native.Scene) else _native.Scene(dict(scene))
        path = directory / f"{built.name}.toml"
        path.write_text(built.effective, "utf-8")
    # This very package, wherever it is, whatever lies in the current directory.
    program = f"import sys; sys.path[:] = {sys.path!r}; from palpate.__main__ import main; sys.exit(main())"
    command = [sys.executable, "-c", program, "serve", str(path), "--listen", endpoint, "--instance", instance]
    command += ["--with-parent", "--no-rt"]
    command += ["--clock", clock] if clock else []
    command += ["--record", str(record)] if record is not None else []
    command += ["--http", http] if http else []
    command += list(more)
    with (directory / "stderr").open("wb") as stderr:
        process = _spawn(command, stderr)
    deadline = time.monotonic() + timeout
    try:
        # It says when its sockets are open. To ask the endpoint would not do: another program may listen there.
        while "serving; poses on" not in _words(directory):
            code = process.poll()
            if code is not None:
                raise _died(code, _words(directory))
            if time.monotonic() > deadline:
                raise DaemonError(f"the daemon did not start within {timeout} s: {_words(directory)}")
            time.sleep(0.01)
        link = _native.Link([endpoint], instance, 5.0)
        link.scene()
    except BaseException:
        process.kill()
        process.wait()
        files.cleanup()
        raise
    return Daemon(process, link, endpoint, Path(record) if record is not None else None, files)
