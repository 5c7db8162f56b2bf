//! Broad phase: which bodies are near each other at all.

use crate::world::Bounds;

/// Pairs i < j of boxes within `reach` of each other, in ascending order.
///
/// Sort and sweep along the axis on which the boxes spread further (Baraff 1992). A tree pays only
/// for many more bodies than a planar scene has, and would have to be kept between queries.
pub(crate) fn pairs(boxes: &[Bounds], reach: f64) -> Vec<(usize, usize)> {
    let axis = usize::from(spread(boxes, 1) > spread(boxes, 0));
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&i, &j| boxes[i].min[axis].total_cmp(&boxes[j].min[axis]).then(i.cmp(&j)));
    let mut pairs = Vec::new();
    for (k, &i) in order.iter().enumerate() {
        let end = boxes[i].max[axis];
        let later = order[k + 1..].iter().take_while(|&&j| boxes[j].min[axis] - end <= reach);
        let near = later.filter(|&&j| boxes[i].near(&boxes[j], reach));
        pairs.extend(near.map(|&j| (i.min(j), i.max(j))));
    }
    pairs.sort_unstable();
    pairs
}

/// Distance between the outermost lower ends of the finite boxes along one axis, m.
fn spread(boxes: &[Bounds], axis: usize) -> f64 {
    let ends = boxes.iter().map(|b| b.min[axis]).filter(|x| x.is_finite());
    ends.clone().fold(f64::NEG_INFINITY, f64::max) - ends.fold(f64::INFINITY, f64::min)
}
