//! An observed motion, and how far a rollout is from it.
//!
//! ```text
//!  r = q(t) − observed(t)        per observed time, body and coordinate (x, y, angle)
//!  L = Σ r² / N                  mean over the N of them
//! ```
//!
//! Motions are compared at equal *times*. Where an observed time falls between two steps, the
//! rollout's poses are interpolated linearly: q(t) = (1 − s) q_k + s q_{k+1}.

use std::path::{Path, PathBuf};

use nalgebra::Vector3;
use tangency::diff::StateVector;
use tangency::{Rollout, Scene, State};

use crate::Failure;
use crate::trajectory_file::{Row, read_rows};

/// Observed times nearer to a step than this fraction of it are at the step.
const AT_STEP: f64 = 1e-9;

/// Greatest observed number, as in scenes.
const LARGEST: f64 = 1e50;

/// Poses of some bodies at some times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observations {
    /// The observed bodies, by index.
    pub bodies: Vec<usize>,
    /// In time order.
    pub frames: Vec<ObservedFrame>,
}

/// Poses at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedFrame {
    /// Time, s.
    pub time: f64,
    /// Poses of the observed bodies, (m, m, rad).
    pub poses: Vec<Vector3<f64>>,
}

/// Where an observed time lies among the steps: between states k and k + 1, at a share s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    k: usize,
    s: f64,
}

impl Observations {
    /// What a rollout shows of some bodies: one frame per state, the initial one included.
    #[must_use]
    pub fn of(rollout: &Rollout, bodies: Vec<usize>) -> Self {
        let frame = |state: &State| ObservedFrame {
            time: state.time,
            poses: bodies.iter().map(|b| state.q[*b]).collect(),
        };
        Self { frames: rollout.states().map(frame).collect(), bodies }
    }

    /// Reads a trajectory as `simulate` writes it. Bodies that cannot move are left out.
    ///
    /// # Errors
    /// The line that is malformed, or names no body of the scene, or is out of order.
    pub fn read(file: &Path, scene: &Scene) -> Result<Self, Failure> {
        let rows = read_rows(file)?;
        let first_line = if file.extension().is_some_and(|e| e == "jsonl") { 1 } else { 2 };
        Reader { file: file.to_owned(), first_line, scene }.observations(&rows)
    }

    /// Time of the last frame, s; 0 if there is none.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.frames.last().map_or(0.0, |frame| frame.time)
    }

    /// Only the frames up to a time.
    #[must_use]
    pub fn until(&self, time: f64) -> Self {
        let early = |frame: &&ObservedFrame| frame.time <= time * (1.0 + AT_STEP);
        Self {
            bodies: self.bodies.clone(),
            frames: self.frames.iter().filter(early).cloned().collect(),
        }
    }

    /// How many numbers were observed.
    #[must_use]
    pub fn len(&self) -> usize {
        3 * self.bodies.len() * self.frames.len()
    }

    /// Whether nothing was observed.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether any observed time but 0 is exactly that of a step.
    #[must_use]
    pub fn meets_steps(&self, states: &[&State]) -> bool {
        self.frames.iter().any(|frame| frame.time > 0.0 && place(states, frame.time).s == 0.0)
    }

    /// The mean squared error of a rollout, m² (and rad²).
    #[must_use]
    pub fn loss(&self, states: &[&State]) -> f64 {
        let squares = self.residuals(states).map(|(_, _, r)| r.norm_squared());
        squares.sum::<f64>() / self.len() as f64
    }

    /// ∂L/∂(state k) for every state of the rollout.
    #[must_use]
    pub fn seeds(&self, states: &[&State]) -> Vec<StateVector> {
        let mut seeds = vec![StateVector::like(states[0]); states.len()];
        let scale = 2.0 / self.len() as f64;
        for (place, body, r) in self.residuals(states) {
            let bar = scale * r;
            let Place { k, s } = place;
            seeds[k].q[body] += (1.0 - s) * bar;
            if let Some(between) = interval(states, k) {
                seeds[k + 1].q[body] += s * bar;
                // The observed time stays; that of the steps moves with dt.
                let slope = between.speed(body).dot(&bar);
                seeds[k].time -= (1.0 - s) * slope;
                seeds[k + 1].time -= s * slope;
            }
        }
        seeds
    }

    /// All residuals one after the other, each divided by √N: their squares add up to the loss.
    #[must_use]
    pub fn scaled_residuals(&self, states: &[&State]) -> Vec<f64> {
        let scale = 1.0 / (self.len() as f64).sqrt();
        self.residuals(states).flat_map(|(_, _, r)| [r.x, r.y, r.z].map(|r| scale * r)).collect()
    }

    /// How the scaled residuals change when the states change by `tangent`.
    #[must_use]
    pub fn scaled_changes(&self, states: &[&State], tangent: &[StateVector]) -> Vec<f64> {
        let scale = 1.0 / (self.len() as f64).sqrt();
        let mut changes = Vec::with_capacity(self.len());
        for frame in &self.frames {
            let Place { k, s } = place(states, frame.time);
            for body in &self.bodies {
                let mut change = (1.0 - s) * tangent[k].q[*body];
                if let Some(between) = interval(states, k) {
                    let time = (1.0 - s) * tangent[k].time + s * tangent[k + 1].time;
                    change += s * tangent[k + 1].q[*body] - time * between.speed(*body);
                }
                changes.extend([change.x, change.y, change.z].map(|c| scale * c));
            }
        }
        changes
    }

    /// Place, body and r of everything observed.
    fn residuals<'a>(
        &'a self,
        states: &'a [&'a State],
    ) -> impl Iterator<Item = (Place, usize, Vector3<f64>)> + 'a {
        self.frames.iter().flat_map(move |frame| {
            let place = place(states, frame.time);
            let after = states[(place.k + 1).min(states.len() - 1)];
            let before = states[place.k];
            self.bodies.iter().zip(&frame.poses).map(move |(body, observed)| {
                let q = (1.0 - place.s) * before.q[*body] + place.s * after.q[*body];
                (place, *body, q - observed)
            })
        })
    }
}

/// Two states with time between them.
struct Interval<'a> {
    before: &'a State,
    after: &'a State,
}

impl Interval<'_> {
    /// Slope of the interpolated pose, m/s and rad/s.
    fn speed(&self, body: usize) -> Vector3<f64> {
        (self.after.q[body] - self.before.q[body]) / (self.after.time - self.before.time)
    }
}

/// The step from state k, if there is one.
fn interval<'a>(states: &[&'a State], k: usize) -> Option<Interval<'a>> {
    Some(Interval { before: states[k], after: states.get(k + 1)? })
}

/// The place of a time; times beyond the last state are at the last state.
fn place(states: &[&State], time: f64) -> Place {
    let steps = states.len() - 1;
    let after = states[1..].partition_point(|state| state.time <= time);
    let k = after.min(steps);
    if k == steps {
        return Place { k, s: 0.0 };
    }
    let (start, end) = (states[k].time, states[k + 1].time);
    let s = ((time - start) / (end - start)).clamp(0.0, 1.0);
    if s > 1.0 - AT_STEP {
        Place { k: k + 1, s: 0.0 }
    } else {
        Place { k, s: if s < AT_STEP { 0.0 } else { s } }
    }
}

/// Turns the rows of a file into frames.
struct Reader<'a> {
    file: PathBuf,
    first_line: usize,
    scene: &'a Scene,
}

impl Reader<'_> {
    fn observations(&self, rows: &[Row]) -> Result<Observations, Failure> {
        let mut seen = Observations::default();
        for (index, row) in rows.iter().enumerate() {
            let body = self.scene.body_index(&row.body).ok_or_else(|| {
                let known = self.scene.bodies().iter().map(|b| b.name.as_str());
                let known = known.collect::<Vec<_>>().join(", ");
                self.wrong(index, format!("body: the scene has no {:?}; known: {known}", row.body))
            })?;
            if self.scene.is_dynamic(body) {
                let pose = Vector3::new(row.x, row.y, row.angle);
                self.add(&mut seen, index, row.time, body, pose)?;
            }
        }
        if seen.is_empty() {
            return Err(self.wrong(0, "no body of the scene that moves is observed".into()));
        }
        let missing = seen.frames.iter().find(|frame| frame.poses.len() < seen.bodies.len());
        let Some(ObservedFrame { time, .. }) = missing else { return Ok(seen) };
        let what = format!("at time {time} some bodies are missing; every time needs the same");
        Err(self.wrong(rows.len() - 1, what))
    }

    /// Adds a pose; the bodies of the first frame set the order for all.
    fn add(
        &self,
        seen: &mut Observations,
        index: usize,
        time: f64,
        body: usize,
        pose: Vector3<f64>,
    ) -> Result<(), Failure> {
        // Their squares must not overflow, either.
        let sound = |x: &f64| x.abs() <= LARGEST;
        if !(sound(&time) && time >= 0.0 && pose.iter().all(sound)) {
            let what = "time, x, y and angle must be finite (at most 1e50), and time not negative";
            return Err(self.wrong(index, what.into()));
        }
        let same_time = seen.frames.last().is_some_and(|frame| frame.time == time);
        if !same_time {
            if seen.frames.last().is_some_and(|frame| frame.time > time) {
                return Err(self.wrong(index, format!("time: {time} comes after a later time")));
            }
            seen.frames.push(ObservedFrame { time, poses: Vec::new() });
        }
        let first = seen.frames.len() == 1;
        let Some(frame) = seen.frames.last_mut() else { return Ok(()) };
        if first {
            seen.bodies.push(body);
        } else if seen.bodies.get(frame.poses.len()) != Some(&body) {
            let what = "body: every time needs the same bodies in the same order";
            return Err(self.wrong(index, what.into()));
        }
        frame.poses.push(pose);
        Ok(())
    }

    fn wrong(&self, index: usize, message: String) -> Failure {
        let line = (index + self.first_line) as u64;
        Failure::Input { file: self.file.clone(), line, message }
    }
}
