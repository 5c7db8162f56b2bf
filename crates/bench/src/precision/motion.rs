//! Motions with closed forms, and two whose equation of one coordinate is integrated by itself.

use std::f64::consts::FRAC_PI_2;

use super::Known;

/// Standard gravity of the cases, m/s².
pub(super) const G: f64 = 9.81;

/// Steps per second of [`runge_kutta`]; its error is near rounding.
const RATE: f64 = 2e4;

/// One step of the classical method for x″ = f(x).
fn runge_kutta([x, v]: [f64; 2], h: f64, f: impl Fn(f64) -> f64) -> [f64; 2] {
    let (k1, l1) = (v, f(x));
    let (k2, l2) = (v + 0.5 * h * l1, f(x + 0.5 * h * k1));
    let (k3, l3) = (v + 0.5 * h * l2, f(x + 0.5 * h * k2));
    let (k4, l4) = (v + h * l3, f(x + h * k3));
    [x + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4), v + h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4)]
}

/// θ and ω at t of θ″ = −k sin θ from rest at `start`.
pub(super) fn swing(k: f64, start: f64, t: f64) -> [f64; 2] {
    let steps = (t * RATE).ceil().max(1.0);
    let h = t / steps;
    let (mut state, mut step) = ([start, 0.0], 0.0);
    while step < steps {
        state = runge_kutta(state, h, |angle| -k * angle.sin());
        step += 1.0;
    }
    state
}

/// A slender rod of 1 m that hangs from `pin`, at θ and ω from hanging.
pub(super) fn hanging(body: usize, pin: [f64; 2], [angle, rate]: [f64; 2]) -> Known {
    let (sin, cos) = angle.sin_cos();
    let q = [pin[0] + 0.5 * sin, pin[1] - 0.5 * cos, angle - FRAC_PI_2];
    Known::new(body, q, [0.5 * cos * rate, 0.5 * sin * rate, rate])
}

/// V04: height over the floor and its rate, dropped from 1 m with e = 0.8.
///
/// ```text
///  first impact at √(2h/g) with √(2gh); flights of 2u/g with u = eᵏ √(2gh)
/// ```
pub(super) fn dropped(t: f64) -> [f64; 2] {
    let first = (2.0 / G).sqrt();
    if t < first {
        return [1.0 - 0.5 * G * t * t, -G * t];
    }
    let (mut since, mut u) = (t - first, 0.8 * G * first);
    while since > 2.0 * u / G {
        since -= 2.0 * u / G;
        u *= 0.8;
    }
    [u * since - 0.5 * G * since * since, u - G * since]
}

/// V07: disc of 0.25 m slides with μ g = g/4 from 4 m/s until it rolls at two thirds of that.
pub(super) fn slid(t: f64) -> Known {
    let (radius, start, a) = (0.25, 4.0, 0.25 * G);
    let rolls = start / (3.0 * a);
    let s = t.min(rolls);
    let (v, rate) = (start - a * s, -2.0 * a * s / radius);
    let (x, angle) = (start * s - 0.5 * a * s * s, -a * s * s / radius);
    let rolling = t - s;
    let q = [x + v * rolling, radius, angle + rate * rolling];
    Known::new(1, q, [v, 0.0, rate])
}

/// A coordinate between walls at `low` and `high` that reflect it, and its rate.
pub(super) fn reflected(start: f64, speed: f64, [low, high]: [f64; 2], t: f64) -> [f64; 2] {
    let width = high - low;
    let place = (start - low + speed * t).rem_euclid(2.0 * width);
    if place <= width { [low + place, speed] } else { [high + width - place, -speed] }
}

/// V17 (a): box 0.2 × 0.6 that rocks from a tilt of half its slope; at each impact the rate falls to
/// 0.85 of itself and the other corner becomes the pivot.
///
/// ```text
///  φ = |θ| > 0:  φ″ = −(m g R / I) sin(α − φ),   R² = 0.1² + 0.3²,  tan α = 1/3,  I = m (0.4/12 + R²)
/// ```
pub(super) fn rocked(start: f64, t: f64) -> Known {
    let square: f64 = 0.1 * 0.1 + 0.3 * 0.3;
    let slope = 0.1_f64.atan2(0.3);
    let k = G * square.sqrt() / (0.4 / 12.0 + square);
    let f = |phi: f64| -k * (slope - phi).sin();
    let (mut state, mut side, mut left) = ([start, 0.0], 1.0, t);
    while left > 0.0 {
        let h = left.min(1.0 / RATE);
        let next = runge_kutta(state, h, f);
        if next[0] >= 0.0 {
            (state, left) = (next, left - h);
            continue;
        }
        let (mut low, mut high) = (0.0, h);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if runge_kutta(state, middle, f)[0] > 0.0 { low = middle } else { high = middle }
        }
        let struck = runge_kutta(state, low, f);
        (state, side, left) = ([0.0, -0.85 * struck[1]], -side, left - low.max(f64::MIN_POSITIVE));
    }
    let (angle, rate) = (side * state[0], side * state[1]);
    let (sin, cos) = angle.sin_cos();
    // From the pivot to the centre: (side 0.1, 0.3), turned.
    let arm = [side * 0.1 * cos - 0.3 * sin, side * 0.1 * sin + 0.3 * cos];
    let pivot = if side > 0.0 { 0.0 } else { 0.2 };
    let v = [-rate * arm[1], rate * arm[0], rate];
    Known::new(1, [pivot + arm[0], arm[1], angle], v)
}

/// V36 (a): disc of 0.1 m at (−0.5, 1) with (5, −5), g = 9.8, e = 0.92: one bounce on the floor, one
/// against the wall at 1.75.
pub(super) fn banked(t: f64) -> Known {
    let (g, e) = (9.8, 0.92);
    let wall = 0.43;
    let [x, vx] =
        if t < wall { [5.0 * t - 0.5, 5.0] } else { [1.65 - 5.0 * e * (t - wall), -5.0 * e] };
    // 0.9 = 5 s + g s²/2
    let fast = (25.0 + 2.0 * g * 0.9_f64).sqrt();
    let floor = (fast - 5.0) / g;
    let [y, vy] = if t < floor {
        [1.0 - 5.0 * t - 0.5 * g * t * t, -5.0 - g * t]
    } else {
        let s = t - floor;
        [0.1 + e * fast * s - 0.5 * g * s * s, e * fast - g * s]
    };
    Known::new(2, [x, y, 0.0], [vx, vy, 0.0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn near(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    /// Elliptic functions give the pendulum's angle and rate after 2 s, and the parallelogram's after
    /// 3 s.
    #[test]
    fn swings() {
        let [angle, rate] = swing(1.5 * G, 2.5, 2.0);
        near(angle, -0.133_402_730_266_384, 1e-11);
        near(rate, 7.262_656_012_358_54, 1e-11);
        let [angle, _] = swing(G * 6.0 / (10.0 / 3.0 + 1.0), 1.2, 3.0);
        near(angle, -0.971_480_744_352_383, 1e-11);
    }

    /// Geometric series give the heights of a bouncing ball.
    #[test]
    fn drops() {
        near(dropped(1.0)[0], 0.468_004_452_526_036, 1e-12);
        near(dropped(3.0)[0], 0.068_707_460_965_765_7, 1e-12);
    }

    /// The box stands upright at the instants of its impacts.
    #[test]
    fn rocks() {
        let tilt = 0.160_875_277_198_321;
        for impact in [0.273_858_974_782_351, 0.666_850_965_033_691, 0.973_757_194_456_258] {
            near(rocked(tilt, impact).q.z, 0.0, 1e-9);
        }
    }

    /// Where the disc rolls, its lowest point rests.
    #[test]
    fn slides() {
        let known = slid(2.0);
        near(known.q.x, 5.695_775_285_989_35, 1e-12);
        near(known.v.x + 0.25 * known.v.z, 0.0, 1e-12);
    }

    #[test]
    fn banks() {
        let end = banked(0.6);
        let loss = (end.q.x + 2.0).powi(2) + (end.q.y - 1.5).powi(2);
        near(loss, 8.316_138_582_201_78, 1e-11);
    }

    #[test]
    fn reflects() {
        near(reflected(0.3, 1.7, [0.05, 1.95], 10.0)[0], 1.8, 1e-12);
        near(reflected(0.4, 1.1, [0.05, 0.95], 10.0)[0], 0.6, 1e-12);
    }
}
