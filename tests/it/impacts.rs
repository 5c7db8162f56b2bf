//! Located impacts: figures of the motion itself, and their derivatives.

mod free;
mod gradients;
mod resting;
mod shapes;

use tangency::{BodyDef, SceneDef, Stepping};
use tangency_bench::scenes::{disc, floor, material};

/// Steps of the scene are divided at impacts.
pub(crate) fn resolved(def: SceneDef) -> SceneDef {
    SceneDef { stepping: Stepping::ImpactResolved { max_impacts: 8 }, ..def }
}

/// A disc (1 kg, radius r) whose centre is at y₀ and moves at v₀ above a floor.
pub(crate) fn dropped(r: f64, y: f64, v: f64, e: f64) -> SceneDef {
    let ball = BodyDef { mass: Some(1.0), velocity: [0.0, v], ..disc("ball", r, [0.0, y]) };
    let def = SceneDef { dt: 0.005, bodies: vec![floor(), ball], ..SceneDef::default() };
    resolved(material(def, 0.0, e))
}

/// Height of a disc that bounces on a floor, with its change along a direction of (y₀, v₀, e, g, r):
///
/// ```text
///  w = √(v₀² + 2 g (y₀ − r))      t = (v₀ + w)/g      then u ← e w, w = u, t ← t + 2 u/g
///  y = r + u s − ½ g s²           s = T − t
/// ```
pub(crate) fn bounced([y, v, e, g, r]: [f64; 5], d: [f64; 5], end: f64) -> [f64; 2] {
    let [dy, dv, de, dg, dr] = d;
    let mut w = (v * v + 2.0 * g * (y - r)).sqrt();
    let mut dw = (v * dv + g * (dy - dr) + (y - r) * dg) / w;
    let (mut t, mut u) = ((v + w) / g, e * w);
    let mut dt = (dv + dw) / g - t * dg / g;
    let mut du = e * dw + w * de;
    while t + 2.0 * u / g < end {
        dt += 2.0 * (du - u * dg / g) / g;
        t += 2.0 * u / g;
        (w, dw) = (u, du);
        (u, du) = (e * w, e * dw + w * de);
    }
    let s = end - t;
    let height = r + u * s - 0.5 * g * s * s;
    [height, dr + du * s - 0.5 * s * s * dg - (u - g * s) * dt]
}
