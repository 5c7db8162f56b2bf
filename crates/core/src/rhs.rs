//! Right-hand sides of rows, with their derivatives beside them.

use crate::{ContactModel, Correction, Softness};

/// A right-hand side b and compliance c with their derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rhs {
    /// b, m/s or rad/s.
    pub value: f64,
    /// c, velocity per impulse.
    pub compliance: f64,
    /// ∂b/∂φ, φ the position error or gap.
    pub d_position: f64,
    /// ∂b/∂(J v⁻).
    pub d_speed: f64,
    /// ∂b/∂dt.
    pub d_dt: f64,
    /// ∂c/∂dt.
    pub compliance_d_dt: f64,
    /// ∂b/∂e, e the restitution.
    pub d_restitution: f64,
    /// ∂b/∂(stiffness, damping).
    pub d_softness: [f64; 2],
    /// ∂c/∂(stiffness, damping).
    pub compliance_d_softness: [f64; 2],
}

/// Rigid row with position error φ: `b = −f φ/dt` (Baumgarte 1972), or 0.
#[must_use]
#[inline]
pub fn rigid(correction: Correction, position: f64, dt: f64) -> Rhs {
    let Correction::Baumgarte { fraction } = correction else { return Rhs::default() };
    let d_position = -fraction / dt;
    Rhs {
        value: d_position * position,
        d_position,
        d_dt: fraction * position / (dt * dt),
        ..Rhs::default()
    }
}

/// Rigid row that the velocities before and after obey together: `J (v⁻ + v⁺) = 0`.
#[must_use]
pub fn midway(speed: f64) -> Rhs {
    Rhs { value: -speed, d_speed: -1.0, ..Rhs::default() }
}

/// Contact that touches, with restitution e: `b = −e J v⁻`.
#[must_use]
pub fn bounce(e: f64, speed: f64) -> Rhs {
    if e == 0.0 {
        return Rhs::default();
    }
    Rhs { value: -e * speed, d_speed: -e, d_restitution: -speed, ..Rhs::default() }
}

/// Spring and damper, implicit: `λ = −dt k (φ + dt u) − dt d u` with u = J v⁺, that is
///
/// ```text
///  u + c λ = b,     D = dt k + d,     c = 1/(dt D),     b = −k φ/D
/// ```
#[must_use]
#[inline]
pub fn soft(softness: Softness, position: f64, dt: f64) -> Rhs {
    let (k, d) = (softness.stiffness, softness.damping);
    let sum = dt * k + d;
    let sum2 = sum * sum;
    let d_position = -k / sum;
    Rhs {
        value: d_position * position,
        compliance: 1.0 / (dt * sum),
        d_position,
        d_dt: k * k * position / sum2,
        compliance_d_dt: -(sum + dt * k) / (dt * dt * sum2),
        d_softness: [-d * position / sum2, k * position / sum2],
        compliance_d_softness: [-1.0 / sum2, -1.0 / (dt * sum2)],
        ..Rhs::default()
    }
}

/// How unilateral rows of a scene are set up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unilateral {
    /// The scene's contact model.
    pub model: ContactModel,
    /// How penetrations are removed.
    pub correction: Correction,
    /// Time step, s.
    pub dt: f64,
    /// Greatest speed at which penetrations are removed, m/s or rad/s.
    pub recovery_speed: f64,
    /// Penetrations below this are rounding, m or rad.
    pub slop: f64,
}

impl Unilateral {
    /// Contact or limit with a gap that changes at `speed` = J v⁻ and restitution e:
    ///
    /// ```text
    ///  gap model:       b = −gap/dt, but  b = −e J v⁻  where it would close: gap + dt J v⁻ ≤ 0
    ///  velocity model:  b = max(0, −e J v⁻)
    ///  penetration:     b = 0, or min(−f gap/dt, recovery speed) by Baumgarte, if that is larger
    /// ```
    #[must_use]
    pub fn rhs(&self, gap: f64, speed: f64, restitution: f64) -> Rhs {
        let base = self.without_bounce(gap);
        let closes = match self.model {
            ContactModel::Gap => gap + self.dt * speed <= 0.0,
            ContactModel::Velocity { .. } => true,
        };
        let bounce = -restitution * speed;
        if closes && restitution > 0.0 && speed < 0.0 && bounce > base.value {
            return Rhs {
                value: bounce,
                d_speed: -restitution,
                d_restitution: -speed,
                ..Rhs::default()
            };
        }
        base
    }

    fn without_bounce(&self, gap: f64) -> Rhs {
        let reaches = |fraction: f64| Rhs {
            value: -fraction * gap / self.dt,
            d_position: -fraction / self.dt,
            d_dt: fraction * gap / (self.dt * self.dt),
            ..Rhs::default()
        };
        if gap >= -self.slop {
            return if self.model == ContactModel::Gap { reaches(1.0) } else { Rhs::default() };
        }
        match self.correction {
            Correction::Baumgarte { fraction } => {
                let rhs = reaches(fraction);
                if rhs.value <= self.recovery_speed {
                    rhs
                } else {
                    Rhs { value: self.recovery_speed, ..Rhs::default() }
                }
            }
            Correction::None | Correction::Post => Rhs::default(),
        }
    }
}

/// Displacement speed that removes a joint's error after the move: −φ/dt, at most `greatest`.
#[must_use]
pub fn post_joint(position: f64, dt: f64, greatest: f64) -> Rhs {
    let value = -position / dt;
    if value.abs() > greatest {
        return Rhs { value: greatest.copysign(value), ..Rhs::default() };
    }
    Rhs { value, d_position: -1.0 / dt, d_dt: position / (dt * dt), ..Rhs::default() }
}

/// The same for a gap: a penetration opens at most at `greatest`, an open gap may close.
#[must_use]
pub fn post_gap(gap: f64, dt: f64, greatest: f64) -> Rhs {
    if gap > 0.0 {
        return post_joint(gap, dt, f64::INFINITY);
    }
    post_joint(gap, dt, greatest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(f: impl Fn(f64) -> f64, x: f64) -> f64 {
        let h = 1e-6 * x.abs().max(1e-3);
        (f(x + h) - f(x - h)) / (2.0 * h)
    }

    #[track_caller]
    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-7 * (1.0 + b.abs()), "{a} is not {b}");
    }

    #[test]
    fn soft_derivatives_match_central_differences() {
        let (k, d, phi, dt) = (30.0, 2.0, 0.07, 0.02);
        let at = |k, d, phi, dt| soft(Softness { stiffness: k, damping: d }, phi, dt);
        let rhs = at(k, d, phi, dt);
        close(rhs.d_position, slope(|x| at(k, d, x, dt).value, phi));
        close(rhs.d_dt, slope(|x| at(k, d, phi, x).value, dt));
        close(rhs.compliance_d_dt, slope(|x| at(k, d, phi, x).compliance, dt));
        close(rhs.d_softness[0], slope(|x| at(x, d, phi, dt).value, k));
        close(rhs.d_softness[1], slope(|x| at(k, x, phi, dt).value, d));
        close(rhs.compliance_d_softness[0], slope(|x| at(x, d, phi, dt).compliance, k));
        close(rhs.compliance_d_softness[1], slope(|x| at(k, x, phi, dt).compliance, d));
    }

    #[test]
    fn restitution_acts_only_where_the_gap_would_close() {
        let rule = Unilateral {
            model: ContactModel::Gap,
            correction: Correction::Post,
            dt: 0.01,
            recovery_speed: 1.0,
            slop: 1e-9,
        };
        assert_eq!(rule.rhs(0.05, -0.01, 0.5).value, -5.0); // stays out of reach: −gap/dt
        assert_eq!(rule.rhs(0.05, -6.0, 0.5).value, 3.0); // reached: −e J v⁻
        assert_eq!(rule.rhs(0.0, 2.0, 0.5).value, 0.0); // separating: no bounce
        assert_eq!(rule.rhs(-0.2, 0.0, 0.5).value, 0.0); // penetrating: left to the correction
    }
}
