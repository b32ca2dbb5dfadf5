"""What the tests share: the command beside the module, and a log of each kind."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import goingrate as gr

SOURCE = Path(__file__).resolve().parents[2]
LOGS = sorted((SOURCE / "data" / "logs").glob("*.csv"))
COMMAND = os.environ.get("GOINGRATE_COMMAND", str(SOURCE / "build" / "release" / "goingrate"))


def plain_environment():
    """Without what a sanitized Python is started with: the command brings its own."""
    return {k: v for k, v in os.environ.items() if k not in ("LD_PRELOAD", "PYTHONMALLOC")}


@pytest.fixture(scope="session")
def command():
    """Runs the command; returns what it wrote to standard output."""

    def run(*words, text=True):
        done = subprocess.run(
            [COMMAND, "--quiet", *map(str, words)],
            capture_output=True, text=text, env=plain_environment(), check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def command_json(command):
    """What a subcommand writes with --json."""
    return lambda *words: json.loads(command(*words, "--json", "-"))


@pytest.fixture(scope="session")
def jump():
    return gr.read(SOURCE / "data" / "logs" / "jump.csv")


@pytest.fixture(scope="session")
def jump_fit(jump):
    return gr.fit(jump, fix={"T0": 2}, events=["150:mu"], profiles=True)


@pytest.fixture
def beats():
    """Times of 500 beats of 2 s with 0.1 ms of jitter, s."""
    noise = np.random.default_rng(1).normal(scale=1e-4, size=500)
    return 2.0001 * np.arange(500) + noise


def numbers_of(result, path=""):
    """All numbers of a JSON result, by their place; words differ where they name options."""
    if isinstance(result, dict):
        for key, value in result.items():
            yield from numbers_of(value, f"{path}.{key}")
    elif isinstance(result, list):
        for i, value in enumerate(result):
            yield from numbers_of(value, f"{path}[{i}]")
    elif not isinstance(result, str):
        yield path, result
