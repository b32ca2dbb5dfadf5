"""The options of a fit as a user writes them, checked and put in the extension's form."""

from __future__ import annotations

import math
import os
from typing import Any, Iterable, Mapping, Union

from . import _core

Fixed = Union[Mapping[str, float], Iterable[str]]
Priors = Union[Mapping[str, "tuple[float, float]"], Iterable[str]]


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
    """The options of a fit, as the extension takes them."""
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
