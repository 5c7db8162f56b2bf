//! Two slender rods hinged to each other: regular and chaotic.

use nalgebra::Matrix4;
use tangency_bench::scenes::double_pendulum;
use tangency_core::{Param, SceneDef, State};

use super::pendulum::angle;
use crate::lab::recommended;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V03",
    title: "Double pendulum",
    parts: &[
        Part::new("plain stepping", plain),
        Part::new("recommended stepping", fine),
        Part::new("growth of a change at the start", growth),
    ],
}];

/// A motion from rest. States are two angles from hanging and two rates.
struct Motion {
    name: &'static str,
    start: [f64; 2],
    /// J, zero at the pin.
    energy: f64,
    /// Time, state, greatest singular value of d state / d state(0).
    states: &'static [(f64, [f64; 4], f64)],
    /// Which of the states plain stepping must meet, and how well: C of C dt.
    plain: (usize, f64),
    /// Tolerance of the recommended stepping.
    fine: f64,
}

const REGULAR: Motion = Motion {
    name: "regular",
    start: [0.5, 0.3],
    energy: -17.599_552_877_377_93,
    states: &[
        (
            2.0,
            [
                0.217_337_047_845_467_2,
                0.329_510_924_385_965_3,
                0.113_148_670_439_624_4,
                2.736_441_413_154_619,
            ],
            8.714,
        ),
        (
            5.0,
            [
                0.197_304_873_765_377,
                0.655_841_982_979_925_8,
                -0.555_949_544_759_677_8,
                -1.156_654_724_686_187,
            ],
            12.92,
        ),
    ],
    plain: (1, 1.0),
    fine: 1e-4,
};

const CHAOTIC: Motion = Motion {
    name: "chaotic",
    start: [2.2, 2.8],
    energy: 13.281_394_521_392_18,
    states: &[
        (
            2.0,
            [
                -2.475_298_988_188_848,
                1.846_419_973_877_368,
                0.762_580_850_568_287,
                0.804_861_403_151_122_3,
            ],
            39.92,
        ),
        (
            3.0,
            [
                1.710_805_382_631_626,
                -0.719_800_484_495_818_4,
                0.601_893_811_621_828_3,
                -8.724_180_114_775_988,
            ],
            948.2,
        ),
        (
            5.0,
            [
                -0.252_238_199_795_985_9,
                -15.004_364_482_383_36,
                5.241_277_757_891_399,
                -2.774_019_631_683_487,
            ],
            1089.2,
        ),
    ],
    plain: (0, 20.0),
    fine: 1e-3,
};

fn minimal(state: &State) -> [f64; 4] {
    [angle(state, 0), angle(state, 1), state.v[0].z, state.v[1].z]
}

/// The greatest error of the four numbers of a state.
fn miss(state: &State, exact: &[f64; 4]) -> f64 {
    minimal(state).iter().zip(exact).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

fn plain(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for motion in [REGULAR, CHAOTIC] {
        let (index, c) = motion.plain;
        let (t, exact, _) = motion.states[index];
        let name = format!("{} state({t})", motion.name);
        let scene = |dt| SceneDef { dt, ..double_pendulum(motion.start) };
        for dt in [4e-3, 1e-3] {
            let run = lab.run(&scene(dt), t)?;
            lab.near(format!("{name} at dt={dt}"), miss(run.last(), &exact), 0.0, c * dt);
        }
        let run = lab.run_steps(&scene(1e-3), 0)?;
        let energy = run.scene.energy(run.last());
        lab.near(format!("{} energy at the start", motion.name), energy, motion.energy, 1e-11);
        lab.order(&name, 0.9, |lab, dt| Ok(miss(lab.run(&scene(dt), t)?.last(), &exact)))?;
    }
    Ok(())
}

fn fine(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for motion in [REGULAR, CHAOTIC] {
        let run = lab.run(&recommended(double_pendulum(motion.start)), 5.0)?;
        for (t, exact, _) in motion.states {
            let numbers = ["upper angle", "lower angle", "upper rate", "lower rate"];
            for ((what, got), exact) in numbers.iter().zip(minimal(run.at(*t))).zip(exact) {
                lab.fine(format!("{} {what}({t})", motion.name), got, *exact, motion.fine);
            }
        }
        let energy = run.worst(|s| (run.scene.energy(s) - motion.energy).abs());
        lab.fine(format!("{} energy error over 5 s", motion.name), energy, 0.0, motion.fine);
    }
    Ok(())
}

fn growth(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for motion in [REGULAR, CHAOTIC] {
        let scene = double_pendulum(motion.start);
        for (t, _, exact) in motion.states {
            let name = format!("{} growth until {t}", motion.name);
            // Plain stepping is off its path by more than a part in fifty once chaos has set in.
            if *exact < 100.0 {
                let run = lab.run(&SceneDef { dt: 1e-3, ..scene.clone() }, *t)?;
                let found = greatest_growth(lab, &run, motion.start)?;
                lab.relative(format!("{name} at dt=0.001"), found, *exact, 2e-2);
            }
            let run = lab.run(&recommended(scene.clone()), *t)?;
            let found = greatest_growth(lab, &run, motion.start)?;
            lab.fine_slope(name, found, *exact, 1e-3);
        }
    }
    Ok(())
}

/// The greatest singular value of d state / d state(0), entry by entry.
fn greatest_growth(lab: &mut Lab<'_>, run: &Run, start: [f64; 2]) -> Result<f64, Stop> {
    let changes = changes(start);
    let mut by = Matrix4::zeros();
    for row in 0..4 {
        let seed = run.pick(|s| if row < 2 { s.q[row].z = 1.0 } else { s.v[row - 2].z = 1.0 });
        for (column, change) in changes.iter().enumerate() {
            by[(row, column)] = lab.slope(run, &seed, change)?;
        }
    }
    Ok(by.singular_values().max())
}

/// How bodies move with each of the four numbers. A rod's own change turns it about its upper end,
/// and the upper rod carries the lower one. From rest, rates move them as angles do.
fn changes([upper, lower]: [f64; 2]) -> [Vec<(Param, f64)>; 4] {
    let (sin, cos) = upper.sin_cos();
    let turned = [(0, 0, 0.5 * cos), (0, 1, 0.5 * sin), (0, 2, 1.0), (1, 0, cos), (1, 1, sin)];
    let (sin, cos) = lower.sin_cos();
    let bent = [(1, 0, 0.5 * cos), (1, 1, 0.5 * sin), (1, 2, 1.0)];
    let of = |kind: fn(usize, usize) -> Param, moved: &[(usize, usize, f64)]| {
        moved.iter().map(|(body, axis, rate)| (kind(*body, *axis), *rate)).collect()
    };
    let (position, velocity) = (Param::Position, Param::Velocity);
    [of(position, &turned), of(position, &bent), of(velocity, &turned), of(velocity, &bent)]
}
