//! Broad phase: which bodies are near each other at all.

use parry2d_f64::bounding_volume::Aabb;
use parry2d_f64::math::Vector;
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy};

use crate::world::Bounds;

/// Up to this many boxes, looking at all pairs costs less than building a tree.
const FEW: usize = 32;

/// Pairs i < j of boxes within `reach` of each other, in ascending order.
///
/// Parry's bounding volume hierarchy over the bounded boxes; a half-plane is near everything. (Here
/// alone parry's vector type meets ours.)
pub(crate) fn pairs(boxes: &[Bounds], reach: f64) -> Vec<(usize, usize)> {
    let near = |&(i, j): &(usize, usize)| boxes[i].near(&boxes[j], reach);
    if boxes.len() <= FEW {
        let all = (0..boxes.len()).flat_map(|i| (i + 1..boxes.len()).map(move |j| (i, j)));
        return all.filter(near).collect();
    }
    let (bounded, unbounded): (Vec<usize>, Vec<usize>) =
        (0..boxes.len()).partition(|i| boxes[*i].is_finite());
    let leaves: Vec<Aabb> = bounded.iter().map(|i| aabb(&boxes[*i], 0.0)).collect();
    let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves);
    let mut pairs = Vec::new();
    for &i in &bounded {
        let grown = aabb(&boxes[i], reach);
        let others = tree.intersect_aabb(&grown).map(|leaf| bounded[leaf as usize]);
        pairs.extend(others.filter(|j| i < *j).map(|j| (i, j)));
        pairs.extend(unbounded.iter().map(|j| (i.min(*j), i.max(*j))));
    }
    pairs.retain(near);
    pairs.sort_unstable();
    pairs
}

fn aabb(bounds: &Bounds, by: f64) -> Aabb {
    let (min, max) = (bounds.min.add_scalar(-by), bounds.max.add_scalar(by));
    Aabb::new(Vector::new(min.x, min.y), Vector::new(max.x, max.y))
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector2;

    use super::*;

    #[test]
    fn the_tree_finds_what_all_pairs_find() {
        // A jittered grid of boxes, and one half-plane's box.
        let mut boxes: Vec<Bounds> = (0..200_u32)
            .map(|k| {
                let (x, y) = (f64::from(k % 20), f64::from(k / 20));
                let shift = 0.3 * (7.0 * x + 3.0 * y).sin();
                let corner = Vector2::new(x + shift, y - shift);
                Bounds { min: corner, max: corner + Vector2::new(0.8, 0.9) }
            })
            .collect();
        boxes.push(Bounds::EVERYTHING);
        let near = |(i, j): &(usize, usize)| boxes[*i].near(&boxes[*j], 0.15);
        let all = (0..201).flat_map(|i| (i + 1..201).map(move |j| (i, j))).filter(near);
        assert_eq!(pairs(&boxes, 0.15), all.collect::<Vec<_>>());
    }
}
