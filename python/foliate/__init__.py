"""Manipulation planning: constraint graphs, foliated manifolds, certified motions.

>>> import foliate
>>> solution = foliate.solve(foliate.Scene("demo"), seed=1)
>>> len(solution.path)
12
>>> times = solution.path.times(100)
>>> solution.path.configurations(times).shape[0] == times.size
True
"""

from foliate._foliate import (
    Cancel,
    CheckReport,
    Event,
    FunnelRow,
    NewScene,
    Path,
    Report,
    Scene,
    Segment,
    Solid,
    Solution,
    Variations,
    __version__,
    check,
    load_path,
    new_scene,
    scenes,
    schedulers,
    solve,
)
from foliate.batch import instances, plan_batch
from foliate.building import SceneBuilder
from foliate.errors import FoliateError, ModelError, NoInstance, NoSolution, PathError, SceneError

__all__ = [
    "Cancel",
    "CheckReport",
    "Event",
    "FoliateError",
    "FunnelRow",
    "ModelError",
    "NewScene",
    "NoInstance",
    "NoSolution",
    "Path",
    "PathError",
    "Report",
    "Scene",
    "SceneBuilder",
    "SceneError",
    "Segment",
    "Solid",
    "Solution",
    "Variations",
    "__version__",
    "check",
    "instances",
    "load_path",
    "new_scene",
    "plan_batch",
    "scenes",
    "schedulers",
    "solve",
]
