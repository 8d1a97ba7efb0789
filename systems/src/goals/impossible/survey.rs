//! All grasps of an object where it starts or where a goal has it: inverse kinematics from many configurations, and what collides in those
//! that are found. Other objects that may be moved are no obstacles here.
//!
//! It is evidence and no proof: as many tries as are made, from random configurations. A survey ends with the first grasp that is possible.

use crate::events::StopSignal;
use crate::goals::impossible::beyond::Limits;
use crate::goals::impossible::hindrance::{Blocked, Hindrance, OutOfReach, Shortfall};
use crate::goals::impossible::moves::grasps_of;
use crate::goals::impossible::site::Site;
use crate::goals::impossible::tries::{solve, widened};
use crate::goals::programs::GoalProgram;
use crate::planning_model::model::{Model, PlanningModel};
use crate::settings::SearchSettings;
use foliate_components::constraint::Frame;
use foliate_components::graph::{State, StateId};
use foliate_components::infeasibility::ObjectPlace;
use foliate_components::robot::{GripperIndex, HandleIndex, Joint, JointType, PartKind, ShapeIndex, Source};
use foliate_kernels::collision::CollisionScratch;
use foliate_kernels::constrained_motion::Scratch;
use foliate_kernels::constraints;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Tries for each grasp at first.
const TRIES: u32 = 32;
/// Tries for each grasp before anything is said, and most of all grasps together.
const MORE_TRIES: u32 = 128;
const ALL_TRIES: u32 = 4096;
/// Tries for a grasp of which only configurations were found in which something collides; no more where there are so many of those.
const BLOCKED_TRIES: u32 = 512;
const ENOUGH_BLOCKED: u64 = 512;
/// Configurations of which all pairs that collide are counted; of the others one is enough.
const COMPARED: u64 = 64;
/// Of objects with more grasps nothing is said.
const MOST_GRASPS: usize = 256;
/// So near a bound a joint is at it, radians and metres.
const AT_LIMIT: f64 = 1e-4;

/// What seems to keep every hand from an object where it starts, or from each place where goals have it. `None` where a grasp is possible,
/// where not all grasps can be tried, where something else than a hand may move the object there, and where the stop signal is raised.
#[must_use]
pub fn why_not_held(
    model: &PlanningModel,
    (settings, stop): (&SearchSettings, &StopSignal),
    start: &[f64],
    object: usize,
    place: ObjectPlace,
) -> Option<Hindrance> {
    let sites = match place {
        ObjectPlace::Start => vec![Site::at_start(model, start, object)?],
        ObjectPlace::Goal => Site::at_goals(model, start, object)?,
    };
    let mut first = None;
    for site in &sites {
        let mut survey = Survey::new(model, settings, stop, site, object)?;
        let hindrance = survey.hindrance()?;
        first.get_or_insert(hindrance);
    }
    first.filter(|_| !stop.is_raised())
}

/// The grasps of an object at a site, and what came of the tries.
pub(crate) struct Survey<'a> {
    model: &'a PlanningModel,
    settings: &'a SearchSettings,
    stop: &'a StopSignal,
    site: &'a Site,
    object: usize,
    pub grasps: Vec<GraspTries>,
    /// Pairs of shapes, and parts that robots meet, over the configurations that were compared.
    pairs: BTreeMap<(ShapeIndex, ShapeIndex), u64>,
    obstacles: BTreeMap<String, u64>,
    compared: u64,
    collision: CollisionScratch,
}

/// The tries of one grasp.
pub(crate) struct GraspTries {
    state: StateId,
    pub grasp: (GripperIndex, HandleIndex),
    /// Compiled when it is first tried; none where grasp and site contradict each other.
    program: Option<Option<GoalProgram>>,
    tries: u32,
    /// Configurations with the hand at the object in which something collides.
    blocked: u64,
    /// How near a try came, metres, and its configuration.
    nearest: Option<(f64, Vec<f64>)>,
    /// A configuration in which nothing collides.
    pub free: Option<Vec<f64>>,
}

impl<'a> Survey<'a> {
    /// `None` where not all grasps of the object are states of their own, or there are too many.
    pub(crate) fn new(
        model: &'a PlanningModel,
        settings: &'a SearchSettings,
        stop: &'a StopSignal,
        site: &'a Site,
        object: usize,
    ) -> Option<Self> {
        let handles = &model.graph.objects[object].handles;
        let is_own = |state: &State| matches!(&state.grasps[..], [(_, handle)] if handles.contains(handle));
        let states = || model.graph.states_of_nodes().filter(|(_, state)| is_own(state));
        let grasp = |(state, record): (StateId, &State)| GraspTries {
            state,
            grasp: record.grasps[0],
            program: None,
            tries: 0,
            blocked: 0,
            nearest: None,
            free: None,
        };
        if states().count() > MOST_GRASPS {
            return None;
        }
        let grasps: Vec<_> = states().map(grasp).collect();
        let is_tried = |wanted: &_| grasps.iter().any(|tries| tries.grasp == *wanted);
        let is_whole = !grasps.is_empty() && all_grasps(model, object).iter().all(is_tried);
        let collision = CollisionScratch::at_level(settings.level);
        let (pairs, obstacles) = (BTreeMap::new(), BTreeMap::new());
        let survey = Self { model, settings, stop, site, object, grasps, pairs, obstacles, compared: 0, collision };
        is_whole.then_some(survey)
    }

    /// What keeps every hand from the object; `None` where a grasp is possible.
    fn hindrance(&mut self) -> Option<Hindrance> {
        let all = self.grasps.len();
        let more = (ALL_TRIES / all.max(1) as u32).clamp(TRIES, MORE_TRIES);
        for tries in [TRIES, more] {
            if (0..all).any(|grasp| self.attempt(grasp, tries, u64::MAX)) {
                return None;
            }
        }
        for grasp in 0..all {
            if self.grasps[grasp].blocked > 0 && self.attempt(grasp, BLOCKED_TRIES, ENOUGH_BLOCKED) {
                return None;
            }
        }
        match self.blocked() {
            0 => self.out_of_reach().map(Hindrance::OutOfReach),
            _ => self.what_blocks().map(Hindrance::Blocked),
        }
    }

    /// Which grasps are possible at the site, by [`Self::grasps`]; each is tried often before it is given up.
    pub(crate) fn possible(&mut self) -> Vec<bool> {
        (0..self.grasps.len()).map(|grasp| self.attempt(grasp, MORE_TRIES, u64::MAX)).collect()
    }

    /// Whether the search was told to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.is_raised()
    }

    /// The place where a configuration has the object.
    pub(crate) fn where_it_is(&self, q: &[f64]) -> Option<Site> {
        Site::at(self.model, q, self.object)
    }

    /// The same grasps at another site.
    pub(crate) fn elsewhere<'b>(&self, site: &'b Site) -> Option<Survey<'b>>
    where
        'a: 'b,
    {
        Survey::new(self.model, self.settings, self.stop, site, self.object)
    }

    fn blocked(&self) -> u64 {
        self.grasps.iter().map(|grasp| grasp.blocked).sum()
    }

    /// Tries a grasp until it has had so many tries, or something collided so often; whether it is possible.
    pub(crate) fn attempt(&mut self, number: usize, tries: u32, enough: u64) -> bool {
        let Some(program) = self.take_program(number) else { return false };
        let mut scratch = Scratch::default();
        while self.grasps[number].free.is_none()
            && self.grasps[number].tries < tries
            && self.blocked() < enough
            && !self.stop.is_raised()
        {
            let (state, try_number) = (self.grasps[number].state, self.grasps[number].tries);
            let found = solve(self.model, self.settings, &program, (&self.site.q, state, try_number), &mut scratch);
            self.grasps[number].tries += 1;
            match found {
                (q, true) if self.is_blocked(state, &q) => self.grasps[number].blocked += 1,
                (q, true) => self.grasps[number].free = Some(q),
                (q, false) => {
                    let off = self.off(self.grasps[number].grasp, &q);
                    let nearest = &mut self.grasps[number].nearest;
                    if nearest.as_ref().is_none_or(|(least, _)| off < *least) {
                        *nearest = Some((off, q));
                    }
                }
            }
        }
        self.grasps[number].program = Some(Some(program));
        self.grasps[number].free.is_some()
    }

    /// The program of a grasp; what is not put back is compiled again.
    fn take_program(&mut self, number: usize) -> Option<GoalProgram> {
        let (model, settings, site) = (self.model, self.settings, self.site);
        let tries = &mut self.grasps[number];
        let compile = || GoalProgram::new(model, settings, &site.goal, &site.q, tries.state, true).ok();
        let program = tries.program.take().unwrap_or_else(compile);
        if program.is_none() {
            tries.program = Some(None);
        }
        program
    }

    /// Whether a robot collides with anything but objects that may be moved, itself and the object included.
    fn is_blocked(&mut self, state: StateId, q: &[f64]) -> bool {
        let model = self.model;
        let X_WJ = model.kinematics.poses(q);
        let guard = self.settings.clearance_guard;
        if model.first_collision(state, &X_WJ, guard, &mut self.collision).is_none() {
            return false;
        }
        let robot = &model.problem.robot;
        let part_of = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].part;
        let own = model.graph.objects[self.object].part;
        let may_move = |part| part != own && model.graph.objects.iter().any(|object| object.part == part);
        let contacts = model.all_collisions(state, &X_WJ, guard);
        let pairs = contacts.iter().map(|contact| model.pair_shapes(contact.pair));
        let in_the_way = pairs.filter_map(|(a, b)| {
            let parts = (part_of(a), part_of(b));
            let (is_a, is_b) = (robot[parts.0].kind == PartKind::Robot, robot[parts.1].kind == PartKind::Robot);
            let counts = (is_a || is_b) && !may_move(parts.0) && !may_move(parts.1);
            let met = if is_a { parts.1 } else { parts.0 };
            counts.then_some(((a, b), met))
        });
        let in_the_way: Vec<_> = in_the_way.collect();
        if self.compared < COMPARED && !in_the_way.is_empty() {
            self.compared += 1;
            let mut met: Vec<_> = in_the_way.iter().map(|(_, part)| *part).collect();
            met.sort_unstable();
            met.dedup();
            met.into_iter().for_each(|part| *self.obstacles.entry(robot[part].name.clone()).or_default() += 1);
            in_the_way.iter().for_each(|(pair, _)| *self.pairs.entry(*pair).or_default() += 1);
        }
        !in_the_way.is_empty()
    }

    /// A configuration for a grasp in which nothing collides, by the number of the try.
    pub(crate) fn draw(&mut self, number: usize, try_number: u32) -> Option<Vec<f64>> {
        let (state, program) = (self.grasps[number].state, self.take_program(number)?);
        let scratch = &mut Scratch::default();
        let (q, is_converged) = solve(self.model, self.settings, &program, (&self.site.q, state, try_number), scratch);
        self.grasps[number].program = Some(Some(program));
        (is_converged && !self.is_blocked(state, &q)).then_some(q)
    }

    /// How far a try that failed is off: the gripper from the handle, or the object in the gripper from where it shall lie, metres.
    fn off(&self, (gripper, handle): (GripperIndex, HandleIndex), q: &[f64]) -> f64 {
        let robot = &self.model.problem.robot;
        if let Some(lies) = &self.site.lies {
            return constraints::residual(robot, lies, q, &self.model.kinematics.poses(q));
        }
        let (gripper, handle) = (&robot.grippers[gripper.at()], &robot.handles[handle.at()]);
        let place = |frame: Frame, q: &[f64]| {
            let on = frame.joint.map_or_else(Default::default, |joint| self.model.kinematics.poses(q)[joint.at()]);
            (on * frame.joint_from_frame).translation
        };
        let hand = place(Frame::on_link(robot, gripper.link, &gripper.link_from_gripper), q);
        hand.distance(place(Frame::on_link(robot, handle.link, &handle.link_from_handle), &self.site.q))
    }

    /// The grasp that needs least beyond a joint limit, else the one that comes nearest.
    fn out_of_reach(&self) -> Option<OutOfReach> {
        let robot = &self.model.problem.robot;
        let told = |(gripper, handle): (GripperIndex, HandleIndex), shortfall, at_limits| OutOfReach {
            gripper: robot.grippers[gripper.at()].name.clone(),
            handle: robot.handles[handle.at()].name.clone(),
            shortfall,
            at_limits,
        };
        let wide = Model::with_graph(widened(&self.model.problem), self.model.graph.clone()).ok()?;
        let wide = PlanningModel(Arc::new(wide));
        let limits = Limits { model: self.model, wide: &wide, settings: self.settings, stop: self.stop };
        let beyond = self.grasps.iter().filter_map(|tries| {
            let (excess, shortfall) = limits.beyond(self.site, tries.state)?;
            Some((excess, told(tries.grasp, shortfall, Vec::new())))
        });
        let least = beyond.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, told)| told);
        least.or_else(|| {
            let missed = self.grasps.iter().filter_map(|tries| Some((tries.nearest.as_ref()?, tries.grasp)));
            let (&(distance, ref q), grasp) = missed.min_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
            let shortfall = match self.site.lies {
                Some(_) => Shortfall::Support(distance),
                None => Shortfall::Distance(distance),
            };
            Some(told(grasp, shortfall, self.at_limits(q)))
        })
    }

    /// The robots' coordinates that are at a bound.
    fn at_limits(&self, q: &[f64]) -> Vec<String> {
        let robot = &self.model.problem.robot;
        let of_robot = |joint: &&Joint| robot[joint.part].kind == PartKind::Robot && !joint.is_immovable();
        let at_limit = |joint: &Joint| {
            let Source::Coordinates { q: index, .. } = joint.source else { return None };
            let is_one = matches!(joint.motion, JointType::Revolute { .. } | JointType::Prismatic { .. });
            let is_locked = self.model.locked.iter().any(|&(locked, _)| locked == index);
            let (low, high) = (robot.space.lower[index], robot.space.upper[index]);
            let is_at = (q[index] - low).abs() < AT_LIMIT || (high - q[index]).abs() < AT_LIMIT;
            (is_one && is_at && !is_locked).then(|| joint.name.clone())
        };
        robot.joints.iter().filter(of_robot).filter_map(at_limit).collect()
    }

    fn what_blocks(&self) -> Option<Blocked> {
        let robot = &self.model.problem.robot;
        let name = |shape: ShapeIndex| robot.shapes[shape.at()].name.clone();
        let link = |shape: ShapeIndex| robot.links[robot.shapes[shape.at()].link.at()].name.clone();
        let (obstacle, &meets_obstacle) = self.obstacles.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0)))?;
        let (&(a, b), _) = self.pairs.iter().max_by(|a, b| a.1.cmp(b.1).then(b.0.cmp(a.0)))?;
        Some(Blocked {
            obstacle: obstacle.clone(),
            meets_obstacle,
            compared: self.compared,
            configurations: self.blocked(),
            shapes: (name(a), name(b)),
            links: (link(a), link(b)),
            grasps: self.grasps.len(),
            out_of_reach: self.grasps.iter().filter(|grasp| grasp.blocked == 0).count(),
        })
    }
}

/// The grasps of an object that may occur: those of the states, and where not all of these are known those that are allowed.
fn all_grasps(model: &Model, object: usize) -> Vec<(GripperIndex, HandleIndex)> {
    if !model.graph.lazy {
        return grasps_of(&model.graph, object);
    }
    let options = &model.problem.graph;
    let handles = &model.graph.objects[object].handles;
    let all = options.grippers.iter().flat_map(|&gripper| handles.iter().map(move |&handle| (gripper, handle)));
    all.filter(|pair| options.grasps.as_ref().is_none_or(|table| table.contains(pair))).collect()
}
