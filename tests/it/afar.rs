//! Contacts that are modelled from afar: they change no motion and no exact derivative, and smoothed ones feel
//! them.

use nalgebra::Vector3;
use tangency::{
    BodyDef, Gradient, GradientMode, Param, Rollout, RolloutVector, Scene, SceneDef, State,
    StateVector, gradient, rollout, tangent,
};
use tangency_bench::retelling::{Retelling, Units};
use tangency_bench::scenes::{disc, floor, hidden_plate, material, stack};

use crate::engine::{backends, built, near, near_relative, run};
use crate::gradients::loss::coefficients;
use crate::gradients::numbers::numbers;

const STEPS: usize = 240;
const BALL: usize = 1;
const PLATE: usize = 2;

fn prepared(mut tape: Rollout, mode: GradientMode) -> Rollout {
    mode.prepare(&mut tape).unwrap_or_else(|error| panic!("{error}"));
    tape
}

fn of_all_states(scene: &Scene, tape: &Rollout) -> Gradient {
    gradient(scene, tape, |k, state| Some(coefficients(k, state))).expect("a gradient")
}

/// A disc at a gap from a floor that no step reaches: with w = v − g dt and one row λ u = ε,
///
/// ```text
///  m v⁺ = m w + λ,   u = v⁺ + gap/dt,   ε = κ m w²        a = ε/(m u²)
///  dv⁺/dv = 1/(1 + a)          dv⁺/dgap = −a/((1 + a) dt)
/// ```
#[test]
fn a_floor_from_afar_has_a_closed_form() {
    let (m, dt, gap, speed, kappa) = (3.0, 0.02, 0.5, -1.5, 1e-2);
    let ball =
        BodyDef { mass: Some(m), velocity: [0.0, speed], ..disc("ball", 0.1, [0.0, 0.1 + gap]) };
    let bodies = vec![floor(), ball];
    let def = SceneDef { dt, contact_reach: 1.0, bodies, ..SceneDef::default() };
    let scene = built(&material(def, 0.0, 0.0));
    let fall = speed - 9.81 * dt;
    let (energy, open) = (kappa * m * fall * fall, gap / dt);
    // m (u − open) = m w + ε/u
    let ahead = fall + open;
    let u = 0.5 * (ahead + (ahead * ahead + 4.0 * energy / m).sqrt());
    let a = energy / (m * u * u);
    for solver in backends() {
        let tape = run(&scene, &*solver, 1);
        near("speed", tape.last().v[1].y, fall, 1e-14);
        let tape = prepared(tape, GradientMode::Smoothed { kappa });
        let mut seed = StateVector::like(tape.last());
        seed.v[1].y = 1.0;
        let by = gradient(&scene, &tape, |k, _| (k == 1).then(|| seed.clone()));
        let by = by.expect("a gradient").by.initial;
        near_relative("dv/dv", by.v[1].y, 1.0 / (1.0 + a), 1e-12);
        near_relative("dv/dgap", by.q[1].y, -a / ((1.0 + a) * dt), 1e-9);
    }
}

/// Reach adds rows, and nothing else.
#[test]
fn motion_and_exact_derivatives_stay() {
    for def in [hidden_plate(), stack(&[1.0, 2.0])] {
        let scenes = [0.0, 1.0].map(|far| built(&SceneDef { contact_reach: far, ..def.clone() }));
        for solver in backends() {
            let [near_by, from_afar] = [0, 1].map(|k| run(&scenes[k], &*solver, 100));
            let rows = |k: usize, tape: &Rollout| tape.records[20].counts(&scenes[k]).rows;
            assert!(rows(0, &near_by) <= rows(1, &from_afar));
            let apart = |(a, b): (&State, &State)| {
                let all = a.q.iter().chain(&a.v).zip(b.q.iter().chain(&b.v));
                all.map(|(a, b)| (a - b).amax()).fold(0.0, f64::max)
            };
            let apart = near_by.states().zip(from_afar.states()).map(apart).fold(0.0, f64::max);
            near("how far motions are apart", apart, 0.0, 1e-10);
            let [one, other] =
                [(0, &near_by), (1, &from_afar)].map(|(k, t)| of_all_states(&scenes[k], t));
            for param in numbers(&scenes[0]) {
                let exact = one.by.by(&scenes[0], param);
                let off = other.by.by(&scenes[1], param) - exact;
                near(&format!("{param:?}"), off, 0.0, 1e-8 * (1.0 + exact.abs()));
            }
        }
    }
}

/// (x − 2.5)² of the plate at the end, and its derivative by the throw.
fn missed(scene: &Scene, tape: &Rollout) -> (f64, Vector3<f64>) {
    let off = tape.last().q[PLATE].x - 2.5;
    let mut seed = StateVector::like(tape.last());
    seed.q[PLATE].x = 2.0 * off;
    let found = gradient(scene, tape, |k, _| (k == STEPS).then(|| seed.clone()));
    (off, found.expect("a gradient").by.initial.v[BALL])
}

/// Descent from a throw that misses what it is to push, where the exact derivative is 0.
#[test]
fn a_throw_finds_what_it_misses() {
    let scene = built(&hidden_plate());
    for solver in backends() {
        let mut start = scene.initial_state();
        let throw = |start: &State| {
            let tape = rollout(&scene, &*solver, start.clone(), STEPS, |_, _| Vec::new());
            tape.expect("a run")
        };
        let (off, exact) = missed(&scene, &throw(&start));
        near("plate before", off, -0.5, 1e-12);
        near("exact derivative", exact.amax(), 0.0, 1e-12);
        for _ in 0..60 {
            let tape = prepared(throw(&start), GradientMode::Smoothed { kappa: 1e-3 });
            let (_, slope) = missed(&scene, &tape);
            start.v[BALL] -= Vector3::new(slope.x, slope.y, 0.0) * 0.03;
        }
        near("plate after", missed(&scene, &throw(&start)).0, 0.0, 1e-4);
    }
}

/// Reverse and forward mode by every number; as κ → 0 they tend to the exact derivative.
#[test]
fn both_modes_agree_and_tend_to_the_exact_one() {
    let scene = built(&hidden_plate());
    for solver in backends() {
        let tape = run(&scene, &*solver, 180);
        let exact = of_all_states(&scene, &tape).by;
        let params = numbers(&scene);
        let scale = params.iter().fold(1.0, |s: f64, p| s.max(exact.by(&scene, *p).abs()));
        let [wide, narrow] = [1e-6, 1e-8].map(|kappa| {
            let tape = prepared(tape.clone(), GradientMode::Smoothed { kappa });
            let by = of_all_states(&scene, &tape).by;
            for param in &params {
                let mut along = RolloutVector::zeros(&scene, 180);
                along.add(&scene, *param, 1.0);
                let changes = tangent(&scene, &tape, &along).expect("a tangent");
                let term = |(k, state): (usize, &State)| coefficients(k, state).dot(&changes[k]);
                let forward: f64 = tape.states().enumerate().map(term).sum();
                near(&format!("{param:?}"), forward, by.by(&scene, *param), 1e-10 * scale);
            }
            let off = |param: &Param| (by.by(&scene, *param) - exact.by(&scene, *param)).abs();
            params.iter().map(off).fold(0.0, f64::max)
        });
        assert!(wide > 1e-9 * scale, "{wide}");
        near_relative("what a hundredth of κ leaves", narrow, 0.01 * wide, 0.05);
    }
}

#[test]
fn units_do_not_matter() {
    let units = Units { length: 1024.0, mass: 128.0, time: 0.125 };
    let def = hidden_plate();
    for solver in backends() {
        let slopes = [def.clone(), units.scene(&def)].map(|def| {
            let scene = built(&def);
            let tape = run(&scene, &*solver, STEPS);
            let tape = prepared(tape, GradientMode::Smoothed { kappa: 1e-3 });
            let mut seed = StateVector::like(tape.last());
            seed.q[PLATE].x = 1.0;
            let found = gradient(&scene, &tape, |k, _| (k == STEPS).then(|| seed.clone()));
            found.expect("a gradient").by.initial.v[BALL]
        });
        near_relative("dx/dv", slopes[1].x, slopes[0].x * 0.125, 1e-9);
    }
}
