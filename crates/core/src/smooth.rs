//! What a smooth flow solved, and why it ended.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use tangency_collision::Contact;

use crate::State;
use crate::motion::Motion;
use crate::record::{IslandRecord, StepRecord};
use crate::row::{RowContext, RowSource};
use crate::scene::Scene;
use crate::stage::Stage;

/// The weights of a flow's slopes: the part of its length that each stands for.
pub const WEIGHTS: [f64; 4] = [1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// From which slope, and after which part of the flow, the next three states follow.
pub const STEPS: [f64; 3] = [0.5, 0.5, 1.0];

/// The accelerations of a flow at one of its four states.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Slope {
    /// The state.
    pub at: State,
    /// The flow's contacts, evaluated there.
    pub contacts: Vec<Contact>,
    /// The problems: their momenta are forces, N and N·m, their velocities accelerations, their
    /// impulses forces.
    pub islands: Vec<IslandRecord>,
    /// Accelerations of all bodies, (m/s², m/s², rad/s²).
    pub accelerations: Vec<Vector3<f64>>,
}

impl Slope {
    /// How fast bodies accelerate, and would if no row held them: what speeds are small beside.
    pub(crate) fn rates(&self) -> Vec<Vector3<f64>> {
        let mut rates: Vec<_> = self.accelerations.iter().map(Vector3::abs).collect();
        for IslandRecord { bodies, problem, .. } in &self.islands {
            for ((body, force), mass) in bodies.iter().zip(&problem.momentum).zip(&problem.mass) {
                rates[*body as usize] += force.component_div(mass).abs();
            }
        }
        rates
    }
}

/// What brought the velocities of a flow back to what its rows hold.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Meeting {
    /// The state before: poses are already mended.
    pub before: State,
    /// The impulses of least size.
    pub record: StepRecord,
}

/// Why a flow ended before its step did. Impacts tell their own time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// A contact that slid stopped doing so, or a motor came up to its speed.
    Speed(RowSource),
    /// A force began or ended.
    Clock,
    /// A contact opened or began to slide, or a motor gave way. Accelerations do not jump there, and what
    /// follows does not depend on the time of it.
    Force(RowSource),
}

/// What a smooth flow solved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SmoothRecord {
    /// The four slopes of Runge and Kutta's method.
    pub slopes: Vec<Slope>,
    /// What brought velocities back to what is held; `None` where nothing is, or no time passed.
    pub meeting: Option<Box<Meeting>>,
    /// Why the flow ended before its step did; `None` for impacts and at the end of the step.
    pub end: Option<End>,
}

impl StepRecord {
    /// The problems of the step; of a smooth flow those of its first slope.
    #[must_use]
    pub fn problems(&self) -> &[IslandRecord] {
        match &self.smooth {
            Some(smooth) => smooth.slopes.first().map_or(&[], |slope| &slope.islands),
            None => &self.islands,
        }
    }

    /// What the rows of one of a flow's slopes were evaluated from.
    #[must_use]
    pub fn slope_context<'a>(&'a self, scene: &'a Scene, slope: &'a Slope) -> RowContext<'a> {
        RowContext {
            scene,
            stage: Stage::Velocity,
            motion: Motion::Smooth,
            dt: 1.0,
            q: &slope.at.q,
            v: &slope.at.v,
            control: &self.control,
            contacts: &slope.contacts,
            loose: &[],
            slow: &[],
            marked: &[],
        }
    }

    /// The time at which it is decided which forces act in a flow, s: its middle.
    #[must_use]
    pub fn middle(&self) -> f64 {
        self.after.time - 0.5 * self.dt
    }
}
