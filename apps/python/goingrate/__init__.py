"""goingrate: rate, friction and drive of pendulum clocks, from logs of their beats.

>>> import goingrate as gr
>>> log = gr.read("data/logs/jump.csv")
>>> fit = gr.fit(log, fix={"T0": 2}, events=["150:mu"])
>>> fit["epsilon"].value, fit["epsilon"].sigma          # doctest: +SKIP
>>> print(fit)                                          # doctest: +SKIP

Everything is computed by the library behind the command `goingrate`; the numbers are the same to
the last bit. Times are in seconds, angles in radians, friction and torque scaled as in P. Hoyng,
*Dynamics and performance of clock pendulums*. Arguments that make no sense raise `ValueError`,
logs that cannot be used `InputError` (a `ValueError` with file, line and column), and calculations
without a result `NumericsError`.
"""

from ._analysis import Analysis, analyse
from ._clock import (
    Integration,
    OperatingPoint,
    RateMap,
    integrate,
    map,
    operating_point,
)
from ._compare import Comparison, compare
from ._core import version as __version__
from ._deviation import DEVIATION_KINDS, Deviation, deviation
from ._fit import Fit, fit
from ._log import Flag, Gap, Issue, Log
from ._parameters import Correlation, Parameter, Quantity
from ._rate import Rate, rate
from ._reading import read
from ._simulation import Simulation, Truth, simulate
from ._spectrum import Line, Rms, Spectrum, spectrum
from .errors import ImpossibleReading, InputError, InputNotFoundError, NumericsError

__all__ = [
    "DEVIATION_KINDS",
    "Analysis",
    "Comparison",
    "Correlation",
    "Deviation",
    "Fit",
    "Flag",
    "Gap",
    "ImpossibleReading",
    "InputError",
    "InputNotFoundError",
    "Integration",
    "Issue",
    "Line",
    "Log",
    "NumericsError",
    "OperatingPoint",
    "Parameter",
    "Quantity",
    "Rate",
    "RateMap",
    "Rms",
    "Simulation",
    "Spectrum",
    "Truth",
    "__version__",
    "analyse",
    "compare",
    "deviation",
    "fit",
    "integrate",
    "map",
    "operating_point",
    "rate",
    "read",
    "simulate",
    "spectrum",
]
