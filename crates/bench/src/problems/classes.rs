//! The classes of hard problems.

use nalgebra::Vector2;
use tangency_core::lcp::{Lcp, NO_BODY};

use super::{Builder, Random};

fn box_inertia(mass: f64) -> [f64; 2] {
    [mass, mass / 6.0]
}

/// Unit boxes one on the other, `contacts` points per interface, masses growing by `ratio` in all.
#[must_use]
pub fn stack(random: &mut Random, ratio: f64) -> Lcp {
    let boxes = random.index(19) + 2;
    let contacts = random.index(3) + 2;
    let mu = random.pick(&[0.1, 0.5, 1.0, 3.0]);
    let noise = random.pick(&[0.0, 0.0, 0.1, 1.0]);
    let mut b = Builder::default();
    for i in 0..boxes {
        let share = i as f64 / (boxes - 1) as f64;
        let velocity = [(); 3].map(|()| noise * random.between(-1.0, 1.0));
        let body = b.body([0.0, i as f64 + 0.5], box_inertia(ratio.powf(share)), velocity);
        let below = if i == 0 { NO_BODY } else { body - 1 };
        for k in 0..contacts {
            let x = k as f64 / (contacts - 1) as f64 - 0.5;
            b.contact([below, body], [x, i as f64], Vector2::y(), 0.0, mu);
        }
    }
    b.lcp
}

/// A brick wall with contacts at the sides.
#[must_use]
pub fn wall(random: &mut Random) -> Lcp {
    let (columns, layers) = (random.index(4) + 2, random.index(4) + 2);
    let mu = random.pick(&[0.2, 0.6, 1.0]);
    let push = random.pick(&[0.0, 0.5, 2.0]);
    let mut b = Builder::default();
    for layer in 0..layers {
        for column in 0..columns {
            let x = column as f64 + 0.5 * (layer % 2) as f64;
            let vx = if layer == layers / 2 && column == 0 { push } else { 0.0 };
            let body = b.body([x, layer as f64 + 0.5], box_inertia(1.0), [vx, 0.0, 0.0]);
            wall_contacts(&mut b, body, [x, layer as f64], columns, mu);
        }
    }
    b.lcp
}

fn wall_contacts(b: &mut Builder, body: u32, [x, y]: [f64; 2], columns: usize, mu: f64) {
    let bodies = b.centres.clone();
    if y == 0.0 {
        for side in [-0.5, 0.5] {
            b.contact([NO_BODY, body], [x + side, 0.0], Vector2::y(), 0.0, mu);
        }
    }
    let near = bodies.len().saturating_sub(columns + 2);
    for (other, centre) in bodies.iter().enumerate().take(bodies.len() - 1).skip(near) {
        let (dx, dy) = (x - centre.x, y + 0.5 - centre.y);
        let other = u32::try_from(other).expect("few bodies");
        if (dy - 1.0).abs() < 1e-9 && dx.abs() < 0.99 {
            let (left, right) = (x.max(centre.x) - 0.5, x.min(centre.x) + 0.5);
            b.contact([other, body], [left, y], Vector2::y(), 0.0, mu);
            b.contact([other, body], [right, y], Vector2::y(), 0.0, mu);
        } else if dy.abs() < 1e-9 && (dx - 1.0).abs() < 1e-9 {
            b.contact([other, body], [x - 0.5, y], Vector2::x(), 0.0, mu);
            b.contact([other, body], [x - 0.5, y + 1.0], Vector2::x(), 0.0, mu);
        }
    }
}

/// A disc or box between two planes at an angle, driven into the corner.
#[must_use]
pub fn wedge(random: &mut Random) -> Lcp {
    let half = random.between(0.05, 1.3);
    let mu = random.between(0.0, 3.0);
    let mut b = Builder::default();
    let velocity =
        [random.between(-1.0, 1.0), random.between(-3.0, 0.0), random.between(-5.0, 5.0)];
    let body = b.body([0.0, 0.0], [1.0, 0.3], velocity);
    let points = random.index(2) + 1;
    for side in [-1.0, 1.0] {
        let normal = Vector2::new(-side * half.cos(), half.sin());
        for point in 0..points {
            let along = Vector2::new(side * half.sin(), half.cos()) * (0.4 * point as f64);
            let at = along - normal;
            b.contact([NO_BODY, body], [at.x, at.y], normal, 0.0, mu);
        }
    }
    b.lcp
}

/// Wedge-shaped stones around a half circle, two contacts per joint, standing on the ground.
#[must_use]
pub fn arch(random: &mut Random) -> Lcp {
    let stones = random.index(13) + 3;
    let (mu, thickness) = (random.pick(&[0.2, 0.5, 1.0, 3.0]), random.between(0.1, 0.6));
    let noise = random.pick(&[0.0, 0.0, 0.1]);
    let angle = |joint: usize| std::f64::consts::PI * joint as f64 / stones as f64;
    let mut b = Builder::default();
    for k in 0..stones {
        let middle = 0.5 * (angle(k) + angle(k + 1));
        let velocity = [(); 3].map(|()| noise * random.between(-1.0, 1.0));
        let mass = thickness / stones as f64;
        b.body([middle.cos(), middle.sin()], [mass, 0.1 * mass], velocity);
    }
    for joint in 0..=stones {
        let (sin, cos) = angle(joint).sin_cos();
        let a = if joint == 0 { NO_BODY } else { index(joint - 1) };
        let c = if joint == stones { NO_BODY } else { index(joint) };
        for radius in [1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness] {
            // The normal points from a to c, along the arch.
            let normal = Vector2::new(-sin, cos);
            if c == NO_BODY {
                b.contact([c, a], [radius * cos, radius * sin], -normal, 0.0, mu);
            } else {
                b.contact([a, c], [radius * cos, radius * sin], normal, 0.0, mu);
            }
        }
    }
    b.lcp
}

/// Rods that touch the floor with one end: Painlevé's problem, one to four of them hinged.
#[must_use]
pub fn rods(random: &mut Random) -> Lcp {
    let mu = random.between(0.0, 3.0);
    let mut b = Builder::default();
    for k in 0..=random.index(4) {
        let angle = random.between(0.2, 1.5);
        let centre = [3.0 * k as f64, angle.sin()];
        let velocity =
            [random.between(-3.0, 3.0), random.between(-2.0, 0.5), random.between(-5.0, 5.0)];
        let body = b.body(centre, [1.0, 1.0 / 3.0], velocity);
        let foot = [centre[0] + angle.cos() * random.pick(&[-1.0, 1.0]), 0.0];
        b.contact([NO_BODY, body], foot, Vector2::y(), 0.0, mu);
        if k > 0 && random.index(2) == 0 {
            b.hinge([body - 1, body], [centre[0] - 1.5, 1.0]);
        }
    }
    b.lcp
}

/// Bodies, contacts and hinges at random.
#[must_use]
pub fn graph(random: &mut Random) -> Lcp {
    let bodies = random.index(28) + 3;
    let mut b = Builder::default();
    for _ in 0..bodies {
        let mass = 10_f64.powf(random.between(-1.0, 1.0));
        let velocity = [(); 3].map(|()| random.between(-2.0, 2.0));
        let centre = [random.between(-3.0, 3.0), random.between(-3.0, 3.0)];
        b.body(centre, [mass, mass * random.between(0.1, 1.0)], velocity);
    }
    let top = random.pick(&[0.3, 0.5, 1.0, 3.0]);
    for _ in 0..random.index(75) + 6 {
        let (pair, at) = random_pair(random, &b, bodies);
        let gap = random.pick(&[0.0, 0.0, 0.01]);
        let (normal, mu) = (random.direction(), random.between(0.0, top));
        b.contact(pair, at, normal, gap, mu);
    }
    for _ in 0..random.index(16) {
        let (pair, at) = random_pair(random, &b, bodies);
        if pair[0] != NO_BODY {
            b.hinge(pair, at);
            let max = random.between(0.01, 1.0);
            b.motor(pair, random.between(-3.0, 3.0), max);
        }
    }
    b.lcp
}

fn random_pair(random: &mut Random, b: &Builder, bodies: usize) -> ([u32; 2], [f64; 2]) {
    let second = random.index(bodies);
    let first = random.index(bodies + 1);
    let first = if first == second || first == bodies { NO_BODY } else { index(first) };
    let offset = random.direction();
    let at = b.centres[second] + 0.5 * offset;
    ([first, index(second)], [at.x, at.y])
}

fn index(value: usize) -> u32 {
    u32::try_from(value).expect("few bodies")
}

/// A closed chain with every hinge entered twice, lying on the floor.
#[must_use]
pub fn doubled_chain(random: &mut Random) -> Lcp {
    let links = random.index(10) + 3;
    let radius = links as f64 / std::f64::consts::TAU;
    let mu = random.between(0.1, 1.0);
    let at = |k: f64| {
        let angle = k * std::f64::consts::TAU / links as f64;
        [radius * angle.cos(), radius * angle.sin()]
    };
    let mut b = Builder::default();
    for k in 0..links {
        let velocity = [(); 3].map(|()| random.between(-1.0, 1.0));
        b.body(at(k as f64), [1.0, 1.0 / 12.0], velocity);
    }
    for k in 0..links {
        let pair = [index(k), index((k + 1) % links)];
        b.hinge(pair, at(k as f64 + 0.5));
        b.hinge(pair, at(k as f64 + 0.5));
        if at(k as f64)[1] < -0.5 * radius {
            let [x, y] = at(k as f64 + 0.5);
            b.contact([NO_BODY, pair[0]], [x, y], Vector2::y(), 0.0, mu);
        }
    }
    b.lcp
}

/// Discs on a triangular grid with tiny gaps and penetrations: many grazing contacts.
#[must_use]
pub fn pile(random: &mut Random) -> Lcp {
    let base = random.index(5) + 2;
    let mu = random.pick(&[0.0, 0.3, 0.7, 1.2]);
    let noise = random.pick(&[0.0, 1e-9, 1e-6, 1e-3]);
    let speed = random.pick(&[0.0, 0.1, 1.0]);
    let mut b = Builder::default();
    for layer in 0..base {
        for k in 0..base - layer {
            let centre = [k as f64 + 0.5 * layer as f64, 0.5 + 0.75_f64.sqrt() * layer as f64];
            let velocity = [(); 3].map(|()| speed * random.between(-1.0, 1.0));
            let body = b.body(centre, [1.0, 0.125], velocity);
            pile_contacts(&mut b, random, body, mu, noise);
        }
    }
    b.lcp
}

fn pile_contacts(b: &mut Builder, random: &mut Random, body: u32, mu: f64, noise: f64) {
    let centre = b.centres[body as usize];
    if centre.y < 0.6 {
        let gap = noise * random.between(-0.5, 1.0);
        b.contact([NO_BODY, body], [centre.x, 0.0], Vector2::y(), gap, mu);
    }
    for other in 0..body {
        let apart = centre - b.centres[other as usize];
        if apart.norm() < 1.0 + 1e-6 {
            let at = b.centres[other as usize] + 0.5 * apart;
            let gap = noise * random.between(-0.5, 1.0);
            b.contact([other, body], [at.x, at.y], apart.normalize(), gap, mu);
        }
    }
}

/// Makes one problem.
pub type Class = fn(&mut Random) -> Lcp;

/// Every class by name.
pub const CLASSES: [(&str, Class); 10] = [
    ("stack", |random| stack(random, 1.0)),
    ("mass ratio", |random| {
        let ratio = random.pick(&[1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6]);
        stack(random, ratio)
    }),
    ("wall", wall),
    ("arch", arch),
    ("wedge", wedge),
    ("rods", rods),
    ("graph", graph),
    ("doubled chain", doubled_chain),
    ("pile", pile),
    ("small graph", |random| {
        let mut lcp = graph(random);
        lcp.rows.truncate(20);
        lcp
    }),
];
