"""Logs of a clock's beats."""

from __future__ import annotations

import enum
from typing import Any, NamedTuple

import numpy as np

from . import _arrays, _core
from ._arrays import Array
from ._options import options_of
from ._tables import frame, new_axes


class Flag(enum.IntEnum):
    """What an event is, in `Log.flags`."""

    GOOD = 0  #: an upward crossing with its cycle number
    SPURIOUS = 1  #: not a crossing: a double or false trigger
    DOWN = 2  #: a downward crossing, with the number of the upward one before it
    RIVAL = 3  #: a second event that fits the same cycle as well
    BOUNCE = 4  #: part of the edge before it: a contact bounced


class Gap(NamedTuple):
    """Cycles without an event."""

    after_cycle: int
    length: int  #: number of missing cycles
    probability: float  #: that `length` is right
    bridged: bool  #: False if the log is split here
    kind: str  #: missed, gap, step, stop or restart


class Issue(NamedTuple):
    """Something wrong with a line, and what was done about it."""

    line: int
    column: int
    kind: str
    found: str
    action: str
    last_line: int  #: the last of a run of such lines
    lines: int  #: how many lines the run has
    file: str  #: the file they are in


class Log:
    """A log: events in time, numbered.

    `read` makes one from a file, this constructor from arrays.

    Parameters
    ----------
    time_s : array_like, shape (n,), optional
        Time of each event, s, in order: float64, integers, or datetime64 of any unit (taken without
        rounding). A float64 holds seconds since 1970 to only 0.24 µs today; `seconds` and
        `fraction` hold them more finely.
    seconds, fraction : array_like, shape (n,), optional
        The same in two parts, whole seconds and the rest.
    amplitude_rad : array_like, shape (n,), optional
        Turning angle at each event, 0 to pi rad; NaN where unknown.
    edge : array_like of str or int, shape (n,), optional
        'up' or 'down' (0 or 1). Without it all events count as upward crossings, unless the
        intervals alternate.
    width_s, temperature_c, pressure_mbar, humidity_percent : array_like, shape (n,), optional
        How long a flag covered the sensor; temperature, pressure and humidity of the air.
    name : str
        What messages call the log.
    nominal_period_s : float, optional
        T0, s, the period to compare with; if not given, guessed from the mean period.
    both_edges, dead_time_s, flag_width_rad, gravity_share, sensor_offset_rad, gap_probability
        As for `read`.

    Raises
    ------
    ValueError
        An argument is not such an array, or an option makes no sense.
    InputError
        The events cannot come from a clock.

    Notes
    -----
    The events are kept once, 40 bytes each; `seconds`, `fraction`, `cycle`, `amplitude_rad`,
    `flags` and `edge` are strided read-only views of that memory. `time_s` and `elapsed_s` are
    computed when first asked for and then kept. A log never changes.
    """

    def __init__(
        self,
        time_s: Any = None,
        *,
        seconds: Any = None,
        fraction: Any = None,
        amplitude_rad: Any = None,
        edge: Any = None,
        width_s: Any = None,
        temperature_c: Any = None,
        pressure_mbar: Any = None,
        humidity_percent: Any = None,
        name: str = "array",
        nominal_period_s: float | None = None,
        both_edges: bool = False,
        dead_time_s: float | None = None,
        flag_width_rad: float | None = None,
        gravity_share: float | None = None,
        sensor_offset_rad: float | str | None = None,
        gap_probability: float | None = None,
    ) -> None:
        whole, part = _arrays.instants(time_s, seconds, fraction)

        def column(what: str, values: Any) -> Array:
            return _arrays.NOTHING if values is None else _arrays.numbers(what, values, whole.size)

        options = options_of(
            nominal_period_s=nominal_period_s,
            both_edges=both_edges,
            dead_time_s=dead_time_s,
            flag_width_rad=flag_width_rad,
            gravity_share=gravity_share,
            sensor_offset_rad=sensor_offset_rad,
            gap_probability=gap_probability,
        )
        self._core = _core.from_arrays(
            whole,
            part,
            _arrays.NOTHING
            if amplitude_rad is None
            else _arrays.amplitudes("amplitude_rad", amplitude_rad, whole.size),
            _arrays.NO_EDGES if edge is None else _arrays.edges("edge", edge, whole.size),
            [
                column("width_s", width_s),
                column("temperature_c", temperature_c),
                column("pressure_mbar", pressure_mbar),
                column("humidity_percent", humidity_percent),
            ],
            name,
            options,
        )
        self._cache: dict[str, Array] = {}

    @classmethod
    def _of(cls, core: _core.Log) -> Log:
        log = cls.__new__(cls)
        log._core = core
        log._cache = {}
        return log

    def _kept(self, name: str) -> Array:
        if name not in self._cache:
            self._cache[name] = getattr(self._core, name)()
        return self._cache[name]

    @property
    def events(self) -> Array:
        """All events, shape (n,): a structured view with seconds, fraction, cycle, amplitude_rad,
        line, segment, flag and edge."""
        return self._core.events

    @property
    def good(self) -> Array:
        """The good beats of the longest segment, as in `events`; rates and fits use these."""
        return self._core.good

    @property
    def time_s(self) -> Array:
        """Times of the events from the log's own origin, s, shape (n,): the nearest float64."""
        return self._kept("time_s")

    @property
    def elapsed_s(self) -> Array:
        """Times since the first event, s, shape (n,): rounded only once, so that they are as
        exact for a late date as for an early one."""
        return self._kept("elapsed_s")

    @property
    def seconds(self) -> Array:
        """Whole seconds of the times, int64, shape (n,)."""
        return self._core.events["seconds"]

    @property
    def fraction(self) -> Array:
        """Rest of the times beyond `seconds`, s, 0 <= fraction < 1, shape (n,)."""
        return self._core.events["fraction"]

    @property
    def datetime(self) -> Array:
        """The times as datetime64[ns], shape (n,), rounded to the nanosecond; for logs that count
        from 1970."""
        if np.abs(self.seconds).max(initial=0) > 9_000_000_000:
            raise ValueError("datetime: the times are beyond what datetime64[ns] holds")
        ns = self.seconds * 10**9 + np.rint(self.fraction * 1e9).astype(np.int64)
        return ns.astype("datetime64[ns]")

    @property
    def cycle(self) -> Array:
        """Which cycle each event belongs to, int64, shape (n,); 0 for the first good beat."""
        return self._core.events["cycle"]

    @property
    def amplitude_rad(self) -> Array:
        """Turning angle at each event, rad, shape (n,); NaN where unknown."""
        return self._core.events["amplitude_rad"]

    @property
    def flags(self) -> Array:
        """What each event is, uint8, shape (n,): see `Flag`."""
        return self._core.events["flag"]

    @property
    def edge(self) -> Array:
        """0 for an upward crossing, 1 for a downward one, uint8, shape (n,)."""
        return self._core.events["edge"]

    @property
    def width_s(self) -> Array | None:
        """How long the flag covered the sensor, s, shape (n,); None without such a column."""
        return self._core.width_s

    @property
    def sigma_s(self) -> Array | None:
        """Standard deviation of each time, s, shape (n,); None unless known."""
        return self._core.sigma_s

    @property
    def temperature_c(self) -> Array | None:
        """Degrees Celsius, shape (n,); None without such a column."""
        return self._core.temperature_c

    @property
    def pressure_mbar(self) -> Array | None:
        """Air pressure, mbar, shape (n,); None without such a column."""
        return self._core.pressure_mbar

    @property
    def humidity_percent(self) -> Array | None:
        """Relative humidity, %, shape (n,); None without such a column."""
        return self._core.humidity_percent

    @property
    def phase_s(self) -> Array | None:
        """The clock's error every `tau0_s`, s (positive: fast); None unless the data are on a
        grid."""
        return self._core.phase_s

    @property
    def tau0_s(self) -> float | None:
        """Interval of data on a grid, s; None for other data."""
        return self._core.tau0_s

    @property
    def source(self) -> str:
        """Name of the log as it was given."""
        return self._core.source

    @property
    def format(self) -> str:
        """What kind of log it is."""
        return self._core.format

    @property
    def has_amplitude(self) -> bool:
        """Whether any amplitude is known."""
        return self._core.has_amplitude

    @property
    def nominal_period_s(self) -> float:
        """T0, s: as given, as stated in the log, or guessed."""
        return self._core.nominal_period_s

    @property
    def nominal_is_known(self) -> bool:
        """False if no nominal period is known; `nominal_period_s` is then the mean period."""
        return self._core.nominal_is_known

    @property
    def segments(self) -> int:
        """Number of parts that are numbered without doubt, each separately."""
        return self._core.segments

    @property
    def missed(self) -> int:
        """Number of cycles without an event, in gaps that were bridged."""
        return self._core.missed

    @property
    def spurious(self) -> int:
        """Number of events that are not crossings."""
        return self._core.spurious

    @property
    def beat_error_s(self) -> tuple[float, float] | None:
        """Beat error, tick - tock, and its standard deviation, s; None without both directions."""
        return self._core.beat_error_s

    @property
    def sensor_offset_rad(self) -> tuple[float, float] | None:
        """Angle of the sensor from the vertical and its standard deviation, rad; None unless it
        was found."""
        return self._core.sensor_offset_rad

    @property
    def assumptions(self) -> list[str]:
        """What was assumed about the log, in words, with the keyword that changes it."""
        return self._core.assumptions

    @property
    def files(self) -> list[str]:
        """Names of the files that were joined to this log, in order, if there are several."""
        return self._core.files

    @property
    def issues(self) -> list[Issue]:
        """Faulty lines of the log, and what was done about them."""
        return [Issue(*issue) for issue in self._core.issues]

    @property
    def gaps(self) -> list[Gap]:
        """Cycles without an event."""
        return [Gap(*gap) for gap in self._core.gaps]

    def native(self, decimals: int = 12) -> str:
        """The log in goingrate's own format, with this many decimals of the second (0 to 17)."""
        if not 0 <= decimals <= 17:
            raise ValueError(f"decimals: found {decimals}, expected 0 to 17")
        return self._core.native_text(decimals)

    def to_pandas(self) -> Any:
        """A DataFrame with a row per event: time_s, elapsed_s, cycle, flag, edge, amplitude_rad."""
        return frame(
            {
                "time_s": self.time_s,
                "elapsed_s": self.elapsed_s,
                "cycle": self.cycle,
                "flag": self.flags,
                "edge": self.edge,
                "amplitude_rad": self.amplitude_rad,
            }
        )

    def plot(self, ax: Any = None) -> Any:
        """The clock's error over time (s, positive: fast), on matplotlib axes, which are
        returned."""
        ax = new_axes(ax)
        if self.phase_s is not None:
            hours = np.arange(self.phase_s.size) * (self.tau0_s or 1.0) / 3600
            ax.plot(hours, self.phase_s)
        else:
            beats = self.good
            elapsed = (beats["seconds"] - beats["seconds"][0]) + (
                beats["fraction"] - beats["fraction"][0]
            )
            ax.plot(elapsed / 3600, _core.clock_error(self._core))
        ax.set(xlabel="time (h)", ylabel="clock error (s)", title=self.source)
        return ax

    def __len__(self) -> int:
        return len(self._core.events)

    def __repr__(self) -> str:
        return (
            f"<goingrate.Log {self.source!r}: {len(self)} events, {self.format}, "
            f"T0 {self.nominal_period_s:.9g} s>"
        )

    def __getstate__(self) -> _core.Log:
        return self._core

    def __setstate__(self, core: _core.Log) -> None:
        self._core = core
        self._cache = {}
