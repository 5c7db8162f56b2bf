//! What tells the time at which a flow ends: a function of the state there that is zero.
//!
//! ```text
//!  gap      g(q, p)                  speed    J(q) v − target                  clock    t − t_event
//! ```

use tangency_core::row::{RowContext, RowSource};
use tangency_core::{End, Scene, StepRecord};

use crate::island::{gap_jvp, gap_vjp, speed_jvp, speed_vjp};
use crate::rotations::Rotations;
use crate::step::contact_changes;
use crate::vector::{Bars, Direction};

/// Such a function, at the state that the flow ends in.
pub(crate) enum Event<'a> {
    /// The gap of a row.
    Gap(RowContext<'a>, RowSource),
    /// The speed of a row, less that of its motor.
    Speed(RowContext<'a>, RowSource),
    /// Time.
    Clock,
}

impl<'a> Event<'a> {
    /// What told the end of a flow; `next` follows it. `None` where its length is fixed, or does not
    /// matter.
    pub(crate) fn of(
        scene: &'a Scene,
        flow: &'a StepRecord,
        next: Option<&'a StepRecord>,
    ) -> Option<Self> {
        if let Some((impact, row)) = next.and_then(|next| Some((next, next.hit?))) {
            return Some(Self::Gap(impact.velocity_context(scene, &flow.after), row));
        }
        let smooth = flow.smooth.as_ref()?;
        match smooth.end? {
            End::Speed(row) => {
                let meeting = smooth.meeting.as_ref()?;
                Some(Self::Speed(meeting.record.velocity_context(scene, &flow.after), row))
            }
            End::Clock => Some(Self::Clock),
            End::Force(_) => None,
        }
    }

    /// Its change along a direction.
    pub(crate) fn along(&self, along: &Direction<'_>) -> f64 {
        match self {
            Self::Gap(context, row) => {
                gap_jvp(context, *row, &contact_changes(context, along), along)
            }
            Self::Speed(context, row) => {
                speed_jvp(context, *row, &contact_changes(context, along), along)
            }
            Self::Clock => along.state.time,
        }
    }

    /// Pulls the gradient by it back.
    pub(crate) fn pull(&self, bar: f64, rotations: &mut Rotations, bars: &mut Bars<'_>) {
        match self {
            Self::Gap(context, row) => gap_vjp(context, *row, bar, rotations, bars),
            Self::Speed(context, row) => speed_vjp(context, *row, bar, rotations, bars),
            Self::Clock => bars.state.time += bar,
        }
    }
}
