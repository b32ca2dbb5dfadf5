"""Arrays given by the user, checked once here so that the extension can rely on them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

NOTHING = np.empty(0)
NO_EDGES = np.empty(0, np.uint8)
_PER_SECOND = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9, "ps": 10**12, "fs": 10**15}
_LONGEST = 4e18  # s; the limit of the reader of files, too


def _place(wrong: Array) -> int:
    return int(np.flatnonzero(wrong)[0])


def _one_dimension(name: str, values: Any, expected: str) -> Array:
    if values is None:
        raise ValueError(f"{name}: found None, expected {expected}")
    if isinstance(values, np.ma.MaskedArray):
        values = np.where(np.ma.getmaskarray(values), np.nan, np.asarray(values, float))
    array: Array = np.asarray(values)
    if array.ndim != 1:
        raise ValueError(f"{name}: found an array of shape {array.shape}, expected one dimension")
    return array


def numbers(name: str, values: Any, length: int | None = None) -> Array:
    """`values` as a contiguous array of float64; no copy if it is one."""
    if type(values) is np.ndarray and values.dtype == np.float64 and values.ndim == 1:
        array = values
        if array.flags.c_contiguous and array.flags.aligned and length in (None, array.size):
            return array
    else:
        array = _one_dimension(name, values, "an array of numbers")
        if array.dtype.kind not in "iuf":
            raise ValueError(f"{name}: found dtype {array.dtype}, expected numbers (float64)")
    if length is not None and array.size != length:
        raise ValueError(f"{name}: found {array.size} values, expected {length}, one an event")
    return np.require(array, np.float64, ["C", "ALIGNED"])


def amplitudes(name: str, values: Any, length: int) -> Array:
    """Angles from 0 to pi; NaN where unknown."""
    array = numbers(name, values, length)
    with np.errstate(invalid="ignore"):
        wrong = (array < 0) | (array > np.pi)
    if wrong.any():
        at = _place(wrong)
        raise ValueError(
            f"{name}: found {array[at]:g} at index {at}, expected 0 to pi rad, or NaN for unknown"
        )
    return array


def edges(name: str, values: Any, length: int) -> Array:
    """uint8, 1 for a downward crossing; takes booleans, 0 and 1, or the words up and down."""
    array = _one_dimension(name, values, "'up' or 'down' for each event")
    if array.dtype.kind == "U":
        down = array == "down"
        wrong = ~(down | (array == "up"))
    elif array.dtype.kind in "biu":
        down = array == 1
        wrong = ~(down | (array == 0))
    else:
        raise ValueError(f"{name}: found dtype {array.dtype}, expected 'up' and 'down', or 0 and 1")
    if array.size != length:
        raise ValueError(f"{name}: found {array.size} values, expected {length}, one an event")
    if wrong.any():
        at = _place(wrong)
        raise ValueError(
            f"{name}: found {array[at]!s} at index {at}, expected 'up' or 'down' (0 or 1)"
        )
    return down.astype(np.uint8)


def _from_dates(name: str, times: Array) -> tuple[Array, Array]:
    unit, step = np.datetime_data(times.dtype)
    if np.isnat(times).any():
        raise ValueError(f"{name}: found NaT at index {_place(np.isnat(times))}, expected a time")
    if unit not in _PER_SECOND:  # minutes and longer: whole seconds
        if unit == "as":
            raise ValueError(f"{name}: found attoseconds, expected a unit from fs to days")
        return times.astype("datetime64[s]").astype(np.int64), np.zeros(times.size)
    per_second = _PER_SECOND[unit]
    count = times.astype(np.int64)
    if per_second % step:
        count, step = count * step, 1
    seconds, rest = np.divmod(count, per_second // step)
    return seconds, rest / (per_second // step)


def _from_numbers(name: str, times: Array) -> tuple[Array, Array]:
    if times.dtype.kind in "iu":
        return times.astype(np.int64), np.zeros(times.size)
    if times.dtype.kind != "f":
        raise ValueError(
            f"{name}: found dtype {times.dtype}, expected times (float64 or datetime64)"
        )
    wrong = ~(np.abs(times) < _LONGEST)
    if wrong.any():
        at = _place(wrong)
        raise ValueError(f"{name}: found {times[at]} at index {at}, expected a finite time in s")
    whole = np.floor(times)
    return whole.astype(np.int64), (times - whole).astype(np.float64)


def instants(
    time_s: Any, seconds: Any = None, fraction: Any = None
) -> tuple[Array, Array]:
    """Whole seconds (int64) and the fraction (float64, 0 <= fraction < 1), without rounding."""
    if (time_s is None) == (seconds is None):
        raise ValueError("time_s: expected times either as time_s or as seconds and fraction")
    if time_s is not None:
        times = _one_dimension("time_s", time_s, "an array of times")
        from_these = _from_dates if times.dtype.kind == "M" else _from_numbers
        whole, part = from_these("time_s", times)
    else:
        base = _one_dimension("seconds", seconds, "an array of times")
        whole, part = _from_numbers("seconds", base)
        more = numbers("fraction", fraction, base.size)
        if not np.isfinite(more).all():
            at = _place(~np.isfinite(more))
            raise ValueError(f"fraction: found {more[at]} at index {at}, expected a finite number")
        part = part + more
    carry = np.floor(part)
    whole, part = whole + carry.astype(np.int64), part - carry
    late = part >= 1.0  # a tiny negative fraction plus 1 rounds to 1
    _check_order(whole + late, part - late)
    return np.ascontiguousarray(whole + late), np.ascontiguousarray(part - late)


def _check_order(seconds: Array, fraction: Array) -> None:
    step = np.diff(seconds)
    back = (step < 0) | ((step == 0) & (np.diff(fraction) < 0))
    if back.any():
        at = _place(back) + 1
        raise ValueError(
            f"time_s: goes back at index {at}; expected times in order (sort them, "
            "or make a log of each run)"
        )


def cycles(name: str, values: Any) -> Array:
    """A whole number, or a one-dimensional array of them, as an array of int64."""
    array = np.asarray(values)
    if array.ndim == 0:
        array = array[np.newaxis]
    if array.ndim != 1:
        raise ValueError(f"{name}: found an array of shape {array.shape}, expected one dimension")
    if array.dtype.kind == "f" and array.size and np.equal(np.mod(array, 1), 0).all():
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu" and array.size:
        raise ValueError(f"{name}: found dtype {array.dtype}, expected whole numbers")
    return np.ascontiguousarray(array, np.int64)
