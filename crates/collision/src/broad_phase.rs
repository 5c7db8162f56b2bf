//! Broad phase: which bodies are near each other at all.

use crate::{bounds::Bounds, settled::Settled, sweep::Sweep, world::World};

/// Up to this many bodies, looking at all pairs costs less than sorting.
const FEW: usize = 16;

/// Two bodies that may be within reach of each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Their indices, the lower one first.
    pub bodies: [u32; 2],
    /// A lower bound of their distance, m; negative or −∞ where it says nothing.
    pub apart: f64,
}

/// Memory of the broad phase.
#[derive(Debug, Default)]
pub(crate) struct BroadPhase {
    settled: Settled,
    sweep: Sweep,
    /// The bodies that are swept, and their boxes.
    swept: Vec<u32>,
    boxes: Vec<Bounds>,
    unbounded: Vec<u32>,
    /// Fixed bodies that were moved by the last placement, ascending.
    displaced: Vec<u32>,
}

impl BroadPhase {
    /// Follows a placement of the bodies. Of two `fixed` ones nothing is found; `same` says that those
    /// were fixed before.
    pub(crate) fn update(&mut self, world: &World, fixed: &[bool], same: bool) {
        if world.len() <= FEW {
            return;
        }
        let displaced = || world.moving().iter().copied().filter(|i| fixed[*i as usize]);
        if same && !world.is_new() && displaced().eq(self.displaced.iter().copied()) {
            return;
        }
        self.displaced.clear();
        self.displaced.extend(displaced());
        self.settled.renew(world, fixed);
        self.swept.clear();
        self.unbounded.clear();
        for i in 0..world.len() {
            if world.is_unbounded(i) {
                self.unbounded.push(number(i));
            } else if !self.settled.contains(i) && !world.is_empty(i) {
                self.swept.push(number(i));
            }
        }
    }

    /// Pairs of bodies no further apart than the greater of their reaches (m), in ascending order.
    pub(crate) fn pairs(
        &mut self,
        world: &World,
        fixed: &[bool],
        reach: &[f64],
        pairs: &mut Vec<Near>,
    ) {
        pairs.clear();
        let bounds = world.bounds();
        let mut add = |i: usize, j: usize| {
            let within = if reach[i] > reach[j] { reach[i] } else { reach[j] };
            if (fixed[i] && fixed[j]) || !bounds[i].near(&bounds[j], within) {
                return;
            }
            let apart = world.apart(i, j);
            if apart <= within {
                pairs.push(Near { bodies: [number(i), number(j)], apart });
            }
        };
        if world.len() <= FEW {
            for i in 0..world.len() {
                (i + 1..world.len()).for_each(|j| add(i, j));
            }
            return;
        }
        let Self { settled, sweep, swept, boxes, unbounded, .. } = self;
        boxes.clear();
        boxes.extend(
            swept.iter().map(|i| world.bounds()[*i as usize].grown(reach[*i as usize].max(0.0))),
        );
        sweep.overlaps(boxes, |k, l| add(swept[k] as usize, swept[l] as usize));
        // How far a settled body can be found from: its own reach counts, too.
        let own = settled.members().iter().map(|i| reach[*i as usize]).fold(0.0, f64::max);
        let mut add_ordered = |i: usize, j: usize| add(i.min(j), i.max(j));
        for i in swept.iter().map(|i| *i as usize).filter(|i| !fixed[*i]) {
            settled.near(&world.bounds()[i], own.max(reach[i]), |j| add_ordered(i, j));
        }
        for (k, plane) in unbounded.iter().enumerate() {
            let others = swept.iter().chain(&unbounded[k + 1..]);
            others.for_each(|i| add_ordered(*i as usize, *plane as usize));
            if !fixed[*plane as usize] {
                let settled = settled.members().iter();
                settled.for_each(|i| add_ordered(*i as usize, *plane as usize));
            }
        }
        pairs.sort_unstable_by_key(|pair| pair.bodies);
    }
}

fn number(body: usize) -> u32 {
    u32::try_from(body).expect("bodies are numbered with 32 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Collider, Pose, Shape, pose::Frame};

    /// A jittered grid of boxes, a few long ones, a half-plane and a body without shapes.
    fn scene(shift: f64) -> (Vec<Collider>, Vec<Frame>) {
        let rectangle =
            |width, height| Shape::Rectangle { width, height, center: [0.0; 2], angle: 0.0 };
        let collider = |shapes: &[Shape]| Collider::new(shapes).expect("valid shapes");
        let mut colliders: Vec<Collider> = (0..200_u32)
            .map(|k| collider(&[rectangle(if k % 67 == 3 { 7.0 } else { 0.8 }, 0.9)]))
            .collect();
        colliders.push(collider(&[Shape::HalfPlane { normal: [0.1, 1.0], offset: 1.0 }]));
        colliders.push(collider(&[]));
        let pose = |k: u32| {
            let (x, y) = (f64::from(k % 20), f64::from(k / 20));
            let s = shift + 0.3 * (7.0 * x + 3.0 * y).sin();
            Pose::new(x + s, y - s, s)
        };
        (colliders, (0..202).map(|k| Frame::new(&pose(k))).collect())
    }

    fn all_pairs(world: &World, fixed: &[bool], reach: &[f64]) -> Vec<Near> {
        // The last body is empty.
        let last = world.len() - 1;
        let pairs = (0..last).flat_map(|i| (i + 1..last).map(move |j| (i, j)));
        let near = |(i, j): (usize, usize)| {
            let pair = Near { bodies: [number(i), number(j)], apart: world.apart(i, j) };
            let within = pair.apart <= reach[i].max(reach[j]);
            (within && !(fixed[i] && fixed[j])).then_some(pair)
        };
        pairs.filter_map(near).collect()
    }

    #[test]
    fn sweeps_and_trees_find_what_all_pairs_find() {
        let (mut world, mut broad_phase, mut found) =
            (World::default(), BroadPhase::default(), Vec::new());
        let fixed: Vec<bool> = (0..202).map(|k| k % 3 == 0).collect();
        let reaches: [fn(u32) -> f64; 4] = [
            |_| 0.15,
            |k| if k == 77 { 4.0 } else { 0.01 * f64::from(k % 5) },
            |_| f64::INFINITY,
            |_| -0.1,
        ];
        // Everything moves, then nothing does, then one quarter, another, and nothing again.
        let (colliders, mut frames) = scene(0.0);
        for quarter in [None, None, Some(0), Some(1), None, None] {
            let moved = scene(0.2).1;
            (0..202).filter(|k| Some(k % 4) == quarter).for_each(|k| frames[k] = moved[k]);
            world.place(&colliders, &frames);
            broad_phase.update(&world, &fixed, true);
            for reach in reaches {
                let reach: Vec<f64> = (0..202).map(reach).collect();
                broad_phase.pairs(&world, &fixed, &reach, &mut found);
                assert_eq!(found, all_pairs(&world, &fixed, &reach));
            }
        }
    }
}
