"""The package: stubs, docstrings, the program, the plugin, the pure part without the compiled one, old Pythons."""

import ast
import importlib.metadata
import inspect
import json
import os
import random
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import palpate as pp
from palpate import _native

from .conftest import ROOT, rigid

PACKAGE = Path(pp.__file__).parent


def stub() -> ast.Module:
    return ast.parse((PACKAGE / "_native.pyi").read_text("utf-8"))


def parameters(node: ast.FunctionDef) -> "list[tuple[str, str, bool]]":
    """Name, kind and whether there is a default, without self and cls."""
    plain = [*node.args.posonlyargs, *node.args.args]
    required = len(plain) - len(node.args.defaults)
    found = [(arg.arg, "plain", k >= required) for k, arg in enumerate(plain)]
    found += [(node.args.vararg.arg, "list", False)] if node.args.vararg else []
    found += [(a.arg, "named", d is not None) for a, d in zip(node.args.kwonlyargs, node.args.kw_defaults)]
    found += [(node.args.kwarg.arg, "dict", False)] if node.args.kwarg else []
    return [entry for entry in found if entry[0] not in ("self", "cls")]


KINDS = {
    inspect.Parameter.POSITIONAL_ONLY: "plain",
    inspect.Parameter.POSITIONAL_OR_KEYWORD: "plain",
    inspect.Parameter.VAR_POSITIONAL: "list",
    inspect.Parameter.KEYWORD_ONLY: "named",
    inspect.Parameter.VAR_KEYWORD: "dict",
}


def real_parameters(function: Any) -> "list[tuple[str, str, bool]]":
    signature = inspect.signature(function)
    found = [(p.name, KINDS[p.kind], p.default is not p.empty) for p in signature.parameters.values()]
    return [entry for entry in found if entry[0] not in ("self", "cls")]


def test_the_stubs_name_what_the_module_has() -> None:
    classes = {node.name: node for node in stub().body if isinstance(node, ast.ClassDef)}
    functions = {node.name: node for node in stub().body if isinstance(node, ast.FunctionDef)}
    real = {name: value for name, value in vars(_native).items() if not name.startswith("__")}
    assert set(real) == set(classes) | set(functions)
    for name, node in functions.items():
        assert parameters(node) == real_parameters(real[name]), name
    ordinary = {"__new__", "__repr__", "__doc__", "__module__", "__hash__", "__ne__", "__lt__", "__le__", "__gt__", "__ge__"}
    for name, node in classes.items():
        # The first of several overloads has the defaults.
        members = {part.name: part for part in reversed(node.body) if isinstance(part, ast.FunctionDef)}
        own = {key for key in vars(real[name]) if key not in ordinary}
        assert own == set(members) - ordinary, name
        for key, part in members.items():
            where = f"{name}.{key}"
            decorators = {d.id for d in part.decorator_list if isinstance(d, ast.Name)}
            if key == "__new__":
                assert parameters(part) == real_parameters(real[name]), where
            elif "property" in decorators:
                assert inspect.isgetsetdescriptor(vars(real[name])[key]), where
            else:
                assert ("staticmethod" in decorators) == isinstance(vars(real[name])[key], staticmethod), where
                if not key.startswith("__"):
                    assert parameters(part) == real_parameters(getattr(real[name], key)), where


def test_everything_public_has_words_with_units() -> None:
    for name in pp._COMPILED:
        value = getattr(pp, name)
        if name in ("CONTACT", "CLOSEST"):
            continue
        assert inspect.getdoc(value), name
        if inspect.isclass(value) and value.__module__.startswith("palpate"):
            for key, member in vars(value).items():
                told = callable(member) or inspect.isdatadescriptor(member)
                if told and not key.startswith("_") and key not in ("count", "index"):
                    assert inspect.getdoc(getattr(value, key)), f"{name}.{key}"
    for words in ("(3,) N", "(n, 3) live view, N", "(nu, nv, 3) m"):
        members = [inspect.getdoc(m) or "" for c in (pp.Output, pp.Batch, pp.Simulation) for m in vars(c).values()]
        assert any(words in text for text in members), words
    assert set(dir(pp)) >= set(pp._COMPILED)
    with pytest.raises(AttributeError, match="banana"):
        _ = pp.banana


def program(*arguments: str, module: bool = False, **options: Any) -> "subprocess.CompletedProcess[str]":
    command = Path(sys.executable).parent / "palpate"
    start = [sys.executable, "-m", "palpate"] if module or not command.exists() else [str(command)]
    return subprocess.run([*start, *arguments], capture_output=True, text=True, timeout=120, cwd=ROOT, **options)


@pytest.mark.parametrize("module", [False, True])
def test_the_command_is_the_program(module: bool, tmp_path: Path) -> None:
    version = program("--version", module=module)
    assert (version.returncode, version.stdout.strip()) == (0, f"palpate {pp.__version__}")
    scene = tmp_path / "scene.toml"
    scene.write_text(pp.Scene(rigid()).text)
    assert program("check", str(scene), module=module).returncode == 0
    scene.write_text("nonsense = 1\n")
    refused = program("check", str(scene), module=module)
    assert refused.returncode == 2 and "nonsense" in refused.stderr
    assert program("info", "none.mcap", module=module).returncode == 2
    assert program("dance", module=module).returncode == 2


def test_versions_agree() -> None:
    assert importlib.metadata.version("palpate") == pp.__version__
    assert pp.build_id().startswith(f"palpate {pp.__version__} ")


def test_the_messages_work_without_the_compiled_part_and_the_rest_says_what_is_missing() -> None:
    code = """
        import sys
        class NoCompiledPart:
            def find_spec(self, name, path=None, target=None):
                if name in ("palpate._native", "numpy"):
                    raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        sys.meta_path.insert(0, NoCompiledPart())
        import palpate, palpate.wire
        pose = palpate.ToolPose(1, 2, (0.0, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0))
        assert palpate.wire.decode(palpate.ToolPose, palpate.wire.encode(pose)) == pose == palpate.decode(palpate.ToolPose, palpate.encode(pose))
        for name in ("Scene", "Pose", "build_id"):
            try:
                getattr(palpate, name)
            except ImportError as error:
                assert "install a wheel" in str(error), error
            else:
                raise AssertionError(name)
        assert "numpy" not in sys.modules
    """
    import textwrap

    subprocess.run([sys.executable, "-c", textwrap.dedent(code)], check=True, timeout=60, cwd=ROOT)


def test_both_decoders_agree_on_golden_and_on_damaged_messages() -> None:
    draw = random.Random(5)
    agreed = refused = 0
    for file in sorted((ROOT / "proto" / "golden").glob("*.bin")):
        name = json.loads(file.with_suffix(".json").read_text("utf-8"))["type"]
        data = file.read_bytes()
        for k in range(60):
            damaged = bytearray(data)
            for _ in range(0 if k == 0 else draw.randint(1, 3)):
                damaged[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
            payload = bytes(damaged[: draw.randrange(len(data)) if k > 50 else len(data)])
            try:
                compiled = json.loads(_native.message_json(name, payload))
            except pp.ClientError:
                with pytest.raises(pp.DecodeError):
                    pp.decode(name, payload)
                refused += 1
                continue
            assert json.dumps(pp.to_json(pp.decode(name, payload)), sort_keys=True) == json.dumps(
                compiled, sort_keys=True
            ), f"{name} {payload.hex()}"
            agreed += 1
    assert agreed > 200 and refused > 200


def test_the_plugin_gives_fixtures(tmp_path: Path) -> None:
    test = tmp_path / "test_client.py"
    test.write_text(
        f"""
import palpate

SCENE = {rigid()!r}

def test_a_client(palpate_daemon, assert_replays, tmp_path):
    daemon = palpate_daemon(SCENE, record=tmp_path / "a.mcap")
    with daemon.tool("probe") as probe:
        assert probe.step((0.0, 0.0, 0.029)).force[2] > 0.0 or True
        for _ in range(9):
            force = probe.step((0.0, 0.0, 0.029))
    daemon.stop()
    assert assert_replays(tmp_path / "a.mcap").ticks_matched == 10

def test_a_daemon_that_died_fails(palpate_daemon):
    import os
    os.kill(palpate_daemon(SCENE).pid, 9)
""",
        "utf-8",
    )
    plugins = importlib.metadata.entry_points()
    named = plugins.select(group="pytest11") if hasattr(plugins, "select") else plugins.get("pytest11", [])
    loaded = any(entry.name == "palpate" for entry in named)
    arguments = [] if loaded else ["-p", "palpate.pytest_plugin"]
    run = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", *arguments, str(test)],
        capture_output=True, text=True, timeout=180, cwd=tmp_path,
    )  # fmt: skip
    assert "2 passed, 1 error" in run.stdout and "signal 9" in run.stdout, run.stdout + run.stderr


def test_the_sources_are_python_3_9() -> None:
    for file in [*PACKAGE.glob("*.py"), *(ROOT / "clients" / "python" / "examples").glob("*.py")]:
        ast.parse(file.read_text("utf-8"), str(file), feature_version=(3, 9))
        assert "match " not in [line.strip()[:6] for line in file.read_text("utf-8").splitlines()], file


def test_type_checkers_accept_the_package(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    use = tmp_path / "use.py"
    use.write_text(
        "import palpate as pp\n"
        "scene = pp.Scene.load('a.toml')\n"
        "out = scene.simulate().step({'ball': pp.Pose((0.0, 0.0, 0.0))})\n"
        "tick: int = out.tick\n"
        "with pp.serve(scene, clock='lockstep') as daemon, daemon.tool('ball') as tool:\n"
        "    force: float = tool.step((0.0, 0.0, 0.0)).force[0]\n"
        "wrong: str = out.tick  # type: ignore[assignment]\n",
        "utf-8",
    )
    run = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--warn-unused-ignores", "--cache-dir", str(tmp_path / "cache"),
         "--follow-imports=silent", str(use)],
        capture_output=True, text=True, timeout=300, cwd=tmp_path, env={**os.environ, "MYPYPATH": ""},
    )  # fmt: skip
    assert run.returncode == 0, run.stdout


def test_a_simulation_draws_itself_for_notebooks() -> None:
    sim = pp.Scene(rigid()).simulate()
    shown = sim.show(width=300, height=200)._repr_html_()
    assert shown.startswith("<img ") and "data:image/svg+xml;base64," in shown


def test_nothing_of_ours_warns(tmp_path: Path) -> None:
    # NumPy's aliases that are gone (np.bool, np.float) and truth values of arrays warn before they fail.
    code = f"""
import numpy as np
import palpate as pp
scene = pp.Scene({rigid()!r})
out = scene.simulate().step({{"probe": np.zeros(3, np.float32)}}, ticks=3)
out.contacts, out.force["probe"], out.fault, str(out), dict(out.depth)
batch = pp.Batch(scene, 2)
batch.step()
batch.reset(np.array([True, False]))
batch.vary("tool/probe/shape/sphere/radius_m", np.array([0.01, 0.011]))
surface = scene.surface("ball")
surface.closest(np.zeros((2, 3))), surface.evaluate(0.5, 0.5, 2), surface.tessellate(cells=2), surface.periodic
assert type(surface.closed) is bool and type(out.fault) is bool
scene.simulate().show()
"""
    run = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, timeout=120, cwd=tmp_path
    )
    assert (run.returncode, run.stderr) == (0, ""), run.stderr
