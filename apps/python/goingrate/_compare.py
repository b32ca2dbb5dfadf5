"""Several clocks compared."""

from __future__ import annotations

from typing import Sequence

from . import _core
from ._log import Log
from ._tables import Report


class Comparison(Report):
    """The results of ``goingrate compare``; ``print(comparison)`` shows its tables."""

    def __init__(self, json: str, text: str, rates: str) -> None:
        self._json_text = json
        self._text = text
        self._rates = rates

    def rates_csv(self) -> str:
        """Rates on one time axis: time_s, then one column in s/day for each clock."""
        return self._rates

    def _json(self) -> str:
        return self._json_text

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return "<goingrate.Comparison>"


def compare(logs: Sequence[Log]) -> Comparison:
    """Compare clocks over the time that all of their logs cover.

    Parameters
    ----------
    logs : sequence of Log, two or more
        One log of each clock, with times counted from the same origin.

    Returns
    -------
    Comparison

    Raises
    ------
    InputError
        The logs have fewer than 64 periods in common, or some have dates and others do not.
    ValueError
        Fewer than two logs.
    """
    for log in logs:
        if not isinstance(log, Log):
            raise ValueError(f"logs: found {type(log).__name__}, expected Logs")
    if len(logs) < 2:
        raise ValueError(f"logs: found {len(logs)}, expected two or more")
    return Comparison(*_core.compare([log._core for log in logs]))
