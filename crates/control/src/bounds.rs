//! Where numbers may lie, and coordinates in which they may lie anywhere.

/// lower ≤ p ≤ upper; infinite where there is no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower bound.
    pub lower: f64,
    /// Upper bound.
    pub upper: f64,
}

impl Bounds {
    /// None.
    pub const FREE: Self = Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
    /// Above zero.
    pub const POSITIVE: Self = Self { lower: 0.0, upper: f64::INFINITY };

    /// Whether a search may begin at `value`: between the bounds, not on one of them, or anywhere if
    /// they leave one number only.
    #[must_use]
    pub fn may_begin_at(&self, value: f64) -> bool {
        let inside = self.lower < value && value < self.upper;
        value.is_finite() && (inside || (self.lower == value && value == self.upper))
    }

    /// Middle and half width, of bounds on both sides.
    fn span(&self) -> [f64; 2] {
        [0.5 * (self.lower + self.upper), 0.5 * (self.upper - self.lower)]
    }

    fn sides(&self) -> [bool; 2] {
        [self.lower.is_finite(), self.upper.is_finite()]
    }

    /// z of p, where
    ///
    /// ```text
    ///  p = z         p = lower + eᶻ         p = upper − eᶻ         p = middle + half · sin z
    /// ```
    pub(crate) fn coordinate(&self, p: f64) -> f64 {
        let [middle, half] = self.span();
        match self.sides() {
            [false, false] => p,
            [true, false] => (p - self.lower).ln(),
            [false, true] => (self.upper - p).ln(),
            [true, true] if half == 0.0 => 0.0,
            [true, true] => ((p - middle) / half).clamp(-1.0, 1.0).asin(),
        }
    }

    /// p of z.
    pub(crate) fn value(&self, z: f64) -> f64 {
        let [middle, half] = self.span();
        match self.sides() {
            [false, false] => z,
            [true, false] => self.lower + z.exp(),
            [false, true] => self.upper - z.exp(),
            [true, true] => (middle + half * z.sin()).clamp(self.lower, self.upper),
        }
    }

    /// dp/dz.
    pub(crate) fn slope(&self, z: f64) -> f64 {
        match self.sides() {
            [false, false] => 1.0,
            [true, false] => z.exp(),
            [false, true] => -z.exp(),
            [true, true] => self.span()[1] * z.cos(),
        }
    }
}

/// Coordinates of several numbers.
pub(crate) struct Chart<'a>(pub(crate) &'a [Bounds]);

impl Chart<'_> {
    /// z of p.
    pub(crate) fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        self.0.iter().zip(values).map(|(bounds, p)| bounds.coordinate(*p)).collect()
    }

    /// p of z.
    pub(crate) fn values(&self, z: &[f64]) -> Vec<f64> {
        self.0.iter().zip(z).map(|(bounds, z)| bounds.value(*z)).collect()
    }

    /// dp/dz.
    pub(crate) fn slopes(&self, z: &[f64]) -> Vec<f64> {
        self.0.iter().zip(z).map(|(bounds, z)| bounds.slope(*z)).collect()
    }
}
