//! The law of one row, softened: both sides of every complementary pair stay positive, and their
//! product is an energy ε.
//!
//! ```text
//!  unilateral         λ u = ε
//!  bounded, friction  u = w⁻ − w⁺,   s± = h ∓ λ,   s⁺ w⁺ = s⁻ w⁻ = ε          h constant or μ λₙ
//! ```
//!
//! Linear at an iterate, with d = z/x of a pair (x, z), every law is u = o − a λ + β h:
//!
//! ```text
//!  unilateral         a = d            β = 0            o = ε/x + z
//!  bounded, friction  a = d⁺ + d⁻      β = d⁺ − d⁻      o = (ε/s⁻ + w⁻) − (ε/s⁺ + w⁺)
//! ```
//!
//! In a row of compliance c the impulse is λ = y + ρ h with ρ = β/(c + a): J v + (c + a) y = b + o. The
//! distances from the bounds follow from y without cancellation,
//!
//! ```text
//!  s⁺ = h (c + 2 d⁻)/(c + a) − y            s⁻ = h (c + 2 d⁺)/(c + a) + y
//! ```

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use crate::Law;

/// A complementary pair, both positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    x: f64,
    z: f64,
}

/// The pairs of a row.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Barrier {
    /// An equality has none.
    None,
    /// (λ, u).
    Wall(Pair),
    /// (s⁺, w⁺), (s⁻, w⁻).
    Walls([Pair; 2]),
}

/// A law made linear: u = o − a λ + β h.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Softness {
    /// d⁺ (of a unilateral row, d), d⁻, velocity per impulse.
    slopes: [f64; 2],
    /// o, m/s or rad/s.
    pub(crate) offset: f64,
}

impl Softness {
    /// a.
    pub(crate) fn compliance(&self) -> f64 {
        self.slopes[0] + self.slopes[1]
    }

    /// β, of a row that has a bound.
    pub(crate) fn by_bound(&self) -> f64 {
        self.slopes[0] - self.slopes[1]
    }

    /// (s⁺, s⁻) of y and h, c + a being the whole compliance of the row.
    fn distances(&self, y: f64, h: f64, compliance: f64) -> [f64; 2] {
        let [plus, minus] = self.slopes;
        let rigid = compliance - plus - minus;
        let [upper, lower] = [minus, plus].map(|slope| h * ((rigid + 2.0 * slope) / compliance));
        [upper - y, lower + y]
    }
}

impl Barrier {
    /// Where u = `slack` + W (λ − `impulse`) meets the law, or near there.
    pub(crate) fn meeting(law: Law, [impulse, slack]: [f64; 2], W: f64, h: f64, e: f64) -> Self {
        let ahead = slack - W * impulse;
        match law {
            Law::Equality => Self::None,
            Law::Unilateral => Self::Wall(Pair::at(distance(ahead, W, e), e)),
            Law::Bounded { .. } | Law::Friction { .. } => {
                let near = distance(ahead.abs() - W * h, W, e).min(h);
                let pairs = [Pair::at(2.0 * h - near, e), Pair::at(near, e)];
                Self::Walls(if ahead > 0.0 { pairs } else { [pairs[1], pairs[0]] })
            }
        }
    }

    /// The impulse that the pairs stand for; none of an equality.
    pub(crate) fn impulse(&self) -> Option<f64> {
        match self {
            Self::None => None,
            Self::Wall(pair) => Some(pair.x),
            Self::Walls([upper, lower]) => Some(0.5 * (lower.x - upper.x)),
        }
    }

    /// The remainder that the pairs stand for.
    pub(crate) fn slack(&self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Wall(pair) => pair.z,
            Self::Walls([upper, lower]) => lower.z - upper.z,
        }
    }

    /// The law made linear.
    pub(crate) fn softness(&self, e: f64) -> Softness {
        match self {
            Self::None => Softness::default(),
            Self::Wall(pair) => Softness { slopes: [pair.slope(), 0.0], offset: pair.offset(e) },
            Self::Walls([upper, lower]) => Softness {
                slopes: [upper.slope(), lower.slope()],
                offset: lower.offset(e) - upper.offset(e),
            },
        }
    }

    /// Where Newton's step leads, given y and h of the row and its whole compliance.
    pub(crate) fn stepped(&self, [y, h]: [f64; 2], compliance: f64, e: f64) -> Self {
        match self {
            Self::None => Self::None,
            Self::Wall(pair) => Self::Wall(pair.stepped(y, e)),
            Self::Walls([upper, lower]) => {
                let [plus, minus] = self.softness(e).distances(y, h, compliance);
                Self::Walls([upper.stepped(plus, e), lower.stepped(minus, e)])
            }
        }
    }

    /// The part of the way to another on which every pair is positive.
    pub(crate) fn longest(&self, to: &Self) -> f64 {
        let both = self.pairs().zip(to.pairs());
        both.fold(f64::INFINITY, |length, (from, to)| length.min(from.longest(to)))
    }

    /// A part of the way to another.
    pub(crate) fn advance(&mut self, to: &Self, length: f64) {
        match (self, to) {
            (Self::Wall(pair), Self::Wall(to)) => pair.advance(to, length),
            (Self::Walls(pairs), Self::Walls(to)) => {
                pairs.iter_mut().zip(to).for_each(|(pair, to)| pair.advance(to, length));
            }
            _ => {}
        }
    }

    /// How far the products are from ε, and the pairs from the bound, as impulses times √W.
    pub(crate) fn defect(&self, impulse: f64, h: f64, W: f64, e: f64) -> f64 {
        let root = W.sqrt();
        let products = self.pairs().map(|pair| pair.defect(root, e)).fold(0.0, f64::max);
        match self {
            Self::Walls([upper, lower]) => {
                let off = (h - impulse - upper.x).abs().max((h + impulse - lower.x).abs());
                products.max(off * root)
            }
            _ => products,
        }
    }

    /// The smaller side of every pair from the greater one, which has more digits.
    pub(crate) fn settled(&self, W: f64, e: f64) -> Self {
        match self {
            Self::None => Self::None,
            Self::Wall(pair) => Self::Wall(pair.settled(W, e)),
            Self::Walls(pairs) => Self::Walls(pairs.map(|pair| pair.settled(W, e))),
        }
    }

    fn pairs(&self) -> impl Iterator<Item = Pair> {
        let [a, b] = match *self {
            Self::None => [None, None],
            Self::Wall(pair) => [Some(pair), None],
            Self::Walls([upper, lower]) => [Some(upper), Some(lower)],
        };
        a.into_iter().chain(b)
    }
}

impl Pair {
    fn at(x: f64, e: f64) -> Self {
        Self { x, z: e / x }
    }

    fn slope(self) -> f64 {
        self.z / self.x
    }

    fn offset(self, e: f64) -> f64 {
        e / self.x + self.z
    }

    fn stepped(self, x: f64, e: f64) -> Self {
        Self { x, z: self.offset(e) - self.slope() * x }
    }

    fn longest(self, to: Self) -> f64 {
        let reach = |from: f64, to: f64| if to < from { from / (from - to) } else { f64::INFINITY };
        reach(self.x, to.x).min(reach(self.z, to.z))
    }

    fn advance(&mut self, to: &Self, length: f64) {
        self.x += length * (to.x - self.x);
        self.z += length * (to.z - self.z);
    }

    fn defect(self, root: f64, e: f64) -> f64 {
        (self.x * self.z - e).abs() / (self.x * root + self.z / root)
    }

    fn settled(self, W: f64, e: f64) -> Self {
        if W * self.x >= self.z {
            Self { z: e / self.x, ..self }
        } else {
            Self { x: e / self.z, ..self }
        }
    }
}

/// The distance x > 0 from a wall at which q + W x = ε/x.
fn distance(q: f64, W: f64, e: f64) -> f64 {
    let root = (q * q + 4.0 * W * e).sqrt();
    if q > 0.0 { 2.0 * e / (q + root) } else { (root - q) / (2.0 * W) }
}
