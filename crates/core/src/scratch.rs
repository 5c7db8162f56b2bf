//! Memory that is reused between steps.

use nalgebra::Vector3;
use tangency_collision::Contact;
use tangency_lcp::{Guess, Lcp, Pool, Row, Scratch};

use crate::detect::Detection;
use crate::frames::Frames;
use crate::guess::Places;
use crate::island::{Groups, Island};
use crate::motion::Motion;
use crate::progress::Progress;
use crate::record::{IslandRecord, PostRecord, StepRecord};
use crate::row::{RowSource, SlowRow};
use crate::rows::Rows;
use crate::smooth::{Slope, SmoothRecord};
use crate::{Rollout, Stage, State};

/// Memory that is reused between steps; it never changes a result.
///
/// Once it has seen a few steps and gets their records [back](Self::recycle), stepping allocates
/// nothing.
#[derive(Debug, Default)]
pub struct StepScratch {
    pub(crate) lcp: Scratch,
    pub(crate) detection: Detection,
    pub(crate) frames: Frames,
    pub(crate) rows: Rows,
    pub(crate) groups: Groups,
    pub(crate) places: Places,
    pub(crate) guess: Guess,
    #[cfg(feature = "parallel")]
    pub(crate) shares: crate::shares::Shares,
    pub(crate) islands: Pool<Island>,
    pub(crate) records: Pool<IslandRecord>,
    pub(crate) progress: Progress,
    pub(crate) posts: Pool<PostRecord>,
    pub(crate) contacts: Pool<Contact>,
    pub(crate) vectors: Pool<Vector3<f64>>,
    pub(crate) floats: Pool<f64>,
    pub(crate) flags: Pool<bool>,
    bodies: Pool<u32>,
    pub(crate) slow: Pool<SlowRow>,
    sources: Pool<RowSource>,
    problem_rows: Pool<Row>,
}

impl StepScratch {
    /// Takes the memory of a record that is needed no more.
    pub fn recycle(&mut self, record: StepRecord) {
        let StepRecord { control, contacts, islands, post, after, .. } = record;
        if record.motion != Motion::Fixed || !record.parts.is_empty() {
            record.parts.into_iter().for_each(|part| self.recycle(part));
            self.vectors.give(record.midway);
            self.flags.give(record.bounces);
            if let Some(smooth) = record.smooth {
                self.recycle_smooth(*smooth);
            }
        }
        self.floats.give(control);
        self.contacts.give(contacts);
        self.recycle_islands(islands);
        if !post.is_empty() {
            self.recycle_posts(post);
        }
        self.vectors.give(after.q);
        self.vectors.give(after.v);
    }

    /// Takes the memory of the factored systems of a record that is kept, but rarely differentiated: a
    /// derivative then factors them again, to the same bits.
    pub fn recycle_systems(&mut self, record: &mut StepRecord) {
        record.parts.iter_mut().for_each(|part| self.recycle_systems(part));
        if let Some(smooth) = &mut record.smooth {
            let slopes = smooth.slopes.iter_mut().flat_map(|slope| &mut slope.islands);
            slopes.for_each(|island| self.lcp.recycle_system(&mut island.solution));
            smooth.meeting.iter_mut().for_each(|it| self.recycle_systems(&mut it.record));
        }
        let post = record.post.iter_mut().flat_map(|post| &mut post.islands);
        for island in record.islands.iter_mut().chain(post) {
            self.lcp.recycle_system(&mut island.solution);
        }
    }

    /// Takes the memory of a run that is needed no more.
    pub fn recycle_run(&mut self, run: Rollout) {
        run.records.into_iter().for_each(|record| self.recycle(record));
    }

    fn recycle_posts(&mut self, mut posts: Vec<PostRecord>) {
        posts.drain(..).for_each(|post| self.recycle_post(post));
        self.posts.give(posts);
    }

    fn recycle_smooth(&mut self, smooth: SmoothRecord) {
        for Slope { at, contacts, islands, accelerations } in smooth.slopes {
            self.vectors.give(at.q);
            self.vectors.give(at.v);
            self.contacts.give(contacts);
            self.recycle_islands(islands);
            self.vectors.give(accelerations);
        }
        if let Some(meeting) = smooth.meeting {
            self.vectors.give(meeting.before.q);
            self.vectors.give(meeting.before.v);
            self.recycle(meeting.record);
        }
    }

    /// Takes the memory of a displacement.
    pub(crate) fn recycle_post(&mut self, post: PostRecord) {
        let PostRecord { moved, contacts, loose, slow, marked, islands } = post;
        self.flags.give(marked);
        self.vectors.give(moved);
        self.contacts.give(contacts);
        self.flags.give(loose);
        self.slow.give(slow);
        self.recycle_islands(islands);
    }

    fn recycle_islands(&mut self, mut islands: Vec<IslandRecord>) {
        for island in islands.drain(..) {
            self.bodies.give(island.bodies);
            self.sources.give(island.sources);
            self.recycle_problem(island.problem);
            self.lcp.recycle(island.solution);
        }
        self.records.give(islands);
    }

    fn recycle_problem(&mut self, problem: Lcp) {
        self.vectors.give(problem.mass);
        self.vectors.give(problem.momentum);
        self.problem_rows.give(problem.rows);
    }

    /// Takes the memory of an island that is not solved.
    pub(crate) fn recycle_island(&mut self, island: Island) {
        self.bodies.give(island.bodies);
        self.sources.give(island.sources);
        self.recycle_problem(island.problem);
    }

    /// An island without bodies and rows.
    pub(crate) fn island(&mut self, stage: Stage) -> Island {
        let (mass, momentum) = (self.vectors.take(), self.vectors.take());
        let problem = Lcp { mass, momentum, rows: self.problem_rows.take() };
        Island { bodies: self.bodies.take(), sources: self.sources.take(), problem, stage }
    }

    /// A copy of a state.
    pub(crate) fn copy(&mut self, state: &State) -> State {
        let (mut q, mut v) = (self.vectors.take(), self.vectors.take());
        q.extend_from_slice(&state.q);
        v.extend_from_slice(&state.v);
        State { time: state.time, q, v }
    }

    /// A copy of a control.
    pub(crate) fn copy_control(&mut self, control: &[f64]) -> Vec<f64> {
        let mut copy = self.floats.take();
        copy.extend_from_slice(control);
        copy
    }
}
