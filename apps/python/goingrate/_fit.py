"""Fits of the amplitude-phase model."""

from __future__ import annotations

import html
import math
import os
import warnings
from statistics import NormalDist
from typing import Any, Callable, Iterable, Iterator, Mapping, Sequence, Union

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._log import Log
from ._tables import Report, frame, new_axes
from .errors import NumericsError

Fixed = Union[Mapping[str, float], Iterable[str]]
Priors = Union[Mapping[str, "tuple[float, float]"], Iterable[str]]
Progress = Callable[[str], object]

_ONE_SIGMA = math.erf(math.sqrt(0.5))  # the probability of the 68 % interval
_Z95 = 1.9599639845400545


class Parameter:
    """A parameter of the model, as a fit of it came out."""

    def __init__(self, core: _core.FittedParameter) -> None:
        self._core = core

    @property
    def name(self) -> str:
        """T0, epsilon, mu, phi0, lambda0, jitter_rms ...; mu@1 after the first change."""
        return self._core.name

    @property
    def unit(self) -> str:
        """s, rad, or nothing for a pure number."""
        return self._core.unit

    @property
    def status(self) -> str:
        """free, fixed, prior, or undetermined: the log does not tell it."""
        return self._core.status

    @property
    def value(self) -> float:
        """NaN where undetermined."""
        return self._core.value

    @property
    def sigma(self) -> float:
        """Standard deviation; NaN where undetermined or fixed."""
        return self._core.sigma

    @property
    def at_bound(self) -> bool:
        """The search ended at the edge of the allowed."""
        return self._core.at_bound

    @property
    def profile(self) -> Array:
        """The profile likelihood, shape (k, 2): value, and by how much 2 log L is below its
        maximum; empty unless the fit was asked to trace it (``profiles=True``)."""
        return np.array(self._core.profile, float).reshape(-1, 2)

    def interval(self, probability: float = 0.95) -> tuple[float, float]:
        """The interval that holds the truth with this probability.

        Parameters
        ----------
        probability : float
            Above 0; up to 0.95, and beyond as far as a profile was traced. 0.68 (or 0.6827) and
            0.95 are those of the profile likelihood to all digits. Others lie on the profile if it
            was traced; if not, on straight lines (in units of sigma) between those two and the
            value, exact for a likelihood that is a parabola.

        Returns
        -------
        low, high : float
            Infinite where the likelihood does not fall far enough on that side.

        Raises
        ------
        ValueError
            For a probability beyond what is known.
        NumericsError
            The parameter is undetermined or fixed: no interval exists.
        """
        if not 0.0 < probability < 1.0:
            raise ValueError(f"probability: found {probability}, expected above 0 and below 1")
        if not math.isfinite(self.value) or math.isnan(self._core.low68):
            raise NumericsError(f"{self.name} is {self.status}: it has no interval")
        if abs(probability - _ONE_SIGMA) < 0.003:
            return self._core.low68, self._core.high68
        if probability == 0.95:
            return self._core.low95, self._core.high95
        z = NormalDist().inv_cdf(0.5 + 0.5 * probability)
        return self._end(-1.0, z), self._end(1.0, z)

    def _end(self, side: float, z: float) -> float:
        """The end on one side at z standard deviations."""
        traced = [
            (math.sqrt(max(0.0, fall)), value)
            for value, fall in self._core.profile
            if side * (value - self.value) > 0.0
        ]
        known = traced or (
            [(1.0, self._core.low68), (_Z95, self._core.low95)]
            if side < 0.0
            else [(1.0, self._core.high68), (_Z95, self._core.high95)]
        )
        known = sorted([(0.0, self.value), *known])
        if z > known[-1][0]:
            raise ValueError(
                "probability: the interval is known up to "
                f"{math.erf(known[-1][0] / math.sqrt(2)):.4g}"
            )
        above = next(i for i, (there, _) in enumerate(known) if there >= z)
        if above == 0:
            return self.value
        (z0, a), (z1, b) = known[above - 1], known[above]
        if math.isinf(b):
            return b
        return a + (b - a) * (z - z0) / (z1 - z0)

    def __float__(self) -> float:
        return self.value

    def __str__(self) -> str:
        return f"{self.name} = {_shown(self.value, self.sigma, self.status)} {self.unit}".rstrip()

    def __repr__(self) -> str:
        return f"<goingrate.Parameter {self}, {self.status}>"


class Quantity:
    """A quantity computed from the parameters, with the uncertainty of all of them."""

    def __init__(self, name: str, value: float, sigma: float, unit: str, expression: str) -> None:
        self.name = name
        self.value = value  #: NaN where the log does not determine it
        self.sigma = sigma
        self.unit = unit
        self.expression = expression  #: of the parameters

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        shown = _shown(self.value, self.sigma, "undetermined" if math.isnan(self.value) else "")
        return f"<goingrate.Quantity {self.name} = {shown} {self.unit}>".replace(" >", ">")


class Correlation:
    """Correlations of the free parameters: a matrix whose rows have names.

    ``fit.correlation["mu", "phi0"]`` and ``fit.correlation[1, 2]`` are numbers,
    ``numpy.asarray(fit.correlation)`` is the matrix.
    """

    def __init__(self, names: Sequence[str], matrix: Array) -> None:
        self.names = tuple(names)
        self.matrix = matrix  #: shape (k, k)

    @property
    def shape(self) -> tuple[int, ...]:
        """(k, k), for k free parameters."""
        return self.matrix.shape

    def _index(self, key: str | int) -> int:
        if not isinstance(key, str):
            return key
        if key not in self.names:
            raise KeyError(f"{key!r} is not free; free are {', '.join(self.names)}")
        return self.names.index(key)

    def __getitem__(self, pair: tuple[str | int, str | int]) -> float:
        first, second = pair
        return float(self.matrix[self._index(first), self._index(second)])

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.array(self.matrix, dtype)

    def __len__(self) -> int:
        return len(self.names)

    def __repr__(self) -> str:
        return f"<goingrate.Correlation of {', '.join(self.names)}>\n{self.matrix}"


class Fit(Report, Mapping[str, Parameter]):
    """The result of a fit: a mapping from names to parameters, and what else is known of it.

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
        """What must be said beside the numbers."""
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
        """What the log determines where it does not determine single parameters."""
        return [
            Quantity(c.name, c.value, c.sigma, c.unit, c.expression)
            for c in self._core.combinations
        ]

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
        """Time of each beat after the first, s, shape (n,); read-only view."""
        return self._core.elapsed_s

    @property
    def residual_s(self) -> Array:
        """How late each beat is against the undisturbed course of the model, mean removed, s,
        shape (n,); read-only view."""
        return self._core.residual_s

    @property
    def model_amplitude_rad(self) -> Array:
        """Turning angle of that course at each beat, rad, shape (n,); read-only view."""
        return self._core.model_amplitude_rad

    @property
    def amplitude_residual_rad(self) -> Array:
        """Measured less model amplitude, rad, shape (n,); empty without amplitudes."""
        return self._core.amplitude_residual_rad

    def predict(self, cycles: Any) -> Array:
        """When the fitted clock passes the vertical upwards.

        Parameters
        ----------
        cycles : array_like of int, shape (k,)
            Cycles as the log counts them, from its first on; those beyond its end are run on with
            the equations of the fit.

        Returns
        -------
        ndarray, shape (k,)
            s after the first beat: the undisturbed course of the model. `predict_sigma` says how
            well it is known; a real beat has its jitter besides, and the noise of its drive.

        Raises
        ------
        ValueError
            A cycle before the first, or no whole number.
        NumericsError
            Beyond the log, where a parameter that is needed is undetermined, or the rate follows
            something that only the log knows, or the clock stalls.
        """
        return self._core.predict(_arrays.cycles("cycles", cycles))[0]

    def predict_sigma(self, cycles: Any) -> Array:
        """How well the fit knows these times: their standard deviation, s, shape (k,).

        That of the parameters with their correlations, and of the origin of time, to first order
        (``test_predictions_have_honest_sigmas``). `NumericsError` where a parameter is undetermined,
        and where the fit has noise of the drive, which makes the times wander besides.
        """
        return self._core.predict_sigma(_arrays.cycles("cycles", cycles))

    def predict_amplitude(self, cycles: Any) -> Array:
        """Turning angle of the fitted clock at these cycles, rad, shape (k,); as `predict`."""
        return self._core.predict(_arrays.cycles("cycles", cycles))[1]

    def to_par(self) -> str:
        """The fit as a file to edit and to feed back: ``fit(log, par=path)``."""
        return self._core.par()

    def to_latex(self) -> str:
        """The parameters as a LaTeX table (booktabs)."""
        return self._core.latex()

    def to_csv(self) -> str:
        """The parameters as CSV, with all digits."""
        return self._core.csv()

    def to_pandas(self) -> Any:
        """A DataFrame with a row a parameter: value, sigma, low68 ... high95, unit, status."""
        core = [p._core for p in self.parameters]
        columns = ("value", "sigma", "low68", "high68", "low95", "high95", "unit", "status")
        table = frame({c: [getattr(p, c) for p in core] for c in columns})
        table.index = [p.name for p in core]
        return table

    def plot(self, ax: Any = None) -> Any:
        """The residuals (s) over time, on matplotlib axes, which it returns."""
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
            f"<tr><td>{html.escape(p.name)}</td><td>{_shown(p.value, p.sigma, p.status)}</td>"
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


def _shown(value: float, sigma: float, status: str) -> str:
    return "undetermined" if math.isnan(value) and status else _core.with_sigma(value, sigma)


def _number(name: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: found {value!r}, expected a number") from None
    if not math.isfinite(number):
        raise ValueError(f"{name}: found {number}, expected a finite number")
    return number


def _words(name: str, words: Any) -> list[str]:
    """A list of words; one word is a list of one."""
    if isinstance(words, str):
        return [words]
    try:
        return [str(word) for word in words]
    except TypeError:
        raise ValueError(f"{name}: found {words!r}, expected a list of words") from None


def request(
    fix: Fixed | None,
    free: str | Iterable[str] | None,
    prior: Priors | None,
    events: str | Iterable[str] | None,
    model: str | None,
    noise: str | None,
    escapement: str | None,
    par: str | os.PathLike[str] | None,
) -> dict[str, Any]:
    """What is asked of a fit, as the extension takes it."""
    asked: dict[str, Any] = {}
    if isinstance(fix, Mapping):
        asked["fixed"] = [(str(k), _number(f"fix {k}", v)) for k, v in fix.items()]
    elif fix is not None:
        asked["fixed"] = [_core.parse_fixed(word) for word in _words("fix", fix)]
    if isinstance(prior, Mapping):
        asked["priors"] = [_prior(str(name), known) for name, known in prior.items()]
    elif prior is not None:
        asked["priors"] = [_core.parse_prior(word) for word in _words("prior", prior)]
    if free is not None:
        asked["freed"] = _words("free", free)
    if events is not None:
        asked["events"] = _words("events", events) or ["none"]
    for name, word in (("model", model), ("noise", noise), ("escapement", escapement)):
        if word is not None:
            asked[name] = str(word)
    if par is not None:
        asked["from"] = os.fspath(par)
    return asked


def _prior(name: str, known: Any) -> tuple[str, float, float]:
    try:
        value, sigma = known
    except (TypeError, ValueError):
        raise ValueError(f"prior {name}: found {known!r}, expected (value, sigma)") from None
    return name, _number(f"prior {name}", value), _number(f"prior {name}", sigma)


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
        (1/day), and where the log has such columns temperature (1/K), pressure (1/mbar), density.
    prior : dict of str to (value, sigma), or list of "NAME=VALUE+-SIGMA", optional
        Knowledge from elsewhere.
    events : list of str, 'auto' or 'none', optional
        Parameters that change: "150:mu" at a cycle, "300s:mu,epsilon" at a time; the k-th gives
        mu@k. 'auto', and None without `par`: searched for. An empty list: none.
    model : {'auto', 'averaged1', 'averaged2', 'map'}, optional
        The equations: the paper's first order, second order, the full equation of motion.
    noise : {'auto', 'jitter', 'drive', 'both', 'slow'}, optional
    escapement : {'auto', 'constant-torque', 'single-impulse', 'none'}, optional
    par : path, optional
        A file of parameters, as `Fit.to_par` writes it; what is said beside it wins.
    profiles : bool
        Trace the profile likelihood of each parameter, for `Parameter.interval` at any level.
    progress : callable, optional
        Told what is being done, in words.

    Returns
    -------
    Fit

    Raises
    ------
    NumericsError
        No model is valid. (A search that ended early warns, and its result has that status.)
    ValueError
        A word or a value makes no sense.
    InputError
        The file of parameters cannot be used, or asks for what the log has not.
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
