//! Finished pictures.

use tiny_skia::Pixmap;

use crate::ViewError;

/// A picture as pixels.
#[derive(Clone, PartialEq)]
pub struct Image {
    pixmap: Pixmap,
}

impl std::fmt::Debug for Image {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Image({} × {})", self.width(), self.height())
    }
}

impl Image {
    /// An opaque picture.
    pub(crate) fn new(pixmap: Pixmap) -> Self {
        Self { pixmap }
    }

    /// Pixels from left to right.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.pixmap.width()
    }

    /// Pixels from top to bottom.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.pixmap.height()
    }

    /// Red, green and blue of every pixel, height × width × 3: row by row from the top, each from the left.
    #[must_use]
    pub fn to_rgb(&self) -> Vec<u8> {
        let (pixels, _) = self.pixmap.data().as_chunks::<4>();
        let mut rgb = vec![0; 3 * pixels.len()];
        for (to, from) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(pixels) {
            *to = [from[0], from[1], from[2]];
        }
        rgb
    }

    /// The bytes of a PNG file.
    ///
    /// # Errors
    /// [`ViewError::Png`] if the encoder fails.
    pub fn to_png(&self) -> Result<Vec<u8>, ViewError> {
        self.pixmap.encode_png().map_err(|source| ViewError::Png { source: source.into() })
    }
}
