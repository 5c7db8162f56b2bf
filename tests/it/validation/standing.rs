//! V14 Tip or slide, V19 Mass ratio.

use tangency::diff::lcp::{LcpVector, lcp_jvp};
use tangency::{LcpSolver, RowSource, Scene, StepRecord};
use tangency_bench::scenes::{stack, tipping_box};

use crate::engine::{backends, built, contact_sums, first_step, near, near_relative, run};

const DT: f64 = 1e-6;
const BOX: usize = 1;

fn first_move(solver: &dyn LcpSolver, degrees: f64, friction: f64) -> StepRecord {
    first_step(&built(&tipping_box(degrees, friction)), solver)
}

#[test]
fn v14_tips() {
    for solver in backends() {
        let record = first_move(&*solver, 25.0, 0.8);
        let turn = -record.after.v[BOX].z / DT;
        near("V14 angular acceleration", turn, 1.524_655_322_442_535_4, 1e-6);
        let (normal, friction) = contact_sums(&record);
        near("V14 normal force", normal / DT, 9.043_344_923_073_789_7, 1e-6);
        near("V14 friction", friction.abs() / DT, 3.764_721_317_065_627_6, 1e-6);
        for impulse in record.contact_impulses() {
            let upper = impulse.point.x < 0.0;
            assert!(!upper || impulse.normal <= 1e-6 * DT, "the upper corner carries {impulse:?}");
        }
    }
}

#[test]
fn v14_slides() {
    for solver in backends() {
        let record = first_move(&*solver, 25.0, 0.3);
        let (sin, cos) = 25.0_f64.to_radians().sin_cos();
        near("V14 slides without turning", record.after.v[BOX].z / DT, 0.0, 1e-6);
        let exact = 9.81 * (sin - 0.3 * cos);
        near("V14 sliding acceleration", record.after.v[BOX].x / DT, exact, 1e-6);
    }
}

#[test]
fn v14_rests() {
    for solver in backends() {
        let record = first_move(&*solver, 20.0, 0.8);
        near("V14 rests", record.after.v[BOX].norm() / DT, 0.0, 1e-6);
    }
}

/// Impulse of the contacts between two bodies, N·s.
fn between(record: &StepRecord, pair: [u32; 2]) -> f64 {
    let of_pair =
        |i: &&tangency::ContactImpulse| record.contacts[i.contact].feature.id.bodies == pair;
    record.contact_impulses().iter().filter(of_pair).map(|i| i.normal).sum()
}

#[test]
fn v19_mass_ratio() {
    for solver in backends() {
        for ratio in [1e3, 1e6, 1e8] {
            let scene = built(&stack(&[1.0, ratio]));
            let tape = run(&scene, &*solver, 1000);
            let (dt, g) = (scene.dt(), 9.81);
            let last = tape.records.last().expect("steps");
            near_relative("V19 floor force", between(last, [0, 1]) / dt, (1.0 + ratio) * g, 1e-8);
            near_relative("V19 upper force", between(last, [1, 2]) / dt, ratio * g, 1e-8);
            for body in [1, 2] {
                near("V19 speed", last.after.v[body].norm(), 0.0, 1e-9);
                let moved = (last.after.q[body] - tape.initial.q[body]).norm();
                near("V19 sinking", moved, 0.0, 1e-9);
            }
            near_relative("V19 d floor force/d top mass", floor_by_top(&scene, last), g, 1e-6);
        }
    }
}

/// The change of the floor's force with the mass of the upper box, m ↦ p = m dt g.
fn floor_by_top(scene: &Scene, record: &StepRecord) -> f64 {
    let island = &record.islands[0];
    let top = island.bodies.iter().position(|b| *b == 2).expect("one island");
    let mass = scene.bodies()[2].mass;
    let mut tangent = LcpVector::zeros(&island.problem);
    tangent.mass[top] = mass / mass.x;
    tangent.momentum[top].y = -9.81 * scene.dt();
    let (_, impulses) = lcp_jvp(&island.problem, &island.solution, &tangent).expect("a derivative");
    let floor = |source: &RowSource| match source {
        RowSource::Normal { contact } => {
            record.contacts[*contact as usize].feature.id.bodies == [0, 1]
        }
        _ => false,
    };
    let rows = island.sources.iter().zip(&impulses).filter(|(source, _)| floor(source));
    rows.map(|(_, impulse)| impulse).sum::<f64>() / scene.dt()
}
