"""The package itself: types, documentation, stubs."""

import inspect
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import goingrate as gr
from conftest import SOURCE, plain_environment
from goingrate import _core

PACKAGE = Path(gr.__file__).parent


def public_things():
    for name in gr.__all__:
        thing = getattr(gr, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            yield name, thing


def test_it_is_typed():
    assert (PACKAGE / "py.typed").exists() and (PACKAGE / "_core.pyi").exists()
    for name, thing in public_things():
        if inspect.isfunction(thing):
            signature = inspect.signature(thing)
            assert signature.return_annotation is not inspect.Signature.empty, name
            for parameter in signature.parameters.values():
                assert parameter.annotation is not inspect.Parameter.empty, (name, parameter)


def test_a_type_checker_is_content():
    mypy = shutil.which("mypy", path="/usr/bin")
    if mypy is None:
        pytest.skip("mypy is not here")
    done = subprocess.run(
        [mypy, "--config-file", str(SOURCE / "apps/python/pyproject.toml"), str(PACKAGE)],
        capture_output=True, text=True, env=plain_environment(), check=False, cwd=PACKAGE.parent)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_names_what_the_extension_has():
    stub = (PACKAGE / "_core.pyi").read_text()
    functions = set(re.findall(r"^def (\w+)", stub, re.M))
    classes = dict(re.findall(r"^class (\w+):\n((?:    .*\n)+)", stub, re.M))
    has = {n: t for n, t in vars(_core).items() if not n.startswith("__")}
    assert {n for n, t in has.items() if inspect.isbuiltin(t)} == functions
    assert {n for n, t in has.items() if inspect.isclass(t)} == set(classes)
    for name, body in classes.items():
        members = {n for n in vars(has[name]) if not n.startswith("_")}
        assert members == set(re.findall(r"    def (\w+)", body)), name


def test_everything_is_documented():
    for name, thing in public_things():
        assert thing.__doc__, name
        if inspect.isfunction(thing):
            for parameter in inspect.signature(thing).parameters:
                assert re.search(rf"\b{parameter}\b.* :|\b{parameter}\b.*\n    ", thing.__doc__), (
                    name, parameter)
            assert "Returns\n" in thing.__doc__, name
        if inspect.isclass(thing):
            for member, value in vars(thing).items():
                if isinstance(value, property) or inspect.isfunction(value):
                    if not member.startswith("_"):
                        assert value.__doc__, (name, member)


def test_the_examples_run():
    import doctest

    assert doctest.testmod(sys.modules["goingrate._deviation"]).failed == 0


def test_pages_of_the_guide_run():
    """Every block of the guide's page on Python, one after the other."""
    page = (SOURCE / "data" / "guide" / "python.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", page, re.S)
    assert len(blocks) >= 5
    script = "import os\n" + "\n".join(blocks)
    environment = {**plain_environment(), "PYTHONPATH": str(PACKAGE.parent), "MPLBACKEND": "Agg"}
    environment.update({k: v for k, v in __import__("os").environ.items() if k == "LD_PRELOAD"})
    work = Path(__import__("tempfile").mkdtemp())
    (work / "data").symlink_to(SOURCE / "data")
    try:
        done = subprocess.run([sys.executable, "-c", script], cwd=work, env=environment,
                              capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[-2000:]
    finally:
        shutil.rmtree(work)


def test_versions_agree():
    text = (SOURCE / "CMakeLists.txt").read_text()
    assert gr.__version__ == re.search(r"project\(goingrate VERSION ([\d.]+)", text)[1]


def test_no_figure_or_table_library_is_loaded_unasked():
    code = "import goingrate, sys; print([m for m in ('pandas', 'matplotlib') if m in sys.modules])"
    environment = {**__import__("os").environ, "PYTHONPATH": str(PACKAGE.parent)}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True,
                          text=True, check=True)
    assert done.stdout.strip() == "[]"
