//! The same scenes in other units, from other frames, in other orders, and once more.

use tangency_bench::retelling::{Frame, Number, Retelling, Reversed, Units, params};
use tangency_core::{Param, Scene, State};
use tangency_diff::RolloutVector;

use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

use super::told::{Told, all, named};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V27",
    title: "Units, frame, order",
    parts: &[
        Part::new("units that are powers of two", binary),
        Part::new("units that are powers of ten", decimal),
        Part::new("turned by 37 degrees", turned),
        Part::new("moved by 1e6 m", moved),
        Part::new("listed in another order", reversed),
        Part::new("run again", again),
    ],
}];

/// Numbers below this are on their way to zero and have lost digits to underflow.
const UNDERFLOW: f64 = 1e-280;

/// A run with the derivatives of its last pose.
struct Measured {
    run: Run,
    /// The last body that moves.
    body: usize,
    /// Of its pose.
    gradients: Vec<RolloutVector>,
    /// By what they are compared.
    params: Vec<Param>,
}

impl Measured {
    fn new(lab: &mut Lab<'_>, told: &Told) -> Result<Self, Stop> {
        let run = lab.run(&told.def, told.duration)?;
        let moves = |i: &usize| run.scene.is_dynamic(*i);
        let body = (0..run.scene.bodies().len()).rev().find(moves).unwrap_or(0);
        let pose = |axis| gradient(&run, &[(Number::Pose(body, axis), 1.0)]);
        let gradients = (0..3).map(pose).collect::<Result<_, _>>()?;
        let params = params(&run.scene);
        Ok(Self { run, body, gradients, params })
    }
}

/// The gradient of a weighted sum of numbers of the last state.
fn gradient(run: &Run, of: &[(Number, f64)]) -> Result<RolloutVector, Stop> {
    let seed = run.pick(|seed| {
        for (number, weight) in of {
            match *number {
                Number::Pose(i, axis) => seed.q[i][axis] = *weight,
                Number::Velocity(i, axis) => seed.v[i][axis] = *weight,
            }
        }
    });
    Ok(run.gradient(&seed)?.by)
}

/// Whether moving it alone moves rows against each other where there are more than need be.
fn is_place(param: &Param) -> bool {
    matches!(
        param,
        Param::Position(..) | Param::AnchorA(..) | Param::AnchorB(..) | Param::Shape(..)
    )
}

/// How far numbers are apart.
#[derive(Default)]
struct Apart {
    /// How many differ in some bit.
    bits: usize,
    /// The worst difference, relative to the number or to its scale.
    worst: f64,
}

impl Apart {
    fn see(&mut self, one: f64, other: f64, scale: f64) {
        let vanish = one.abs() < UNDERFLOW && other.abs() < UNDERFLOW;
        if one != other && !vanish {
            let apart = (one - other).abs() / one.abs().max(scale);
            self.bits += 1;
            self.worst = if apart <= self.worst { self.worst } else { apart };
        }
    }

    fn see_states(&mut self, one: &State, other: &State) {
        let numbers = |state: &State| -> Vec<f64> {
            let vectors = state.q.iter().chain(&state.v).flat_map(|x| x.iter().copied());
            std::iter::once(state.time).chain(vectors).collect()
        };
        numbers(one).iter().zip(numbers(other)).for_each(|(one, other)| self.see(*one, other, 1.0));
    }
}

/// States and derivatives of a run beside those of its retelling.
fn compare(
    lab: &mut Lab<'_>,
    told: &Measured,
    way: &dyn Retelling,
    [states, slopes]: [&mut Apart; 2],
) -> Result<(), Stop> {
    let Run { scene, tape } = &told.run;
    let retold = lab.run_steps(&way.scene(scene.def()), tape.records.len())?;
    for (one, other) in tape.states().zip(retold.tape.states()) {
        states.see_states(one, &way.told_back(other));
    }
    for (axis, by) in told.gradients.iter().enumerate() {
        let of = way.number(scene.bodies().len(), Number::Pose(told.body, axis));
        let found = gradient(&retold, &of)?;
        for param in &told.params {
            let terms = way.param(scene, *param).into_iter();
            let other = terms.map(|(param, rate)| rate * found.by(&retold.scene, param)).sum();
            slopes.see(by.by(scene, *param), other, scale(scene, *param));
        }
    }
    Ok(())
}

/// A derivative by a number p is of the size of one, or of 1/p where that is more.
fn scale(scene: &Scene, param: Param) -> f64 {
    let value = scene.get(param).map_or(0.0, f64::abs);
    if value > 0.0 { value.recip().max(1.0) } else { 1.0 }
}

/// A scene beside each of some ways to tell it: states and derivatives.
fn retell(lab: &mut Lab<'_>, told: &Measured, ways: &[&dyn Retelling]) -> Result<[Apart; 2], Stop> {
    let [mut states, mut slopes] = <[Apart; 2]>::default();
    for way in ways {
        compare(lab, told, *way, [&mut states, &mut slopes])?;
    }
    Ok([states, slopes])
}

/// No bit may differ.
fn same(
    lab: &mut Lab<'_>,
    told: &Measured,
    ways: &[&dyn Retelling],
    how: &str,
) -> Result<(), Stop> {
    let [states, slopes] = retell(lab, told, ways)?;
    let title = format!("{}, {how}", told.run.scene.def().name);
    lab.near(format!("{title}: numbers of states that differ"), states.bits as f64, 0.0, 0.0);
    lab.near(format!("{title}: derivatives that differ"), slopes.bits as f64, 0.0, 0.0);
    Ok(())
}

/// No number may differ by more than a tolerance.
fn close(
    lab: &mut Lab<'_>,
    scenes: &[Told],
    ways: &[&dyn Retelling],
    (how, tolerance): (&str, f64),
) -> Result<(), Stop> {
    for told in scenes {
        let mut measured = Measured::new(lab, told)?;
        measured.params.retain(|param| !(told.overdetermined && is_place(param)));
        let [states, slopes] = retell(lab, &measured, ways)?;
        let title = format!("{}, {how}", told.def.name);
        lab.near(format!("{title}: states"), states.worst, 0.0, tolerance);
        lab.near(format!("{title}: derivatives"), slopes.worst, 0.0, tolerance);
    }
    Ok(())
}

fn binary(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let units = |powers: &[[i32; 3]]| -> Vec<Units> {
        powers.iter().map(|power| Units::powers_of(2.0, *power)).collect()
    };
    let families = [
        ("length by 2^(±20) and 2", units(&[[20, 0, 0], [-20, 0, 0], [1, 0, 0]])),
        ("mass by 2^(±20) and 2", units(&[[0, 20, 0], [0, -20, 0], [0, 1, 0]])),
        ("time by 2^(±10) and 2", units(&[[0, 0, 10], [0, 0, -10], [0, 0, 1]])),
        ("all units", units(&[[20, 20, 10], [-20, -20, -10], [-19, 13, 7], [20, -19, -9]])),
    ];
    for told in all() {
        let told = Measured::new(lab, &told)?;
        for (how, units) in &families {
            let ways: Vec<&dyn Retelling> = units.iter().map(|units| units as _).collect();
            same(lab, &told, &ways, how)?;
        }
    }
    Ok(())
}

fn decimal(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let alone = [[6, 0, 0], [-6, 0, 0], [0, 6, 0], [0, -6, 0], [0, 0, 6], [0, 0, -6]];
    let powers = alone.iter().chain(&[[6, 6, 6], [-6, -6, -6], [6, -6, 6]]);
    let units: Vec<Units> = powers.map(|power| Units::powers_of(10.0, *power)).collect();
    let ways: Vec<&dyn Retelling> = units.iter().map(|units| units as _).collect();
    close(lab, &all(), &ways, ("units by 10^(±6)", 1e-9))
}

fn turned(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let frame = Frame { angle: 37.0_f64.to_radians(), ..Frame::default() };
    close(lab, &all(), &[&frame], ("turned", 1e-9))
}

fn moved(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let frame = Frame { offset: [1e6, -1e6], ..Frame::default() };
    close(lab, &named(), &[&frame], ("moved", 1e-6))
}

fn reversed(lab: &mut Lab<'_>) -> Result<(), Stop> {
    close(lab, &all(), &[&Reversed], ("reversed", 1e-9))
}

fn again(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for told in all() {
        let told = Measured::new(lab, &told)?;
        same(lab, &told, &[&Units::SAME], "again")?;
    }
    Ok(())
}
