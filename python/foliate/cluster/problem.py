"""Problems that can be sent to another process."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from foliate._foliate import Scene, __version__
from foliate.document import plain

__all__ = ["Problem"]


@dataclass(frozen=True)
class Problem:
    """A scene, what is different in it, and how it is solved: plain data."""

    scene: str | Mapping[str, Any]
    """A shipped scene's name, a file, or a dictionary with the keys of a scene file."""
    start: Mapping[str, Any] = field(default_factory=dict)
    """As ``Scene.with_start``."""
    goal: Mapping[str, Any] = field(default_factory=dict)
    """As ``Scene.with_goal``; none: the scene's own goals."""
    settings: Mapping[str, Any] = field(default_factory=dict)
    """As ``solve``: ``seed``, ``time_limit``, ``improve_work`` and so on."""
    folder: str = "."
    """Where names of files in a dictionary start."""
    packages: tuple[str, ...] = ()
    """Folders in which ``package://`` names are looked up."""

    def load(self) -> Scene:
        """The scene. Scenes that have been loaded in this process are kept (the last 16).

        Raises what ``Scene`` raises.
        """
        text = self.scene if isinstance(self.scene, str) else json.dumps(plain(self.scene))
        scene = _loaded(text, isinstance(self.scene, str), self.folder, self.packages)
        if self.start:
            scene = scene.with_start(self.start)
        return scene.with_goal(self.goal) if self.goal else scene

    @property
    def identity(self) -> str:
        """32 hexadecimal digits that say which problem it is: of scene, start, goal, settings and the version of Foliate. Of a scene's file its bytes count, not its name; models that it names do not
        count."""
        scene: Any = plain(self.scene) if isinstance(self.scene, Mapping) else self.scene
        if isinstance(scene, str) and Path(scene).is_file():
            scene = hashlib.sha256(Path(scene).read_bytes()).hexdigest()
        parts = [scene, plain(self.start), plain(self.goal), plain(self.settings), __version__]
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()[:32]


@lru_cache(maxsize=16)
def _loaded(text: str, is_name: bool, folder: str, packages: tuple[str, ...]) -> Scene:
    if is_name:
        return Scene(text, packages=list(packages))
    return Scene.from_dict(json.loads(text), folder=folder, packages=list(packages))
