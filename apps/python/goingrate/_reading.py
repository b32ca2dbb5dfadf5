"""Reading logs from files, open files and bytes."""

from __future__ import annotations

import gzip
import io
import os
from typing import IO, Any, Callable, Sequence, Union

from . import _core
from ._log import Log
from ._options import options_of
from .errors import InputError, InputNotFoundError

File = Union[str, "os.PathLike[str]"]
Source = Union[File, Sequence[File], bytes, bytearray, memoryview, IO[Any]]
Progress = Callable[[float], object]
_UNPACKED_LIMIT = 4 << 30  # bytes, as for files


def _unpacked(data: bytes, name: str, limit: int) -> bytes:
    if data[:2] != b"\x1f\x8b":
        return data
    try:
        with gzip.GzipFile(fileobj=io.BytesIO(data)) as packed:
            text = packed.read(limit + 1)
    except (OSError, EOFError) as error:
        raise InputError(f"{name}: found damaged gzip data, expected a whole .gz file", name) from error
    if len(text) > limit:
        raise InputError(f"{name}: found gzip data that unpack to more than {limit} bytes", name)
    return text


def _content(source: Any) -> bytes | None:
    """The bytes of a source that is not a path; None for a path."""
    if isinstance(source, (bytes, bytearray, memoryview)):
        return bytes(source)
    if hasattr(source, "read"):
        text = source.read()
        return text.encode() if isinstance(text, str) else bytes(text)
    return None


def _path(source: Any) -> str:
    try:
        path = os.fspath(source)
    except TypeError:
        raise ValueError(
            f"source: found {type(source).__name__}, expected paths, a file object or bytes"
        ) from None
    path = os.fsdecode(path)
    if path != "-":
        try:
            os.stat(path)
        except NotADirectoryError:
            pass  # a file inside a ZIP
        except FileNotFoundError:
            raise InputNotFoundError(f"{path}: there is no such file", path) from None
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot be opened: {error}", path) from error
    return path


def _paths(source: Any) -> list[str]:
    if isinstance(source, (str, os.PathLike)) or not isinstance(source, Sequence):
        return [_path(source)]
    if not source:
        raise ValueError("source: found an empty list, expected paths")
    if any(isinstance(part, bytes) for part in source):
        raise ValueError("source: found a list of bytes, expected paths or bytes alone")
    return [_path(part) for part in source]


def _month_first(date_order: str | None) -> bool | None:
    if date_order is None:
        return None
    if date_order not in ("day", "month"):
        raise ValueError(f"date_order: found {date_order!r}, expected 'day' or 'month'")
    return date_order == "month"


def read(
    source: Source,
    *,
    format: str | None = None,
    nominal_period_s: float | None = None,
    columns: Sequence[str] | None = None,
    unit: str | None = None,
    wrap_s: float | None = None,
    tau0_s: float | None = None,
    counter_hz: float | None = None,
    decimal_comma: bool = False,
    date_order: str | None = None,
    channel: str | None = None,
    beat_channel: int | None = None,
    pps_channel: int | None = None,
    clock_ppm: float | None = None,
    rest_angle_rad: float | None = None,
    strict: bool = False,
    both_edges: bool = False,
    dead_time_s: float | None = None,
    flag_width_rad: float | None = None,
    gravity_share: float | None = None,
    sensor_offset_rad: float | str | None = None,
    gap_probability: float | None = None,
    only_phases: bool = False,
    weather: File | Sequence[File] | None = None,
    weather_zone: str | None = None,
    weather_offset_s: float | None = None,
    site: tuple[float, float] | None = None,
    unpacked_limit: int | None = None,
    name: str | None = None,
    progress: Progress | None = None,
) -> Log:
    """Read a log and number its beats.

    Parameters
    ----------
    source : path, list of paths, file object or bytes
        A file of any format that the command reads (plain or gzip; '-' is standard input), an open
        file, or its content. Several paths, a folder or a ZIP: files of one clock, read as one
        log in order of time.
    format : str, optional
        timestamps, periods, clock-error, phase, frequency, ticc, ticc-interval, table, angle,
        native. Where this or an option below is not given, it is worked out from the log if
        possible, and `Log.assumptions` lists the choice.
    nominal_period_s : float, optional
        T0, s, the period to compare with; it is taken as given.
    columns : sequence of str, optional
        What the columns hold: "ROLE=PLACE[:UNIT]", for example "time=2", "amplitude=5:mrad".
    unit : str, optional
        Unit of the times: s, ms, us, ns, min, h, d, mjd.
    wrap_s : float, optional
        The times start again from 0 after this many s; 0: they never do.
    tau0_s : float, optional
        Interval between values of phase, frequency or intervals, s.
    counter_hz : float, optional
        For a log in cycles of a counter: its cycles per second.
    decimal_comma : bool
        Numbers are written with a decimal comma: 12,5 is twelve and a half.
    date_order : 'day' or 'month', optional
        Which comes first in dates such as 03/04/2013.
    channel : str, optional
        For a TICC: chA, chB.
    beat_channel : int, optional
        For a recording of sound: the channel in which the clock is heard, from 1.
    pps_channel : int, optional
        For a recording: the channel in which a reference clicks once a second.
    clock_ppm : float, optional
        For a recording without such a channel: the standard deviation of its sampling rate, parts
        per million; 50 if not given.
    rest_angle_rad : float, optional
        For samples of an angle: the angle at which the pendulum hangs at rest.
    strict : bool
        The first faulty line is an error.
    both_edges : bool
        The log holds both directions without labels.
    dead_time_s : float, optional
        Events within this many s after an edge are part of it; 0: none are.
    flag_width_rad : float, optional
        Angle that a centred flag subtends at the pivot.
    gravity_share : float, optional
        Gravity's share of the restoring torque; a spring supplies the rest. 1 (if not given) is a
        pendulum, 0 a torsion pendulum. The circular error, amplitudes from widths and the fit
        depend on it.
    sensor_offset_rad : float or 'auto', optional
        Angle of the sensor from the vertical; 'auto': estimated from the log.
    gap_probability : float, optional
        Split the log at a gap if the number of cycles in it is right with less than this
        probability, 0.5 to 1.
    only_phases : bool
        Data on a grid need not come from a pendulum: they are taken as they are, for `deviation`.
    weather : path or list of paths, optional
        Tables with a header that names a time, and a temperature, a pressure or a humidity. They
        may have another cadence than the log: they are interpolated to the beats.
    weather_zone : str, optional
        Time zone of the tables' dates, if they name none and are not in the log's: "+01:00".
    weather_offset_s : float, optional
        Added to the tables' times, s.
    site : (float, float), optional
        Latitude and longitude of the clock, degrees, north and east positive: the tides of Moon
        and Sun are then computed for a dated log.
    unpacked_limit : int, optional
        Most bytes to which a packed log may unpack.
    name : str, optional
        What messages call a log that is not a file.
    progress : callable, optional
        Called now and then with the share that has been read, 0 to 1.

    Returns
    -------
    Log

    Raises
    ------
    InputError
        The log cannot be used; file, line and column say where. Two kinds of it:
        `ImpossibleReading`: as it was read, the rate is farther off than any clock's; `others`
        has likelier readings. `InputNotFoundError`: there is no such file.
    NumericsError
        No three beats could be numbered together.
    ValueError
        An option makes no sense.
    """
    options = options_of(
        format=format,
        nominal_period_s=nominal_period_s,
        columns=None if columns is None else [str(column) for column in columns],
        unit=unit,
        wrap_s=wrap_s,
        tau0_s=tau0_s,
        counter_hz=counter_hz,
        decimal_comma=decimal_comma,
        month_first=_month_first(date_order),
        channel=channel,
        beat_channel=beat_channel,
        pps_channel=pps_channel,
        clock_ppm=clock_ppm,
        rest_angle_rad=rest_angle_rad,
        strict=strict,
        both_edges=both_edges,
        dead_time_s=dead_time_s,
        flag_width_rad=flag_width_rad,
        gravity_share=gravity_share,
        sensor_offset_rad=sensor_offset_rad,
        gap_probability=gap_probability,
        only_phases=only_phases,
        weather=None if weather is None else _paths(weather),
        weather_zone=weather_zone,
        weather_offset_s=weather_offset_s,
        site=site,
        unpacked_limit=unpacked_limit,
    )
    if isinstance(columns, str):
        raise ValueError(f"columns: found {columns!r}, expected a list of such words")
    content = _content(source)
    if content is None:
        return Log._of(_core.read(_paths(source), options, progress))
    called = name or str(getattr(source, "name", "log"))
    text = _unpacked(content, called, unpacked_limit or _UNPACKED_LIMIT)
    return Log._of(_core.read_text(text, called, options, progress))
