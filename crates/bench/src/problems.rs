//! Hard one-step problems, from seeds: no geometry, only bodies, contact points and normals.

#![expect(non_snake_case, reason = "matrices carry their names from the paper")]

mod classes;

pub use classes::{CLASSES, Class, arch, doubled_chain, graph, pile, rods, stack, wall, wedge};

use nalgebra::{Vector2, Vector3};
use tangency_core::lcp::{Law, Lcp, NO_BODY, Row};

/// SplitMix64 (Steele, Lea & Flood 2014): the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number from `low` to `high`, uniformly.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// An index below `count`.
    ///
    /// # Panics
    /// If `count` is zero.
    pub fn index(&mut self, count: usize) -> usize {
        usize::try_from(self.bits() % count as u64).expect("an index")
    }

    /// One of the choices.
    pub fn pick<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.index(choices.len())]
    }

    pub(crate) fn direction(&mut self) -> Vector2<f64> {
        let angle = self.between(0.0, std::f64::consts::TAU);
        Vector2::new(angle.cos(), angle.sin())
    }
}

/// Time step and weight of every scene here.
pub const DT: f64 = 0.01;
const GRAVITY: f64 = 9.81;

/// A problem under construction: bodies with places, then rows.
#[derive(Default)]
pub struct Builder {
    /// The problem so far.
    pub lcp: Lcp,
    pub(crate) centres: Vec<Vector2<f64>>,
}

impl Builder {
    /// A body with velocity v⁻; gravity is added.
    ///
    /// # Panics
    /// Beyond 2³² bodies.
    pub fn body(&mut self, centre: [f64; 2], mass: [f64; 2], velocity: [f64; 3]) -> u32 {
        let M = Vector3::new(mass[0], mass[0], mass[1]);
        let p = M.component_mul(&Vector3::from(velocity))
            - Vector3::new(0.0, DT * GRAVITY * mass[0], 0.0);
        self.lcp.mass.push(M);
        self.lcp.momentum.push(p);
        self.centres.push(Vector2::from(centre));
        u32::try_from(self.centres.len() - 1).expect("few bodies")
    }

    fn row(&mut self, bodies: [u32; 2], at: Vector2<f64>, along: Vector2<f64>, rhs: f64, law: Law) {
        let block = |body: u32, sign: f64| match self.centres.get(body as usize) {
            Some(centre) if body != NO_BODY => {
                let r = at - centre;
                sign * Vector3::new(along.x, along.y, along.y * r.x - along.x * r.y)
            }
            _ => Vector3::zeros(),
        };
        let jacobian = [block(bodies[0], -1.0), block(bodies[1], 1.0)];
        self.lcp.rows.push(Row { bodies, jacobian, rhs, compliance: 0.0, law });
    }

    /// A contact at a point, normal from a to b.
    ///
    /// # Panics
    /// Beyond 2³² rows.
    pub fn contact(
        &mut self,
        bodies: [u32; 2],
        at: [f64; 2],
        normal: Vector2<f64>,
        gap: f64,
        mu: f64,
    ) {
        let at = Vector2::from(at);
        let index = u32::try_from(self.lcp.rows.len()).expect("few rows");
        self.row(bodies, at, normal, -gap / DT, Law::Unilateral);
        if mu > 0.0 {
            let tangent = Vector2::new(-normal.y, normal.x);
            self.row(bodies, at, tangent, 0.0, Law::Friction { normal: index, mu });
        }
    }

    /// A hinge at a point.
    pub fn hinge(&mut self, bodies: [u32; 2], at: [f64; 2]) {
        self.row(bodies, Vector2::from(at), Vector2::x(), 0.0, Law::Equality);
        self.row(bodies, Vector2::from(at), Vector2::y(), 0.0, Law::Equality);
    }

    /// A motor on the relative angular velocity.
    pub fn motor(&mut self, bodies: [u32; 2], speed: f64, max: f64) {
        let jacobian = [-Vector3::z(), Vector3::z()];
        let law = Law::Bounded { max };
        self.lcp.rows.push(Row { bodies, jacobian, rhs: speed, compliance: 0.0, law });
    }
}
