//! From a body's definition to shapes about its centre of mass, mass and inertia.

use nalgebra::{Vector2, Vector3};
use tangency_collision::{Collider, MassProperties, Pose, Shape, pose};

use crate::compile::{
    conflict, derived, finite, finite_point, non_negative, positive, unit_interval,
};
use crate::model::Body;
use crate::{BodyDef, BodyKind, SceneError};

pub(crate) struct CompiledBody {
    pub(crate) body: Body,
    pub(crate) collider: Collider,
    pub(crate) pose: Pose,
    pub(crate) velocity: Vector3<f64>,
}

pub(crate) fn compile_body(def: &BodyDef, path: &str) -> Result<CompiledBody, SceneError> {
    for (i, shape) in def.shapes.iter().enumerate() {
        let at = |source| SceneError::Shape { path: format!("{path}.shapes[{i}]"), source };
        shape.validate().map_err(at)?;
        if matches!(shape, Shape::HalfPlane { .. }) && def.kind == BodyKind::Dynamic {
            let path = format!("{path}.shapes[{i}]");
            return conflict(path, "a half plane has no mass; make the body static or kinematic");
        }
    }
    non_negative(def.friction, &format!("{path}.friction"))?;
    unit_interval(def.restitution, &format!("{path}.restitution"))?;
    finite(def.gravity_scale, &format!("{path}.gravity_scale"))?;
    let position = finite_point(def.position, &format!("{path}.position"))?;
    finite(def.angle, &format!("{path}.angle"))?;
    let velocity = finite_point(def.velocity, &format!("{path}.velocity"))?;
    finite(def.angular_velocity, &format!("{path}.angular_velocity"))?;
    if def.kind == BodyKind::Static && (velocity != Vector2::zeros() || def.angular_velocity != 0.0)
    {
        return conflict(
            format!("{path}.velocity"),
            "a static body cannot move; make it kinematic",
        );
    }

    let properties = MassProperties::combined(
        def.shapes.iter().filter_map(Shape::mass_properties).collect::<Vec<_>>().into_iter(),
    );
    let centroid = properties.as_ref().map_or_else(Vector2::zeros, |p| p.centroid);
    let shapes: Vec<Shape> = def.shapes.iter().map(|s| s.translated(-centroid)).collect();
    let collider = Collider::new(&shapes)
        .map_err(|source| SceneError::Shape { path: format!("{path}.shapes"), source })?;
    let frame = Pose::new(position.x, position.y, def.angle);
    let center = pose::point(&frame, &centroid);
    let (mass, inertia_follows_mass) = mass_of(def, properties.as_ref(), path)?;
    let body = Body {
        name: def.name.clone(),
        kind: def.kind,
        mass,
        area: properties.as_ref().map_or(0.0, |p| p.area),
        inertia_follows_mass,
        friction: def.friction,
        restitution: def.restitution,
        gravity_scale: def.gravity_scale,
        groups: def.groups.clone(),
        category: def.category,
        mask: def.mask,
    };
    let velocity = Vector3::new(velocity.x, velocity.y, def.angular_velocity);
    Ok(CompiledBody { body, collider, pose: Pose::new(center.x, center.y, def.angle), velocity })
}

/// (m, m, I), and whether I follows from m.
fn mass_of(
    def: &BodyDef,
    properties: Option<&MassProperties>,
    path: &str,
) -> Result<(Vector3<f64>, bool), SceneError> {
    if let Some(mass) = def.mass {
        positive(mass, &format!("{path}.mass"))?;
    }
    if let Some(density) = def.density {
        positive(density, &format!("{path}.density"))?;
    }
    if let Some(inertia) = def.inertia {
        positive(inertia, &format!("{path}.inertia"))?;
    }
    if def.kind != BodyKind::Dynamic {
        return Ok((Vector3::zeros(), false));
    }
    let mass = match (def.mass, def.density, properties) {
        (Some(_), Some(_), _) => {
            return conflict(format!("{path}.density"), "give either mass or density, not both");
        }
        (Some(mass), None, _) => mass,
        (None, density, Some(p)) => derived(density.unwrap_or(1.0) * p.area, path)?,
        (None, _, None) => return conflict(path.into(), "a body without shapes needs `mass`"),
    };
    let inertia = match (def.inertia, properties) {
        (Some(inertia), _) => inertia,
        (None, Some(p)) => mass * p.second_moment / p.area,
        (None, None) => return conflict(path.into(), "a body without shapes needs `inertia`"),
    };
    Ok((Vector3::new(mass, mass, inertia), def.inertia.is_none()))
}
