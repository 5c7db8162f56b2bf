//! Every refusal names the item and the field.

use tangency_lcp::{Law, Lcp, LcpError, NO_BODY};

use crate::problems::{V, disc};

#[track_caller]
fn refused(change: impl FnOnce(&mut Lcp), wanted: &str) {
    let mut problem = disc(1.0);
    problem.validate().expect("valid before the change");
    change(&mut problem);
    let found = problem.validate().expect_err("refused").to_string();
    assert!(found.contains(wanted), "`{found}` does not say `{wanted}`");
}

#[test]
fn bodies() {
    refused(|p| p.mass[0].z = 0.0, "mass of item 0 is 0");
    refused(|p| p.mass[0].x = f64::NAN, "mass of item 0 is not finite");
    refused(|p| p.momentum[0].y = f64::INFINITY, "momentum of item 0 is not finite");
    refused(|p| p.mass[0].x = 1e-320, "mass of item 0 is 1e-320, which is out of range");
    refused(|p| p.mass[0].x = f64::MAX, "mass of item 0 is 1.79");
    refused(|p| p.momentum[0].x = -1e200, "momentum of item 0 is -1e200, which is out of range");
    refused(|p| p.momentum.push(V::zeros()), "momentum has 2 entries, expected 1");
}

#[test]
fn rows() {
    refused(|p| p.rows[1].rhs = f64::NAN, "row.rhs of item 1");
    refused(|p| p.rows[0].compliance = -1.0, "row.compliance of item 0 is -1");
    refused(|p| p.rows[0].jacobian[1].x = f64::NAN, "row.jacobian of item 0");
    refused(|p| p.rows[0].bodies[1] = 3, "row 0 acts on body 3, but there are 1 bodies");
    refused(|p| p.rows[0].bodies[0] = 0, "row 0 joins body 0 to itself");
    refused(|p| p.rows[0].jacobian[0] = V::x(), "row 0 has a non-zero jacobian block 0");
    refused(|p| p.rows[0].bodies = [NO_BODY; 2], "row 0 has a non-zero jacobian block 1");
}

#[test]
fn laws() {
    refused(|p| p.rows[0].law = Law::Bounded { max: 0.0 }, "row.law.max of item 0 is 0");
    refused(|p| p.rows[1].law = Law::Friction { normal: 0, mu: -0.5 }, "row.law.mu of item 1");
    refused(|p| p.rows[1].law = Law::Friction { normal: 1, mu: 0.5 }, "which must come earlier");
    refused(
        |p| p.rows[0].law = Law::Equality,
        "names row 0 as its normal, which is not unilateral",
    );
}

#[test]
fn errors_tell_their_residual() {
    assert_eq!(LcpError::NotConverged { iterations: 3, residual: 0.5 }.residual(), Some(0.5));
    assert_eq!(LcpError::NotFinite { what: "q", index: 0 }.residual(), None);
}
