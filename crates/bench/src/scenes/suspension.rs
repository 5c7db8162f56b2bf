//! Chains that hang between supports, or swing.

use tangency_core::{SceneDef, WORLD};

use super::bodies::{hinge, rod};
use super::joints::chain;

/// V16 (a): ten slender rods (0.2 m, 0.5 kg) between (0, 0) and (1.2, 0), at rest where the pull H
/// along x balances the weight: tan aᵢ = (i − 4.5) m g/H.
#[must_use]
pub fn suspended_chain(pull: f64) -> SceneDef {
    let (length, mass) = (0.2, 0.5);
    let mut def = SceneDef { name: "suspended chain".into(), ..SceneDef::default() };
    let mut node = [0.0, 0.0];
    for i in 0..10 {
        let angle = ((f64::from(i) - 4.5) * mass * 9.81 / pull).atan();
        let next = [node[0] + length * angle.cos(), node[1] + length * angle.sin()];
        let center = [0, 1].map(|axis| f64::midpoint(node[axis], next[axis]));
        let above = if i == 0 { WORLD.into() } else { format!("link{}", i - 1) };
        let link = format!("link{i}");
        def.joints.push(hinge(&format!("pin{i}"), &above, &link, node));
        def.bodies.push(rod(&link, length, mass, center, angle));
        node = next;
    }
    def.joints.push(hinge("end", WORLD, "link9", [1.2, 0.0]));
    def
}

/// V16 (b): hanging slender rods (`length`, `mass`), each turned by one of `angles` from hanging,
/// at rest.
#[must_use]
pub fn turned_chain(angles: &[f64], length: f64, mass: f64) -> SceneDef {
    let mut def = chain(angles.len(), length, mass);
    let mut node = [0.0, 0.0];
    for (i, angle) in angles.iter().enumerate() {
        let (sin, cos) = angle.sin_cos();
        let above = if i == 0 { WORLD.into() } else { format!("link{}", i - 1) };
        let link = &mut def.bodies[i];
        link.position = [node[0] + 0.5 * length * sin, node[1] - 0.5 * length * cos];
        link.angle += angle;
        def.joints[i] = hinge(&format!("pin{i}"), &above, &link.name, node);
        node = [node[0] + length * sin, node[1] - length * cos];
    }
    def
}
