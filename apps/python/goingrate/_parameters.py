"""Parameters of a fit, quantities computed from them, and their correlations."""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import Any, Sequence

import numpy as np

from . import _core
from ._arrays import Array
from .errors import NumericsError

_ONE_SIGMA = math.erf(math.sqrt(0.5))  # the probability of the 68 % interval
_Z95 = 1.9599639845400545


def shown(value: float, sigma: float, status: str) -> str:
    return "undetermined" if math.isnan(value) and status else _core.with_sigma(value, sigma)


class Parameter:
    """A parameter of the model, as the fit found it."""

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
        """free, fixed, prior, or undetermined if the log does not determine it."""
        return self._core.status

    @property
    def value(self) -> float:
        """The fitted value; NaN if undetermined."""
        return self._core.value

    @property
    def sigma(self) -> float:
        """Standard deviation; NaN if undetermined or fixed."""
        return self._core.sigma

    @property
    def at_bound(self) -> bool:
        """Whether the search ended at the edge of the allowed range."""
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
            Above 0; up to 0.95, and beyond that as far as a profile was traced. At 0.68 (or 0.6827)
            and 0.95 the ends are the profile likelihood's, to all digits. Elsewhere they are read
            off the profile if it was traced; if not, they are interpolated linearly (in units of
            sigma) between the value and those two intervals, which is exact if the logarithm of
            the likelihood is a parabola.

        Returns
        -------
        low, high : float
            Infinite where the likelihood does not fall far enough on that side.

        Raises
        ------
        ValueError
            The likelihood is not known as far out as this probability.
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
        return f"{self.name} = {shown(self.value, self.sigma, self.status)} {self.unit}".rstrip()

    def __repr__(self) -> str:
        return f"<goingrate.Parameter {self}, {self.status}>"


class Quantity:
    """A quantity computed from the parameters, with the uncertainty that follows from theirs."""

    def __init__(self, name: str, value: float, sigma: float, unit: str, expression: str) -> None:
        self.name = name
        self.value = value  #: NaN where the log does not determine it
        self.sigma = sigma
        self.unit = unit
        self.expression = expression  #: the formula, in terms of the parameters

    def __float__(self) -> float:
        return self.value

    def __repr__(self) -> str:
        text = shown(self.value, self.sigma, "undetermined" if math.isnan(self.value) else "")
        return f"<goingrate.Quantity {self.name} = {text} {self.unit}>".replace(" >", ">")


class Correlation:
    """Correlations of the free parameters: a matrix whose rows and columns have names.

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
