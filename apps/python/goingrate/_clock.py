"""Clocks without a log: their stationary operation, and their motion under any law."""

from __future__ import annotations

import math
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._tables import frame, new_axes
from .errors import NumericsError

_S_PER_DAY = 86400.0
Law = Callable[[float, float], float]


class RateMap:
    """Stationary rate as a function of friction and torque.

    Attributes
    ----------
    phi0 : float
        Escapement angle, rad.
    epsilon, mu : ndarray, shapes (k,) and (l,)
        Friction and torque, scaled.
    rate_excess : ndarray, shape (l, k)
        One row per torque, one column per friction; NaN where the clock stalls.
    """

    def __init__(
        self, phi0: float, epsilon: Array, mu: Array, rate_excess: Array
    ) -> None:
        self.phi0 = phi0
        self.epsilon = epsilon
        self.mu = mu
        self.rate_excess = rate_excess

    @property
    def rate_s_per_day(self) -> Array:
        """Seconds gained per day, shape (l, k)."""
        return self.rate_excess * _S_PER_DAY

    def to_pandas(self) -> Any:
        """A DataFrame with a row per point: epsilon, mu, rate_excess, rate_s_per_day."""
        epsilon, mu = np.meshgrid(self.epsilon, self.mu)
        return frame(
            {
                "epsilon": epsilon.ravel(),
                "mu": mu.ravel(),
                "rate_excess": self.rate_excess.ravel(),
                "rate_s_per_day": self.rate_s_per_day.ravel(),
            }
        )

    def plot(self, ax: Any = None) -> Any:
        """The rate (s/day) as colours over friction and torque, on matplotlib axes."""
        ax = new_axes(ax)
        most = np.nanpercentile(np.abs(self.rate_s_per_day), 95)
        mesh = ax.pcolormesh(
            self.epsilon, self.mu, self.rate_s_per_day, cmap="RdBu_r", vmin=-most, vmax=most,
            shading="nearest",
        )
        ax.figure.colorbar(mesh, ax=ax, label="rate (s/day)")
        ax.set(xscale="log", yscale="log", xlabel="ε", ylabel="μ")
        return ax

    def __repr__(self) -> str:
        return f"<goingrate.RateMap of {self.mu.size} × {self.epsilon.size} points>"


class OperatingPoint(NamedTuple):
    """Stationary operation of a clock."""

    epsilon: float
    mu: float
    amplitude: float  #: φ̇ at the upward crossing, scaled; in first order its cycle average
    rate_excess: float

    @property
    def rate_s_per_day(self) -> float:
        """Seconds gained per day."""
        return self.rate_excess * _S_PER_DAY


def _axis(name: str, values: Any, points: int) -> Array:
    if isinstance(values, tuple) and len(values) == 2:
        low, high = (float(v) for v in values)
        if not 1e-15 <= low < high < 1.0:
            raise ValueError(f"{name}: found {values}, expected two numbers from 1e-15 to 1, "
                             "the smaller first")
        return np.array(_core.log_grid(low, high, points))
    return _arrays.numbers(name, values)


def map(
    phi0: float = 0.03,
    *,
    epsilon: Any = (1e-5, 5e-4),
    mu: Any = (1e-6, 5e-5),
    points: int = 41,
    first_order: bool = False,
) -> RateMap:
    """The stationary rate of clocks as a function of friction and torque.

    Parameters
    ----------
    phi0 : float
        Escapement angle, rad.
    epsilon, mu : tuple of two floats, or array_like
        A tuple: the ends of a grid of `points` values with equal ratios. An array or list: the
        values themselves.
    points : int
        Number of points in each grid, 2 to 2000.
    first_order : bool
        Use the paper's averaged equations instead of the full equation of motion.

    Returns
    -------
    RateMap
    """
    if not 2 <= points <= 2000:
        raise ValueError(f"points: found {points}, expected 2 to 2000")
    if not 0.0 < phi0 < math.pi:
        raise ValueError(f"phi0: found {phi0}, expected above 0 and below pi rad")
    across, up = _axis("epsilon", epsilon, points), _axis("mu", mu, points)
    rates = _core.rate_map(phi0, across.tolist(), up.tolist(), first_order)
    return RateMap(phi0, across, up, rates)


def operating_point(
    *,
    epsilon: float | None = None,
    mu: float | None = None,
    amplitude: float | None = None,
    rate: float | None = None,
    rate_excess: float | None = None,
    phi0: float = 0.03,
    first_order: bool = False,
) -> list[OperatingPoint]:
    """The operating point of a clock, from two of its quantities.

    Parameters
    ----------
    epsilon, mu : float, optional
        Friction and torque, scaled, above 0 and below 1.
    amplitude : float, optional
        rad (φ̇ at the upward crossing, scaled), above 0 and below 2.
    rate, rate_excess : float, optional
        The rate in seconds gained per day, or as a pure number.
    phi0 : float
        Escapement angle, rad.
    first_order : bool
        Use the paper's averaged equations instead of the full equation of motion.

    Returns
    -------
    list of OperatingPoint
        In order of amplitude; one or two, as the rate first rises with the amplitude, then falls.

    Raises
    ------
    NumericsError
        No clock has such an operating point.
    """
    if rate is not None:
        if rate_excess is not None:
            raise ValueError("rate: expected either rate (s/day) or rate_excess, not both")
        rate_excess = rate / _S_PER_DAY
    given = {"epsilon": epsilon, "mu": mu, "amplitude": amplitude, "rate_excess": rate_excess}
    known = {name: float(value) for name, value in given.items() if value is not None}
    if len(known) != 2:
        raise ValueError(f"expected two of epsilon, mu, amplitude and rate; found {len(known)}")
    points = _core.operating_points(known, phi0, first_order)
    if not points:
        raise NumericsError("no clock with this escapement angle has such an operating point")
    return [OperatingPoint(*point) for point in points]


class Integration:
    """The motion of a pendulum, period by period.

    Attributes
    ----------
    period_s, rate_excess, amplitude_rad, velocity : ndarray, shape (periods,)
        For each period its length (s) and T0 / period - 1, and for the crossing that ends it
        φ̇ (`velocity`, scaled) and the turning angle (rad) of a free pendulum that passes the
        vertical at this speed.
    ended : str or None
        Why the motion ended before the last of the periods asked for; None if it did not.
    """

    def __init__(
        self, nominal_period_s: float, excess: Array, velocity: Array, ended: str
    ) -> None:
        self.nominal_period_s = nominal_period_s
        self.velocity = velocity
        self.period_s = nominal_period_s * (1.0 + excess / (2 * math.pi))
        self.rate_excess = -excess / (2 * math.pi + excess)
        self.amplitude_rad = 2.0 * np.arcsin(0.5 * velocity)
        self.ended = ended or None

    @property
    def cycle(self) -> Array:
        """Number of the upward crossing that ends each period, shape (periods,)."""
        return np.arange(1, self.velocity.size + 1)

    @property
    def time_s(self) -> Array:
        """When each period ends, s after the start, shape (periods,)."""
        drift = np.cumsum(self.period_s - self.nominal_period_s)
        return self.cycle * self.nominal_period_s + drift

    def to_pandas(self) -> Any:
        """A DataFrame with a row per period."""
        names = ("cycle", "time_s", "period_s", "rate_excess", "amplitude_rad", "velocity")
        return frame({name: getattr(self, name) for name in names})

    def __len__(self) -> int:
        return self.velocity.size

    def __repr__(self) -> str:
        return f"<goingrate.Integration of {len(self)} periods" + (
            f": {self.ended}>" if self.ended else ">"
        )


def integrate(
    friction: Law,
    *,
    torque: Law | None = None,
    mu: float = 0.0,
    phi0: float = 0.03,
    amplitude_rad: float = 0.05,
    periods: int = 100,
    jumps: Sequence[float] | None = None,
    jumps_with_direction: bool = True,
    nominal_period_s: float = 2.0,
) -> Integration:
    """Move a pendulum under laws of one's own: φ̈ + sin φ = torque(φ, φ̇) - friction(φ, φ̇).

    Parameters
    ----------
    friction : callable
        A function of the angle (rad) and φ̇ (scaled); positive where it acts against φ̇ > 0;
        scaled like 2 ε φ̇.
    torque : callable, optional
        A function of the same two, positive along φ, scaled like μ. If not given, the paper's
        escapement: μ until φ rises through `phi0`, then -μ until it falls through -`phi0`.
    mu, phi0 : float
        Torque and angle (rad) of the paper's escapement; with neither `torque` nor `mu` the
        pendulum is free.
    amplitude_rad : float
        Turning angle that belongs to the speed of the upward crossing at which the motion
        starts; above 0, below pi.
    periods : int
        Number of periods.
    jumps : sequence of float, optional
        Angles (rad) at which a law jumps; integration steps end there. If neither this nor
        `torque` is given, those of the paper's escapement.
    jumps_with_direction : bool
        A law depends on the sign of φ̇: integration steps end at the turning points too.
    nominal_period_s : float
        T0, s: the length of 2 pi in scaled time.

    Returns
    -------
    Integration

    Notes
    -----
    Fehlberg's formula of order 8, with crossings found by Newton steps. For laws that the library
    knows, it agrees with the library's direct integration within 1e-12. Most of the time goes into
    about 4000 calls of each law per period, some 1 ms in Python; a law written in C++ takes
    0.02 ms, and one that the library knows (`simulate`) 0.0001 ms. The callables hold the
    interpreter's lock.

    Raises
    ------
    ValueError
        An argument is out of range. An exception that a law raises ends the motion and is passed
        on.
    """
    if not callable(friction):
        raise ValueError(f"friction: found {type(friction).__name__}, expected a callable")
    if torque is not None and not callable(torque):
        raise ValueError(f"torque: found {type(torque).__name__}, expected a callable")
    if not 0.0 < amplitude_rad < math.pi:
        raise ValueError(f"amplitude_rad: found {amplitude_rad}, expected above 0 and below pi")
    if periods < 1:
        raise ValueError(f"periods: found {periods}, expected 1 or more")
    if not (math.isfinite(nominal_period_s) and nominal_period_s > 0.0):
        raise ValueError(f"nominal_period_s: found {nominal_period_s}, expected above 0")
    if torque is None and not (0.0 <= mu < 1.0 and 0.0 < phi0 < math.pi):
        raise ValueError(f"mu, phi0: found {mu}, {phi0}, expected 0 <= mu < 1, 0 < phi0 < pi")
    if jumps is None:
        jumps = [-phi0, phi0] if torque is None and mu > 0.0 else []
    excess, velocity, ended = _core.integrate(
        friction, torque, mu, phi0, 2.0 * math.sin(0.5 * amplitude_rad), periods,
        _arrays.numbers("jumps", jumps).tolist(), jumps_with_direction,
    )
    return Integration(nominal_period_s, excess, velocity, ended)
