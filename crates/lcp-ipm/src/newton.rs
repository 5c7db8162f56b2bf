//! The interior point's iterate and its condensed Newton system.
//!
//! Eliminating the pairs leaves one equation per row. With d± = w±/s± and c the wanted change of a
//! product,
//!
//! ```text
//!  positive    (W Δy)ᵢ + (z/y) Δyᵢ                            = −rᵢ − c/y
//!  box         (W Δy)ᵢ + (d⁺ + d⁻) Δyᵢ + μ (d⁻ − d⁺) Δy_n     = −rᵢ + c⁺/s⁺ − c⁻/s⁻ + d⁺ r⁺ − d⁻ r⁻
//!  free        (W Δy)ᵢ + δ Δyᵢ                                = −rᵢ
//! ```
//!
//! where r is u = W y + q less what the pairs say, and r± = h ∓ y − s±. Only the coupling of friction
//! to its normal makes the matrix non-symmetric.

use tangency_lcp::{BandMatrix, BoxForm, BoxLaw, Lu};

/// δ: keeps equalities solvable when they depend on each other.
const PROXIMAL: f64 = 1e-10;

/// A complementary pair 0 ≤ x ⟂ z ≥ 0.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pair {
    pub(crate) x: f64,
    pub(crate) z: f64,
}

/// Unknowns y and pairs: one per positive row (x = y), two per box row (s⁺, w⁺), (s⁻, w⁻).
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    pub(crate) y: Vec<f64>,
    pub(crate) pairs: Vec<[Pair; 2]>,
}

impl Iterate {
    /// Impulses of `size`, slacks of about one.
    pub(crate) fn start(form: &BoxForm, size: f64) -> Self {
        let mut iterate =
            Self { y: vec![0.0; form.len()], pairs: vec![[Pair::default(); 2]; form.len()] };
        for (slot, law) in form.laws.iter().enumerate() {
            let u = form.q[slot];
            match *law {
                BoxLaw::Free => {}
                BoxLaw::Positive => {
                    iterate.y[slot] = size;
                    iterate.pairs[slot][0] = Pair { x: size, z: u.abs().max(1.0) };
                }
                BoxLaw::Bounded { max: bound } | BoxLaw::Friction { mu: bound, .. } => {
                    let s = bound.max(0.01);
                    iterate.pairs[slot] =
                        [Pair { x: s, z: 1.0 + (-u).max(0.0) }, Pair { x: s, z: 1.0 + u.max(0.0) }];
                }
            }
        }
        iterate
    }

    /// The pairs in use.
    pub(crate) fn live<'a>(&'a self, form: &'a BoxForm) -> impl Iterator<Item = Pair> + 'a {
        form.laws
            .iter()
            .zip(&self.pairs)
            .flat_map(|(law, pairs)| pairs[..law.pairs()].iter().copied())
    }

    /// Mean product of the pairs.
    pub(crate) fn mean_product(&self, form: &BoxForm) -> f64 {
        let (sum, count) =
            self.live(form).fold((0.0, 0), |(sum, count), pair| (sum + pair.x * pair.z, count + 1));
        if count == 0 { 0.0 } else { sum / f64::from(count) }
    }

    /// The longest step up to `limit` that keeps every pair positive.
    pub(crate) fn longest(&self, form: &BoxForm, step: &Self, limit: f64) -> f64 {
        self.live(form).zip(step.live(form)).fold(limit, |longest, (pair, step)| {
            reach(pair.x, step.x, reach(pair.z, step.z, longest))
        })
    }

    /// The iterate plus `length` times the step.
    pub(crate) fn advance(&mut self, form: &BoxForm, step: &Self, length: f64) {
        for (y, dy) in self.y.iter_mut().zip(&step.y) {
            *y += length * dy;
        }
        for (pairs, steps) in self.pairs.iter_mut().zip(&step.pairs) {
            for (pair, step) in pairs.iter_mut().zip(steps) {
                pair.x += length * step.x;
                pair.z += length * step.z;
            }
        }
        for (slot, law) in form.laws.iter().enumerate() {
            if *law == BoxLaw::Positive {
                self.y[slot] = self.pairs[slot][0].x;
            }
        }
    }
}

fn reach(value: f64, change: f64, longest: f64) -> f64 {
    if change < 0.0 { longest.min(-value / change) } else { longest }
}

/// Factored Newton matrix at one iterate.
pub(crate) struct Newton<'a> {
    form: &'a BoxForm,
    at: &'a Iterate,
    /// W y + q.
    u: &'a [f64],
    matrix: BandMatrix,
    scale: Vec<f64>,
    factor: Lu,
}

impl<'a> Newton<'a> {
    pub(crate) fn new(form: &'a BoxForm, at: &'a Iterate, u: &'a [f64]) -> Self {
        let mut matrix = form.matrix.clone();
        for (slot, law) in form.laws.iter().enumerate() {
            let [plus, minus] = at.pairs[slot];
            match *law {
                BoxLaw::Free => {}
                BoxLaw::Positive => matrix.add(slot, slot, plus.z / plus.x),
                BoxLaw::Bounded { .. } => {
                    matrix.add(slot, slot, plus.z / plus.x + minus.z / minus.x);
                }
                BoxLaw::Friction { normal, mu } => {
                    let (d_plus, d_minus) = (plus.z / plus.x, minus.z / minus.x);
                    matrix.add(slot, slot, d_plus + d_minus);
                    matrix.add(slot, normal, mu * (d_minus - d_plus));
                }
            }
        }
        let scale: Vec<f64> = (0..form.len())
            .map(|slot| {
                let diagonal = matrix.get(slot, slot).abs();
                if diagonal > 0.0 && diagonal.is_finite() { diagonal.sqrt().recip() } else { 1.0 }
            })
            .collect();
        let mut scaled = matrix.clone();
        scaled.scale(&scale);
        for (slot, law) in form.laws.iter().enumerate() {
            scaled.add(slot, slot, if *law == BoxLaw::Free { PROXIMAL } else { 1e-15 });
        }
        let factor = Lu::new(scaled, 1e-15);
        Self { form, at, u, matrix, scale, factor }
    }

    /// The step towards products `target`, with the second-order terms of `predictor` if given.
    pub(crate) fn step(&self, target: f64, predictor: Option<&Iterate>) -> Iterate {
        let wanted = |slot: usize, k: usize| {
            let pair = self.at.pairs[slot][k];
            let second = predictor.map_or(0.0, |p| p.pairs[slot][k].x * p.pairs[slot][k].z);
            pair.x * pair.z + second - target
        };
        let rhs: Vec<f64> =
            (0..self.form.len()).map(|slot| self.right_side(slot, wanted)).collect();
        let y = self.solve(&rhs);
        let mut step = Iterate { pairs: vec![[Pair::default(); 2]; y.len()], y };
        let along = self.form.matrix.times(&step.y);
        for slot in 0..self.form.len() {
            step.pairs[slot] = self.pair_steps(slot, &step.y, &along, wanted);
        }
        step
    }

    fn right_side(&self, slot: usize, wanted: impl Fn(usize, usize) -> f64) -> f64 {
        let [plus, minus] = self.at.pairs[slot];
        let u = self.u[slot];
        match self.form.laws[slot] {
            BoxLaw::Free => -u,
            BoxLaw::Positive => -(u - plus.z) - wanted(slot, 0) / plus.x,
            BoxLaw::Bounded { .. } | BoxLaw::Friction { .. } => {
                let [r_plus, r_minus] = self.bound_defects(slot);
                -(u - (minus.z - plus.z)) + (wanted(slot, 0) + plus.z * r_plus) / plus.x
                    - (wanted(slot, 1) + minus.z * r_minus) / minus.x
            }
        }
    }

    /// r± = h ∓ y − s±.
    fn bound_defects(&self, slot: usize) -> [f64; 2] {
        let [plus, minus] = self.at.pairs[slot];
        let (bound, y) = (self.form.bound(slot, &self.at.y), self.at.y[slot]);
        [bound - y - plus.x, bound + y - minus.x]
    }

    fn pair_steps(
        &self,
        slot: usize,
        dy: &[f64],
        along: &[f64],
        wanted: impl Fn(usize, usize) -> f64,
    ) -> [Pair; 2] {
        let pairs = self.at.pairs[slot];
        let bound = match self.form.laws[slot] {
            BoxLaw::Free => return [Pair::default(); 2],
            BoxLaw::Positive => {
                let z = along[slot] + self.u[slot] - pairs[0].z;
                return [Pair { x: dy[slot], z }, Pair::default()];
            }
            BoxLaw::Bounded { .. } => 0.0,
            BoxLaw::Friction { normal, mu } => mu * dy[normal],
        };
        let defects = self.bound_defects(slot);
        let changes = [bound - dy[slot] + defects[0], bound + dy[slot] + defects[1]];
        [0, 1].map(|k| {
            let (pair, x) = (pairs[k], changes[k]);
            Pair { x, z: -(wanted(slot, k) + pair.z * x) / pair.x }
        })
    }

    /// Solves with two refinements against the matrix without δ.
    fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; rhs.len()];
        let mut r = rhs.to_vec();
        for sweep in 0..3 {
            if sweep > 0 {
                r = self.matrix.times(&y);
                r.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
            }
            r.iter_mut().zip(&self.scale).for_each(|(r, s)| *r *= s);
            self.factor.solve(&mut r);
            y.iter_mut().zip(&r).zip(&self.scale).for_each(|((y, r), s)| *y += r * s);
        }
        y
    }
}
