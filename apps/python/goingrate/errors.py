"""What goingrate raises besides Python's own exceptions."""

from __future__ import annotations

from typing import Any, Sequence

__all__ = ["ImpossibleReading", "InputError", "InputNotFoundError", "NumericsError"]


class InputError(ValueError):
    """A log, a scenario or a file of parameters cannot be used.

    Attributes
    ----------
    file : str
        Its name as it was given.
    line, column : int or None
        Where, counted from 1; None: the whole file.

    The message says what was found and what was expected there.
    """

    def __init__(
        self, message: str, file: str = "", line: int | None = None, column: int | None = None
    ) -> None:
        super().__init__(message, file, line, column)
        self.file = file
        self.line = line
        self.column = column

    def __str__(self) -> str:
        return str(self.args[0])


class InputNotFoundError(InputError, FileNotFoundError):
    """There is no such file; also a `FileNotFoundError`."""


class ImpossibleReading(InputError):
    """A log was read, but no clock is so far off: it is not what it was taken for.

    Attributes
    ----------
    others : list of (str, dict)
        The likeliest other readings, best first: in words, and as keywords of `read`, so that
        ``gr.read(path, **error.others[0][1])`` tries the first.
    """

    def __init__(
        self,
        message: str,
        file: str = "",
        line: int | None = None,
        column: int | None = None,
        others: Sequence[tuple[str, dict[str, Any]]] = (),
    ) -> None:
        super().__init__(message, file, line, column)
        self.args = (message, file, line, column, list(others))
        self.others = list(others)


class NumericsError(ArithmeticError):
    """An input was read, but the numbers did not work out: the clock stalls, no fit exists."""
