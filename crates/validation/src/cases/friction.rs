//! Coulomb friction at one and at two contacts, as exact one-step problems.

use nalgebra::Vector3;
use tangency_bench::scenes::{block, floor, material};
use tangency_core::{BodyDef, ForceDef, Param, SceneDef};
use tangency_diff::lcp::{LcpGradientReport, lcp_vjp};
use tangency_lcp::{
    Law, Lcp, LcpError, LcpSolution, NO_BODY, RawFriction, Row, Scratch, solve_checked,
};

use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V33",
    title: "Friction",
    parts: &[
        Part::new("disc", disc),
        Part::new("box", box_on_two),
        Part::new("sticking", sticks),
        Part::new("linear systems of the derivatives", systems),
        Part::new("as raw problems", raw),
        Part::new("box of a scene", scene),
    ],
}];

const MU: f64 = 0.5;

/// A body of 1 kg that gravity presses down by 1/10 N·s in the step, at `speed` along x. Its lower
/// contacts are one below the centre line each, normal up, tangent along x.
fn lying(inertia: f64, below: f64, contacts: &[f64], speed: f64) -> Lcp {
    let mut rows = Vec::new();
    for (normal, &x) in (0..).step_by(2).zip(contacts) {
        let row = |block, law| Row {
            bodies: [NO_BODY, 0],
            jacobian: [Vector3::zeros(), block],
            rhs: 0.0,
            compliance: 0.0,
            law,
        };
        rows.push(row(Vector3::new(0.0, 1.0, x), Law::Unilateral));
        rows.push(row(Vector3::new(1.0, 0.0, below), Law::Friction { normal, mu: MU }));
    }
    let (mass, momentum) = (Vector3::new(1.0, 1.0, inertia), Vector3::new(speed, -0.1, 0.0));
    Lcp { mass: vec![mass], momentum: vec![momentum], rows }
}

/// Contact matrix diag(1, 3): a disc of radius 1.
fn disc_at(speed: f64) -> Lcp {
    lying(0.5, 1.0, &[0.0], speed)
}

/// A unit box on its two lower corners.
fn box_at(speed: f64) -> Lcp {
    lying(1.0 / 6.0, 0.5, &[-0.5, 0.5], speed)
}

fn accepted(lab: &Lab<'_>, problem: &Lcp) -> Result<LcpSolution, Stop> {
    Ok(solve_checked(lab.solver(), problem, None, &mut Scratch::default(), 1e-10)?.0)
}

fn all(lab: &mut Lab<'_>, what: &str, found: &[f64], exact: &[f64]) {
    for (i, (found, exact)) in found.iter().zip(exact).enumerate() {
        lab.near(format!("{what}[{}]", i + 1), *found, *exact, 1e-10);
    }
}

fn disc(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (what, speed, tangent, slip) in
        [("sticks", 0.1, -1.0 / 30.0, 0.0), ("slips", 1.0, -0.05, 17.0 / 20.0)]
    {
        let found = accepted(lab, &disc_at(speed))?;
        all(lab, &format!("disc {what}: impulses"), &found.impulses, &[0.1, tangent]);
        lab.near(format!("disc {what}: slip"), found.slacks[1], slip, 1e-10);
    }
    Ok(())
}

/// Normal and tangential impulses of both contacts.
fn impulses(found: &LcpSolution) -> ([f64; 2], [f64; 2]) {
    let i = &found.impulses;
    ([i[0], i[2]], [i[1], i[3]])
}

fn box_on_two(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (speed, after, normals) in
        [(1.0, 0.95, [0.025, 0.075]), (0.02, 0.0, [0.04, 0.06]), (0.05, 0.0, [0.025, 0.075])]
    {
        let found = accepted(lab, &box_at(speed))?;
        let what = format!("box at {speed}");
        all(lab, &format!("{what}: v"), found.velocities[0].as_slice(), &[after, 0.0, 0.0]);
        let (n, t) = impulses(&found);
        all(lab, &format!("{what}: n"), &n, &normals);
        lab.near(format!("{what}: t1 + t2"), t[0] + t[1], after - speed, 1e-10);
        if speed >= 0.05 {
            all(lab, &format!("{what}: t, on its bound"), &t, &normals.map(|n| -MU * n));
        }
    }
    Ok(())
}

/// The contact of a sticking body keeps its velocity 0, whatever small force acts.
fn sticks(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (what, problem) in
        [("disc at 0.1", disc_at(0.1)), ("box at 0", box_at(0.0)), ("box at 0.02", box_at(0.02))]
    {
        let mut worst = 0.0_f64;
        for k in 0..6 {
            let mut pushed = problem.clone();
            pushed.momentum[0][k % 3] += if k < 3 { 1e-3 } else { -1e-3 };
            let found = accepted(lab, &pushed)?;
            worst = found.slacks.iter().fold(worst, |worst, u| worst.max(u.abs()));
        }
        lab.near(format!("{what}: greatest contact velocity when pushed"), worst, 0.0, 1e-12);
    }
    Ok(())
}

/// dv/df row by row, and what the derivative reports.
fn by_force(lab: &Lab<'_>, problem: &Lcp) -> Result<([Vector3<f64>; 3], LcpGradientReport), Stop> {
    let found = accepted(lab, problem)?;
    let mut rows = [Vector3::zeros(); 3];
    let mut last = LcpGradientReport::default();
    for (k, row) in rows.iter_mut().enumerate() {
        let pulled = lcp_vjp(problem, &found, &[Vector3::ith(k, 1.0)], None);
        let (bar, report) = pulled
            .map_err(|error| LcpError::Backend { solver: "derivative", source: Box::new(error) })?;
        (*row, last) = (bar.momentum[0], report);
    }
    Ok((rows, last))
}

fn systems(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (what, problem, defect) in [
        ("disc sticks", disc_at(0.1), 0.0),
        ("disc slips", disc_at(1.0), 0.0),
        ("box at 0", box_at(0.0), 1.0),
        ("box at 0.02", box_at(0.02), 1.0),
    ] {
        let (rows, report) = by_force(lab, &problem)?;
        let found = f64::from(report.rank_defect);
        lab.near(format!("{what}: ranks lacking"), found, defect, 0.0);
        lab.holds(format!("{what}: strictly complementary"), report.weak.is_empty());
        lab.near(format!("{what}: defect of the derivative"), report.defect, 0.0, 1e-12);
        if defect > 0.0 {
            let worst = rows.iter().map(nalgebra::Matrix::amax).fold(0.0, f64::max);
            lab.near(format!("{what}: greatest dv/df"), worst, 0.0, 1e-12);
        } else if what == "disc sticks" {
            // The lowest point moves at v + w.
            let slip = (rows[0] + rows[2]).amax();
            lab.near(format!("{what}: d(contact velocity)/df"), slip, 0.0, 1e-12);
        }
    }
    Ok(())
}

fn raw(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (what, problem, defect) in [
        ("disc at 0.1", disc_at(0.1), 0),
        ("disc at 1", disc_at(1.0), 0),
        ("box at 1", box_at(1.0), 0),
        ("box at 0.02", box_at(0.02), 1),
    ] {
        let (matrix, q) = problem.delassus();
        let friction = RawFriction { matrix, q, mu: vec![MU; problem.rows.len() / 2] };
        let found = lab.raw().solve_friction(&friction)?;
        let r = friction.reactions(&found.z);
        lab.near(format!("{what}, raw: residual"), friction.residual(&r), 0.0, 1e-10);
        let velocities = problem.velocities(r.as_slice());
        let exact = accepted(lab, &problem)?;
        let apart = (velocities[0] - exact.velocities[0]).amax();
        lab.near(format!("{what}, raw: velocities"), apart, 0.0, 1e-10);
        let lacking = found.rank_defect == defect && found.weak.is_empty();
        lab.holds(format!("{what}, raw: strictly complementary, {defect} ranks lacking"), lacking);
        if problem.rows.len() == 2 {
            let by = friction.derivative(&found)?;
            // The normal impulse follows −q, the tangential one −q/3, or −mu n when it slips.
            let exact = if what == "disc at 1" {
                [-1.0, 0.5, 0.0, 0.0]
            } else {
                [-1.0, 0.0, 0.0, -1.0 / 3.0]
            };
            all(lab, &format!("{what}, raw: dr/dq"), by.as_slice(), &exact);
        }
    }
    Ok(())
}

/// The box through the whole engine: g dt = 1/10.
fn scene(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let lying = |speed, force| {
        let slider = BodyDef { velocity: [speed, 0.0], ..block("box", [1.0; 2], [0.0, 0.5]) };
        let push = ForceDef { body: "box".into(), force: [force, 0.0], ..ForceDef::default() };
        let (bodies, forces) = (vec![floor(), slider], vec![push]);
        let def = SceneDef { gravity: [0.0, -10.0], bodies, forces, ..SceneDef::default() };
        material(def, MU, 0.0)
    };
    for (speed, after) in [(1.0, 0.95), (0.02, 0.0), (0.05, 0.0)] {
        let v = lab.first_step(&lying(speed, 0.0))?.after.v[1];
        all(lab, &format!("box of a scene at {speed}: v"), v.as_slice(), &[after, 0.0, 0.0]);
    }
    for force in [-1.0, -1e-6, 1e-6, 1.0] {
        let v = lab.first_step(&lying(0.0, force))?.after.v[1];
        lab.near(format!("box of a scene, pushed by {force} N: speed"), v.norm(), 0.0, 1e-12);
    }
    let run = lab.run_steps(&lying(0.0, 0.0), 1)?;
    for axis in 0..3 {
        let seed = run.pick(|s| s.v[1][axis] = 1.0);
        for (what, param) in [("Fx", 0), ("Fy", 1), ("torque", 2)] {
            let by = lab.slope(&run, &seed, &[(Param::Force(0, param), 1.0)])?;
            lab.near(format!("box of a scene: dv[{axis}]/d{what}"), by, 0.0, 1e-12);
        }
    }
    Ok(())
}
