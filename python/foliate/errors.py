"""Exceptions of the package, each with what it says as attributes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from foliate._foliate import Report

__all__ = ["FoliateError", "ModelError", "NoInstance", "NoSolution", "PathError", "SceneError"]


class FoliateError(Exception):
    """Any error of the package that is not about a wrong argument."""


class SceneError(FoliateError):
    """A scene or a model cannot be read."""

    def __init__(self, text: str, file: str, line: int | None, element: str, message: str, hint: str) -> None:
        super().__init__(text)
        self.file = file
        """The file, as the user would find it."""
        self.line = line
        """Line, counted from 1, where the format has lines."""
        self.element = element
        """The element or key."""
        self.message = message
        """What is wrong."""
        self.hint = hint
        """What to do about it; may be empty."""


class ModelError(FoliateError):
    """The problem cannot be planned for, or has no coordinate of that name."""


class NoInstance(FoliateError):
    """A scene that varies has no instance of a number: none of the draws could be planned for."""

    outcome = "no_instance"
    """As the outcome of a problem."""

    def __init__(self, text: str, number: int) -> None:
        super().__init__(text)
        self.number = number
        """The number."""
        self.detail = text
        """What was wrong with the draws."""


class PathError(FoliateError):
    """A path file cannot be read or written, or a path answers no such question."""


class NoSolution(FoliateError):
    """A search ended without a path."""

    def __init__(self, text: str, outcome: str, detail: str | None, report: Report) -> None:
        super().__init__(text)
        self.outcome = outcome
        """``timeout``, ``step_limit``, ``memory_limit``, ``cancelled``, ``infeasible_start``, ``infeasible_goal``, ``crashed`` or ``failed``."""
        self.detail = detail
        """Why start or goal are infeasible; ``None`` where the outcome says all."""
        self.report = report
        """What the search did."""
