//! The matrix W + D of Newton's equations, by bodies or by rows.

use tangency_lcp::{Added, BandMatrix, BodySystem, BoxForm, BoxLaw, Lu, Scratch};

/// δ: keeps equalities solvable when they depend on each other.
const PROXIMAL: f64 = 1e-10;

/// Box unknowns, and solutions of (W + D) y = r.
pub(crate) trait System {
    /// Laws of the unknowns.
    fn laws(&self) -> &[BoxLaw];
    /// q.
    fn q(&self) -> &[f64];
    /// Row of the problem of an unknown.
    fn row(&self, slot: usize) -> usize;
    /// Impulses per row of the problem.
    fn impulses(&self, y: &[f64], impulses: &mut Vec<f64>);
    /// out = W y.
    fn times(&mut self, y: &[f64], out: &mut [f64]);
    /// Factors W + D.
    fn factor(&mut self, added: Added, scratch: &mut Scratch);
    /// Solves (W + D) y = r, refined; false if that failed.
    fn solve(&mut self, added: Added, r: &[f64], y: &mut [f64]) -> bool;
}

impl System for BodySystem<'_> {
    fn laws(&self) -> &[BoxLaw] {
        &self.laws
    }

    fn q(&self) -> &[f64] {
        &self.q
    }

    fn row(&self, slot: usize) -> usize {
        slot
    }

    fn impulses(&self, y: &[f64], impulses: &mut Vec<f64>) {
        BodySystem::impulses(self, y, impulses);
    }

    fn times(&mut self, y: &[f64], out: &mut [f64]) {
        BodySystem::times(self, y, out);
    }

    fn factor(&mut self, added: Added, scratch: &mut Scratch) {
        BodySystem::factor(self, added, scratch);
    }

    fn solve(&mut self, added: Added, r: &[f64], y: &mut [f64]) -> bool {
        BodySystem::solve(self, added, r, y)
    }
}

/// By rows, with exchanges of rows: slower, and sound where sliding contacts spoil the elimination of
/// bodies; the only way for raw problems.
pub(crate) struct RowSystem<'a> {
    form: &'a BoxForm,
    matrix: BandMatrix,
    scale: Vec<f64>,
    factor: Option<Lu>,
}

impl<'a> RowSystem<'a> {
    pub(crate) fn new(form: &'a BoxForm) -> Self {
        Self { form, matrix: form.matrix.clone(), scale: vec![1.0; form.len()], factor: None }
    }
}

impl System for RowSystem<'_> {
    fn laws(&self) -> &[BoxLaw] {
        &self.form.laws
    }

    fn q(&self) -> &[f64] {
        &self.form.q
    }

    fn row(&self, slot: usize) -> usize {
        self.form.rows[slot] as usize
    }

    fn impulses(&self, y: &[f64], impulses: &mut Vec<f64>) {
        *impulses = self.form.impulses(y);
    }

    fn times(&mut self, y: &[f64], out: &mut [f64]) {
        out.copy_from_slice(&self.form.matrix.times(y));
    }

    fn factor(&mut self, Added { d, e }: Added, _: &mut Scratch) {
        self.matrix.clone_from(&self.form.matrix);
        for (slot, law) in self.form.laws.iter().enumerate() {
            self.matrix.add(slot, slot, d[slot]);
            if let BoxLaw::Friction { normal, .. } = *law {
                self.matrix.add(slot, normal, e[slot]);
            }
            let diagonal = self.matrix.get(slot, slot).abs();
            let sound = diagonal > 0.0 && diagonal.is_finite();
            self.scale[slot] = if sound { diagonal.sqrt().recip() } else { 1.0 };
        }
        let mut scaled = self.matrix.clone();
        scaled.scale(&self.scale);
        for (slot, law) in self.form.laws.iter().enumerate() {
            scaled.add(slot, slot, if *law == BoxLaw::Free { PROXIMAL } else { 1e-15 });
        }
        self.factor = Some(Lu::new(scaled, 1e-15));
    }

    /// Two refinements against the matrix without δ.
    fn solve(&mut self, _: Added, rhs: &[f64], y: &mut [f64]) -> bool {
        let Some(factor) = &self.factor else { return false };
        y.fill(0.0);
        let mut r = rhs.to_vec();
        for sweep in 0..3 {
            if sweep > 0 {
                r = self.matrix.times(y);
                r.iter_mut().zip(rhs).for_each(|(r, b)| *r = b - *r);
            }
            r.iter_mut().zip(&self.scale).for_each(|(r, s)| *r *= s);
            factor.solve(&mut r);
            y.iter_mut().zip(&r).zip(&self.scale).for_each(|((y, r), s)| *y += r * s);
        }
        true
    }
}
