"""The spectrum of the rate, and its split into fast drive, slow drive and jitter."""

from __future__ import annotations

from typing import Any, NamedTuple

from . import _core
from ._arrays import Array
from ._fit import Fit, Progress, fit as fit_log
from ._log import Log
from ._request import Fixed, Priors
from ._tables import Report, frame, new_axes


class Rms(NamedTuple):
    """An rms value with its 68 % interval; None where the log does not determine it."""

    rms: float | None
    low68: float | None
    high68: float | None


class Line(NamedTuple):
    """A strictly periodic part of the rate."""

    period_s: float
    amplitude: float  #: of the relative drive, or of the rate where the drive is not known
    amplitude_of: str
    false_alarm: float  #: probability that noise alone shows such a line


class Spectrum(Report):
    """The spectrum of the rate about the fit, and what it says about the drive."""

    def __init__(self, core: _core.DriveAnalysis, fit: Fit | None = None) -> None:
        self._core = core
        self.fit = fit  #: the fit whose rate was subtracted

    @property
    def frequency_hz(self) -> Array:
        """Frequencies, Hz, shape (k,); read-only view."""
        return self._core.frequency_hz

    @property
    def density(self) -> Array:
        """One-sided density of the relative rate, 1/Hz, shape (k,); read-only view."""
        return self._core.density

    @property
    def fast_density(self) -> Array | None:
        """The part of the fast drive in the fitted density, 1/Hz, shape (k,); None if unknown."""
        return self._core.fast_density

    @property
    def slow_density(self) -> Array | None:
        """The part of the slow drive, 1/Hz, shape (k,); None if unknown."""
        return self._core.slow_density

    @property
    def jitter_density(self) -> Array | None:
        """The part of the sensor's jitter, 1/Hz, shape (k,); None if unknown."""
        return self._core.jitter_density

    @property
    def rates(self) -> Array:
        """Rate excess of each cycle about the fit, shape (cycles,); read-only view."""
        return self._core.rates

    def _values(self) -> dict[str, Any]:
        if not hasattr(self, "_dict"):
            self._dict = self.to_dict()
        return self._dict

    @property
    def corner_hz(self) -> float | None:
        """2 epsilon / T0, Hz: at lower frequencies the amplitude follows the drive. None if
        unknown."""
        return self._values()["corner_hz"]

    @property
    def fast(self) -> Rms:
        """The part of the relative drive that is independent from period to period (white)."""
        return Rms(**self._values()["fast"])

    @property
    def slow(self) -> Rms:
        """The part of the relative drive that is correlated over periods."""
        return Rms(**self._values()["slow"])

    @property
    def jitter_s(self) -> Rms:
        """Jitter of the sensor, s."""
        return Rms(**self._values()["jitter_s"])

    @property
    def lines(self) -> list[Line]:
        """Lines, strongest first."""
        keys = Line._fields
        return [Line(*(line[key] for key in keys)) for line in self._values()["lines"]]

    def to_csv(self) -> str:
        """The table that ``goingrate spectrum -o`` writes."""
        return self._core.csv()

    def to_pandas(self) -> Any:
        """A DataFrame with a row per frequency: frequency_hz, density, and its parts if known."""
        columns = {"frequency_hz": self.frequency_hz, "density": self.density}
        for part in ("fast_density", "slow_density", "jitter_density"):
            if getattr(self, part) is not None:
                columns[part] = getattr(self, part)
        return frame(columns)

    def plot(self, ax: Any = None) -> Any:
        """The density and its parts, on matplotlib axes with logarithmic scales."""
        ax = new_axes(ax)
        ax.plot(self.frequency_hz[1:], self.density[1:], linewidth=0.7, label="rate")
        for part in ("fast", "slow", "jitter"):
            density = getattr(self, part + "_density")
            if density is not None:
                ax.plot(self.frequency_hz[1:], density[1:], label=part)
        ax.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="density (1/Hz)")
        ax.legend()
        return ax

    def _json(self) -> str:
        return self._core.json()

    def __str__(self) -> str:
        return self._core.text()

    def __repr__(self) -> str:
        return f"<goingrate.Spectrum of {len(self.rates)} rates>"


def spectrum(
    log: Log,
    fit: Fit | None = None,
    *,
    split_hz: float | None = None,
    fix: Fixed | None = None,
    prior: Priors | None = None,
    events: Any = None,
    model: str | None = None,
    noise: str | None = None,
    escapement: str | None = None,
    progress: Progress | None = None,
) -> Spectrum:
    """The spectrum of the rate, split into fast drive, slow drive and jitter.

    Parameters
    ----------
    log : Log
    fit : Fit, optional
        A fit of this log; if not given, one is made with the options below.
    split_hz : float, optional
        Frequency that separates fast from slow drive, Hz.
    fix, prior, events, model, noise, escapement, progress
        As for `fit`.

    Returns
    -------
    Spectrum

    Raises
    ------
    NumericsError
        Too few beats, or no fit.
    ValueError
        An option makes no sense, or `fit` belongs to another log.
    """
    if not isinstance(log, Log):
        raise ValueError(f"log: found {type(log).__name__}, expected a Log (of read() or Log())")
    if split_hz is not None and not split_hz > 0:
        raise ValueError(f"split_hz: found {split_hz}, expected above 0")
    if fit is None:
        fit = fit_log(
            log, fix=fix, prior=prior, events=events, model=model, noise=noise,
            escapement=escapement, progress=progress,
        )
    elif not isinstance(fit, Fit) or len(fit.residual_s) != len(log.good):
        raise ValueError("fit: expected a fit of this log")
    return Spectrum(_core.spectrum(log._core, fit._core, split_hz or 0.0), fit)
