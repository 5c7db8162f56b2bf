//! Numbers of the scene itself.

use tangency::{ContactModel, Correction, Stepping};

use super::check;

#[test]
fn settings() {
    check(|d| d.version = 7, "version is 7: this engine reads version 1");
    check(|d| d.dt = 0.0, "dt is 0: give a positive finite number");
    check(|d| d.dt = -0.01, "dt is -0.01: give a positive finite number");
    check(|d| d.dt = f64::NAN, "dt is NaN: give a positive finite number");
    check(|d| d.gravity[1] = f64::INFINITY, "gravity[1] is inf: give a finite number");
    check(|d| d.tolerance = 0.0, "tolerance is 0: give a positive finite number");
    check(|d| d.recovery_speed = -1.0, "recovery_speed is -1: give a positive finite number");
    check(|d| d.recovery_rate = 0.0, "recovery_rate is 0: give a positive finite number");
    check(
        |d| d.contact_model = ContactModel::Velocity { contact_distance: 0.0 },
        "contact_model.velocity.contact_distance is 0: give a positive finite number",
    );
    check(
        |d| d.contact_reach = -1.0,
        "contact_reach is -1: give a finite number of metres, 0 for none",
    );
    check(
        |d| (d.contact_reach, d.stepping) = (1.0, Stepping::ImpactResolved { max_impacts: 8 }),
        "contact_reach: contacts from afar need the contact model `gap` and stepping `fixed`",
    );
    check(
        |d| d.stabilisation.joints = Correction::Baumgarte { fraction: 1.5 },
        "stabilisation.joints.baumgarte.fraction is 1.5: give a fraction in (0, 1]",
    );
}

#[test]
fn tolerances_that_accept_anything() {
    check(
        |d| d.tolerance = 2.0,
        "tolerance is 2: a residual of 1 is no solution; give 1e-10 or so",
    );
}
