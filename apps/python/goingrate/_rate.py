"""The rate of a log."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import _core
from ._arrays import Array
from ._log import Log
from ._tables import Report, frame, new_axes
from .errors import NumericsError

_S_PER_DAY = 86400.0


class Rate(Report):
    """The rates of a log, or of its longest segment if it is split.

    A rate excess is T0 / period - 1, positive: fast. Attributes that end in ``_s_per_day`` are
    the same times 86400. If no nominal period is known, the rate is taken against the mean period
    and says nothing: `nominal_is_known` is then False.
    """

    def __init__(self, log: Log, core: _core.RateSummary) -> None:
        self.log = log
        self._core = core

    @property
    def crossings(self) -> int:
        """Number of good upward crossings."""
        return self._core.crossings

    @property
    def periods(self) -> int:
        """Number of cycles from the first to the last good crossing."""
        return self._core.periods

    @property
    def missed(self) -> int:
        """Number of cycles without an event, in gaps that were bridged."""
        return self.log.missed

    @property
    def spurious(self) -> int:
        """Number of events that are not crossings."""
        return self.log.spurious

    @property
    def segments(self) -> int:
        """Number of parts of the log that are numbered separately."""
        return self.log.segments

    @property
    def duration_s(self) -> float:
        """Time from the first to the last crossing, s."""
        return self._core.duration_s

    @property
    def nominal_period_s(self) -> float:
        """T0, s."""
        return self._core.nominal_period_s

    @property
    def nominal_is_known(self) -> bool:
        """False if T0 is only the mean period; the rates then say nothing."""
        return self._core.nominal_is_known

    @property
    def mean_period_s(self) -> float:
        """Duration divided by the number of periods, s."""
        return self._core.mean_period_s

    @property
    def mean_period_sigma_s(self) -> float:
        """Standard deviation of the mean period, s."""
        return self._core.mean_period_sigma_s

    @property
    def last_period_s(self) -> float:
        """The last period, s."""
        return self._core.last_period_s

    @property
    def rate_excess(self) -> float:
        """T0 / mean period - 1."""
        return self._core.rate_excess

    @property
    def rate_excess_sigma(self) -> float:
        """Standard deviation of the rate excess, from jitter and from the scatter of block
        rates."""
        return self._core.rate_excess_sigma

    @property
    def rate_s_per_day(self) -> float:
        """Seconds gained per day."""
        return self.rate_excess * _S_PER_DAY

    @property
    def rate_sigma_s_per_day(self) -> float:
        """Standard deviation of the rate in s/day."""
        return self.rate_excess_sigma * _S_PER_DAY

    @property
    def cycle(self) -> Array:
        """Cycle that ends each period, int64, shape (n - 1,) for n good beats."""
        return self.log.good["cycle"][1:]

    @property
    def period_s(self) -> Array:
        """Length of each period, s, shape (n - 1,); across missed beats the mean period there."""
        beats = self.log.good
        passed = np.diff(beats["seconds"]) + np.diff(beats["fraction"])
        return passed / np.diff(beats["cycle"])

    @property
    def rate_excess_each(self) -> Array:
        """T0 / period - 1 for each period, shape (n - 1,), computed without cancellation."""
        return _core.rate_per_period(self.log._core)

    @property
    def clock_error_s(self) -> Array:
        """How far the clock is ahead at each good beat, s, shape (n,)."""
        return _core.clock_error(self.log._core)

    def blocks(self, block_s: float) -> dict[str, Array]:
        """Rates of blocks of `block_s` seconds.

        Returns
        -------
        dict of str to ndarray, each of shape (blocks,)
            segment, from_cycle, to_cycle, time_s, duration_s, rate_excess, sigma, amplitude_rad.
        """
        return _core.block_rates(self.log._core, block_s)

    def segment_rates(self) -> dict[str, Array]:
        """Rates of the segments, in the same columns as `blocks`."""
        return _core.segment_rates(self.log._core)

    def to_csv(self, running_cycles: int = 0) -> str:
        """The table that ``goingrate rate`` writes, with a row per event; with `running_cycles`
        also the rate over that many cycles up to each event."""
        return _core.rate_csv(self.log._core, running_cycles)

    def to_pandas(self) -> Any:
        """A DataFrame with a row per period: cycle, period_s, rate_excess, rate_s_per_day,
        amplitude_rad."""
        each = self.rate_excess_each
        return frame(
            {
                "cycle": self.cycle,
                "period_s": self.period_s,
                "rate_excess": each,
                "rate_s_per_day": each * _S_PER_DAY,
                "amplitude_rad": self.log.good["amplitude_rad"][1:],
            }
        )

    def plot(self, ax: Any = None) -> Any:
        """The rate of each period (s/day) by cycle, on matplotlib axes."""
        ax = new_axes(ax)
        ax.plot(self.cycle, self.rate_excess_each * _S_PER_DAY, ".", markersize=2)
        ax.set(xlabel="cycle", ylabel="rate (s/day)", title=self.log.source)
        return ax

    def _json(self) -> str:
        return self._core.json(self.log._core)

    def __str__(self) -> str:
        return self._core.text(self.log._core)

    def __repr__(self) -> str:
        return (
            f"<goingrate.Rate {self.rate_s_per_day:.6g} ± {self.rate_sigma_s_per_day:.2g} s/day, "
            f"{self.crossings} beats>"
        )


def rate(log: Log) -> Rate:
    """The mean rate of a log and its uncertainty.

    Parameters
    ----------
    log : Log

    Returns
    -------
    Rate
        Its `rate_excess` is taken from end to end, T0 n / (t_n - t_0) - 1; the standard deviation
        comes from the jitter at both ends and from the scatter of block rates.

    Raises
    ------
    NumericsError
        The log was read as phases only.
    """
    if not isinstance(log, Log):
        raise ValueError(f"log: found {type(log).__name__}, expected a Log (of read() or Log())")
    if len(log.good) == 0:
        raise NumericsError(f"{log.source}: read as phases only, it has no beats")
    return Rate(log, _core.rate(log._core))
