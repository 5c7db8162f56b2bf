//! Sine and cosine of every body, computed once per angle.

use tangency_collision::{Frame, Pose};

/// Frames of the bodies at some poses, and the world's behind them.
#[derive(Debug, Default)]
pub(crate) struct Frames(Vec<Frame>);

impl Frames {
    /// Moves the frames to `q`. What was there before only saves work.
    pub(crate) fn place(&mut self, q: &[Pose]) {
        if self.0.len() != q.len() + 1 {
            self.0.clear();
            self.0.resize(q.len() + 1, Frame::new(&Pose::zeros()));
        }
        for (frame, pose) in self.0.iter_mut().zip(q) {
            *frame = frame.moved(pose);
        }
    }

    /// Frames of the bodies.
    pub(crate) fn bodies(&self) -> &[Frame] {
        &self.0[..self.0.len() - 1]
    }

    /// Frame of a body.
    pub(crate) fn body(&self, body: usize) -> &Frame {
        &self.0[body]
    }

    /// Frame of a joint's side; `None` is the world.
    pub(crate) fn side(&self, body: Option<usize>) -> &Frame {
        &self.0[body.unwrap_or(self.0.len() - 1)]
    }
}
