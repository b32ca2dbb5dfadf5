"""What the results share: JSON, and pandas and matplotlib, imported only when they are used."""

from __future__ import annotations

import json
from typing import Any, Mapping


def frame(columns: Mapping[str, Any]) -> Any:
    """A DataFrame of copies of these columns."""
    import pandas

    return pandas.DataFrame({name: pandas.Series(values) for name, values in columns.items()})


def new_axes(ax: Any) -> Any:
    """The axes given, or new ones."""
    if ax is not None:
        return ax
    from matplotlib import pyplot

    return pyplot.subplots()[1]


class Report:
    """A result that the library also writes as JSON and as text."""

    def _json(self) -> str:
        raise NotImplementedError

    def to_json(self) -> str:
        """The JSON that the command writes with ``--json``: all numbers with all their digits."""
        return self._json()

    def to_dict(self) -> dict[str, Any]:
        """The same as a dict; an unknown number is None."""
        result: dict[str, Any] = json.loads(self._json())
        return result
