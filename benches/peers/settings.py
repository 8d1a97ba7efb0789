"""How HPP's public benchmarks set each problem up: what the scene file does not say.

Sources, all public: the scripts of github.com/humanoid-path-planner/hpp_benchmark, folder `future/` unless another
one is named (until 2025 for hpp-corbaserver), `2026/07-13/` (for pyhpp), `2016/08-29/`; hpp_tutorial 6.0.0
`script/tutorial_3.py`; agimus-demos `talos/pass_box_between_hands`. Where the two generations differ, the choice and its
reason stand in the entry.
"""

from __future__ import annotations

from dataclasses import dataclass

MRRT, SPF, DIFFUSING, BIRRT = "mrrt", "spf", "diffusing", "birrt"
MANIPULATION = (MRRT, SPF)

STATES_PATH_FINDER = {
    "StatesPathFinder/innerPlannerTimeOut": 0.0,
    "StatesPathFinder/innerPlannerMaxIterations": 100,
    "StatesPathFinder/nTriesUntilBacktrack": 3,
}
"""The same in every `*-spf` script, 2022 to 2026."""


@dataclass(frozen=True)
class Settings:
    """`validation`: kind and parameter of the path validation, None for HPP's default (Discretized, 0.05).
    `projector`: kind and step of the path projector, None for none. `threshold`: norm of a constraint's error below
    which it holds. `weights`: of transitions, by name. `lift_straight`: an object on a plane keeps its complement while
    it is lifted. `sequence`: the only states of the graph, each a set of grasps. `margin`: security margin (m).
    `may_move`: how far projecting start and goal on a state may move a coordinate (rad or m)."""

    source: str
    validation: tuple[str, float] | None = None
    projector: tuple[str, float] | None = None
    threshold: float = 1e-3
    iterations: int = 40
    weights: tuple[tuple[str, float], ...] = ()
    lift_straight: bool = False
    sequence: tuple[tuple[tuple[str, str], ...], ...] = ()
    margin: float = 0.0
    may_move: float = 1e-2
    solvers: tuple[str, ...] = MANIPULATION


_BAXTER = Settings(
    "baxter-manipulation-boxes (2016 to 2025): Dichotomy 0, no path projector. The pyhpp script of 2026/07-13 sets no "
    "validation, so samples every 0.05; the continuous one is the one that can be compared with a certificate",
    validation=("Dichotomy", 0.0),
)

_ASSEMBLY = (
    (),
    (("r0/gripper", "sphere0/handle"),),
    (("r0/gripper", "sphere0/handle"), ("r1/gripper", "cylinder0/handle")),
    (("r0/gripper", "sphere0/handle"), ("r1/gripper", "cylinder0/handle"), ("cylinder0/magnet0", "sphere0/magnet")),
    (("r1/gripper", "cylinder0/handle"), ("cylinder0/magnet0", "sphere0/magnet")),
    (("r1/gripper", "cylinder0/handle"), ("cylinder0/magnet0", "sphere0/magnet"), ("r0/gripper", "sphere1/handle")),
    (("r1/gripper", "cylinder0/handle"), ("cylinder0/magnet0", "sphere0/magnet"), ("r0/gripper", "sphere1/handle"),
     ("cylinder0/magnet1", "sphere1/magnet")),
    (("r1/gripper", "cylinder0/handle"), ("cylinder0/magnet0", "sphere0/magnet"),
     ("cylinder0/magnet1", "sphere1/magnet")),
    (("cylinder0/magnet0", "sphere0/magnet"), ("cylinder0/magnet1", "sphere1/magnet")),
)

SCENES: dict[str, Settings] = {
    "baxter-case1": _BAXTER,
    "baxter-case2": _BAXTER,
    "baxter-case3": _BAXTER,
    "baxter-case4": _BAXTER,
    "baxter-manipulation-boxes": _BAXTER,
    "romeo-placard": Settings(
        "romeo-placard, romeo-placard-spf: HPP's default validation (with Dichotomy 0 an iteration can take minutes while "
        "hands touch the pole), Progressive 0.05",
        projector=("Progressive", 0.05), threshold=2e-4,
    ),
    "ur3-spheres": Settings(
        "ur3-spheres, ur3-spheres-spf",
        validation=("Dichotomy", 0.0), projector=("Progressive", 0.01), threshold=1e-4, lift_straight=True,
    ),
    "pr2-manipulation-two-hand": Settings(
        "pr2-manipulation-two-hand, pr2-manipulation-two-hand-spf",
        validation=("Dichotomy", 0.0), projector=("Progressive", 0.2),
    ),
    "pr2-manipulation-kitchen": Settings(
        "pr2-manipulation-kitchen, pr2-manipulation-kitchen-spf: weight 1 for both loops",
        validation=("Dichotomy", 0.0), weights=(("Loop | f", 1), ("Loop | 0-0", 1)),
    ),
    "construction-set": Settings(
        "construction-set-mrrt: the graph has only the nine states of one assembly sequence (`--bigGraph` is not given)",
        validation=("Progressive", 0.02), projector=("Progressive", 0.05), threshold=1e-4, sequence=_ASSEMBLY,
        margin=0.02,
    ),
    "pr2-in-iai-kitchen": Settings(
        "pr2-in-iai-kitchen: motion planning, DiffusingPlanner; BiRRT beside it",
        validation=("Dichotomy", 0.0), solvers=(DIFFUSING, BIRRT),
    ),
    "pyrene-on-the-ground": Settings(
        "pyrene-on-the-ground: motion planning on one manifold, DiffusingPlanner, Progressive 0.2; HPP's BiRRT has no path "
        "projector. HPP's centre of mass is another one (README), and the goal moves by 0.037 onto its leaf",
        validation=("Dichotomy", 0.0), projector=("Progressive", 0.2), threshold=1e-4, iterations=20,
        may_move=0.05, solvers=(DIFFUSING,),
    ),
    "hpp-tutorial-3": Settings("hpp_tutorial script/tutorial_3.py: default validation, no projector"),
    "talos-pass-box": Settings(
        "agimus-demos pass_box_between_hands: default validation, Progressive 0.2. HPP's centre of mass is another one "
        "(README), and the goal moves by 0.076 rad onto its leaf",
        projector=("Progressive", 0.2), may_move=0.1,
    ),
}
"""In the order in which they are run."""

CANNOT_STATE: dict[str, str] = {
    "demo": "no public benchmark; primitive shapes of our own",
    "drawer": "no public benchmark; a drawer that only moves while it is held needs a graph of one's own",
    "stack": "no public benchmark; objects lie on other objects, which the graph factory does not build",
    "romeo-fridge-upright": "no public script; the door's state and both feet sliding need a graph of one's own",
    "talos-steps": "no public script for Talos; states of the problem's own (which feet stand), which the factory does not build",
    **dict.fromkeys(("panda-table", "panda-shelf", "panda-box", "panda-cage"),
                    "no public benchmark of HPP; plain motion planning of our own, beside VAMP's figures in docs/benchmarks.md"),
}
"""Scenes that count in no ratio, and why."""
