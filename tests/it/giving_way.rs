//! Where what should be contradicts itself (bounces, position errors), it gives way, is recorded, and
//! what must be still holds.

use tangency::core::row::Stage;
use tangency::diff::StateVector;
use tangency::lcp::LcpError;
use tangency::{Param, SceneDef, State, StepError, StepRecord, gradient, simulate};
use tangency_bench::scenes::{
    disc, hinge, misfit_hinges, narrow_slot, plane, rod, seesaw, unit_scene, wedged_box,
};

use crate::engine::{backends, built, first_step, near, near_relative, run};

fn stages(record: &StepRecord) -> Vec<Stage> {
    let post = record.post.iter().flat_map(|post| &post.islands);
    record.islands.iter().chain(post).map(|island| island.stage).collect()
}

/// Two corners at each wall give way by κ Wᵢᵢ, Wᵢᵢ = 1/M + (h/2)²/I = 5/(2 M), κ = 0.01:
/// ±w + κ Wᵢᵢ λᵢ = bᵢ and M w = 2 (λ₁ − λ₂), so that of δ there remains δ/(1 + 8/(5 κ)) = δ/161.
#[test]
fn wedged_box_moves_to_the_middle() {
    for solver in backends() {
        let offset = 0.03;
        let record = first_step(&built(&wedged_box(offset)), &*solver);
        assert_eq!(stages(&record), [Stage::Velocity, Stage::SoftPost]);
        near("wedged box", record.after.q[2].x, offset / 161.0, 1e-14);
        assert_eq!(record.after.v[2].norm(), 0.0, "mending adds no velocity");
    }
}

/// Between walls, overlaps add up to what they were. Five contacts of discs and two of walls, which are
/// half as soft (κ Wᵢᵢ, Wᵢᵢ = 2/M and 1/M) under nearly the same force, share them: the worst becomes a
/// sixth of the sum, less than a quarter of what it was. Yet they gave way, and are not mended again.
#[test]
fn discs_in_a_row_share_their_overlaps_once() {
    let (radius, deep, slight, count) = (0.1, 0.01, 1e-4, 6_i32);
    let x = |i: i32| (2.0 * radius - slight) * f64::from(i) + radius - deep;
    let end = x(count - 1) + radius - slight;
    let walls = [plane("left", [1.0, 0.0], 0.0), plane("right", [-1.0, 0.0], -end)];
    let discs = (0..count).map(|i| disc(&format!("disc{i}"), radius, [x(i), 0.0]));
    let bodies = walls.into_iter().chain(discs).collect();
    let def = SceneDef { recovery_speed: 1e6, ..unit_scene("overlapping row", bodies) };
    for solver in backends() {
        let scene = built(&def);
        let record = first_step(&scene, &*solver);
        assert_eq!(stages(&record), [Stage::Velocity, Stage::SoftPost]);
        let worst = scene.penetration(&record.after).expect("a penetration");
        let share = (deep + 6.0 * slight) / 6.0;
        near_relative("worst overlap", worst, share, 0.15);
        assert!(worst < deep / 4.0, "{worst}");
    }
}

/// x⁺ = δ/(1 + 2 s), s = 2/(κ r), r = 1 + M/(4 I): the softness counts among the derivatives.
#[test]
fn wedged_box_derivatives() {
    for solver in backends() {
        let scene = built(&wedged_box(0.03));
        let tape = run(&scene, &*solver, 1);
        let seed = |k: usize, state: &State| {
            let mut seed = StateVector::like(state);
            seed.q[2].x = 1.0;
            (k == 1).then_some(seed)
        };
        let by = gradient(&scene, &tape, seed).expect("a gradient").by;
        near("by the offset", by.by(&scene, Param::Position(2, 0)), 1.0 / 161.0, 1e-14);
        let (mass, inertia) = (2.0, 2.0 / 6.0);
        let by_s = -2.0 * 0.03 / (161.0 * 161.0);
        let by_r = -2.0 / 0.01 / (2.5 * 2.5) * by_s;
        let by_inertia = by_r * -mass / (4.0 * inertia * inertia);
        near("by the inertia", by.by(&scene, Param::Inertia(2)), by_inertia, 1e-14);
        // The mass scales the inertia along, and nothing changes.
        near("by the mass", by.by(&scene, Param::Mass(2)), 0.0, 1e-14);
    }
}

/// Off one wall at e v means through the other: the ball stops at the wall instead.
#[test]
fn ball_in_a_narrow_slot_does_not_bounce() {
    for solver in backends() {
        let scene = built(&narrow_slot(0.8));
        let record = first_step(&scene, &*solver);
        assert_eq!(stages(&record), [Stage::Plastic]);
        near("meets the wall", record.after.q[2].x, 2e-3, 1e-15);
        assert_eq!(record.counts(&scene).plastic_islands, 1);
        let tape = run(&scene, &*solver, 50);
        let worst = tape.states().map(|s| s.q[2].x.abs()).fold(0.0, f64::max);
        near("stays in the slot", worst, 2e-3, 1e-12);
    }
}

/// Both hinges share a misfit that is small for drift; the rod does not move otherwise.
#[test]
fn misfit_hinges_share_the_misfit() {
    for solver in backends() {
        let scene = built(&misfit_hinges(0.01));
        let record = first_step(&scene, &*solver);
        assert_eq!(stages(&record), [Stage::Loose, Stage::SoftPost]);
        let tape = run(&scene, &*solver, 100);
        let (q, v) = (tape.last().q[0], tape.last().v[0]);
        near("x", q.x, 0.505, 1e-8);
        near("y", q.y, 0.0, 1e-8);
        near("speed", v.norm(), 0.0, 1e-6);
    }
}

/// A misfit that no drift explains is refused, with what was violated.
#[test]
fn misfit_that_is_no_drift() {
    for solver in backends() {
        let error = simulate(&built(&misfit_hinges(0.3)), &*solver, 1).expect_err("infeasible");
        let StepError::Lcp { source: LcpError::Infeasible { residual }, .. } = error else {
            panic!("{error}");
        };
        assert!(residual > 1e-3, "{residual}");
    }
}

/// A penetration below what counts as rounding, from both sides.
#[test]
fn slot_too_narrow_by_rounding() {
    for solver in backends() {
        let half = 0.1 * (1.0 - 1e-10);
        let walls = [plane("left", [1.0, 0.0], -half), plane("right", [-1.0, 0.0], -half)];
        let bodies = walls.into_iter().chain([disc("ball", 0.1, [0.0; 2])]).collect();
        let tape = run(&built(&unit_scene("tight slot", bodies)), &*solver, 20);
        near("stays", tape.last().q[2].norm(), 0.0, 1e-10);
        near("stands", tape.last().v[2].norm(), 0.0, 1e-9);
    }
}

/// A lever is no contradiction: nothing gives way, and Newton's law holds at the contact struck,
/// u⁺ = −e u⁻ with u⁻ = −1 m/s.
#[test]
fn seesaw_keeps_its_restitution() {
    for solver in backends() {
        let record = first_step(&built(&seesaw(0.8)), &*solver);
        assert!(!stages(&record).iter().any(|stage| stage.gives_way()), "{:?}", stages(&record));
        let v = &record.after.v;
        let under = v[0].y + v[0].z * (-1.0 - 2.5);
        near("Newton's law at the heavy disc", v[1].y - under, 0.8, 1e-9);
        assert!(v[2].y > 6.0, "the light disc flies at {} m/s", v[2].y);
    }
}

/// What gives way in one island changes nothing in another: a pendulum beside a jam moves to the last
/// bit as it does alone.
#[test]
fn islands_give_way_by_themselves() {
    let swinging =
        || (rod("swing", 1.0, 1.0, [5.5, 0.0], 0.0), hinge("pin", "world", "swing", [5.0, 0.0]));
    for solver in backends() {
        let ((body, joint), mut jam) = (swinging(), misfit_hinges(0.01));
        jam.bodies.push(body);
        jam.joints.push(joint);
        let beside = run(&built(&jam), &*solver, 30);
        let ((body, joint), mut alone) = (swinging(), misfit_hinges(0.01));
        (alone.bodies, alone.joints) = (vec![body], vec![joint]);
        let alone = run(&built(&alone), &*solver, 30);
        assert!(
            beside.records.iter().any(|record| record.islands.iter().any(|i| i.stage.drifts()))
        );
        assert_eq!(beside.last().q[1], alone.last().q[0]);
    }
}
