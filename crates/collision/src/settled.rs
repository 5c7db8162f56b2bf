//! Bodies that stay where they are: a tree around them lasts until one of them moves.

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::math::Vector;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy};

use crate::{bounds::Bounds, world::World};

/// Of fewer bodies than this a tree does not pay.
const FEW: usize = 16;

/// Bounded fixed bodies that were not moved by the last placement, in parry's bounding volume
/// hierarchy. (Here alone parry's vector type meets ours.)
#[derive(Default)]
pub(crate) struct Settled {
    members: Vec<u32>,
    is_member: Vec<bool>,
    tree: Bvh,
}

impl Settled {
    /// The members after a placement, in a tree.
    pub(crate) fn renew(&mut self, world: &World, fixed: &[bool]) {
        self.is_member.clear();
        self.is_member.extend_from_slice(fixed);
        let moving = world.moving().iter().map(|i| *i as usize);
        moving.for_each(|i| self.is_member[i] = false);
        for (is_member, bounds) in self.is_member.iter_mut().zip(world.bounds()) {
            *is_member &= bounds.is_finite();
        }
        self.members.clear();
        self.members.extend((0..).zip(&self.is_member).filter(|(_, is)| **is).map(|(i, _)| i));
        if self.members.len() < FEW {
            self.members.clear();
            self.is_member.fill(false);
        }
        let leaves: Vec<Aabb> =
            self.members.iter().map(|i| aabb(&world.bounds()[*i as usize], 0.0)).collect();
        self.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
    }

    /// The bodies, ascending.
    pub(crate) fn members(&self) -> &[u32] {
        &self.members
    }

    /// Whether a body is among them.
    pub(crate) fn contains(&self, body: usize) -> bool {
        self.is_member[body]
    }

    /// The bodies whose boxes are within `reach` of a box, in no particular order.
    pub(crate) fn near(&self, bounds: &Bounds, reach: f64, mut found: impl FnMut(usize)) {
        let grown = aabb(bounds, reach);
        self.tree
            .intersect_aabb(&grown)
            .for_each(|leaf| found(self.members[leaf as usize] as usize));
    }
}

impl std::fmt::Debug for Settled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Settled").field("members", &self.members).finish_non_exhaustive()
    }
}

fn aabb(bounds: &Bounds, by: f64) -> Aabb {
    let Bounds { min, max } = bounds.grown(by);
    Aabb::new(Vector::new(min.x, min.y), Vector::new(max.x, max.y))
}
