//! Moore and Penrose's inverse, through faer's singular values.

use faer::MatRef;
use nalgebra::DMatrix;

/// ```text
///  A = U Σ Vᵀ        A⁺ = V Σ⁺ Uᵀ,  singular values up to `zero` counting as none
/// ```
///
/// `None` if the decomposition fails, as it does where A is not finite.
#[must_use]
pub fn pseudo_inverse(a: &DMatrix<f64>, zero: f64) -> Option<DMatrix<f64>> {
    if !a.iter().all(|x| x.is_finite()) {
        return None;
    }
    let (m, n) = a.shape();
    let svd = MatRef::from_column_major_slice(a.as_slice(), m, n).thin_svd().ok()?;
    let (u, s, v) = (svd.U(), svd.S().column_vector(), svd.V());
    let kept: Vec<usize> = (0..s.nrows()).filter(|k| s[*k] > zero).collect();
    let scaled = DMatrix::from_fn(n, kept.len(), |i, k| v[(i, kept[k])] / s[kept[k]]);
    let left = DMatrix::from_fn(m, kept.len(), |i, k| u[(i, kept[k])]);
    Some(scaled * left.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rank one: A = u vᵀ has A⁺ = v uᵀ / (|u|²|v|²).
    #[test]
    fn of_a_rank_one_matrix() {
        let (u, v) = (DMatrix::from_column_slice(3, 1, &[1.0, 2.0, 2.0]), [3.0, 4.0]);
        let v = DMatrix::from_column_slice(2, 1, &v);
        let inverse = pseudo_inverse(&(&u * v.transpose()), 1e-12).expect("finite");
        assert!((inverse - &v * u.transpose() / 225.0).amax() < 1e-15);
    }

    #[test]
    fn of_what_is_not_finite() {
        assert_eq!(pseudo_inverse(&DMatrix::from_element(2, 2, f64::NAN), 1e-12), None);
    }
}
