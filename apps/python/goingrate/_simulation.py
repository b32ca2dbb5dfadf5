"""Simulated logs, of clocks whose parameters are known."""

from __future__ import annotations

import os
from typing import Any, Mapping, NamedTuple, Sequence, Union

import numpy as np

from . import _core
from ._arrays import Array
from ._log import Log
from ._reading import read
from ._tables import frame
from ._toml import toml_of
from .errors import InputError, InputNotFoundError

Scenario = Union[str, "os.PathLike[str]", Mapping[str, Any]]


class Truth:
    """The true state of a simulated clock: arrays with one entry per period, shape (periods,).

    Attributes
    ----------
    cycle : ndarray of int64
        Number of the upward crossing that ends the period.
    time_s, period_s : ndarray
        When the period ends, s after the start, and its length.
    velocity : ndarray
        φ̇ at that crossing, scaled.
    amplitude_rad : ndarray
        Turning angle at that crossing, rad.
    mu : ndarray
        The torque that acted during the period, scaled.
    method : str
        How the motion was computed, and why that way.
    """

    def __init__(self, arrays: dict[str, Array], method: str) -> None:
        self.cycle = arrays["cycle"]
        self.time_s = arrays["time_s"]
        self.period_s = arrays["period_s"]
        self.velocity = arrays["velocity"]
        self.amplitude_rad = arrays["amplitude_rad"]
        self.mu = arrays["mu"]
        self.method = method

    def to_pandas(self) -> Any:
        """A DataFrame with a row per period."""
        names = ("cycle", "time_s", "period_s", "velocity", "amplitude_rad", "mu")
        return frame({name: getattr(self, name) for name in names})

    def __len__(self) -> int:
        return len(self.cycle)

    def __repr__(self) -> str:
        return f"<goingrate.Truth of {len(self)} periods by {self.method}>"


class Simulation(NamedTuple):
    """The result of `simulate`: ``log, truth = gr.simulate(...)``."""

    log: Log
    truth: Truth


def _text_of(scenario: Scenario) -> tuple[str, str]:
    """The text of a scenario, and the name that messages give it."""
    if isinstance(scenario, Mapping):
        return toml_of(scenario), "scenario"
    if isinstance(scenario, str) and "\n" in scenario:
        return scenario, "scenario"
    try:
        path = os.fspath(scenario)
    except TypeError:
        raise ValueError(
            f"scenario: found {type(scenario).__name__}, expected a path, TOML text or a dict"
        ) from None
    try:
        with open(path, encoding="utf-8") as file:
            return file.read(), path
    except FileNotFoundError:
        raise InputNotFoundError(f"{path}: there is no such file", path) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: cannot be read: {error}", path) from error


def _overrides(given: Mapping[str, Any] | Sequence[str] | None) -> list[str]:
    if given is None:
        return []
    if isinstance(given, Mapping):
        return [f"{key}={value}" for key, value in given.items()]
    if isinstance(given, str):
        return [given]
    return [str(word) for word in given]


def simulate(
    scenario: Scenario,
    *,
    seed: int = 1,
    set: Mapping[str, Any] | Sequence[str] | None = None,
    read_options: Mapping[str, Any] | None = None,
) -> Simulation:
    """Simulate a clock and the sensor that watches it.

    Parameters
    ----------
    scenario : path, str or dict
        A file, its text (any string with a line end), or the same as a dict:
        ``{"clock": {"epsilon": 2.5e-4, ...}, "run": {"periods": 2000}, "event": [{...}]}``.
    seed : int
        Seed of the random streams, 0 to 2**64 - 1; equal seeds give equal logs.
    set : dict or list of "KEY=VALUE", optional
        Values that override the scenario's, for example ``{"clock.mu": 3e-5}``.
    read_options : dict, optional
        Keywords with which `read` reads the log.

    Returns
    -------
    Simulation
        `log`, as `read` reads it from the file that ``goingrate simulate`` writes (the same
        events, with as many digits as the sensor has), and `truth`.

    Raises
    ------
    InputError
        The scenario cannot be used; line and column say where.
    NumericsError
        The clock stops.
    """
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or not 0 <= seed < 2**64:
        raise ValueError(f"seed: found {seed!r}, expected a whole number from 0 to 2^64 - 1")
    text, name = _text_of(scenario)
    written, arrays, method = _core.simulate(text, name, _overrides(set), int(seed))
    log = read(written, name="simulated", **(read_options or {}))
    return Simulation(log, Truth(arrays, method))
