"""The path file `foliate.path/2` (or `/1`, which has no velocities), read strictly.

What is not well formed stops with an `InputError` that names the place in the file. Whether the motion is *right* is
not asked here.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from packages import InputError

FORMATS = ("foliate.path/1", "foliate.path/2")
LATER_KEYS = ("rate_limits", "events")
LATER_CLAIMS = ("max_velocity", "max_acceleration", "continuity")
RATES = ("velocity", "acceleration", "jerk")
UP_AXES = ("as-written", "declared")
KINDS = ("robot", "object", "environment")
ROOTS = ("fixed", "freeflyer", "planar")
MIMIC = ("follow", "free")
BOUNDS = ("equal", "at_least", "at_most")
FREEFLYER_COORDINATES = ("x", "y", "z", "qx", "qy", "qz", "qw")
PLANAR_COORDINATES = ("x", "y", "theta")
DEFAULT_PATH_TOLERANCE = 2e-4


@dataclass(frozen=True)
class PartEntry:
    name: str
    kind: str
    urdf: str
    srdf: str | None
    mimic: str
    root: str
    world_from_root: np.ndarray
    up_axis: str = "as-written"


@dataclass(frozen=True)
class Gripper:
    link: str
    link_from_gripper: np.ndarray


@dataclass(frozen=True)
class Handle:
    link: str
    link_from_handle: np.ndarray
    mask: list[bool]
    mask_complement: list[bool]


@dataclass(frozen=True)
class Surface:
    """Convex polygons on a link: `points` (N, 3) in the link's frame, `polygons` as indices, normals out of the
    solid by the right-hand rule."""

    link: str
    points: np.ndarray
    polygons: list[list[int]]


@dataclass(frozen=True)
class Attachment:
    """A grasp (`gripper`, `handle`) or a placement (`surface`, `support`, or `on` a link) of `object`."""

    object: str
    carrier: bool
    gripper: str | None = None
    handle: str | None = None
    surface: str | None = None
    support: str | None = None
    on: str | None = None

    @property
    def is_grasp(self) -> bool:
        return self.gripper is not None

    def __str__(self) -> str:
        if self.is_grasp:
            return f"{self.gripper} > {self.handle}"
        return f"{self.object} on {self.on}" if self.on else f"{self.surface} on {self.support}"


@dataclass(frozen=True)
class Frame:
    """A named frame (`world`, a part for its root link, a gripper, a handle, `part/link`, `part/joint`), or a pose in it."""

    name: str
    pose: np.ndarray | None = None

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Plane:
    """A row on a centre of mass: `normal . c - offset` is zero, or not negative."""

    normal: np.ndarray
    offset: float
    inequality: bool


@dataclass(frozen=True)
class Constraint:
    """See src/path_file/constraint.rs for which kind reads what. `mask` and `inequality` have six rows."""

    kind: str
    name: str
    frame: Frame | None
    to: Frame | None
    mask: list[bool]
    inequality: list[bool]
    value: np.ndarray | None
    parts: list[str]
    planes: list[Plane]
    height: float | None
    length: float | None
    bound: str
    joint: str | None
    position: float | None
    within: float | None
    tolerance: float | None

    def __str__(self) -> str:
        about = self.kind
        if self.joint is not None:
            about += f" {self.joint}"
        elif self.parts:
            about += f" of {', '.join(self.parts)}"
        elif self.frame is not None:
            about += f" of {self.frame} in {self.to}"
        return f"{self.name} ({about})" if self.name else about


@dataclass(frozen=True)
class Segment:
    index: int
    transition: str
    state: str
    attachments: list[Attachment]
    constraints: list[Constraint]
    knots: np.ndarray
    times: np.ndarray | None
    velocities: np.ndarray | None = None


@dataclass(frozen=True)
class Event:
    """A grasp or a release at the first knot of a segment, which then stands still for `dwell` seconds."""

    time: float | None
    dwell: float
    segment: int
    kind: str
    object: str
    gripper: str
    handle: str
    fingers: dict[str, float]


@dataclass(frozen=True)
class PathFile:
    file: Path
    parts: list[PartEntry]
    coordinates: list[str]
    limits: dict[str, tuple[float, float]]
    grippers: dict[str, Gripper]
    handles: dict[str, Handle]
    surfaces: dict[str, Surface]
    ignored_pairs: list[tuple[str, str, str]]
    margins: list[tuple[str, str, float]]
    placement_margin: float
    rests: tuple[str, float] | None
    path_tolerance: float
    certificate: dict
    segments: list[Segment]
    rate_limits: dict[str, dict[str, float]]
    events: list[Event] | None


class _Node:
    """A value of the JSON tree that knows where it stands."""

    def __init__(self, value, where: str):
        self.value, self.where = value, where

    def fail(self, message: str):
        raise InputError(f"{self.where}: {message}")

    def get(self, key: str, default=...) -> "_Node":
        self.expect(dict, "an object")
        if key not in self.value:
            if default is ...:
                self.fail(f"{key!r} is missing")
            return _Node(default, f"{self.where}.{key}")
        return _Node(self.value[key], f"{self.where}.{key}")

    def items(self) -> list["_Node"]:
        self.expect(list, "a list")
        return [_Node(value, f"{self.where}[{index}]") for index, value in enumerate(self.value)]

    def entries(self) -> list[tuple[str, "_Node"]]:
        self.expect(dict, "an object")
        return [(key, _Node(value, f"{self.where}.{key}")) for key, value in self.value.items()]

    def expect(self, kind, words: str):
        if not isinstance(self.value, kind):
            self.fail(f"{words} expected, found {json.dumps(self.value)[:60]}")
        return self.value

    def text(self, choices: tuple[str, ...] | None = None) -> str:
        self.expect(str, "a text")
        if choices and self.value not in choices:
            self.fail(f"{self.value!r} is none of {', '.join(choices)}")
        return self.value

    def number(self) -> float:
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)):
            self.fail(f"a number expected, found {json.dumps(self.value)[:60]}")
        return float(self._finite([self.value])[0])

    def numbers(self, count: int | None = None) -> np.ndarray:
        values = self.expect(list, "a list of numbers")
        if not all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
            self.fail("only numbers expected in this list")
        if count is not None and len(values) != count:
            self.fail(f"{count} numbers expected, found {len(values)}")
        return self._finite(values)

    def _finite(self, values: list) -> np.ndarray:
        try:
            numbers = np.array(values, dtype=float)
        except OverflowError:
            numbers = np.array([np.inf])
        if not np.isfinite(numbers).all():
            self.fail("a number too large for this checker")
        return numbers

    def pose(self) -> np.ndarray:
        values = self.numbers(7)
        if abs(np.linalg.norm(values[3:]) - 1.0) > 1e-6:
            self.fail("the quaternion (x y z w) is not a unit quaternion")
        return values

    def mask(self, sizes: tuple[int, ...] = (6,)) -> list[bool]:
        values = self.expect(list, "a mask")
        if len(values) not in sizes or not all(value in (0, 1) for value in values):
            self.fail(f"a mask of {' or '.join(map(str, sizes))} booleans expected")
        return [bool(value) for value in values]


def _read_rests(item: _Node) -> tuple[str, float] | None:
    """The rule by which objects rest, and its margin (m); none: the centre of the object's polygon is over the support."""
    if item.value is None:
        return None
    return item.get("rule").text(("stable", "whole-face")), item.get("margin").number()


def read_path_file(file: Path) -> PathFile:
    """The path in `file`; `InputError` when it is not one."""
    root = _Node(_read_json(file), str(file))
    is_first = root.get("format").text(FORMATS) == FORMATS[0]
    coordinates = [item.text() for item in root.get("coordinates").items()]
    if len(set(coordinates)) != len(coordinates):
        root.get("coordinates").fail("a coordinate is named twice")
    documents = root.get("documents", {})
    certificate = root.get("certificate", {})
    path = PathFile(
        file=file,
        parts=[_read_part(item) for item in root.get("parts").items()],
        coordinates=coordinates,
        limits={name: _read_limit(item) for name, item in root.get("limits").entries()},
        grippers={name: _read_gripper(item) for name, item in documents.get("grippers", {}).entries()},
        handles={name: _read_handle(item) for name, item in documents.get("handles", {}).entries()},
        surfaces={name: _read_surface(item) for name, item in documents.get("surfaces", {}).entries()},
        ignored_pairs=[_read_ignored(item) for item in root.get("ignored_pairs", []).items()],
        margins=[_read_margin(item) for item in root.get("margins", []).items()],
        placement_margin=root.get("placement_margin", 0.0).number(),
        rests=_read_rests(root.get("rests", None)),
        path_tolerance=certificate.get("path_tolerance", DEFAULT_PATH_TOLERANCE).number(),
        certificate=certificate.expect(dict, "an object"),
        segments=[
            _read_segment(index, item, len(coordinates), is_first)
            for index, item in enumerate(root.get("segments").items())
        ],
        rate_limits={name: _read_rates(item) for name, item in root.get("rate_limits", {}).entries()},
        events=None if is_first else [_read_event(item) for item in root.get("events", []).items()],
    )
    _refuse_other_versions(root, path, is_first)
    names = [part.name for part in path.parts]
    if len(set(names)) != len(names):
        root.get("parts").fail("a part is named twice")
    if not path.segments:
        root.get("segments").fail("a path has at least one segment")
    for name in path.limits:
        if name not in coordinates:
            root.get("limits").fail(f"{name!r} is no coordinate")
    return path


def _refuse_other_versions(root: _Node, path: PathFile, is_first: bool) -> None:
    """Keys of version 2 in a file of version 1, and what version 2 wants together."""
    if is_first:
        later = [key for key in LATER_KEYS if key in root.value]
        later += [f"certificate.{key}" for key in LATER_CLAIMS if key in path.certificate]
        if later:
            root.fail(f"{later[0]} belongs to version 2")
        return
    timed = [segment.times is not None for segment in path.segments]
    if any(timed) != all(timed):
        root.get("segments").fail("all segments have times, or none has")
    if any(timed) != ("rate_limits" in root.value):
        root.fail("rate_limits belong to a path with times")
    for name in path.rate_limits:
        if name not in path.coordinates:
            root.get("rate_limits").fail(f"{name!r} is no coordinate")
    for event in path.events:
        if not 1 <= event.segment < len(path.segments):
            root.get("events").fail(f"no segment {event.segment} begins with an event")
        if (event.time is not None) != all(timed):
            root.get("events").fail("events have times in a path with times, and only there")


def _read_rates(node: _Node) -> dict[str, float]:
    rates = {}
    for key, item in node.entries():
        if key not in RATES or not item.number() > 0.0:
            node.fail("a limit of velocity, acceleration or jerk is more than 0")
        rates[key] = item.number()
    return rates


def _read_event(node: _Node) -> Event:
    segment, dwell = node.get("segment"), node.get("dwell").number()
    if isinstance(segment.value, bool) or not isinstance(segment.value, int):
        segment.fail("the number of a segment expected")
    if dwell < 0.0:
        node.get("dwell").fail("seconds expected")
    return Event(
        time=None if "time" not in node.value else node.get("time").number(),
        dwell=dwell,
        segment=segment.value,
        kind=node.get("kind").text(("grasp", "release")),
        object=node.get("object").text(),
        gripper=node.get("gripper").text(),
        handle=node.get("handle").text(),
        fingers={name: item.number() for name, item in node.get("fingers", {}).entries()},
    )


def _read_json(file: Path):
    def refuse(constant):
        raise ValueError(f"{constant} is not a number")

    def without_duplicates(pairs):
        result = dict(pairs)
        if len(result) != len(pairs):
            keys = [key for key, _ in pairs]
            raise ValueError(f"key {next(key for key in keys if keys.count(key) > 1)!r} is given twice")
        return result

    try:
        text = file.read_text(encoding="utf-8")
        tree = json.loads(text, parse_constant=refuse, object_pairs_hook=without_duplicates)
    except (OSError, ValueError, RecursionError) as error:
        raise InputError(f"{file}: {error}") from error
    return tree


def _read_part(node: _Node) -> PartEntry:
    srdf = node.get("srdf", None)
    part = PartEntry(
        name=node.get("name").text(),
        kind=node.get("kind").text(KINDS),
        urdf=node.get("urdf").text(),
        srdf=None if srdf.value in (None, "") else srdf.text(),
        mimic=node.get("mimic", "follow").text(MIMIC),
        root=node.get("root").text(ROOTS),
        world_from_root=node.get("world_from_root", [0, 0, 0, 0, 0, 0, 1]).pose(),
        up_axis=node.get("mesh_up_axis", "as-written").text(UP_AXES),
    )
    if part.kind == "environment" and part.root != "fixed":
        node.fail("an environment never moves: its root is fixed")
    return part


def _read_limit(node: _Node) -> tuple[float, float]:
    low, high = (item.value if item.value is None else item.number() for item in _exactly(node, 2))
    limit = (-np.inf if low is None else low, np.inf if high is None else high)
    if limit[0] > limit[1]:
        node.fail(f"lower limit {low} above upper limit {high}")
    return limit


def _exactly(node: _Node, count: int) -> list[_Node]:
    items = node.items()
    if len(items) != count:
        node.fail(f"{count} entries expected, found {len(items)}")
    return items


def _read_gripper(node: _Node) -> Gripper:
    return Gripper(node.get("link").text(), node.get("link_from_gripper").pose())


def _read_handle(node: _Node) -> Handle:
    mask = node.get("mask", [True] * 6).mask()
    complement = node.get("mask_complement", [not row for row in mask]).mask()
    if sum(mask[3:]) == 1:
        node.fail("a mask with exactly one fixed rotation describes no grasp")
    return Handle(node.get("link").text(), node.get("link_from_handle").pose(), mask, complement)


def _read_surface(node: _Node) -> Surface:
    points = np.array([item.numbers(3) for item in node.get("points").items()]).reshape(-1, 3)
    polygons = []
    for item in node.get("polygons").items():
        indices = item.expect(list, "a list of point indices")
        inside = all(isinstance(index, int) and 0 <= index < len(points) for index in indices)
        if len(indices) < 3 or not inside:
            item.fail("at least three indices of points expected")
        polygons.append(indices)
    return Surface(node.get("link").text(), points, polygons)


def _read_ignored(node: _Node) -> tuple[str, str, str]:
    items = node.items()
    if len(items) not in (2, 3):
        node.fail("[link, link, reason] expected")
    return items[0].text(), items[1].text(), items[2].text() if len(items) == 3 else "no reason given"


def _read_margin(node: _Node) -> tuple[str, str, float]:
    first, second, margin = _exactly(node, 3)
    return first.text(), second.text(), margin.number()


def _read_segment(index: int, node: _Node, width: int, is_first: bool) -> Segment:
    knots = [item.numbers(width) for item in node.get("knots").items()]
    if not knots:
        node.get("knots").fail("a segment has at least one knot")
    times, velocities = node.get("times", None), node.get("velocities", None)
    if is_first and "velocities" in node.value:
        velocities.fail("belongs to version 2")
    if not is_first and (times.value is None) != (velocities.value is None):
        node.fail("has times without velocities, or velocities without times")
    rows = None if velocities.value is None else [item.numbers(width) for item in velocities.items()]
    if rows is not None and len(rows) != len(knots):
        velocities.fail(f"{len(rows)} rows for {len(knots)} knots")
    return Segment(
        index=index,
        transition=_optional_text(node.get("transition", "")),
        state=_optional_text(node.get("state", "")),
        attachments=[_read_attachment(item) for item in node.get("attachments", []).items() if not _only_rests(item)],
        constraints=[_read_constraint(item) for item in node.get("constraints", []).items()],
        knots=np.array(knots),
        times=None if times.value is None else times.numbers(len(knots)),
        velocities=None if rows is None else np.array(rows),
    )


def _optional_text(node: _Node) -> str:
    return "" if node.value is None else str(node.value)


def _only_rests(node: _Node) -> bool:
    """Whether an attachment names nothing but its object, which then stays where it is."""
    return not any(key in node.expect(dict, "an object") for key in ("gripper", "handle", "surface", "support", "on"))


def _read_attachment(node: _Node) -> Attachment:
    carrier = node.get("carrier", False).expect(bool, "a boolean")
    name = node.get("object").text()
    if "gripper" in node.value:
        return Attachment(name, carrier, gripper=node.get("gripper").text(), handle=node.get("handle").text())
    if "on" in node.value:
        return Attachment(name, carrier, on=node.get("on").text())
    return Attachment(name, carrier, surface=node.get("surface").text(), support=node.get("support").text())


def _read_constraint(node: _Node) -> Constraint:
    kind, value = node.get("kind").text(), node.get("value", None)
    mask = _full_mask(kind, node.get("mask", [False] * 6 if "of_mass" in kind else [True] * 6).mask((3, 6)))
    inequality = _full_mask(kind, _or_default(node.get("inequality", None), [False] * 6).mask((3, 6)))
    if any(sided and not counts for counts, sided in zip(mask, inequality)):
        node.get("inequality").fail("rows that the mask leaves out")
    return Constraint(
        kind=kind,
        name=_optional_text(node.get("name", "")),
        frame=_read_frame(node.get("frame", None)),
        to=_read_frame(node.get("to", None)),
        mask=mask,
        inequality=inequality,
        value=None if value.value is None else _read_value(value),
        parts=[item.text() for item in node.get("parts", []).items()],
        planes=[_read_plane(item) for item in node.get("planes", []).items()],
        height=_optional_number(node.get("height", None)),
        length=_optional_number(node.get("length", None)),
        bound=_or_default(node.get("bound", None), "equal").text(BOUNDS),
        joint=None if node.get("joint", None).value is None else node.get("joint").text(),
        position=_optional_number(node.get("position", None)),
        within=_optional_number(node.get("within", None)),
        tolerance=_optional_number(node.get("tolerance", None)),
    )


def _full_mask(kind: str, mask: list[bool]) -> list[bool]:
    """Six rows; a mask of three belongs to the constraint's only kind of rows."""
    if len(mask) == 3:
        mask = [False] * 3 + mask if kind == "orientation" else mask + [False] * 3
    if kind == "position" or kind.endswith("of_mass"):
        return mask[:3] + [False] * 3
    return [False] * 3 + mask[3:] if kind == "orientation" else mask


def _or_default(node: _Node, default) -> _Node:
    return _Node(default, node.where) if node.value is None else node


def _optional_number(node: _Node) -> float | None:
    return None if node.value is None else node.number()


def _read_frame(node: _Node) -> Frame | None:
    if node.value is None or isinstance(node.value, str):
        return None if node.value is None else Frame(node.value)
    return Frame(node.get("link").text(), node.get("pose").pose())


def _read_plane(node: _Node) -> Plane:
    normal = node.get("normal").numbers(3)
    if abs(np.linalg.norm(normal) - 1.0) > 1e-6:
        node.get("normal").fail("not of unit length")
    inequality = node.get("inequality", False).expect(bool, "a boolean")
    return Plane(normal, node.get("offset").number(), inequality)


def _read_value(node: _Node) -> np.ndarray:
    """A pose, or a position (then with no rotation)."""
    if isinstance(node.value, list) and len(node.value) == 3:
        return np.concatenate([node.numbers(3), [0.0, 0.0, 0.0, 1.0]])
    return node.pose()
