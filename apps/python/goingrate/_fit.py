"""Fits of the amplitude-phase model."""

from __future__ import annotations

import html
import os
import warnings
from typing import Any, Callable, Iterable, Iterator, Mapping

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._log import Log
from ._parameters import Correlation, Parameter, Quantity, shown
from ._request import Fixed, Priors, request
from ._tables import Report, frame, new_axes
from .errors import NumericsError

Progress = Callable[[str], object]


class Fit(Report, Mapping[str, Parameter]):
    """The result of a fit: a mapping from names to parameters, with its other results as members.

    ``print(fit)`` is the text of ``goingrate fit``.
    """

    def __init__(self, core: _core.Fit) -> None:
        self._core = core
        self._index()

    def _index(self) -> None:
        self._by_name = {p.name: Parameter(p) for p in self._core.parameters}

    def __getitem__(self, name: str) -> Parameter:
        try:
            return self._by_name[name]
        except KeyError:
            known = ", ".join(self._by_name) or "none"
            raise KeyError(f"the fit has no parameter {name!r}; it has {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self._by_name)

    @property
    def parameters(self) -> list[Parameter]:
        """All parameters, noise included, in the order of the report."""
        return list(self._by_name.values())

    @property
    def status(self) -> str:
        """converged, stopped-early, no-valid-model or contradicts-log."""
        return self._core.status

    @property
    def success(self) -> bool:
        """Whether a maximum was found and the model describes the log."""
        return self.status == "converged"

    @property
    def termination(self) -> str:
        """How the search ended, in words."""
        return self._core.termination

    @property
    def notes(self) -> list[str]:
        """Notes that must be read with the numbers."""
        return self._core.notes

    @property
    def derived(self) -> dict[str, Quantity]:
        """Q, stationary_amplitude (rad), rate_s_per_day and decay_time_s, by name."""
        names = ("Q", "stationary_amplitude", "rate_s_per_day", "decay_time_s")
        return {
            name: Quantity(name, d.value, d.sigma, d.unit, d.expression)
            for name, d in zip(names, self._core.derived)
        }

    @property
    def combinations(self) -> list[Quantity]:
        """Combinations that the log determines where it does not determine single parameters."""
        return [
            Quantity(c.name, c.value, c.sigma, c.unit, c.expression)
            for c in self._core.combinations
        ]

    @property
    def decay(self) -> dict[str, Any] | None:
        """How a free swing dies away: decay time, Q by amplitude, laws of friction; keys as in
        `to_dict`.

        None for a driven clock.
        """
        found: dict[str, Any] | None = self.to_dict().get("decay")
        return found

    @property
    def correlation(self) -> Correlation:
        """Correlations of the free parameters."""
        size = len(self._core.names)
        return Correlation(
            self._core.names, np.array(self._core.correlation, float).reshape(size, size)
        )

    @property
    def cycle(self) -> Array:
        """Cycle of each beat that was fitted, int64, shape (n,)."""
        return self._core.cycle

    @property
    def elapsed_s(self) -> Array:
        """Time from the first beat to each beat, s, shape (n,); read-only view."""
        return self._core.elapsed_s

    @property
    def residual_s(self) -> Array:
        """How much later each beat is than the model's undisturbed course, mean removed, s,
        shape (n,); read-only view."""
        return self._core.residual_s

    @property
    def model_amplitude_rad(self) -> Array:
        """Turning angle of the model's undisturbed course at each beat, rad, shape (n,);
        read-only view."""
        return self._core.model_amplitude_rad

    @property
    def amplitude_residual_rad(self) -> Array:
        """Measured minus model amplitude, rad, shape (n,); empty without amplitudes."""
        return self._core.amplitude_residual_rad

    def predict(self, cycles: Any) -> Array:
        """When the fitted clock passes the vertical upwards.

        Parameters
        ----------
        cycles : array_like of int, shape (k,)
            Cycles as the log counts them, none before its first; past the end of the log the
            equations of the fit are run on.

        Returns
        -------
        ndarray, shape (k,)
            s after the first beat, on the model's undisturbed course. `predict_sigma` says how
            well this is known; a real beat also has jitter, and the noise of the drive.

        Raises
        ------
        ValueError
            A cycle is before the first, or is not a whole number.
        NumericsError
            A cycle is past the end of the log, and a parameter that is needed there is
            undetermined, or the rate depends on something that only the log holds, or the clock
            stalls.
        """
        return self._core.predict(_arrays.cycles("cycles", cycles))[0]

    def predict_sigma(self, cycles: Any) -> Array:
        """Standard deviation of the times that `predict` gives, s, shape (k,).

        It comes from the parameters, with their correlations, and from the origin of time, to
        first order (``test_predictions_have_honest_sigmas``). `NumericsError` if a parameter is
        undetermined, or if the fit has noise of the drive, which makes the times wander further.
        """
        return self._core.predict_sigma(_arrays.cycles("cycles", cycles))

    def predict_amplitude(self, cycles: Any) -> Array:
        """Turning angle of the fitted clock at these cycles, rad, shape (k,); limits and errors
        as for `predict`."""
        return self._core.predict(_arrays.cycles("cycles", cycles))[1]

    def to_par(self) -> str:
        """The fit as text for a file that can be edited and read back: ``fit(log, par=path)``."""
        return self._core.par()

    def to_latex(self) -> str:
        """The parameters as a LaTeX table (booktabs)."""
        return self._core.latex()

    def to_csv(self) -> str:
        """The parameters as CSV, with all digits."""
        return self._core.csv()

    def to_pandas(self) -> Any:
        """A DataFrame with a row per parameter: value, sigma, low68 ... high95, unit, status."""
        core = [p._core for p in self.parameters]
        columns = ("value", "sigma", "low68", "high68", "low95", "high95", "unit", "status")
        table = frame({c: [getattr(p, c) for p in core] for c in columns})
        table.index = [p.name for p in core]
        return table

    def plot(self, ax: Any = None) -> Any:
        """The residuals (s) over time, on matplotlib axes, which are returned."""
        ax = new_axes(ax)
        ax.plot(self.elapsed_s / 3600, self.residual_s, ".", markersize=2)
        ax.set(xlabel="time (h)", ylabel="residual (s; positive: late)")
        return ax

    def _json(self) -> str:
        return self._core.json()

    def __str__(self) -> str:
        return self._core.text()

    def __repr__(self) -> str:
        return f"<goingrate.Fit {self.status}: {', '.join(str(p) for p in self.parameters)}>"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{html.escape(p.name)}</td><td>{shown(p.value, p.sigma, p.status)}</td>"
            f"<td>{html.escape(p.unit)}</td><td>{p.status}</td></tr>"
            for p in self.parameters
        )
        notes = "".join(f"<p>{html.escape(note)}</p>" for note in self.notes)
        return (
            f"<table><caption>goingrate fit: {html.escape(self.termination)}</caption>"
            "<thead><tr><th>parameter</th><th>value ± σ</th><th>unit</th><th>status</th></tr>"
            f"</thead><tbody>{rows}</tbody></table>{notes}"
        )

    # Equal only to itself; a mapping would compare parameter by parameter.
    __eq__ = object.__eq__
    __hash__ = object.__hash__

    def __getstate__(self) -> _core.Fit:
        return self._core

    def __setstate__(self, core: _core.Fit) -> None:
        self._core = core
        self._index()


def fit(
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
    profiles: bool = False,
    progress: Progress | None = None,
) -> Fit:
    """Fit friction, drive and escapement angle to a log.

    Parameters
    ----------
    log : Log
    fix : dict of str to float, or list of "NAME=VALUE", optional
        Parameters that are held: T0 (s), epsilon, mu, phi0 (rad), lambda0, mu@1 ...
    free : list of str, optional
        Parameters that are fitted only if named: quadratic_drag, dry_friction, offset (rad), drift
        (1/day), and where the log has such columns temperature (1/K), pressure (1/mbar),
        humidity (1/%), density.
    prior : dict of str to (value, sigma), or list of "NAME=VALUE+-SIGMA", optional
        Knowledge from elsewhere.
    events : list of str, 'auto' or 'none', optional
        Parameters that change: "150:mu" at a cycle, "300s:mu,epsilon" at a time; the k-th event
        gives mu@k. 'auto', or None without `par`: changes are searched for. 'none' or an empty
        list: there are none.
    model : {'auto', 'averaged1', 'averaged2', 'map'}, optional
        The equations: averaged to the paper's first order or to second order, or the full
        equation of motion.
    noise : {'auto', 'jitter', 'drive', 'both', 'slow'}, optional
    escapement : {'auto', 'constant-torque', 'single-impulse', 'none'}, optional
    par : path, optional
        A file of parameters, as `Fit.to_par` writes it; the other arguments override it.
    profiles : bool
        Trace the profile likelihood of each parameter, for `Parameter.interval` at any level.
    progress : callable, optional
        Called with the step under way, in words.

    Returns
    -------
    Fit

    Raises
    ------
    NumericsError
        No model is valid. (A search that stopped early only warns; the status of its result says
        so.)
    ValueError
        A word or a value makes no sense.
    InputError
        The file of parameters cannot be used, or needs data that the log does not have.
    """
    if not isinstance(log, Log):
        raise ValueError(f"log: found {type(log).__name__}, expected a Log (of read() or Log())")
    asked = request(fix, free, prior, events, model, noise, escapement, par)
    result = Fit(_core.fit(log._core, asked, profiles, progress))
    if not result._core.has_result:
        raise NumericsError(f"no fit: {result.termination}")
    if result.status == "stopped-early":
        warnings.warn(f"no fit: {result.termination}", RuntimeWarning, stacklevel=2)
    return result
