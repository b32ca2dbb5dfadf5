"""The exceptions that goingrate raises besides Python's own."""

from __future__ import annotations

from typing import Any, Sequence

__all__ = ["ImpossibleReading", "InputError", "InputNotFoundError", "NumericsError"]


class InputError(ValueError):
    """A log, a scenario or a file of parameters cannot be used.

    Attributes
    ----------
    file : str
        Name of the file as it was given.
    line, column : int or None
        Place of the fault, counted from 1; None if it concerns the whole file.

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
    """A log was read, but its rate is farther off than any clock's: it must be something else.

    Attributes
    ----------
    others : list of (str, dict)
        The likeliest other readings, best first, each in words and as keywords of `read`:
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
    """The input was read, but it has no numerical result: the clock stalls, or no fit exists."""
