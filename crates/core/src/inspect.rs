//! What is modelled at a state, and what is wrong with it.

use std::fmt;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use tangency_lcp::Law;

use crate::StepScratch;
use crate::detect::Detection;
use crate::frames::Frames;
use crate::record::Path;
use crate::row::{RowContext, RowSource};
use crate::scene::Scene;
use crate::step::set_up;
use crate::{BodyKind, JointRow, State, StepError};

/// Rows and bodies of one island.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct IslandInspection {
    /// Names of its bodies.
    pub bodies: Vec<String>,
    /// The path that its problem takes.
    pub path: Path,
    /// Rows of joints, springs and unbounded motors.
    pub equality_rows: usize,
    /// Rows of motors with a greatest force.
    pub motor_rows: usize,
    /// Rows of joint limits in reach.
    pub limit_rows: usize,
    /// Normal rows of contacts in reach.
    pub contact_rows: usize,
    /// Friction rows.
    pub friction_rows: usize,
}

/// What one step from a state would model.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Inspection {
    /// Dynamic bodies: the only ones with unknowns.
    pub dynamic_bodies: usize,
    /// Static and kinematic bodies.
    pub other_bodies: usize,
    /// Names of dynamic bodies that nothing is in reach of: closed form, no solve.
    pub free_bodies: Vec<String>,
    /// Islands in order.
    pub islands: Vec<IslandInspection>,
}

/// What the next step from `state` would model, with all controls zero.
///
/// # Errors
/// A [`StepError`] where the state does not fit the scene or geometry has no answer.
pub fn inspect(scene: &Scene, state: &State) -> Result<Inspection, StepError> {
    state.check(scene.bodies.len())?;
    let control = vec![0.0; scene.controls.len()];
    let setup = set_up(scene, state, &control, scene.dt, &mut StepScratch::default())?;
    let name = |body: usize| scene.bodies[body].name.clone();
    let mut bound = vec![false; scene.bodies.len()];
    let mut islands = Vec::new();
    for island in &setup.islands {
        island.bodies.iter().for_each(|b| bound[*b as usize] = true);
        let count = |f: &dyn Fn(&RowSource, &Law) -> bool| {
            let rows = island.sources.iter().zip(&island.problem.rows);
            rows.filter(|(source, row)| f(source, &row.law)).count()
        };
        islands.push(IslandInspection {
            bodies: island.bodies.iter().map(|b| name(*b as usize)).collect(),
            path: Path::of(&island.problem),
            equality_rows: count(&|_, law| *law == Law::Equality),
            motor_rows: count(&|_, law| matches!(law, Law::Bounded { .. })),
            limit_rows: count(&|source, _| {
                matches!(source, RowSource::Lower { .. } | RowSource::Upper { .. })
            }),
            contact_rows: count(&|source, _| matches!(source, RowSource::Normal { .. })),
            friction_rows: count(&|_, law| matches!(law, Law::Friction { .. })),
        });
    }
    let dynamic: Vec<usize> = (0..bound.len()).filter(|i| scene.is_dynamic(*i)).collect();
    Ok(Inspection {
        dynamic_bodies: dynamic.len(),
        other_bodies: bound.len() - dynamic.len(),
        free_bodies: dynamic.iter().filter(|i| !bound[**i]).map(|i| name(*i)).collect(),
        islands,
    })
}

impl fmt::Display for Inspection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "dynamic bodies   {}", self.dynamic_bodies)?;
        writeln!(f, "other bodies     {}", self.other_bodies)?;
        writeln!(f, "free flight      {}", list(&self.free_bodies))?;
        for (i, island) in self.islands.iter().enumerate() {
            let path = match island.path {
                Path::Linear => "one linear solve",
                Path::Complementarity => "complementarity problem",
            };
            writeln!(f, "island {:<9} {}", i + 1, list(&island.bodies))?;
            writeln!(
                f,
                "  {path}: {} equality, {} motor, {} limit, {} contact, {} friction rows",
                island.equality_rows,
                island.motor_rows,
                island.limit_rows,
                island.contact_rows,
                island.friction_rows
            )?;
        }
        Ok(())
    }
}

fn list(names: &[String]) -> String {
    const SHOWN: usize = 6;
    let more = names.len().saturating_sub(SHOWN);
    let shown = names[..names.len() - more].join(", ");
    match (names.len(), more) {
        (0, _) => "none".into(),
        (n, 0) => format!("{n}: {shown}"),
        (n, _) => format!("{n}: {shown}, and {more} more"),
    }
}

impl Scene {
    /// Mechanical energy, J: kinetic, of gravity (zero at the origin), and of springs.
    #[must_use]
    pub fn energy(&self, state: &State) -> f64 {
        let mut energy = 0.0;
        for (i, body) in self.bodies.iter().enumerate() {
            if body.kind == BodyKind::Dynamic {
                energy += 0.5 * state.v[i].dot(&body.mass.component_mul(&state.v[i]));
                let height = self.gravity.dot(&state.q[i].xy());
                energy -= body.mass.x * body.gravity_scale * height;
            }
        }
        let soft = self.position_errors(state, true);
        energy + soft.iter().map(|(k, error)| 0.5 * k * error * error).sum::<f64>()
    }

    /// The largest position error of the rigid joints, m or rad.
    #[must_use]
    pub fn joint_drift(&self, state: &State) -> f64 {
        self.position_errors(state, false).iter().map(|(_, error)| error.abs()).fold(0.0, f64::max)
    }

    /// The deepest penetration, m; 0 where nothing penetrates.
    ///
    /// # Errors
    /// A [`StepError`] where geometry has no answer.
    pub fn penetration(&self, state: &State) -> Result<f64, StepError> {
        state.check(self.bodies.len())?;
        let mut contacts = Vec::new();
        let mut frames = Frames::default();
        frames.place(&state.q);
        let (detection, frames) = (&mut Detection::default(), frames.bodies());
        detection.within(self, state.time, frames, 0.0, &mut contacts)?;
        Ok(contacts.iter().map(|c| -c.gap).fold(0.0, f64::max))
    }

    /// (stiffness, error) of every held row of the soft, or of the rigid, joints.
    fn position_errors(&self, state: &State, soft: bool) -> Vec<(f64, f64)> {
        let context = RowContext::of(self, state, &[], self.dt);
        let mut errors = Vec::new();
        for (index, joint) in (0_u32..).zip(&self.joints) {
            if joint.softness.is_some() == soft {
                let stiffness = joint.softness.map_or(0.0, |s| s.stiffness);
                let error = |row: &JointRow| (stiffness, context.joint_geometry(index, *row).value);
                errors.extend(joint.held.iter().map(error));
            }
        }
        errors
    }

    /// Linear momentum (N·s, N·s) and angular momentum about the origin (N·m·s).
    #[must_use]
    pub fn total_momentum(&self, state: &State) -> Vector3<f64> {
        let part = |(i, body): (usize, &crate::Body)| {
            let p = body.mass.component_mul(&state.v[i]);
            Vector3::new(p.x, p.y, p.z + state.q[i].xy().perp(&p.xy()))
        };
        self.bodies.iter().enumerate().map(part).sum()
    }
}
