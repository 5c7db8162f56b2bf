//! A disc that rolls, slides, or changes from one to the other.

use tangency_bench::scenes::{incline_disc, sliding_disc};
use tangency_core::{Param, SceneDef, State};

use crate::lab::recommended;
use crate::run::{Run, Slope, by_friction};
use crate::{Case, Lab, Part, Stop};

pub(crate) const CASES: &[Case] = &[
    Case {
        id: "V06",
        title: "Disc on an incline",
        parts: &[
            Part::new("motion", descent),
            Part::new("threshold of rolling", threshold),
            Part::new("derivatives", descent_derivatives),
        ],
    },
    Case {
        id: "V07",
        title: "Sliding to rolling",
        parts: &[Part::new("motion", roll), Part::new("derivatives", roll_derivatives)],
    },
];

const DISC: usize = 1;
const RADIUS: f64 = 0.25;
const T: f64 = 1.5;
/// Friction, x and |w| at T.
const DESCENTS: [(f64, f64, f64); 2] = [
    (0.05, 3.256_085_672_470_487_5, 5.531_030_765_945_8),
    (0.3, 2.516_413_204_518_607_7, 13.420_870_424_099_241),
];

fn slope_angle() -> f64 {
    20.0_f64.to_radians()
}

fn incline(friction: f64, dt: f64) -> SceneDef {
    SceneDef { dt, ..incline_disc(friction) }
}

/// Distance down the slope.
fn travel(run: &Run) -> f64 {
    let (sin, cos) = slope_angle().sin_cos();
    let d = run.last().q[DISC] - run.tape.initial.q[DISC];
    -(d.x * cos + d.y * sin)
}

/// Speed of the disc's lowest point up the slope.
fn slip(state: &State, angle: f64) -> f64 {
    let v = state.v[DISC];
    v.x * angle.cos() + v.y * angle.sin() + v.z * RADIUS
}

fn descent(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (friction, x, rate) in DESCENTS {
        for dt in [1e-2, 1e-3] {
            let run = lab.run(&incline(friction, dt), T)?;
            lab.near(format!("x, mu={friction}, dt={dt}"), travel(&run), x, 3.0 * dt);
            let w = run.last().v[DISC].z.abs();
            lab.near(format!("rate, mu={friction}, dt={dt}"), w, rate, 1e-10);
            if friction > 0.2 {
                let slip = run.worst(|s| slip(s, slope_angle()).abs());
                lab.near(format!("rolling contact point's speed, dt={dt}"), slip, 0.0, 1e-10);
            }
        }
        // T is no whole number of steps of 8 ms, but x(t) = x(T) (t/T)².
        lab.order(&format!("x, mu={friction}"), 0.9, |lab, dt| {
            Ok(travel(&lab.run(&incline(friction, dt), 1.496)?) - x * (1.496 / T).powi(2))
        })?;
        let fine = lab.run(&recommended(incline_disc(friction)), T)?;
        lab.fine(format!("x, mu={friction}"), travel(&fine), x, 1e-9);
        lab.fine(format!("rate, mu={friction}"), fine.last().v[DISC].z.abs(), rate, 1e-9);
    }
    Ok(())
}

/// It rolls iff mu ≥ tan/3 = 0.12132341142206745.
fn threshold(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let rolls = lab.run(&incline(0.121_324, 1e-3), T)?;
    let worst = rolls.worst(|s| slip(s, slope_angle()).abs());
    lab.near("slip at mu=0.121324", worst, 0.0, 1e-10);
    let slides = lab.run(&incline(0.121_323, 1e-3), T)?;
    // The slip grows at 3 g cos (mu − tan/3).
    let exact = 3.0 * 9.81 * slope_angle().cos() * (0.121_323 - 0.121_323_411_422_067_45) * T;
    lab.near("slip at mu=0.121323", slip(slides.last(), slope_angle()), exact, 1e-10);
    Ok(())
}

fn descent_derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (sin, cos) = slope_angle().sin_cos();
    let friction = by_friction(0, DISC);
    // A larger disc of the same mass: inertia m R²/2, centre R above the slope.
    let radius = [
        (Param::Radius(DISC, 0), 1.0),
        (Param::Inertia(DISC), RADIUS),
        (Param::Position(DISC, 0), -sin),
        (Param::Position(DISC, 1), cos),
    ];
    for (mu, by_friction) in [(0.05, -10.370_682_686_148_481), (0.3, 0.0)] {
        let entries: [Slope<'_>; 2] = [("mu", &friction, by_friction), ("R", &radius, 0.0)];
        let what = format!("x, mu={mu}");
        let pick = |s: &mut tangency_diff::StateVector| {
            (s.q[DISC].x, s.q[DISC].y) = (-cos, -sin);
        };
        lab.slopes(&what, (&incline_disc(mu), T), pick, &entries, 1e-6)?;
    }
    Ok(())
}

const ROLLS_FROM: f64 = 0.543_662_928_984_029_9;
const END: f64 = 5.695_775_285_989_353_3;

fn flat(dt: f64) -> SceneDef {
    SceneDef { dt, ..sliding_disc() }
}

/// The first time at which the contact point rests.
fn rolls_from(run: &Run) -> f64 {
    let first = run.moments().find(|s| slip(s, 0.0).abs() <= 1e-9);
    first.map_or(f64::NAN, |state| state.time)
}

fn roll(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for dt in [2e-2, 1e-2, 1e-3] {
        let run = lab.run(&flat(dt), 2.0)?;
        lab.near(format!("v(2) at dt={dt}"), run.last().v[DISC].x, 8.0 / 3.0, 1e-10);
        lab.near(format!("x(2) at dt={dt}"), run.last().q[DISC].x, END, dt);
        lab.near(format!("rolls from, dt={dt}"), rolls_from(&run), ROLLS_FROM, dt);
    }
    lab.order("x(2)", 0.9, |lab, dt| Ok(lab.run(&flat(dt), 2.0)?.last().q[DISC].x - END))?;
    let fine = lab.run(&recommended(sliding_disc()), 2.0)?;
    lab.fine("x(2)", fine.last().q[DISC].x, END, 1e-5);
    lab.fine("v(2)", fine.last().v[DISC].x, 8.0 / 3.0, 1e-10);
    lab.fine("rolls from", rolls_from(&fine), ROLLS_FROM, 1e-5);
    Ok(())
}

fn roll_derivatives(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let (friction, speed) = (by_friction(0, DISC), [(Param::Velocity(DISC, 0), 1.0)]);
    let of_x: [Slope<'_>; 2] =
        [("v0", &speed, 1.514_554_309_661_343_3), ("mu", &friction, -1.449_767_810_624_079_7)];
    let of_v: [Slope<'_>; 2] = [("v0", &speed, 2.0 / 3.0), ("mu", &friction, 0.0)];
    let scene = sliding_disc();
    lab.slopes("x(2)", (&scene, 2.0), |s| s.q[DISC].x = 1.0, &of_x, 1e-6)?;
    lab.slopes("v(2)", (&scene, 2.0), |s| s.v[DISC].x = 1.0, &of_v, 1e-6)
}
