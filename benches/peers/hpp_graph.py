"""The constraint graph of a scene in HPP, built by its own factory, and problem and planner on top of it."""

from __future__ import annotations

import re

import numpy as np
import pinocchio
import pyhpp.constraints
import pyhpp.core
import pyhpp.manipulation
from pyhpp.constraints import ComparisonType, ComparisonTypes, Implicit, LockedJoint
from pyhpp.manipulation.constraint_graph_factory import ConstraintGraphFactory, Rule
from pyhpp.manipulation.security_margins import SecurityMargins

from hpp_problem import HppModel, project_paths, se3, validate_paths
from scene_file import Relation, SceneError
from settings import BIRRT, DIFFUSING, MRRT, SPF, STATES_PATH_FINDER, Settings

IN_PLANE = [False, False, True, True, True, False]
ALONG_PLANE = [not row for row in IN_PLANE]


class HppProblem:
    """A problem ready to be solved: `planner(solver)` makes one of HPP's planners for it."""

    def __init__(self, model: HppModel, settings: Settings):
        self.model, self.settings = model, settings
        self.moved = 0.0
        """How far projecting start and goal has moved a coordinate (rad or m)."""
        self.start, self.goal = model.to_hpp(model.scene.start), model.to_hpp(model.scene.goal)
        if model.scene.manipulates:
            self.problem = pyhpp.manipulation.Problem(model.device)
            self._state_manipulation()
        else:
            self.problem = pyhpp.core.Problem(model.device.asPinDevice())
            self._state_motion()
        self.problem.initConfig(self.start)
        self.problem.addGoalConfig(self.goal)

    def planner(self, solver: str):
        if solver == MRRT:
            return pyhpp.manipulation.ManipulationPlanner(self.problem)
        if solver == SPF:
            for name, value in STATES_PATH_FINDER.items():
                self.problem.setParameter(name, value)
            return pyhpp.manipulation.StatesPathFinder(self.problem)
        if solver == DIFFUSING:
            return pyhpp.core.DiffusingPlanner(self.problem)
        if solver == BIRRT:
            return pyhpp.core.BiRRTPlanner(self.problem)
        raise SceneError(f"no solver {solver!r}")

    # Motion planning

    def _state_motion(self) -> None:
        validate_paths(self.problem, self.model.device.asPinDevice(), self.settings)
        relations = self._relations() + self._locked()
        if relations:
            # In the core these two are attributes, where the graph has methods.
            self.problem.errorThreshold = self.settings.threshold
            self.problem.maxIterProjection = self.settings.iterations
            self.problem.addNumericalConstraintsToConfigProjector("everywhere", relations, [0] * len(relations))
        project_paths(self.problem, self.settings, pyhpp.core)
        if relations:
            self.start, self.goal = self._projected(self.start), self._projected(self.goal)

    def _projected(self, configuration: np.ndarray) -> np.ndarray:
        reached, projected, error = self.problem.applyConstraints(configuration)
        if not reached:
            raise SceneError(f"HPP cannot project start or goal, error {error}")
        self.moved = max(self.moved, float(np.abs(projected - configuration).max()))
        return projected

    # Manipulation

    def _state_manipulation(self) -> None:
        scene, settings = self.model.scene, self.settings
        graph = pyhpp.manipulation.Graph("graph", self.model.device, self.problem)
        graph.errorThreshold(settings.threshold)
        graph.maxIterations(settings.iterations)
        planes = {name: entry for name, entry in scene.objects.items() if entry.plane is not None}
        constraints: dict = {}
        for name, entry in planes.items():
            constraints |= self._rests_on_plane(graph, name, entry.plane)
        for name, entry in scene.objects.items():
            if entry.surfaces and scene.supports:
                constraints |= self._rests_on_surfaces(graph, name, entry.surfaces)
        validate_paths(self.problem, self.model.device, settings)
        project_paths(self.problem, settings, self._projector_module())
        factory = self._factory(graph, constraints)
        everywhere = self._locked() + self._relations()
        if everywhere:
            graph.addNumericalConstraintsToGraph(everywhere)
        for transition, weight in settings.weights:
            graph.setWeight(graph.getTransition(transition), weight)
        if settings.lift_straight:
            self._lift_straight(graph, factory, planes, constraints)
        if settings.margin:
            parts = [part.name for part in scene.parts if part.kind != "environment"]
            margins = SecurityMargins(self.problem, factory, parts, self.model.device)
            margins.defaultMargin = settings.margin
            margins.apply()
        graph.initialize()
        project_paths(self.problem, settings, self._projector_module())
        self.problem.constraintGraph(graph)
        self.graph, self.factory = graph, factory
        self.start, self.goal = self._in_a_state(self.start), self._in_a_state(self.goal)

    def _projector_module(self):
        """The scripts make the projector in `pyhpp.manipulation` where a plane holds objects, else in `pyhpp.core`."""
        planes = any(entry.plane is not None for entry in self.model.scene.objects.values())
        return pyhpp.manipulation if planes and not self.settings.sequence else pyhpp.core

    def _factory(self, graph, constraints: dict) -> ConstraintGraphFactory:
        scene = self.model.scene
        factory = ConstraintGraphFactory(graph, constraints)
        factory.setGrippers(scene.grippers)
        if scene.supports:
            factory.environmentContacts(scene.supports)
        factory.setObjects(
            list(scene.objects),
            [entry.handles for entry in scene.objects.values()],
            [entry.surfaces for entry in scene.objects.values()],
        )
        for name in scene.objects:
            factory.setPreplacementDistance(name, scene.preplacement_distance)
        if self.settings.sequence:
            factory.setRules([_only(dict(grasps), scene.grippers) for grasps in self.settings.sequence])
        else:
            if scene.grasps:
                factory.setPossibleGrasps(scene.grasps)
            if scene.rules:
                factory.setRules([_rule(rule.when, rule.allow) for rule in scene.rules])
        factory.generate()
        return factory

    def _rests_on_surfaces(self, graph, name: str, surfaces: list[str]) -> dict:
        """As the factory would, with the scene's margin: objects start 1 mm above their support, as in the scripts until
        2025, and the factory's own margin of 0.1 mm would put them outside of the leaf."""
        scene = self.model.scene
        place, complement, hold = graph.createPlacementConstraint(
            f"place_{name}", surfaces, scene.supports, scene.placement_margin
        )
        preplace = graph.createPrePlacementConstraint(
            f"preplace_{name}", surfaces, scene.supports, scene.preplacement_distance, scene.placement_margin
        )
        return {
            f"place_{name}": place,
            f"place_{name}/complement": complement,
            f"place_{name}/hold": hold,
            f"preplace_{name}": preplace,
        }

    def _rests_on_plane(self, graph, name: str, plane: list[float]) -> dict:
        """Placement, complement, both at once, and preplacement of an object without faces."""
        device, joint = self.model.device, self.model.model.getJointId(f"{name}/root_joint")
        above = [*plane[:2], plane[2] + self.model.scene.preplacement_distance, *plane[3:]]

        def relation(title: str, pose: list[float], mask: list[bool], kind) -> Implicit:
            function = pyhpp.constraints.Transformation(title, device, joint, pinocchio.SE3.Identity(), se3(pose), mask)
            return Implicit(function, _comparisons([kind] * 3), [True] * 3)

        zero, frozen = ComparisonType.EqualToZero, ComparisonType.Equality
        place = relation(f"place_{name}", plane, IN_PLANE, zero)
        complement = relation(f"place_{name}/complement", plane, ALONG_PLANE, frozen)
        both = [frozen if along else zero for along in ALONG_PLANE]
        hold = LockedJoint(device, f"{name}/root_joint", np.array(plane), _comparisons(both))
        graph.registerConstraints(place, complement, hold)
        return {
            f"place_{name}": place,
            f"place_{name}/complement": complement,
            f"place_{name}/hold": hold,
            f"preplace_{name}": relation(f"preplace_{name}", above, IN_PLANE, zero),
        }

    def _lift_straight(self, graph, factory, planes: dict, constraints: dict) -> None:
        """Transitions between where a grasp meets a placement and the preplacement above it, both ways."""
        for name in planes:
            complement = [constraints[f"place_{name}/complement"]]
            for transition in graph.getTransitionNames():
                lifts = re.fullmatch(rf"\S+ > {re.escape(name)}/\S+ \| \S+_23", transition)
                lowers = re.fullmatch(rf"\S+ < {re.escape(name)}/\S+ \| \S+_32", transition)
                if lifts or lowers:
                    graph.addNumericalConstraintsToTransition(graph.getTransition(transition), complement)

    def _in_a_state(self, configuration: np.ndarray) -> np.ndarray:
        """A configuration projected on the state that holds most of it: what holds already stays as it is."""
        tried = []
        for name in self._states_by_grasps():
            reached, projected, error = self.graph.applyStateConstraints(self.graph.getState(name), configuration)
            moved = float(np.abs(projected - configuration).max())
            if reached and moved < self.settings.may_move:
                self.moved = max(self.moved, moved)
                return projected
            tried.append(f"{name}: {'moved by' if reached else 'error'} {moved if reached else error:.2g}")
        raise SceneError(f"HPP finds start or goal in no state of the graph ({'; '.join(tried)})")

    def _states_by_grasps(self) -> list[str]:
        """The states that are no waypoints, those with most grasps first."""
        names = [name for name in self.graph.getStateNames() if "|" not in name]
        return sorted(names, key=lambda name: (-name.count(" grasps "), name))

    # What both have

    def _locked(self) -> list:
        locks = []
        for name, value in self.model.scene.locked.items():
            if isinstance(value, list):
                x, y, theta = value
                locks.append(LockedJoint(self.model.device, name, np.array([x, y, np.cos(theta), np.sin(theta)])))
            else:
                locks.append(LockedJoint(self.model.device, name, np.array([float(value)])))
        return locks

    def _relations(self) -> list:
        return [self._relation(relation) for relation in self.model.scene.everywhere]

    def _relation(self, relation: Relation) -> Implicit:
        """Every value is the one of the start."""
        joint, joint_from_frame = self.model.joint_of(relation.frame)
        here = self.model.pose_of(relation.frame, self.start)
        if relation.kind == "centre_of_mass":
            return self._centre_of_mass(relation, joint, here * joint_from_frame.inverse())
        device = self.model.device
        if relation.to is None:
            function = pyhpp.constraints.Transformation(
                relation.name, device, joint, joint_from_frame, here, relation.mask
            )
        else:
            other, other_from_frame = self.model.joint_of(relation.to)
            there = self.model.pose_of(relation.to, self.start)
            function = pyhpp.constraints.RelativeTransformation(
                relation.name, device, other, joint, other_from_frame * there.inverse() * here, joint_from_frame,
                relation.mask,
            )
        rows = sum(relation.mask)
        return Implicit(function, _comparisons([ComparisonType.EqualToZero] * rows), [True] * rows)

    def _centre_of_mass(self, relation: Relation, joint: int, world_from_joint: pinocchio.SE3) -> Implicit:
        """Of the frame's part alone, told in the joint that carries the frame. HPP 9.0.2 takes for a subtree the joints up
        to the root's last *direct* child (Romeo: legs and trunk, 33 of 41 kg), so this keeps another point than it says;
        there is no other constraint in pyhpp that would keep the right one."""
        part = relation.frame.partition("/")[0]
        self.problem.addPartialCom(part, [f"{part}/root_joint"])
        self.model.device.getJointsPosition(self.start, [f"{part}/root_joint"])  # brings the centre of mass up to date
        self.model.device.currentConfiguration(self.start)
        centre = world_from_joint.inverse().act(np.array(self.problem.getPartialCom(part)))
        return self.problem.createRelativeComConstraint(
            relation.name, part, self.model.model.names[joint], centre, relation.mask
        )


def _comparisons(kinds: list) -> ComparisonTypes:
    comparisons = ComparisonTypes()
    comparisons[:] = tuple(kinds)
    return comparisons


def _rule(when: dict[str, str], allow: bool) -> Rule:
    """HPP reads names as regular expressions that match from the beginning."""
    grippers = [f"^{re.escape(gripper)}$" for gripper in when]
    return Rule(grippers, [f"^{re.escape(handle)}$" for handle in when.values()], allow)


def _only(grasps: dict[str, str], grippers: list[str]) -> Rule:
    """Allows one state: these grasps and no other."""
    return _rule({gripper: grasps.get(gripper, "") for gripper in grippers}, True)
