"""
The compiled part of the package `foliate`.
"""

from _typeshed import SupportsGetItem
from collections.abc import Mapping
from numpy import float64, uint32
from numpy.typing import ArrayLike, NDArray
from os import PathLike
from typing import Any, Final, SupportsFloat, SupportsIndex, final

__all__ = ["__version__", "Batch", "Cancel", "CheckReport", "Event", "FunnelRow", "NewScene", "Path", "Report", "Scene", "Segment", "Solid", "Solution", "Variations", "check", "load_path", "new_scene", "run_program", "scenes", "schedulers", "solve"]

__version__: Final[str]
"""
Version of Foliate.
"""

@final
class Batch:
    """
    Threads that plan for one problem each, and give the answers in the order of the problems. `plan_batch` is what programs use.
    """
    def __len__(self, /) -> int:
        """
        How many problems were added and not taken.
        """
    def __new__(cls, /, threads: SupportsIndex) -> Batch:
        """
        So many threads, each of which plans for one problem at a time.
        """
    def add(self, /, problem: Scene | tuple[Variations, SupportsIndex], *, seed: SupportsIndex = 1, time_limit: SupportsFloat | SupportsIndex = 60.0, scheduler: str = "sequence", first: bool = False, improve_work: SupportsIndex | None = None, improve_time: SupportsFloat | SupportsIndex | None = None, candidates: SupportsIndex = 16, memory_limit: str | None = None) -> None:
        """
        Adds a problem: a scene, or what varies and the number of an instance, which is drawn by the thread that plans for it. The settings are those of `solve`.

        Raises `ValueError` for a value that no option has, and once the batch was closed.
        """
    def close(self, /) -> None:
        """
        Ends: problems that were not begun never are, searches that are under way end soon.
        """
    def take(self, /) -> Solution:
        """
        The answer to the problem that was added first, once it is there; what `solve` raises is raised.

        Raises `IndexError` where no problem is left.
        """

@final
class Cancel:
    """
    Ends solves from another thread.

    One may be given to any number of solves. They end with `NoSolution`, whose reason is `cancelled`.
    """
    def __new__(cls, /) -> Cancel: ...
    def cancel(self, /) -> None:
        """
        Ends the solves that have been given this, and those that will be.
        """
    @property
    def is_cancelled(self, /) -> bool:
        """
        Whether `cancel` was called.
        """

@final
class CheckReport:
    """
    What `check` has found.
    """
    def __bool__(self, /) -> bool: ...
    def __repr__(self, /) -> str: ...
    @property
    def clearance(self, /) -> float | None:
        """
        Proven lower bound of the clearance along the whole path, metres, where it was asked for.
        """
    @property
    def notes(self, /) -> list[str]:
        """
        Remarks.
        """
    @property
    def proved(self, /) -> bool:
        """
        Whether everything is proved, against a scene.
        """
    def to_dict(self, /) -> Any:
        """
        Everything, as `foliate check --json` says it.
        """
    @property
    def verdict(self, /) -> str:
        """
        `"proved"`, `"refused"`, `"relative"` (proved, but only relative to what the file says of itself) or `"undecided"`.
        """
    @property
    def violations(self, /) -> list[str]:
        """
        Broken promises, in words.
        """
    @property
    def weaker(self, /) -> list[str]:
        """
        Why what is proved is less than an answer to a scene.
        """

@final
class Event:
    """
    A hand takes or lets go of an object.
    """
    def __repr__(self, /) -> str: ...
    @property
    def dwell(self, /) -> float:
        """
        How long the robot stands still then, seconds.
        """
    @property
    def fingers(self, /) -> dict[str, float]:
        """
        Joints of the gripper and where they are when the hand has closed or opened, radians or metres.
        """
    @property
    def gripper(self, /) -> str:
        """
        `part/gripper`.
        """
    @property
    def handle(self, /) -> str:
        """
        `part/handle`.
        """
    @property
    def kind(self, /) -> str:
        """
        `"grasp"` or `"release"`.
        """
    @property
    def object(self, /) -> str:
        """
        The part that is taken or let go.
        """
    @property
    def segment(self, /) -> int:
        """
        Number of the segment that begins with it.
        """
    @property
    def time(self, /) -> float:
        """
        Seconds, as the path counts them.
        """

@final
class FunnelRow:
    """
    What became of the candidates of a transition.
    """
    def __repr__(self, /) -> str: ...
    @property
    def blocked_by(self, /) -> list[tuple[str, str, int]]:
        """
        Pairs of shapes that stopped candidates, most frequent first, each with its count.
        """
    @property
    def partial(self, /) -> int:
        """
        Candidates that went a part of the way.
        """
    @property
    def projection_rate(self, /) -> float:
        """
        How often the waypoints of a candidate could be projected, by Laplace's rule.
        """
    @property
    def reached(self, /) -> int:
        """
        Candidates that reached the target.
        """
    @property
    def success_rate(self, /) -> float:
        """
        How often a candidate reached the target, by Laplace's rule.
        """
    @property
    def transition(self, /) -> str:
        """
        Name of the transition.
        """
    @property
    def tried(self, /) -> int:
        """
        Candidates.
        """

@final
class NewScene:
    """
    A scene that was made of models, and what is known of it.
    """
    def __repr__(self, /) -> str: ...
    @property
    def grippers(self, /) -> list[str]:
        """
        The grippers that were found.
        """
    @property
    def objects(self, /) -> list[tuple[str, int, int]]:
        """
        By object: its name, how many handles it has, and on how many faces it rests.
        """
    @property
    def scene(self, /) -> Scene:
        """
        The scene.
        """
    @property
    def solved(self, /) -> bool:
        """
        Whether a search found a path to its goal.
        """
    @property
    def text(self, /) -> str:
        """
        The text of the scene file: plain entries with comments, to be looked at and changed. Names of files in it start at the `folder` that was given.
        """
    @property
    def warnings(self, /) -> list[str]:
        """
        What reading the models has to remark.
        """

@final
class Path:
    """
    A certified path: segments, each on one leaf, and, where it has times, a curve over time.

    Configurations are rows of numbers: metres, radians, and quaternions x, y, z, w; the numbers of parts one after the other, joints depth first as
    pinocchio has them, a free part as x, y, z and its quaternion. Poses are x, y, z and the quaternion, in the world.
    """
    def __len__(self, /) -> int: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    def clearances(self, /, times: ArrayLike | None = None) -> NDArray[float64]:
        """
        How close any two tested shapes that move against each other are at times (seconds; clamped to the path), without `times` at the knots: an array of
        shape (times,), metres, 0 where they meet. In a path without times a unit of length takes a second. Measured there; `min_clearance` is proved for what lies between too.
        """
    def configurations(self, /, times: ArrayLike) -> NDArray[float64]:
        """
        Whole configurations at times (seconds; clamped to the path): an array of shape (times, numbers of a configuration). Objects are where they are
        carried.
        """
    @property
    def coordinates(self, /) -> list[str]:
        """
        Names of the numbers of a configuration: `part/joint`, `part/x` to `part/qw` of a free part, `part/x`, `part/y` and `part/theta` of a planar one.
        """
    @property
    def duration(self, /) -> float | None:
        """
        How long it takes, seconds; `None` in a path without times.
        """
    @property
    def events(self, /) -> list[Event]:
        """
        When hands take and let go, in the order of time.
        """
    @property
    def grippers(self, /) -> list[str]:
        """
        Names of all grippers, `part/gripper`.
        """
    def joint_names(self, /, robot: str) -> list[str]:
        """
        Names of a robot's joints of one coordinate, `part/joint`, those that follow others included, depth first (pinocchio's order).
        """
    def joints(self, /, joints: str | SupportsGetItem[int, str], times: ArrayLike) -> tuple[NDArray[float64], NDArray[float64], NDArray[float64]]:
        """
        What joints do at times: positions, velocities and accelerations, three arrays of shape (times, joints) in rad, rad/s, rad/s² or metres. `joints` is
        the name of a robot, or names of joints.
        """
    @property
    def knots(self, /) -> NDArray[float64]:
        """
        All knots in the direction of travel: an array of shape (knots, numbers of a configuration). The last knot of a segment is the first of the next
        one, and is there once.
        """
    @property
    def min_clearance(self, /) -> float | None:
        """
        Proven lower bound of the distance of all tested pairs beyond their margins, metres; `None` where no pair is tested.
        """
    @property
    def objects(self, /) -> list[str]:
        """
        Names of the objects.
        """
    def poses(self, /, names: SupportsGetItem[int, str], times: ArrayLike) -> NDArray[float64]:
        """
        Poses in the world of links (`part/link`) or parts (`part`: its root link) at times: an array of shape (times, names, 7), x, y, z in metres and the
        quaternion x, y, z, w.
        """
    @property
    def robots(self, /) -> list[str]:
        """
        Names of the robots.
        """
    def save(self, /, out: str | PathLike[str]) -> None:
        """
        Writes the path file (`foliate.path/2`), which `check` and the command `foliate` read.
        """
    @property
    def segments(self, /) -> list[Segment]:
        """
        The segments in the direction of travel.
        """
    def times(self, /, rate: SupportsFloat | SupportsIndex) -> NDArray[float64]:
        """
        Times at a rate (per second), the last one exactly at the end: an array of shape (times,), seconds.
        """
    def view(self, /, out: str | PathLike[str] | None = None) -> str:
        """
        A page that plays the path: its text, or, with `out`, the name of the file into which it is written.
        """

@final
class Report:
    """
    What a search did. Times are of this run; everything else depends on problem, settings and seed alone.
    """
    def __repr__(self, /) -> str: ...
    @property
    def candidates(self, /) -> int:
        """
        Candidates.
        """
    @property
    def edges(self, /) -> int:
        """
        Edges of the roadmap.
        """
    @property
    def fingerprint(self, /) -> int:
        """
        Hash of the roadmap: the same for any number of threads.
        """
    @property
    def funnel(self, /) -> list[FunnelRow]:
        """
        What became of the candidates, a row for each transition.
        """
    @property
    def leaves(self, /) -> int:
        """
        Leaves that were reached.
        """
    @property
    def nodes(self, /) -> int:
        """
        Nodes of the roadmap.
        """
    @property
    def snapped(self, /) -> list[str]:
        """
        What of the start and the goals was a little off a state and was moved onto it.
        """
    @property
    def steps(self, /) -> int:
        """
        Steps.
        """
    @property
    def time(self, /) -> float:
        """
        Seconds from the prepared problem to the answer, on the clock.
        """

@final
class Scene:
    """
    What is planned for: robots, objects, who may hold what and where things may lie, a start and goals.

    `Scene("demo")` is a scene that is shipped (`scenes()` lists them), `Scene("my.toml")` reads a file, `Scene.from_text` a text. A scene does not
    change: `with_start` and `with_goal` give others. It may be used by any number of threads.

    `packages` are folders in which `package://` names are looked up, beside those of the environment (`FOLIATE_PACKAGE_PATH`, `ROS_PACKAGE_PATH`).

    Raises `SceneError` with file, line and hint where something cannot be read.
    """
    def __new__(cls, /, name: str, *, packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> Scene: ...
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def description(self, /) -> str:
        """
        What it says of itself.
        """
    @property
    def environments(self, /) -> list[str]:
        """
        Names of what never moves.
        """
    @staticmethod
    def from_dict(document: Mapping[str, Any], *, folder: str | PathLike[str] = ..., packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> Scene:
        """
        Reads a scene from a dictionary that has the keys of a scene file. Names of files in it start at `folder`.

        Raises `ValueError` where a value has no form in a scene file.
        """
    @staticmethod
    def from_text(text: str, *, folder: str | PathLike[str] = ..., name: str = "scene", packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> Scene:
        """
        Reads a scene from a text in the form of a scene file (TOML). Names of files in it start at `folder`.
        """
    def joint_names(self, /, robot: str) -> list[str]:
        """
        Names of a robot's joints of one coordinate, `part/joint`, depth first (pinocchio's order), without those that follow others.
        """
    @property
    def name(self, /) -> str:
        """
        Its name.
        """
    @property
    def objects(self, /) -> list[str]:
        """
        Names of the objects.
        """
    def poses(self, /, names: SupportsGetItem[int, str]) -> NDArray[float64]:
        """
        Poses in the world of links (`part/link`) or parts (`part`: its root link) at the start: an array of shape (names, 7), x, y, z in metres and the
        quaternion x, y, z, w.
        """
    @property
    def robots(self, /) -> list[str]:
        """
        Names of the robots.
        """
    def solids(self, /, *, visual: bool = False) -> list[Solid]:
        """
        The solids of its links: those that collide, or, with `visual`, what is seen (of a link without visual elements what collides).
        """
    def start(self, /, name: str) -> list[float]:
        """
        What a joint (`part/joint`) or part has at the start: a number, three (x, y, angle) or seven (x, y, z, and the quaternion x, y, z, w); metres and
        radians.
        """
    def view(self, /, out: str | PathLike[str] | None = None) -> str:
        """
        A page that shows the scene: its text, or, with `out`, the name of the file into which it is written.
        """
    @property
    def warnings(self, /) -> list[str]:
        """
        What reading it has to remark.
        """
    def with_goal(self, /, values: Mapping[str, ArrayLike]) -> Scene:
        """
        The scene with another goal: joints and parts as in `with_start` that have these values in the end. What is not named is free, but nothing stays in
        a hand.
        """
    def with_start(self, /, values: Mapping[str, ArrayLike]) -> Scene:
        """
        The scene with another start: joints (`part/joint`, radians or metres) and parts (poses in the world: x, y, z in metres and the quaternion x, y, z,
        w). What is not named starts as before.
        """

@final
class Segment:
    """
    A motion on one leaf.
    """
    def __repr__(self, /) -> str: ...
    @property
    def holding(self, /) -> list[tuple[str, str]]:
        """
        Who holds what during the motion: grippers (`part/gripper`) and handles (`part/handle`).
        """
    @property
    def knots(self, /) -> NDArray[float64]:
        """
        Configurations: an array of shape (knots, numbers of a configuration).
        """
    @property
    def state(self, /) -> str:
        """
        Name of the state in which the motion lies.
        """
    @property
    def times(self, /) -> NDArray[float64] | None:
        """
        When the knots are passed, seconds: an array of shape (knots,). `None` in a path without times.
        """
    @property
    def transition(self, /) -> str:
        """
        Name of the transition that is travelled.
        """

@final
class Solid:
    """
    A solid of a link.
    """
    def __repr__(self, /) -> str: ...
    @property
    def color(self, /) -> list[float] | None:
        """
        Red, green, blue and opacity from 0 to 1; `None` where the model says nothing.
        """
    @property
    def kind(self, /) -> str:
        """
        `"box"`, `"cylinder"`, `"sphere"`, `"capsule"` or `"mesh"`.
        """
    @property
    def link(self, /) -> str:
        """
        The link that it belongs to, `part/link`.
        """
    @property
    def pose(self, /) -> list[float]:
        """
        Its pose in the link: x, y, z in metres and the quaternion x, y, z, w.
        """
    @property
    def size(self, /) -> list[float]:
        """
        Its sizes, metres: the sides of a box; radius and length of a cylinder; the radius of a sphere; radius and length of a capsule without its round ends;
        nothing of a mesh.
        """
    @property
    def triangles(self, /) -> NDArray[uint32]:
        """
        Triangles of its surface as indices of vertices, counter-clockwise seen from outside: an array of shape (triangles, 3).
        """
    @property
    def vertices(self, /) -> NDArray[float64]:
        """
        The corners of its surface in its own frame, metres: an array of shape (vertices, 3). Round solids are approximated from inside.
        """

@final
class Solution:
    """
    A certified path, and what the search did to find it.
    """
    def __repr__(self, /) -> str: ...
    def _repr_html_(self, /) -> str: ...
    @property
    def outcome(self, /) -> str:
        """
        `"solved"`.
        """
    @property
    def path(self, /) -> Path:
        """
        The path.
        """
    @property
    def report(self, /) -> Report:
        """
        What the search did.
        """
    @property
    def scene(self, /) -> Scene:
        """
        What was planned for.
        """
    @property
    def seed(self, /) -> int:
        """
        The seed.
        """

@final
class Variations:
    """
    Instances of a scene that differ in what `vary` says: random starts and goals of objects on their supports, object counts, poses of parts, sizes, obstacles.

    `Variations("demo", {"seed": 7, "starts": True, "goals": ["box1"]})`; `vary` has the keys of `[vary]` in a suite file (docs/batches.md). An instance follows from the scene, `vary` and its number
    alone. All start and goal in states of the constraint graph and without collision; that there is a path is not known.

    Raises `SceneError` where the scene cannot be read, or cannot vary so.
    """
    def __new__(cls, /, scene: str, vary: Mapping[str, Any], *, packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> Variations: ...
    @staticmethod
    def from_suite(file: str | PathLike[str], *, packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> list[tuple[Variations, int]]:
        """
        Those of a suite file, one for each of its scenes, with how many instances it wants; of a suite without `[vary]` none.
        """
    def instance(self, /, number: SupportsIndex) -> Scene:
        """
        The instance of a number.

        Raises `NoInstance` where no draw has a start and goals that could be planned for; it says what was wrong with them.
        """

def check(file: str | PathLike[str], scene: Scene | str | None = None, *, time_limit: SupportsFloat | SupportsIndex = 600.0, clearance: bool = False, packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> CheckReport:
    """
    Proves a path file over the continuum, by code that shares nothing with the search.

    `scene` is what the path has to answer: a `Scene`, a scene's name or file. Without it, it is the scene that the file names. `time_limit` is in seconds;
    what is not decided by then counts as undecided. `clearance` asks for a proven bound of the smallest clearance.

    Other threads of Python run meanwhile; Ctrl-C ends the check.

    Raises `PathError` where the file or a model cannot be read.
    """

def load_path(file: str | PathLike[str], *, packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> Path:
    """
    Reads a path file, of any version of Foliate that wrote one.
    """

def new_scene(robot: str, objects: SupportsGetItem[int, str], *, table: str = "1.2 0.8 0.75", srdf: str | None = None, drives: bool = False, grippers: SupportsGetItem[int, str] = ..., grasps: str | PathLike[str] | None = None, grasp_axes: str = "xy", seed: SupportsIndex = 0, folder: str | PathLike[str] = ..., packages: SupportsGetItem[int, str | PathLike[str]] = ...) -> NewScene:
    """
    Makes a scene of a robot and objects: finds grippers, handles, resting faces and links that touch by design, lays the objects on a table within reach, and
    plans to see that the first one can be moved. It is what the command `foliate new` does.

    `robot` and `srdf` are files or `package://` URLs. An object is `"box X Y Z"`, `"cylinder RADIUS LENGTH"`, `"sphere RADIUS"` (metres), a mesh as
    `"FILE [SCALE]"`, or a URDF. `table` is `"LENGTH WIDTH HEIGHT"` (metres), and, where its place is not to be found, `"X Y"` or `"X Y YAW"` of its middle, seen
    from the root of the robot (metres, radians). `drives`: the root of the robot is planar. `grippers` names links of hands, or tool frames as `LINK` or
    `LINK:AXIS`; without it all hands with two jaws are found. `grasps` is a file with grasps of the first object, lines of `x y z qx qy qz qw [score]`, and
    `grasp_axes` says which axes of its frames approach and close. Names of files in the text start at `folder`.

    Raises `SceneError` where a model cannot be read, `ModelError` where there is no gripper, or an object cannot be held or reached, `ValueError` for a request
    that is none.
    """

def run_program(arguments: SupportsGetItem[int, str]) -> int:
    """
    Runs the program `foliate` with arguments, of which the first is its name; returns its exit code. It is the end of the process: signals are its own from
    then on.
    """

def scenes() -> list[tuple[str, str, bool]]:
    """
    The scenes that are shipped: name, what it is, and whether it needs published robot models (`foliate models --install`).
    """

def schedulers() -> list[str]:
    """
    The schedulers that are shipped.
    """

def solve(scene: Scene, *, seed: SupportsIndex = 1, time_limit: SupportsFloat | SupportsIndex = 60.0, threads: SupportsIndex = 1, scheduler: str = "sequence", first: bool = False, improve_work: SupportsIndex | None = None, improve_time: SupportsFloat | SupportsIndex | None = None, candidates: SupportsIndex = 16, memory_limit: str | None = None, progress: Any | None = None, cancel: Cancel | None = None) -> Solution:
    """
    Plans a path for a scene.

    The answer depends on scene, seed and settings alone, not on `threads` or the machine. `time_limit` is in seconds. `improve_work` is how much counted
    work is spent on a better path than the first, `improve_time` seconds instead; `first` asks for the first path, without times. `candidates` is how many
    candidates a step has. `progress` is called with a dictionary (`step`, `candidates`, `nodes`, `edges`, `leaves`) at most ten times a second; what it raises
    ends the search. `cancel` ends it from another thread. Other threads of Python run meanwhile; Ctrl-C ends the search.

    Raises `NoSolution` where there is no path, with the reason and what the search did; `ModelError` where the problem cannot be planned for; `ValueError` for
    a value that no option has.
    """
