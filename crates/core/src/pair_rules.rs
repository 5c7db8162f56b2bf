//! What pairs of bodies do differently from others.

use crate::model::{Joint, Pair};

/// Exceptions by body, found without search for bodies that have none.
#[derive(Clone, Debug, Default)]
pub(crate) struct PairRules {
    /// Where the rules of each body begin, and where the last one's end.
    starts: Vec<u32>,
    /// In the order of their bodies, lower index first.
    rules: Vec<PairRule>,
}

/// What one pair does differently.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairRule {
    /// Lower index first.
    bodies: [usize; 2],
    /// Whether a joint keeps them from colliding.
    jointed: bool,
    /// Whether they collide, if that is said.
    pub(crate) collide: Option<bool>,
    /// Friction coefficient, if one is given.
    pub(crate) friction: Option<f64>,
    /// Restitution, if one is given.
    pub(crate) restitution: Option<f64>,
}

impl PairRules {
    /// The rules of `n` bodies: the given ones, and joints whose bodies do not collide.
    pub(crate) fn new(n: usize, pairs: &[Pair], jointed: &[&Joint]) -> Self {
        let silent = |bodies| PairRule {
            bodies,
            jointed: false,
            collide: None,
            friction: None,
            restitution: None,
        };
        let of_joint = |joint: &&Joint| match joint.bodies {
            [Some(a), Some(b)] => Some(PairRule { jointed: true, ..silent([a.min(b), a.max(b)]) }),
            _ => None,
        };
        let of_pair = |p: &Pair| {
            let Pair { bodies, collide, friction, restitution } = *p;
            PairRule { collide, friction, restitution, ..silent(bodies) }
        };
        let joints = jointed.iter().filter_map(of_joint);
        let mut rules: Vec<PairRule> = pairs.iter().map(of_pair).chain(joints).collect();
        rules.sort_by_key(|rule| rule.bodies);
        // A joint's rule is behind the pair's own.
        rules.dedup_by(|later, first| {
            let same = later.bodies == first.bodies;
            first.jointed |= same && later.jointed;
            same
        });
        let start = |i| rules.partition_point(|rule| rule.bodies[0] < i);
        let number = |k: usize| u32::try_from(k).expect("fewer rules than u32 counts");
        Self { starts: (0..=n).map(|i| number(start(i))).collect(), rules }
    }

    /// The rule of two bodies.
    pub(crate) fn of(&self, a: usize, b: usize) -> Option<&PairRule> {
        let bodies = [a.min(b), a.max(b)];
        let [start, end] = [bodies[0], bodies[0] + 1].map(|i| self.starts[i] as usize);
        if start == end {
            return None;
        }
        let rules = &self.rules[start..end];
        rules.binary_search_by_key(&bodies, |rule| rule.bodies).ok().map(|k| &rules[k])
    }
}

impl PairRule {
    /// Whether the pair may touch; `None` where its categories decide.
    pub(crate) fn collides(&self) -> Option<bool> {
        self.collide.or(self.jointed.then_some(false))
    }
}
