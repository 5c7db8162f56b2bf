//! What must be refused: numbers that mean nothing, and scenes that no motion satisfies.

use tangency_bench::scenes::{
    block, coincident_discs, disc, floor, hinge, overlapping_boxes, overstretched_rod, press,
};
use tangency_core::{
    ControlDef, ControlInput, Scene, SceneDef, Shape, State, StepError, StepScratch, WORLD, step,
};
use tangency_lcp::LcpError;

use crate::{Case, Grade, Lab, Part, Relation, Stop};

pub(crate) const CASES: &[Case] = &[Case {
    id: "V30",
    title: "Refusals",
    parts: &[
        Part::new("numbers of a scene", refuses_numbers),
        Part::new("shapes and joints", refuses_things),
        Part::new("states and controls", refuses_states),
        Part::new("coincident centres", refuses_coincidence),
        Part::new("contradictions", tells_infeasible),
        Part::new("overlap at the start", recovers),
    ],
}];

const INF: f64 = f64::INFINITY;
const NAN: f64 = f64::NAN;

/// A good scene; each figure spoils one thing.
fn good() -> SceneDef {
    let bodies = vec![floor(), block("box", [1.0, 1.0], [0.0, 0.5]), disc("ball", 0.2, [3.0, 1.0])];
    let joints = vec![hinge("pin", WORLD, "ball", [3.0, 2.0])];
    let input = ControlInput::ForceX { body: "box".into() };
    let controls = vec![ControlDef { name: "push".into(), input }];
    SceneDef { bodies, joints, controls, ..SceneDef::default() }
}

/// The spoilt scene must be refused, and the error must name `path`.
fn spoilt(lab: &mut Lab<'_>, path: &str, value: &str, spoil: impl FnOnce(&mut SceneDef)) {
    let mut def = good();
    spoil(&mut def);
    let named = Scene::new(&def).err().is_some_and(|error| error.path() == path);
    lab.holds(format!("{path} {value} is refused by name"), named);
}

fn refuses_numbers(lab: &mut Lab<'_>) -> Result<(), Stop> {
    Scene::new(&good())?;
    for value in [0.0, -1.0, NAN, INF] {
        let told = format!("= {value}");
        spoilt(lab, "dt", &told, |d| d.dt = value);
        spoilt(lab, "bodies[1].mass", &told, |d| d.bodies[1].mass = Some(value));
        spoilt(lab, "bodies[1].inertia", &told, |d| d.bodies[1].inertia = Some(value));
    }
    for value in [-0.1, NAN, INF] {
        let told = format!("= {value}");
        spoilt(lab, "bodies[1].friction", &told, |d| d.bodies[1].friction = value);
        spoilt(lab, "bodies[1].restitution", &told, |d| d.bodies[1].restitution = value);
    }
    spoilt(lab, "bodies[1].restitution", "= 1.1", |d| d.bodies[1].restitution = 1.1);
    for value in [NAN, INF] {
        let told = format!("= {value}");
        spoilt(lab, "bodies[1].position[0]", &told, |d| d.bodies[1].position[0] = value);
        spoilt(lab, "bodies[1].angle", &told, |d| d.bodies[1].angle = value);
        spoilt(lab, "bodies[1].velocity[1]", &told, |d| d.bodies[1].velocity[1] = value);
        let path = "bodies[1].angular_velocity";
        spoilt(lab, path, &told, |d| d.bodies[1].angular_velocity = value);
    }
    Ok(())
}

fn refuses_things(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let polygons: [(&str, Vec<[f64; 2]>); 4] = [
        ("of two points", vec![[0.0, 0.0], [1.0, 0.0]]),
        ("of points on a line", vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]),
        ("of one point three times", vec![[1.0, 1.0]; 3]),
        ("with a NaN", vec![[0.0, NAN], [1.0, 1.0], [2.0, 0.0]]),
    ];
    for (what, points) in polygons {
        let shapes = vec![Shape::Polygon { points }];
        spoilt(lab, "bodies[1].shapes[0]", what, |d| d.bodies[1].shapes = shapes);
    }
    let own = |d: &mut SceneDef| d.joints[0].bodies = ["ball".into(), "ball".into()];
    spoilt(lab, "joints[0].bodies", "twice the same", own);
    Ok(())
}

fn refuses_states(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let scene = Scene::new(&good())?;
    let initial = scene.initial_state();
    for value in [NAN, INF, -INF] {
        let (mut pose, mut velocity) = (initial.clone(), initial.clone());
        (pose.q[1].y, velocity.v[2].z) = (value, value);
        for (what, index, state, control) in [
            ("pose of body", 1, &pose, 0.0),
            ("velocity of body", 2, &velocity, 0.0),
            ("control", 0, &initial, value),
        ] {
            let error = first_error(lab, &scene, state, control);
            let named = matches!(error, Some(StepError::NotFinite { what: of, index: i })
                if of == what && i == index);
            lab.holds(format!("{what} {index} = {value} is refused by name"), named);
        }
    }
    Ok(())
}

fn first_error(lab: &Lab<'_>, scene: &Scene, state: &State, control: f64) -> Option<StepError> {
    let control = vec![control; scene.controls().len()];
    step(scene, lab.solver(), state, &control, &mut StepScratch::default()).err()
}

/// The only step of a definition that must not be taken.
fn refusal(lab: &Lab<'_>, def: &SceneDef) -> Result<Option<StepError>, Stop> {
    let scene = Scene::new(def)?;
    Ok(first_error(lab, &scene, &scene.initial_state(), 0.0))
}

fn refuses_coincidence(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let error = refusal(lab, &coincident_discs())?;
    let collision = matches!(error, Some(StepError::Collision { .. }));
    lab.holds("coincident centres are refused", collision);
    let told = error.map_or(String::new(), |error| error.to_string());
    lab.holds("coincident centres: the bodies are named", told.contains("bodies 0 and 1"));
    Ok(())
}

fn tells_infeasible(lab: &mut Lab<'_>) -> Result<(), Stop> {
    for (body, def) in [("rod", overstretched_rod()), ("box", press())] {
        let error = refusal(lab, &def)?;
        lab.holds(format!("{}: no state is returned", def.name), error.is_some());
        let Some(StepError::Lcp { bodies, source, .. }) = error else { continue };
        lab.holds(format!("{}: its body is named", def.name), bodies == body);
        let infeasible = matches!(source, LcpError::Infeasible { .. });
        lab.holds(format!("{}: told infeasible", def.name), infeasible);
        let residual = source.residual().unwrap_or(f64::NAN);
        lab.at_least(format!("{}: residual", def.name), residual, 1e-6);
    }
    Ok(())
}

/// The boxes part at 1 m/s at most, and no speed is left of it.
fn recovers(lab: &mut Lab<'_>) -> Result<(), Stop> {
    let run = lab.run(&overlapping_boxes(), 0.5)?;
    let gap = |s: &State| (s.q[1].x - s.q[0].x) - 1.0;
    let gaps: Vec<f64> = run.tape.states().map(gap).collect();
    let dt = run.scene.dt();
    let fastest = gaps.windows(2).map(|pair| (pair[1] - pair[0]) / dt).fold(0.0, f64::max);
    let most = [fastest, 1.0, 1e-12]; // up to the rounding of the positions
    lab.figure("overlap: greatest speed of recovery", Grade::Step, Relation::AtMost, most);
    lab.near("overlap: gap at the end", gap(run.last()), 0.0, 1e-9);
    let speed = run.worst(|s| s.v.iter().map(nalgebra::Matrix::norm).fold(0.0, f64::max));
    lab.near("overlap: greatest speed kept", speed, 0.0, 1e-9);
    Ok(())
}
