//! Why there is no picture.

use tangency_core::StepError;

/// A picture that cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// No pixels, or too many.
    #[error("the picture is {width} × {height} pixels: give `width` and `height` from 1 to {most}")]
    Size {
        /// The width given.
        width: u32,
        /// The height given.
        height: u32,
        /// The greatest of both.
        most: u32,
    },
    /// A view without an area, or without an end.
    #[error(
        "the view reaches from {lower:?} to {upper:?}: `lower` must be below `upper`, both finite; \
         `View::fit` makes one"
    )]
    View {
        /// `lower` as given, m.
        lower: [f64; 2],
        /// `upper` as given, m.
        upper: [f64; 2],
    },
    /// A colour for a body that is not there.
    #[error("`colors` has a colour for body {body}, but the scene has {bodies} bodies, from 0")]
    Body {
        /// The body named.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// A state that does not fit the scene, or is not finite.
    #[error(transparent)]
    State(#[from] StepError),
    /// The picture cannot be written as PNG.
    #[error("the picture cannot be written as PNG")]
    Png {
        /// What the encoder says.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}
