//! Published tasks: a shot off floor and wall, and a disc that is pushed at another. What is learnt
//! needs the derivatives of the times of impact: steps are divided at impacts.

use tangency_bench::scenes::{bank_shot, pushed_pair};
use tangency_core::{Param, SceneDef, StepRecord};
use tangency_diff::StateVector;

use crate::lab::resolved;
use crate::run::{Direction, Run};
use crate::{Case, Grade, Lab, Part, Relation, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V36",
    title: "Published tasks",
    parts: &[
        Part::new("(a) shot", shot),
        Part::new("(b) pushed disc", pushed),
        Part::new("(a) descent", descent),
        Part::new("(b) learned control", learns_straight),
        Part::new("(c) learned control", learns_around),
    ],
}];

const BALL: usize = 2;
const TARGET: [f64; 2] = [-2.0, 1.5];
const SHOT: f64 = 0.6;
const DT: f64 = 0.01;

/// Squared distance to the target, and its seed.
fn miss(run: &Run) -> (f64, StateVector) {
    let [dx, dy] = [run.last().q[BALL].x - TARGET[0], run.last().q[BALL].y - TARGET[1]];
    let seed = run.pick(|s| (s.q[BALL].x, s.q[BALL].y) = (2.0 * dx, 2.0 * dy));
    (dx * dx + dy * dy, seed)
}

fn thrown_at(velocity: [f64; 2]) -> SceneDef {
    let mut def = resolved(bank_shot(), DT);
    def.bodies[BALL].velocity = velocity;
    def
}

/// The times at which the ball left something, as its record has them.
fn impacts(run: &Run) -> Vec<f64> {
    let hit = |record: &&StepRecord| !record.contact_impulses().is_empty();
    run.parts().filter(hit).map(|record| record.after.time).collect()
}

fn shot(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&resolved(bank_shot(), DT), SHOT)?;
    let times = impacts(&run);
    lab.fine("(a) number of impacts", times.len() as f64, 2.0, 0.0);
    for (i, (found, exact)) in times.iter().zip([0.156_115_417_033, 0.43]).enumerate() {
        lab.fine(format!("(a) time of impact {}", i + 1), *found, exact, 1e-11);
    }
    let (loss, seed) = miss(&run);
    lab.fine("(a) loss", loss, 8.316_138_582_201_787, 1e-9);
    let wall = [(Param::Restitution(0), 1.0), (Param::Restitution(1), 1.0)];
    let all = [wall[0], wall[1], (Param::Restitution(BALL), 1.0)];
    let entries: [(&str, Direction<'_>, f64); 5] = [
        ("x0", &[(Param::Position(BALL, 0), 1.0)], -5.277_12),
        ("y0", &[(Param::Position(BALL, 1), 1.0)], 0.216_285_754_846_219_35),
        ("vx", &[(Param::Velocity(BALL, 0), 1.0)], -3.166_272),
        ("vy", &[(Param::Velocity(BALL, 1), 1.0)], -0.212_229_548_006_031_56),
        ("e", &all, -3.129_588_067_683_528_7),
    ];
    for (by, direction, exact) in entries {
        let slope = lab.slope(&run, &seed, direction)?;
        lab.impact(format!("(a) dL/d{by}"), slope, exact, 1e-6 * exact.abs());
    }
    let best = lab.run(&thrown_at([10.195_652_173_913_043, -4.090_710_091_067_452_6]), SHOT)?;
    lab.fine("(a) loss of the best throw", miss(&best).0, 0.0, 1e-9);
    Ok(())
}

/// 1000 steps at rate 0.01. Without the change of the times of impact they run to vx = −2.49.
fn descent(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let mut v = bank_shot().bodies[BALL].velocity;
    for _ in 0..1000 {
        let run = lab.run(&thrown_at(v), SHOT)?;
        let by = run.gradient(&miss(&run).1)?.by;
        for (axis, v) in v.iter_mut().enumerate() {
            *v -= 0.01 * by.by(&run.scene, Param::Velocity(BALL, axis));
        }
    }
    lab.impact("(a) descent, vx", v[0], 10.184_146_36, 1e-3);
    lab.impact("(a) descent, vy", v[1], -4.203_605_30, 1e-3);
    let end = lab.run(&thrown_at(v), SHOT)?;
    lab.impact("(a) descent, loss", miss(&end).0, 0.001_278_45, 1e-4);
    Ok(())
}

const STEPS: usize = 480;
const SECOND: usize = 1;

/// The 480 steps of the task.
fn pair(first: [f64; 2]) -> SceneDef {
    resolved(pushed_pair(first), 1.0 / STEPS as f64)
}

/// |x₂|² + weight · mean |u|², with its seed.
fn cost(run: &Run, controls: &[Vec<f64>], weight: f64) -> (f64, StateVector) {
    let at = run.last().q[SECOND].xy();
    let effort: f64 = controls.iter().flatten().map(|u| u * u).sum();
    let seed = run.pick(|s| (s.q[SECOND].x, s.q[SECOND].y) = (2.0 * at.x, 2.0 * at.y));
    (at.norm_squared() + weight * effort / STEPS as f64, seed)
}

/// Name, number by axis, and exact derivative.
type Component = (&'static str, fn(usize) -> Param, f64);

fn pushed(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let controls = vec![vec![3.0; 2]; STEPS];
    let run = lab.run_driven(&pair([-2.0; 2]), &controls)?;
    let (loss, seed) = cost(&run, &controls, 0.1);
    lab.fine("(b) loss", loss, 2.059_143_506_108_589_8, 1e-9);
    let by = run.gradient(&seed)?.by;
    let entries: [Component; 4] = [
        ("x1", |axis| Param::Position(0, axis), -0.398_668_416_461_416_52),
        ("x2", |axis| Param::Position(SECOND, axis), -0.321_253_115_524_660_66),
        ("v1", |axis| Param::Velocity(0, axis), -0.497_790_657_365_996_97),
        ("v2", |axis| Param::Velocity(SECOND, axis), -0.222_130_874_620_080_23),
    ];
    for axis in 0..2 {
        for (what, param, exact) in entries {
            let slope = by.by(&run.scene, param(axis));
            lab.impact(format!("(b) dL/d{what}[{axis}]"), slope, exact, 1e-6 * exact.abs());
        }
        let slope = by.controls[0][axis] + effort_slope(3.0, 0.1);
        let exact = 0.000_213_801_296_321_840_39;
        lab.impact(format!("(b) dL/du(0)[{axis}]"), slope, exact, 1e-6 * exact);
    }
    Ok(())
}

/// Of weight · mean |u|² by one control.
fn effort_slope(u: f64, weight: f64) -> f64 {
    2.0 * weight * u / STEPS as f64
}

/// The lowest loss that 300 steps of gradient descent meet.
fn learn(
    lab: &mut Lab<'_>,
    (first, weight): ([f64; 2], f64),
    start: [f64; 2],
) -> Result<f64, Stop> {
    let (def, mut controls) = (pair(first), vec![start.to_vec(); STEPS]);
    let mut lowest = f64::INFINITY;
    for _ in 0..ROUNDS {
        let run = lab.run_driven(&def, &controls)?;
        let (loss, seed) = cost(&run, &controls, weight);
        lowest = lowest.min(loss);
        let by = run.gradient(&seed)?.by.controls;
        for (u, by) in controls.iter_mut().flatten().zip(by.iter().flatten()) {
            *u -= RATE * STEPS as f64 * (by + effort_slope(*u, weight));
        }
    }
    Ok(lowest)
}

const ROUNDS: usize = 300;
/// Per control, on the mean over all steps.
const RATE: f64 = 0.3;

fn learns_straight(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let lowest = learn(lab, ([-2.0; 2], 0.1), [3.0; 2])?;
    learned(lab, "(b)", lowest, 1.41, 1.396_542_160_123_197_3);
    Ok(())
}

fn learns_around(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let lowest = learn(lab, ([-1.0, -2.0], 0.01), [0.0, 3.0])?;
    learned(lab, "(c)", lowest, 0.32, 0.311_416_870_358_471_68);
    Ok(())
}

/// Below what must be reached, and not below what no control can reach.
fn learned(lab: &mut Lab<'_>, what: &str, lowest: f64, most: f64, best: f64) {
    let (most, least) = ([lowest, most, 0.0], [lowest, best, 1e-9]);
    lab.figure(format!("{what} learned loss"), Grade::Impact, Relation::AtMost, most);
    lab.figure(format!("{what} best possible loss"), Grade::Impact, Relation::AtLeast, least);
}
