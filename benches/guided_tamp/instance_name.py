"""The name of an instance: task, demonstration, robot, and which of the package's poses its base has."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, order=True)
class InstanceName:
    task: str
    demo: int
    robot: str
    pose: int

    @property
    def text(self) -> str:
        """As scene files are named: `shelf-0-panda-1`."""
        return f"{self.task}-{self.demo}-{self.robot}-{self.pose}"

    @property
    def group(self) -> str:
        """The line of the table: `shelf-1` is the shelf with one object, which the package calls demonstration 0."""
        return f"shelf-{self.demo + 1}" if self.task == "shelf" else self.task

    @staticmethod
    def of(text: str) -> InstanceName:
        """The instance that `text` names."""
        words = text.split("-")
        if len(words) != 4 or not words[1].isdigit() or not words[3].isdigit():
            raise ValueError(f"{text!r} is no instance: TASK-DEMONSTRATION-ROBOT-POSE")
        return InstanceName(words[0], int(words[1]), words[2], int(words[3]))
