//! What does a knot of a motion on a leaf cost, the motion alone and beside others?

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement};
use foliate_benches::humanoid::Humanoid;
use foliate_benches::{criterion, one_thread};
use foliate_components::Pose;
use foliate_components::robot::configuration::ConfigurationSpace;
use foliate_kernels::constrained_motion::{
    ConstraintProgram, MotionEnd, MotionJob, MotionScratch, MotionSettings, project_motion, project_motions,
};
use foliate_kernels::kinematics::Kinematics;
use std::time::Instant;

/// Motions; a multiple of all crowds.
const MOTIONS: usize = 48;

/// The motions to follow.
struct Bench<'a> {
    program: &'a ConstraintProgram,
    space: &'a ConfigurationSpace,
    ends: Vec<(&'a [f64], &'a [f64])>,
    settings: MotionSettings,
}

impl Bench<'_> {
    /// Follows all motions, so many at once (none: each alone, in scalar code); how many arrive, and their knots.
    fn walk(&self, crowd: Option<usize>, scratch: &mut MotionScratch, knots: &mut [Vec<f64>]) -> (usize, usize) {
        let Self { program, space, ends, settings } = self;
        knots.iter_mut().for_each(Vec::clear);
        let arrived = match crowd {
            None => ends
                .iter()
                .zip(knots.iter_mut())
                .map(|(&ends, knots)| project_motion(program, space, ends, &[], settings, scratch, knots))
                .filter(|end| *end == MotionEnd::Reached)
                .count(),
            Some(crowd) => {
                let jobs = ends.iter().zip(knots.iter_mut());
                let mut jobs: Vec<_> = jobs.map(|(&ends, knots)| MotionJob::new(ends, &[] as &[Pose], knots)).collect();
                for crowd in jobs.chunks_mut(crowd) {
                    project_motions(program, space, crowd, settings, scratch);
                }
                jobs.iter().filter(|job| job.end == MotionEnd::Reached).count()
            }
        };
        (arrived, knots.iter().map(|knots| knots.len() / space.size()).sum())
    }

    fn measure(&self, group: &mut BenchmarkGroup<'_, measurement::WallTime>, crowd: Option<usize>) {
        let (mut scratch, mut knots) = (MotionScratch::default(), vec![Vec::new(); self.ends.len()]);
        let (mut best, mut counts) = (f64::INFINITY, (0, 0));
        for _ in 0..20 {
            let started = Instant::now();
            counts = self.walk(crowd, &mut scratch, &mut knots);
            best = best.min(started.elapsed().as_secs_f64());
        }
        let name = crowd.map_or("alone, scalar code".to_owned(), |crowd| format!("{crowd} in lanes"));
        println!(
            "{name}: {} of {MOTIONS} arrive, {} knots, {:.2} us a knot",
            counts.0,
            counts.1,
            best * 1e6 / counts.1 as f64
        );
        group.throughput(Throughput::Elements(counts.1 as u64));
        group.bench_function(name, |b| b.iter(|| self.walk(crowd, &mut scratch, &mut knots)));
    }
}

fn bench_humanoid(c: &mut Criterion, humanoid: &Humanoid) {
    let kinematics = Kinematics::new(&humanoid.robot);
    let program = humanoid.program(&kinematics, true, false);
    let (solutions, _) = humanoid.solutions(&kinematics, &program, 0.2);
    let pairs = solutions.chunks_exact(2).take(MOTIONS);
    let bench = Bench {
        program: &program,
        space: &humanoid.robot.space,
        ends: pairs.map(|pair| (pair[0].as_slice(), pair[1].as_slice())).collect(),
        settings: MotionSettings::default(),
    };
    let (variables, rows) = program.equations();
    let mut group = c.benchmark_group(format!("motions/{} {variables}x{rows}", humanoid.name));
    for crowd in [None, Some(1), Some(2), Some(3), Some(8), Some(MOTIONS)] {
        bench.measure(&mut group, crowd);
    }
    group.finish();
}

fn bench(c: &mut Criterion) {
    one_thread();
    bench_humanoid(c, &Humanoid::sample());
    Humanoid::talos().iter().for_each(|talos| bench_humanoid(c, talos));
}

criterion_group! { name = benches; config = criterion(); targets = bench }
criterion_main!(benches);
