//! A linear complementarity problem without any physics: w = M z + q, 0 ≤ z ⟂ w ≥ 0.
//!
//! Prints the solution, how it was confirmed, and its derivative dz/dq.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use nalgebra::{DMatrix, DVector};
use tangency::lcp_ipm::{InteriorPoint, RawLcp, solve_raw};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Not symmetric, and not positive semidefinite: a matrix as Coulomb friction makes them.
    let problem = RawLcp {
        free: 0,
        matrix: DMatrix::from_row_slice(3, 3, &[2.0, 0.3, 0.0, -0.3, 1.0, 1.0, 0.5, -1.0, 0.0]),
        q: DVector::from_column_slice(&[-1.0, -0.4, 0.2]),
    };
    let solution = solve_raw(&problem, &InteriorPoint::default())?;
    println!("z = {:?}", solution.z.as_slice());
    println!("w = {:?}", solution.w.as_slice());
    println!("residual {:.1e}, unique: {}", problem.residual(&solution.z), solution.is_regular());
    println!("dz/dq ={:.4}", problem.derivative(&solution)?);
    Ok(())
}
