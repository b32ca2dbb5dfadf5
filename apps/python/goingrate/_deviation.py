"""Allan deviations and their relatives."""

from __future__ import annotations

import math
from typing import Any, Sequence, Union

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._log import Log
from ._tables import Report, frame, new_axes

DEVIATION_KINDS: tuple[str, ...] = _core.DEVIATION_KINDS
"""The values that `deviation` takes as `kind`."""

Taus = Union[str, Sequence[float], Array]


class Deviation(Report):
    """A table of deviations: arrays with one entry per averaging time.

    ``print(deviation)`` shows the table and the sentences of ``goingrate stability``.
    """

    def __init__(self, core: _core.DeviationTable) -> None:
        self._core = core

    @property
    def kind(self) -> str:
        """oadev, mdev, ..."""
        return self._core.kind

    @property
    def tau0_s(self) -> float:
        """Interval of the data, s."""
        return self._core.tau0_s

    @property
    def tau_s(self) -> Array:
        """Averaging times, s, shape (k,)."""
        return self._core.tau_s

    @property
    def value(self) -> Array:
        """The deviations, shape (k,): dimensionless, or s (tdev, ttotdev, mtie, tierms)."""
        return self._core.value

    @property
    def low(self) -> Array:
        """Lower ends of the 68.27 % intervals, shape (k,); NaN where there is none."""
        return np.where(self._core.has_interval, self._core.low, np.nan)

    @property
    def high(self) -> Array:
        """Upper ends, shape (k,)."""
        return np.where(self._core.has_interval, self._core.high, np.nan)

    @property
    def m(self) -> Array:
        """Averaging factors, int64, shape (k,)."""
        return self._core.m

    @property
    def n(self) -> Array:
        """Number of terms averaged, int64, shape (k,)."""
        return self._core.n

    @property
    def alpha(self) -> Array:
        """Exponent of the noise at each averaging time (2 white phase ... -2 random walk of
        frequency), int, shape (k,); 0 also where none was identified."""
        return self._core.alpha

    def to_pandas(self) -> Any:
        """A DataFrame with a row per averaging time."""
        columns = ("tau_s", "m", "n", "value", "low", "high", "alpha")
        return frame({name: getattr(self, name) for name in columns})

    def plot(self, ax: Any = None) -> Any:
        """The deviations with their intervals, on matplotlib axes with logarithmic scales."""
        ax = new_axes(ax)
        below, above = self.value - self.low, self.high - self.value
        errors = np.nan_to_num(np.vstack([below, above]))
        ax.errorbar(self.tau_s, self.value, yerr=errors, fmt="o-", markersize=3, capsize=2)
        unit = " (s)" if self._core.in_seconds else ""
        ax.set(xscale="log", yscale="log", xlabel="τ (s)", ylabel=self.kind + unit)
        return ax

    def _json(self) -> str:
        return self._core.json()

    def __len__(self) -> int:
        return len(self._core.tau_s)

    def __str__(self) -> str:
        return self._core.text()

    def __repr__(self) -> str:
        return f"<goingrate.Deviation {self.kind}: {len(self)} averaging times>"


def _interval(rate: float | None, tau0_s: float | None) -> float | None:
    """tau0 from the sampling rate or from the interval."""
    if rate is None and tau0_s is None:
        return None
    if rate is not None and tau0_s is not None:
        raise ValueError("rate: expected either rate (Hz) or tau0_s (s), not both")
    if rate is not None:
        return 1.0 / _above_zero("rate", rate)
    return _above_zero("tau0_s", tau0_s)


def _above_zero(name: str, value: Any) -> float:
    is_number = isinstance(value, (int, float, np.number))
    if not (is_number and math.isfinite(value) and value > 0):
        raise ValueError(f"{name}: found {value!r}, expected a number above 0")
    return float(value)


def deviation(
    log: Log | None = None,
    *,
    phase: Any = None,
    frequency: Any = None,
    rate: float | None = None,
    tau0_s: float | None = None,
    kind: str = "oadev",
    taus: Taus = "octave",
    alpha: int | None = None,
    remove_bias: bool = True,
    threads: int = 0,
) -> Deviation:
    """Allan deviation or a related one, with intervals and the type of noise.

    Give one of `log`, `phase` and `frequency`.

    Parameters
    ----------
    log : Log, optional
        A log, whose clock error at every cycle is taken as the phase.
    phase : array_like, shape (n,), optional
        Time errors, s, at equal intervals; NaN marks a gap. A contiguous array of float64 is not
        copied.
    frequency : array_like, shape (n,), optional
        Fractional frequencies at equal intervals.
    rate : float, optional
        Samples per second (as in allantools); 1 if neither this nor `tau0_s` is given.
    tau0_s : float, optional
        The interval, s: 1 / rate.
    kind : str
        One of `DEVIATION_KINDS`.
    taus : {'octave', 'decade', 'all'} or array_like
        Averaging times, s.
    alpha : int, optional
        The noise assumed at every averaging time, 2 to -4; identified if not given.
    remove_bias : bool
        Correct total variances and Theo1 for their bias; False leaves them as they are.
    threads : int
        Number of threads; 0: chosen by the amount of work. The result does not depend on it.

    Returns
    -------
    Deviation

    Raises
    ------
    ValueError
        An array, a word or a time makes no sense.

    Examples
    --------
    >>> import numpy as np, goingrate as gr
    >>> x = np.cumsum(np.random.default_rng(1).normal(size=10000)) * 1e-6
    >>> d = gr.deviation(phase=x, rate=1.0, kind="oadev", taus="decade")
    >>> d.tau_s[:3]
    array([1., 2., 4.])
    """
    given = (log is not None) + (phase is not None) + (frequency is not None)
    if given != 1:
        raise ValueError(f"expected one of log, phase and frequency; found {given} of them")
    if alpha is not None and not -4 <= alpha <= 2:
        raise ValueError(f"alpha: found {alpha}, expected -4 to 2")
    if threads < 0:
        raise ValueError(f"threads: found {threads}, expected 0 or more")
    averaging = taus if isinstance(taus, str) else _arrays.numbers("taus", taus).tolist()
    if len(averaging) == 0:
        raise ValueError("taus: found no averaging time, expected octave, decade, all or seconds")
    interval = _interval(rate, tau0_s)
    options = (kind, averaging, alpha, remove_bias, threads)
    if log is not None:
        if not isinstance(log, Log):
            raise ValueError(f"log: found {type(log).__name__}, expected a Log; "
                             "arrays go to phase= or frequency=")
        return Deviation(_core.deviation_of_log(log._core, interval or 0.0, *options))
    interval = 1.0 if interval is None else interval
    if phase is not None:
        x = _arrays.numbers("phase", phase)
    else:
        x = _core.phase_from_frequency(_arrays.numbers("frequency", frequency), interval, 0.0)
    return Deviation(_core.deviation(x, interval, *options))
