"""Everything about one log."""

from __future__ import annotations

import os
from typing import Any, Iterable

from . import _core
from ._arrays import Array
from ._deviation import Deviation
from ._fit import Fit, Progress
from ._log import Log
from ._rate import Rate
from ._request import Fixed, Priors, request
from ._spectrum import Spectrum
from ._tables import Report


class Analysis(Report):
    """The results of ``goingrate report``; ``print(analysis)`` is its summary."""

    def __init__(self, log: Log, core: _core.Analysis) -> None:
        self.log = log
        self._core = core

    @property
    def rate(self) -> Rate:
        """The mean rate."""
        return Rate(self.log, self._core.rate)

    @property
    def fit(self) -> Fit:
        """The fit; its status says whether it has a result."""
        return Fit(self._core.fit)

    @property
    def spectrum(self) -> Spectrum | None:
        """The spectrum of the rate; None if the log is too short."""
        drive = self._core.drive
        return Spectrum(drive, self.fit) if drive.has_spectrum else None

    @property
    def deviation(self) -> Deviation:
        """Overlapping Allan deviation."""
        return Deviation(self._core.deviation)

    @property
    def causes(self) -> list[dict[str, Any]]:
        """Likely causes, likeliest first, with the keys cause, gain_2logL, for, against, advice."""
        return self.to_dict()["causes"]

    @property
    def diary(self) -> dict[str, Any]:
        """Changes and interruptions, with their times."""
        return self.to_dict()["diary"]

    @property
    def kept_diary(self) -> dict[str, Any] | None:
        """The keeper's diary: each entry with what was planned and what the log shows, and what
        the log shows without an entry. None if no diary was given."""
        return self.to_dict().get("kept_diary")

    @property
    def isochronism(self) -> dict[str, Any] | None:
        """Slope of the rate against the amplitude, and the fitted clock's curves; None without
        them."""
        return self.to_dict().get("isochronism")

    def diary_csv(self) -> str:
        """The changes and interruptions found in the log, as a diary that `analyse` can read."""
        return self._core.diary_text()

    @property
    def covariates(self) -> list[dict[str, Any]]:
        """How the rate depends on temperature and pressure, where the log has them."""
        return self._core.covariates

    @property
    def drive_history(self) -> dict[str, Array] | None:
        """History of the drive: time_s, relative_drive, sigma, each of shape (blocks,)."""
        return self._core.history

    def to_html(self, path: str | os.PathLike[str] | None = None) -> str:
        """The report as an HTML page; if `path` is given, it is written there too."""
        page = self._core.html()
        if path is not None:
            part_path = f"{os.fspath(path)}.{os.getpid()}.part"
            with open(part_path, "w", encoding="utf-8") as file:
                file.write(page)
            os.replace(part_path, path)  # so that a failed write leaves no truncated page
        return page

    def _json(self) -> str:
        return self._core.json()

    def __str__(self) -> str:
        return self._core.text()

    def __repr__(self) -> str:
        return f"<goingrate.Analysis of {self.log.source!r}>"


def analyse(
    log: Log,
    *,
    fix: Fixed | None = None,
    free: str | Iterable[str] | None = None,
    prior: Priors | None = None,
    events: str | Iterable[str] | None = None,
    model: str | None = None,
    noise: str | None = None,
    escapement: str | None = None,
    par: str | os.PathLike[str] | None = None,
    nut_pitch_m: float | None = None,
    pendulum_length_m: float | None = None,
    diary: str | os.PathLike[str] | None = None,
    profiles: bool = True,
    progress: Progress | None = None,
) -> Analysis:
    """Analyses a log: rate, changes, fit, drive, causes, stability.

    Parameters
    ----------
    log : Log
    fix, free, prior, events, model, noise, escapement, par
        As for `fit`.
    nut_pitch_m : float, optional
        How far one turn of the rating nut moves the bob, m: the report then says how many turns
        bring the rate to zero.
    pendulum_length_m : float, optional
        Length for that calculation; if not given, a simple pendulum's of the same period.
    diary : path, optional
        What was done to the clock: CSV with time, what, value, sigma, note.
    profiles : bool
        Trace profile likelihoods, for the figures of the page; takes a third of the time.
    progress : callable, optional
        Called with the step under way, in words.

    Returns
    -------
    Analysis
    """
    if not isinstance(log, Log):
        raise ValueError(f"log: found {type(log).__name__}, expected a Log (from read() or Log())")
    for name, value in (("nut_pitch_m", nut_pitch_m), ("pendulum_length_m", pendulum_length_m)):
        if value is not None and not value > 0:
            raise ValueError(f"{name}: found {value}, expected above 0")
    asked = request(fix, free, prior, events, model, noise, escapement, par)
    return Analysis(
        log,
        _core.analyse(
            log._core,
            asked,
            nut_pitch_m,
            pendulum_length_m,
            profiles,
            None if diary is None else os.fspath(diary),
            progress,
        ),
    )
