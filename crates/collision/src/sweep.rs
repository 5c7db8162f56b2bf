//! Boxes that overlap, by sorting along one axis within strips across the other.
//!
//! ```text
//!  strip 2  ───[ c  ]──────────────     Sorted by their lower ends along the wider axis, a box meets
//!  strip 1  ─[ a ]─┼──[ b ]────────     only those that begin before it ends. Strips as high as an
//!  strip 0  ─[ d   ]──[ e ]────────     average box keep those few; a box is in all strips it touches,
//!                                       a pair belongs to the first strip that both are in.
//! ```
//!
//! The order of the last call is where the next sort begins: cheap where little moved, and without any
//! effect on what is found.

use nalgebra::Vector2;

use crate::bounds::Bounds;

/// Boxes to a strip, at least.
const CROWD: usize = 4;

/// Exchanges for each box after which sorting by insertion is given up.
const PATIENCE: usize = 8;

/// Memory of the sweep.
#[derive(Debug, Default)]
pub(crate) struct Sweep {
    /// Numbers of the boxes by their lower ends.
    order: Vec<u32>,
    /// Lower end of each box.
    lower: Vec<f64>,
    /// Where each strip's entries begin, and where the last one's end.
    starts: Vec<usize>,
    entries: Vec<Entry>,
}

/// A box in a strip.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// Ends along the sorted axis, m.
    along: [f64; 2],
    /// Ends across it, m.
    across: [f64; 2],
    /// The first and last strip that it is in.
    strips: [u32; 2],
    number: u32,
}

impl Sweep {
    /// Calls `found` with each pair of numbers of boxes that overlap, lower number first, in no
    /// particular order.
    pub(crate) fn overlaps(&mut self, boxes: &[Bounds], mut found: impl FnMut(usize, usize)) {
        let all = boxes.iter().copied().fold(Bounds::EMPTY, Bounds::joined);
        let extent = all.max - all.min;
        let axis = usize::from(extent.y > extent.x);
        self.sort(boxes, axis);
        let strips = Strips::new(boxes, 1 - axis, &all);
        self.fill(boxes, axis, &strips);
        for strip in 0..strips.count {
            let entries = &self.entries[self.starts[strip]..self.starts[strip + 1]];
            for (k, e) in entries.iter().enumerate() {
                let begins_in_it = |f: &&Entry| f.along[0] <= e.along[1];
                for f in entries[k + 1..].iter().take_while(begins_in_it) {
                    if e.meets(f) && e.strips[0].max(f.strips[0]) as usize == strip {
                        found(e.number.min(f.number) as usize, e.number.max(f.number) as usize);
                    }
                }
            }
        }
    }

    /// Orders the boxes by their lower ends, equal ones by their numbers.
    fn sort(&mut self, boxes: &[Bounds], axis: usize) {
        self.lower.clear();
        self.lower.extend(boxes.iter().map(|b| b.min[axis]));
        if self.order.len() != boxes.len() {
            self.order.clear();
            self.order.extend((0..).take(boxes.len()));
        }
        let lower = &self.lower;
        let key = |i: u32| (lower[i as usize], i);
        let before = |i: u32, j: u32| key(i) < key(j);
        let mut patience = PATIENCE * boxes.len();
        for k in 1..self.order.len() {
            let mut at = k;
            while at > 0 && before(self.order[at], self.order[at - 1]) && patience > 0 {
                self.order.swap(at, at - 1);
                (at, patience) = (at - 1, patience - 1);
            }
        }
        if patience == 0 {
            let by_key =
                |i: &u32, j: &u32| lower[*i as usize].total_cmp(&lower[*j as usize]).then(i.cmp(j));
            self.order.sort_unstable_by(by_key);
        }
    }

    /// Puts each box into its strips, where they stay in order.
    fn fill(&mut self, boxes: &[Bounds], axis: usize, strips: &Strips) {
        let of = |number: u32| strips.of(&boxes[number as usize]);
        self.starts.clear();
        self.starts.resize(strips.count + 1, 0);
        for number in &self.order {
            let [first, last] = of(*number);
            self.starts[first + 1..=last + 1].iter_mut().for_each(|count| *count += 1);
        }
        let mut total = 0;
        for start in &mut self.starts {
            total += *start;
            *start = total;
        }
        self.entries.clear();
        self.entries.resize(total, Entry::default());
        for number in &self.order {
            let [first, last] = of(*number);
            let entry = Entry::new(*number, &boxes[*number as usize], axis, [first, last]);
            for start in &mut self.starts[first..=last] {
                self.entries[*start] = entry;
                *start += 1;
            }
        }
        // Every start has moved to the next strip's.
        self.starts.rotate_right(1);
        self.starts[0] = 0;
    }
}

impl Entry {
    fn new(number: u32, bounds: &Bounds, axis: usize, strips: [usize; 2]) -> Self {
        let along = [bounds.min[axis], bounds.max[axis]];
        let across = [bounds.min[1 - axis], bounds.max[1 - axis]];
        let strip = |k: usize| u32::try_from(k).expect("fewer strips than boxes");
        Self { along, across, strips: strips.map(strip), number }
    }

    fn meets(&self, other: &Self) -> bool {
        self.across[0] <= other.across[1] && other.across[0] <= self.across[1]
    }
}

/// How the plane is cut.
struct Strips {
    axis: usize,
    count: usize,
    /// Where the first strip begins, m.
    start: f64,
    /// Strips to a metre.
    density: f64,
}

impl Strips {
    fn new(boxes: &[Bounds], axis: usize, all: &Bounds) -> Self {
        let extent = (all.max - all.min)[axis];
        let heights = boxes.iter().map(|b| b.max - b.min).fold(Vector2::zeros(), |s, h| s + h);
        let average = heights[axis] / boxes.len() as f64;
        let most = (boxes.len() / CROWD).max(1);
        let wanted = extent / average;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let count = if wanted.is_finite() { (wanted as usize).clamp(1, most) } else { 1 };
        let density = if count > 1 { count as f64 / extent } else { 0.0 };
        Self { axis, count, start: all.min[axis], density }
    }

    /// The first and last strip that a box is in.
    fn of(&self, bounds: &Bounds) -> [usize; 2] {
        [bounds.min[self.axis], bounds.max[self.axis]].map(|x| self.at(x))
    }

    fn at(&self, x: f64) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates")]
        let strip = ((x - self.start) * self.density) as usize;
        strip.min(self.count - 1)
    }
}
