//! What drives the environments of a batch.

use tangency_core::State;

use crate::BatchError;

/// A feedback law: `policy(environment, k, state, control)` writes the control of step k (counted from
/// 0 in every call of the batch), one number per channel, into `control`, which comes as zeros.
pub type Policy<'a> = dyn Fn(usize, usize, &State, &mut [f64]) + Sync + 'a;

/// Controls of all environments over some steps. Arrays are row-major; what an entry means and its
/// unit (N or N·m) is said by the scene's channels.
#[derive(Clone, Copy)]
pub enum Controls<'a> {
    /// Zero in every channel.
    Zero,
    /// The same at every step: environments × channels.
    Held(&'a [f64]),
    /// Known beforehand: environments × steps × channels.
    Planned(&'a [f64]),
    /// Decided step by step, on the thread that steps the environment.
    Policy(&'a Policy<'a>),
}

/// Of which environment and step a control is asked.
#[derive(Clone, Copy)]
pub(crate) struct Place {
    pub(crate) environment: usize,
    pub(crate) step: usize,
    /// Steps in all.
    pub(crate) steps: usize,
    pub(crate) channels: usize,
}

impl Controls<'_> {
    pub(crate) fn check(
        &self,
        environments: usize,
        steps: usize,
        channels: usize,
    ) -> Result<(), BatchError> {
        let (layout, expected, found) = match self {
            Self::Zero | Self::Policy(_) => return Ok(()),
            Self::Held(u) => ("environments × channels", environments * channels, u.len()),
            Self::Planned(u) => {
                let expected = environments * steps * channels;
                ("environments × steps × channels", expected, u.len())
            }
        };
        if found == expected {
            Ok(())
        } else {
            Err(BatchError::ControlSize { layout, expected, found })
        }
    }

    /// The control at a place, one number per channel; `room` is used where it is not yet written
    /// anywhere.
    pub(crate) fn at<'b>(
        &'b self,
        place: Place,
        state: &State,
        room: &'b mut Vec<f64>,
    ) -> &'b [f64] {
        let Place { environment, step, steps, channels } = place;
        let row = |k: usize| k * channels..(k + 1) * channels;
        room.clear();
        room.resize(channels, 0.0);
        match self {
            Self::Zero => {}
            Self::Held(u) => return &u[row(environment)],
            Self::Planned(u) => return &u[row(environment * steps + step)],
            Self::Policy(policy) => policy(environment, step, state, room),
        }
        room
    }
}
