//! Derivatives of the rows of contacts.
//!
//! ```text
//!  d = n or t,  ρ = c − p,  J = [−d, −d·⊥ρ_a | d, d·⊥ρ_b],  ∂d/∂ψ = ⊥d
//!  d̄ = −J̄_a + J̄_b − J̄_aθ ⊥ρ_a + J̄_bθ ⊥ρ_b       ψ̄ = d̄·⊥d
//!  ρ̄_a = J̄_aθ ⊥d     ρ̄_b = −J̄_bθ ⊥d              c̄ = ρ̄_a + ρ̄_b     p̄ = −ρ̄
//! ```
//!
//! Point c, angle ψ of the normal, and gap then go through the contact's own derivative, that of
//! `ContactFeature::jet` read backwards. With o the side whose point the contact rides on, s = +1 for
//! a and −1 for b:
//!
//! ```text
//!  ψ̄ += s (r_o + gap/2) t·c̄      h = s n·c̄      ḡ += h/2      r̄ = −ḡ (+ h for o)
//!  w̄ = ḡ n      ψ̄ += ḡ t·w      Points: w̄ += ψ̄ t/|w|      LineA: θ̄_a += ψ̄      LineB: θ̄_b += ψ̄
//!  x̄_a = −w̄      x̄_b = w̄      x̄_o += c̄      p̄ += x̄      θ̄ += ⊥(x − p)·x̄
//! ```
//!
//! What points and lines are made of follows: l̄ = Rᵀ x̄ for the vertex that a point is, and for the vertices
//! k and k + 1 that a line goes through, e from the one to the other,
//!
//! ```text
//!  dψ = ⊥e·(dl_{k+1} − dl_k)/|e|²        l̄_k += Rᵀ x̄ − ψ̄ ⊥e/|e|²        l̄_{k+1} += ψ̄ ⊥e/|e|²
//! ```

use nalgebra::{Vector2, Vector3, Vector4, Vector6};
use tangency_collision::pose::perp;
use tangency_collision::{Collider, Contact, Feature, Part};
use tangency_core::bend::Bend;
use tangency_core::row::RowContext;

use crate::rotations::Rotations;
use crate::shape::Shape;
use crate::vector::{Bars, Direction};

/// A contact at the poses of a step, and what is collected over its rows.
pub(crate) struct ContactPlace<'a> {
    contact: &'a Contact,
    bodies: [usize; 2],
    known: [Option<usize>; 2],
    /// ρ, m.
    arms: [Vector2<f64>; 2],
    /// ρ̄ per side, ψ̄ and ḡ.
    arms_bar: [Vector2<f64>; 2],
    turn_bar: f64,
    gap_bar: f64,
}

impl<'a> ContactPlace<'a> {
    /// The contact at the context's poses.
    pub(crate) fn new(context: &RowContext<'a>, contact: u32) -> Self {
        let bodies = context.contact_bodies(contact);
        let contact = &context.contacts[contact as usize];
        let arms = bodies.map(|body| contact.point - context.q[body].xy());
        let arms_bar = [Vector2::zeros(); 2];
        let known = bodies.map(Some);
        Self { contact, bodies, known, arms, arms_bar, turn_bar: 0.0, gap_bar: 0.0 }
    }

    /// Bodies a and b.
    pub(crate) fn bodies(&self) -> &[Option<usize>; 2] {
        &self.known
    }

    /// n.
    pub(crate) fn normal(&self) -> Vector2<f64> {
        self.contact.normal
    }

    /// Gap, m.
    pub(crate) fn gap(&self) -> f64 {
        self.contact.gap
    }

    /// Value and gradient of the row along d.
    #[inline]
    pub(crate) fn shape(&self, d: &Vector2<f64>, value: f64) -> Shape {
        let [turn_a, turn_b] = self.arms.map(|arm| d.dot(&perp(&arm)));
        let jacobian = [Vector3::new(-d.x, -d.y, -turn_a), Vector3::new(d.x, d.y, turn_b)];
        Shape { value, jacobian }
    }

    /// Collects ∂L/∂J (1 × 3 per side) and ∂L/∂gap of the row along d.
    #[inline]
    pub(crate) fn add_row(&mut self, d: &Vector2<f64>, bar: &[Vector3<f64>; 2], gap_bar: f64) {
        let ([a, b], [arm_a, arm_b], turned) = (bar, &self.arms, perp(d));
        let d_bar = b.xy() - a.xy() - perp(arm_a) * a.z + perp(arm_b) * b.z;
        self.turn_bar += d_bar.dot(&turned);
        self.arms_bar[0] += turned * a.z;
        self.arms_bar[1] -= turned * b.z;
        self.gap_bar += gap_bar;
    }

    /// Pulls what was collected onto poses and radii.
    pub(crate) fn pull_back(
        &self,
        context: &RowContext<'_>,
        rotations: &mut Rotations,
        bars: &mut Bars<'_>,
    ) {
        let (feature, n) = (&self.contact.feature, self.contact.normal);
        let (t, c_bar) = (perp(&n), self.arms_bar[0] + self.arms_bar[1]);
        let own = usize::from(matches!(feature.feature, Feature::LineA { .. }));
        let s = if own == 0 { 1.0 } else { -1.0 };
        let half = s * n.dot(&c_bar);
        let gap_bar = self.gap_bar + 0.5 * half;
        let mut radii_bar = [-gap_bar; 2];
        radii_bar[own] += half;

        let [x_a, x_b] = self.points(context, rotations);
        let [p_a, p_b] = self.bodies.map(|body| context.q[body].xy());
        let w = p_b + x_b - p_a - x_a;
        let lever = s * (feature.radii[own] + 0.5 * self.contact.gap);
        let turn_bar = self.turn_bar + lever * t.dot(&c_bar) + gap_bar * t.dot(&w);
        let (mut w_bar, mut angle_bar) = (n * gap_bar, [0.0; 2]);
        match feature.feature {
            Feature::Points { .. } => w_bar += t * (turn_bar / w.norm()),
            Feature::LineA { .. } => angle_bar[0] = turn_bar,
            Feature::LineB { .. } => angle_bar[1] = turn_bar,
        }
        let mut x_bar = [-w_bar, w_bar];
        x_bar[own] += c_bar;
        for (side, arm) in [x_a, x_b].iter().enumerate() {
            let (body, p_bar) = (self.bodies[side], x_bar[side] - self.arms_bar[side]);
            let l_bar = rotations.of(body, &context.q[body]).inverse() * x_bar[side];
            self.reshape(context, side, &l_bar, angle_bar[side], bars);
            let angle_bar = angle_bar[side] + perp(arm).dot(&x_bar[side]);
            bars.state.q[body] += Vector3::new(p_bar.x, p_bar.y, angle_bar);
            if feature.radii[side] > 0.0 {
                let shape = feature.id.shapes[side] as usize;
                bars.scene.bodies[body].radii[shape] += radii_bar[side];
            }
        }
    }

    /// Pulls the gradient by γ of one of the contact's rows onto its shapes.
    pub(crate) fn pull_bend(
        &self,
        context: &RowContext<'_>,
        bend: &Bend,
        bar: f64,
        bars: &mut Bars<'_>,
    ) {
        let line = match self.contact.feature.feature {
            Feature::Points { .. } => None,
            Feature::LineA { .. } => Some(0),
            Feature::LineB { .. } => Some(1),
        };
        for side in 0..2 {
            let l_bar = bend.by_anchors.fixed_rows::<2>(2 * side) * bar;
            let turn_bar = if line == Some(side) { bend.by_turn * bar } else { 0.0 };
            self.reshape(context, side, &l_bar, turn_bar, bars);
        }
    }

    /// Pulls the gradient by a side's point and by the direction of its line onto the vertices.
    fn reshape(
        &self,
        context: &RowContext<'_>,
        side: usize,
        l_bar: &Vector2<f64>,
        turn_bar: f64,
        bars: &mut Bars<'_>,
    ) {
        let (body, id) = (self.bodies[side], &self.contact.feature.id);
        let shape = id.shapes[side] as usize;
        let (collider, by) = (&context.scene.colliders()[body], &mut bars.scene.bodies[body]);
        let first = collider.first_vertex(shape);
        match (id.parts[side], edge_of(collider, shape, id.parts[side])) {
            (Part::Vertex(k), _) => by.vertices[first + k as usize] += l_bar,
            (_, Some(([from, to], e))) => {
                let turned = perp(&e) * (turn_bar / e.norm_squared());
                by.vertices[from] += l_bar - turned;
                by.vertices[to] += turned;
            }
            (_, None) => {
                by.vertices[first] += l_bar;
                by.turns[shape] += turn_bar;
            }
        }
    }

    /// x − p of the two points whose difference w the gap measures.
    fn points(&self, context: &RowContext<'_>, rotations: &mut Rotations) -> [Vector2<f64>; 2] {
        let [l_a, l_b] = match self.contact.feature.feature {
            Feature::Points { a, b } => [a, b],
            Feature::LineA { point, b, .. } => [point, b],
            Feature::LineB { a, point, .. } => [a, point],
        };
        let mut turn = |body: usize| rotations.of(body, &context.q[body]);
        [turn(self.bodies[0]) * l_a, turn(self.bodies[1]) * l_b]
    }
}

/// The change of (c_x, c_y, ψ, gap) of one contact along a direction.
pub(crate) fn contact_jvp(
    context: &RowContext<'_>,
    contact: &Contact,
    along: &Direction<'_>,
) -> Vector4<f64> {
    let bodies = contact.feature.id.bodies.map(|i| i as usize);
    let jet = contact.feature.jet(&context.q[bodies[0]], &context.q[bodies[1]]);
    let mut change = Vector4::zeros();
    for (side, body) in bodies.into_iter().enumerate() {
        change += jet.pose.fixed_columns::<3>(3 * side) * along.state.q[body];
        if contact.feature.radii[side] > 0.0 {
            let shape = contact.feature.id.shapes[side] as usize;
            change += jet.radii.column(side) * along.scene.bodies[body].radii[shape];
        }
    }
    change + reshaped(context, contact, along)
}

/// The ends of an edge and the vector between them; `None` of vertices and half-planes.
fn edge_of(collider: &Collider, shape: usize, part: Part) -> Option<([usize; 2], Vector2<f64>)> {
    match part {
        Part::Edge(k) => collider.edge(shape, k as usize),
        Part::Vertex(_) => None,
    }
}

/// The changes of the points of a contact's features and of the angle of its line, within their bodies.
fn shape_change(
    context: &RowContext<'_>,
    contact: &Contact,
    along: &Direction<'_>,
) -> ([Vector2<f64>; 2], f64) {
    let id = &contact.feature.id;
    let (mut moved, mut turned) = ([Vector2::zeros(); 2], 0.0);
    for (side, moved) in moved.iter_mut().enumerate() {
        let (body, shape) = (id.bodies[side] as usize, id.shapes[side] as usize);
        let (collider, by) = (&context.scene.colliders()[body], &along.scene.bodies[body]);
        let first = collider.first_vertex(shape);
        match (id.parts[side], edge_of(collider, shape, id.parts[side])) {
            (Part::Vertex(k), _) => *moved = by.vertices[first + k as usize],
            (_, Some(([from, to], e))) => {
                *moved = by.vertices[from];
                let along = by.vertices[to] - by.vertices[from];
                turned = perp(&e).dot(&along) / e.norm_squared();
            }
            (_, None) => (*moved, turned) = (by.vertices[first], by.turns[shape]),
        }
    }
    (moved, turned)
}

/// What the change of the shapes does to γ of one of a contact's rows.
pub(crate) fn bend_change(
    context: &RowContext<'_>,
    contact: &Contact,
    bend: &Bend,
    along: &Direction<'_>,
) -> f64 {
    let (moved, turned) = shape_change(context, contact, along);
    let by = |side: usize| bend.by_anchors.fixed_rows::<2>(2 * side).dot(&moved[side]);
    by(0) + by(1) + bend.by_turn * turned
}

/// What the change of the shapes does to a contact.
fn reshaped(context: &RowContext<'_>, contact: &Contact, along: &Direction<'_>) -> Vector4<f64> {
    let (moved, turned) = shape_change(context, contact, along);
    if turned == 0.0 && moved.iter().all(|moved| *moved == Vector2::zeros()) {
        return Vector4::zeros();
    }
    let [a, b] = contact.feature.id.bodies.map(|body| &context.q[body as usize]);
    contact.feature.reshaped(a, b, &moved, turned)
}

/// The change of J (6) of one row, given that of its contact.
pub(crate) fn row_jvp(
    context: &RowContext<'_>,
    contact: u32,
    d: &Vector2<f64>,
    change: &Vector4<f64>,
    along: &Direction<'_>,
) -> Vector6<f64> {
    let bodies = context.contact_bodies(contact);
    let point = context.contacts[contact as usize].point;
    let dd = perp(d) * change.z;
    let turn = |body: usize| {
        let rho = point - context.q[body].xy();
        let d_rho = change.xy() - along.state.q[body].xy();
        dd.dot(&perp(&rho)) + d.dot(&perp(&d_rho))
    };
    Vector6::new(-dd.x, -dd.y, -turn(bodies[0]), dd.x, dd.y, turn(bodies[1]))
}
