//! Chains of rods: hanging between supports, swinging, struck.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use tangency_bench::scenes::{hanging_chain_hit, slender_inertia, suspended_chain, turned_chain};
use tangency_core::{Param, SceneDef, State};

use super::{held_impulse, moved};
use crate::lab::recommended;
use crate::run::Run;
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V16",
    title: "Chains",
    parts: &[
        Part::new("between supports", suspended),
        Part::new("swinging", swinging),
        Part::new("struck", struck),
        Part::new("struck, derivatives", by_link_mass),
    ],
}];

const LINKS: usize = 10;
const PULL: f64 = 7.990_832_274_108_768_7;
const END: u32 = 10;

fn suspended(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let def = suspended_chain(PULL);
    let run = lab.run(&def, 10.0)?;
    lab.near("(a) moved in 10 s", moved(&run), 0.0, 1e-9);
    for (name, joint) in [("left", 0), ("right", END)] {
        let [x, y] = [0, 1].map(|row| held_impulse(run.end(), joint, row) / def.dt);
        lab.relative(format!("(a) {name} force"), x.hypot(y), 25.793_972_657_055_724, 1e-9);
    }
    let middle = run.last().q[4];
    let sag = -(middle.y + 0.1 * middle.z.sin());
    lab.near("(a) sag", sag, 0.731_090_072_598_837_01, 1e-9);
    Ok(())
}

const LENGTH: f64 = 0.1;
const MASS: f64 = 0.2;
const AMPLITUDE: f64 = 1e-3;
const FREQUENCIES: [f64; 3] = [3.767_208_518_301_97, 8.728_321_546_416_22, 14.045_381_952_777_5];

fn swinging(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let modes = Modes::new();
    for (k, exact) in FREQUENCIES.into_iter().enumerate() {
        let def = modes.scene(k, 1e-3);
        let name = format!("(b) frequency {}", k + 1);
        let found = modes.frequency(k, &lab.run(&def, 1.5 * TAU / exact)?);
        lab.relative(format!("{name} at dt=0.001"), found, exact, 20.0 * 1e-3);
        let fine = modes.frequency(k, &lab.run(&recommended(def), 1.5 * TAU / exact)?);
        lab.fine(name, fine, exact, 1e-4 * exact);
    }
    let period = TAU / FREQUENCIES[0];
    let dt = period / (period / 1e-3).round();
    let back = lab.run(&modes.scene(0, dt), period)?;
    lab.near("(b) off after a period, relative", off(&back), 0.0, 20.0 * dt);
    let fine = lab.run(&recommended(modes.scene(0, dt)), period)?;
    lab.fine("(b) off after a period", off(&fine), 0.0, 1e-4);
    Ok(())
}

/// Greatest change of an angle over the amplitude.
fn off(run: &Run) -> f64 {
    let angles = run.last().q.iter().zip(&run.tape.initial.q);
    angles.map(|(a, b)| (a.z - b.z).abs()).fold(0.0, f64::max) / AMPLITUDE
}

/// Small motions of hanging rods, M θ″ + K θ = 0.
struct Modes {
    mass: DMatrix<f64>,
    /// In the order of their frequencies.
    shapes: Vec<DVector<f64>>,
}

impl Modes {
    /// ```text
    ///  M_ij = m L² (n − max(i, j) − ½), i ≠ j    M_ii = m L² (n − i − 2/3)    K_ii = m g L (n − i − ½)
    /// ```
    fn new() -> Self {
        let below = |i: usize| (LINKS - i) as f64;
        let mass = DMatrix::from_fn(LINKS, LINKS, |i, j| {
            let less = if i == j { 2.0 / 3.0 } else { 0.5 };
            MASS * LENGTH * LENGTH * (below(i.max(j)) - less)
        });
        let root = DVector::from_fn(LINKS, |i, _| (MASS * 9.81 * LENGTH * (below(i) - 0.5)).sqrt());
        // K^(-1/2) M K^(-1/2) has the eigenvalues 1/ω².
        let scaled = DMatrix::from_fn(LINKS, LINKS, |i, j| mass[(i, j)] / (root[i] * root[j]));
        let eigen = scaled.symmetric_eigen();
        let mut order: Vec<usize> = (0..LINKS).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let shape = |k: &usize| {
            let shape = eigen.eigenvectors.column(*k).component_div(&root);
            &shape * (AMPLITUDE / shape.amax())
        };
        Self { mass, shapes: order.iter().map(shape).collect() }
    }

    fn scene(&self, k: usize, dt: f64) -> SceneDef {
        SceneDef { dt, ..turned_chain(self.shapes[k].as_slice(), LENGTH, MASS) }
    }

    /// From the first to the third zero of the mode's coordinate φᵀ M θ.
    fn frequency(&self, k: usize, run: &Run) -> f64 {
        let weights = &self.mass * &self.shapes[k];
        let hanging = -TAU / 4.0;
        let along = |s: &State| -> f64 {
            s.q.iter().zip(weights.iter()).map(|(q, w)| w * (q.z - hanging)).sum()
        };
        let states: Vec<(f64, f64)> = run.tape.states().map(|s| (s.time, along(s))).collect();
        let crossing = |pair: &[(f64, f64)]| {
            let [(t, a), (u, b)] = [pair[0], pair[1]];
            (a * b <= 0.0 && a != 0.0).then(|| t + (u - t) * a / (a - b))
        };
        let zeros: Vec<f64> = states.windows(2).filter_map(crossing).collect();
        zeros.get(2).map_or(f64::NAN, |third| TAU / (third - zeros[0]))
    }
}

const DISC: usize = 10;
const LOWEST: usize = 9;
const DIVISOR: f64 = 943_009.0;

fn struck(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [1e-4, 1e-3, 1e-2] {
        let v = lab.first_step(&SceneDef { dt, ..hanging_chain_hit() })?.after.v;
        let lowest = v[LOWEST].z.abs();
        lab.near(format!("(c) lowest rate at dt={dt}"), lowest, 12_640_680.0 / DIVISOR, 1e-9);
        lab.near(format!("(c) topmost rate at dt={dt}"), v[0].z.abs(), 180.0 / DIVISOR, 1e-9);
        lab.near(format!("(c) disc at dt={dt}"), v[DISC].x, 837_670.0 / DIVISOR, 1e-9);
    }
    Ok(())
}

/// By the mass that all links share, inertia along.
fn by_link_mass(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run_steps(&SceneDef { dt: 1e-3, ..hanging_chain_hit() }, 1)?;
    let inertia = slender_inertia(1.0, 0.2);
    let link = |i| [(Param::Mass(i), 1.0), (Param::Inertia(i), inertia)];
    let links: Vec<(Param, f64)> = (0..LINKS).flat_map(link).collect();
    let sign = run.last().v[LOWEST].z.signum();
    let lowest = run.pick(|s| s.v[LOWEST].z = sign);
    let disc = run.pick(|s| s.v[DISC].x = 1.0);
    let found = lab.slope(&run, &lowest, &links)?;
    lab.relative("(c) d(lowest rate)/d(link mass)", found, -37.254_972_029_979_4, 1e-9);
    let found = lab.slope(&run, &disc, &links)?;
    lab.relative("(c) d(disc)/d(link mass)", found, -8.027_330_828_593_91, 1e-9);
    Ok(())
}
