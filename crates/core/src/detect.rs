//! Which contacts and limits are in reach of a step.

use nalgebra::Vector3;
use tangency_collision::{CollisionError, Contact, Detector, Frame, Near};

use crate::compile::LEAST;
use crate::reach::{Groups, Link};
use crate::scene::Scene;
use crate::{ContactModel, State, StepError};

/// All bodies up to this part of their size away are looked at, whatever their reach.
const VICINITY: f64 = 0.5;

/// Memory of detection, and what it knows of the last state that it was given.
#[derive(Debug, Default)]
pub(crate) struct Detection {
    detector: Detector,
    groups: Groups,
    /// How far around each body its neighbours are looked for, m.
    vicinity: Vec<f64>,
    near: Vec<Near>,
}

impl Detection {
    /// Replaces `found` by the contacts that the step must know of, in the order of their ids.
    ///
    /// # Errors
    /// [`StepError::Collision`] or [`StepError::CoincidentAnchors`] where geometry has no answer
    /// (coincident centres, a distance of zero).
    pub(crate) fn detect(
        &mut self,
        scene: &Scene,
        state: &State,
        frames: &[Frame],
        momentum: &[Vector3<f64>],
        found: &mut Vec<Contact>,
    ) -> Result<(), StepError> {
        check_lengths(scene, state.time, frames)?;
        if scene.touches || scene.joined.limited {
            self.groups.measure(scene, &state.v, momentum);
        }
        if !scene.touches {
            found.clear();
            return Ok(());
        }
        self.contacts(scene, frames, found)
            .map_err(|source| StepError::Collision { time: state.time, source })
    }

    /// Replaces `found` by the contacts with a gap of at most `reach`, m.
    ///
    /// # Errors
    /// [`StepError::Collision`] where centres coincide.
    pub(crate) fn within(
        &mut self,
        scene: &Scene,
        time: f64,
        frames: &[Frame],
        reach: f64,
        found: &mut Vec<Contact>,
    ) -> Result<(), StepError> {
        self.all_within(scene, frames, reach, found)
            .map_err(|source| StepError::Collision { time, source })
    }

    /// How far they can get.
    pub(crate) fn groups(&self) -> &Groups {
        &self.groups
    }

    /// Contacts in reach, by the smallest groups that leave nobody out ([`crate::reach`]).
    ///
    /// Where nothing moves far, all contacts as far away as anything moves are found, and their gaps
    /// give the groups. Otherwise boxes give groups first, at most too large, and hence pairs and
    /// reaches that suffice.
    fn contacts(
        &mut self,
        scene: &Scene,
        frames: &[Frame],
        found: &mut Vec<Contact>,
    ) -> Result<(), CollisionError> {
        let ContactModel::Velocity { contact_distance } = scene.def.contact_model else {
            let far = scene.contact_reach();
            let greatest = self.groups.greatest().max(far);
            let slow = |i| scene.fixed[i] || greatest <= VICINITY * scene.size(i);
            if far > 0.0 || (0..scene.bodies.len()).all(slow) {
                self.all_within(scene, frames, greatest, found)?;
            } else {
                self.all_near(scene, frames, greatest, found)?;
                self.groups.restart(scene);
            }
            self.groups.grow(&scene.fixed, &links(found), None);
            found.retain(|c| c.gap <= self.groups.of_pair(c.feature.id.bodies).max(far));
            return Ok(());
        };
        self.all_within(scene, frames, contact_distance, found)?;
        self.groups.grow(&scene.fixed, &links(found), Some(contact_distance));
        Ok(())
    }

    /// Replaces `found` by all contacts within the reach of the groups that the boxes make.
    ///
    /// Each body looks around it as far as its group gets, dynamic ones at least half their size;
    /// where groups then get further, once more.
    fn all_near(
        &mut self,
        scene: &Scene,
        frames: &[Frame],
        greatest: f64,
        found: &mut Vec<Contact>,
    ) -> Result<(), CollisionError> {
        let Self { detector, groups, vicinity, near } = self;
        detector.place(&scene.colliders, frames, &scene.fixed)?;
        let least = |i: usize| if scene.fixed[i] { 0.0 } else { VICINITY * scene.size(i) };
        vicinity.clear();
        vicinity.extend((0..frames.len()).map(|i| groups.of(i).linear.max(least(i)).min(greatest)));
        loop {
            detector.near(vicinity, near);
            near.retain(|pair| scene.collides(pair.bodies[0] as usize, pair.bodies[1] as usize));
            let links = near.iter().map(|pair| (pair.bodies, pair.apart));
            groups.grow(&scene.fixed, &links, None);
            let reach = |i: usize| groups.of(i).linear;
            if vicinity.iter().enumerate().all(|(i, vicinity)| reach(i) <= *vicinity) {
                break;
            }
            vicinity
                .iter_mut()
                .enumerate()
                .for_each(|(i, vicinity)| *vicinity = vicinity.max(reach(i)));
        }
        found.clear();
        for pair in near {
            let reach = groups.of_pair(pair.bodies);
            if pair.apart <= reach {
                detector.between(pair.bodies, reach, found)?;
            }
        }
        Ok(())
    }

    /// Replaces `found` by all contacts with a gap of at most `reach`, m.
    fn all_within(
        &mut self,
        scene: &Scene,
        frames: &[Frame],
        reach: f64,
        found: &mut Vec<Contact>,
    ) -> Result<(), CollisionError> {
        let Self { detector, vicinity, near, .. } = self;
        detector.place(&scene.colliders, frames, &scene.fixed)?;
        vicinity.clear();
        vicinity.resize(frames.len(), reach);
        detector.near(vicinity, near);
        found.clear();
        for Near { bodies, .. } in near {
            if scene.collides(bodies[0] as usize, bodies[1] as usize) {
                detector.between(*bodies, reach, found)?;
            }
        }
        Ok(())
    }
}

/// Refuses distances of zero, which have no direction.
fn check_lengths(scene: &Scene, time: f64, frames: &[Frame]) -> Result<(), StepError> {
    let anchor = |body: Option<usize>, local| body.map_or(local, |b| frames[b].point(&local));
    for joint in scene.joints.iter().filter(|joint| joint.holds_length()) {
        let [a, b] = [0, 1].map(|i| anchor(joint.bodies[i], joint.anchors[i]));
        if (b - a).norm() < LEAST {
            return Err(StepError::CoincidentAnchors { time, joint: joint.name.clone() });
        }
    }
    Ok(())
}

/// What connects bodies: contacts and their gaps.
fn links(found: &[Contact]) -> impl DoubleEndedIterator<Item = Link> + Clone {
    found.iter().map(|contact| (contact.feature.id.bodies, contact.gap))
}
