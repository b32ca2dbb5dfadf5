"""Turns a scenario given as a dict into the TOML text that the library reads."""

from __future__ import annotations

import json
import os
from typing import Any, Mapping

import numpy as np


def _key(key: Any) -> str:
    return json.dumps(str(key), ensure_ascii=False)


def _value(place: str, value: Any) -> str:
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_key(k)} = {_value(f'{place}.{k}', v)}"
                               for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(place, v) for v in value) + "]"
    raise ValueError(f"{place}: found {value!r}, expected a number, text, list or dict")


def toml_of(scenario: Mapping[str, Any]) -> str:
    """TOML text, one line per key."""
    return "".join(f"{_key(k)} = {_value(str(k), v)}\n" for k, v in scenario.items())
