"""What goes wrong, sorted by what there is to do about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing to fix. What is not known is `None`."""

    message: str
    """What is wrong."""
    file: str | None = None
    """The file it is in; `<dict>` of a scene that was made of a dictionary."""
    line: int | None = None
    """Line, from 1."""
    column: int | None = None
    """Column in characters, from 1."""
    item: str | None = None
    """The item there, as in `sensor.bands[3]`."""
    help: str | None = None
    """What to do, if the message does not make it obvious."""


class Error(Exception):
    """Anything that goes wrong; `problems` has all of it, each with its place."""

    def __init__(self, message: str, problems: Sequence[Problem] = ()) -> None:
        super().__init__(message)
        self.problems: list[Problem] = list(problems)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.args[0], self.problems)


class IoError(Error, OSError):
    """A file or folder could not be read or written: check the path, the permissions and the free space."""

    def __str__(self) -> str:
        return str(self.args[0])


class TextError(Error, ValueError):
    """A text does not follow its format: fix it at this place."""


class InvalidError(Error, ValueError):
    """A text is well formed, but values in it are not usable: fix them. All are told."""


def refused(*problems: Problem) -> InvalidError:
    """What was asked for cannot be done: all that is wrong with it, a line each."""
    lines = []
    for problem in problems:
        at = "" if problem.item is None else f"{problem.item}: "
        lines.append(f"{at}{problem.message}{'' if problem.help is None else f'; {problem.help}'}")
    return InvalidError("\n".join(lines), problems)


class UnsupportedError(Error, NotImplementedError):
    """Understood, but not something this version can do."""


class StoppedError(Error):
    """The work was asked to stop; nothing was written."""


class InternalError(Error, RuntimeError):
    """A fault of mmxrt: please report it."""
