//! How far bodies can get within a step, group by group.
//!
//! With s = max(|v⁻|, |p/m|) the speed of a body before and after what drives it, ω likewise, R its
//! radius and k its radius of gyration, the body's own bounds are
//!
//! ```text
//!  x = 2 dt (s + ω R)    m           α = 2 dt (ω + s/k)    rad
//! ```
//!
//! A collision may pass speed on to whatever it reaches, even doubled, hence the factor 2. So bodies
//! form groups, and the greatest x and α of a group hold for all its members. Two dynamic bodies are
//! in one group if a joint connects them, or a contact whose gap is at most the greater of the two
//! groups' x. A kinematic body that a joint connects to a group, or that is so near, lends it its own
//! x and α, but connects nothing. These are the smallest groups of which that is true: they grow
//! until nothing is in reach any more that is not in them. A fast body far away widens nobody's reach.

use nalgebra::Vector3;

use crate::model::Joint;
use crate::scene::Scene;

/// How far anything can move towards anything else within one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Reach {
    /// m.
    pub(crate) linear: f64,
    /// rad.
    pub(crate) angular: f64,
}

impl Reach {
    /// By a body's own motion.
    fn own(scene: &Scene, body: usize, v: &Vector3<f64>, momentum: &Vector3<f64>) -> Self {
        let fixed = scene.fixed[body];
        let mass = &scene.bodies[body].mass;
        let free = if fixed { *v } else { momentum.component_div(mass) };
        let radius = Some(scene.colliders[body].radius()).filter(|r| r.is_finite()).unwrap_or(0.0);
        let speed = v.xy().norm_squared().max(free.xy().norm_squared()).sqrt();
        let rate = v.z.abs().max(free.z.abs());
        let linear = 2.0 * scene.dt * (speed + rate * radius);
        if !scene.joined.limited {
            return Self { linear, angular: 0.0 };
        }
        let gyration = if fixed { scene.size(body) } else { (mass.z / mass.x).sqrt() };
        Self { linear, angular: 2.0 * scene.dt * (rate + speed / gyration) }
    }

    fn joined(self, other: Self) -> Self {
        let (linear, angular) = (self.linear.max(other.linear), self.angular.max(other.angular));
        Self { linear, angular }
    }
}

/// Bodies that joints connect; constant.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointGroups {
    /// A member of each body's group, the same for all of them.
    root: Vec<u32>,
    /// Dynamic bodies and the other bodies that joints connect them to.
    driven: Vec<[u32; 2]>,
    /// Whether any joint has limits, for which alone angles count.
    pub(crate) limited: bool,
}

impl JointGroups {
    /// Of bodies of which some are fixed (not dynamic).
    pub(crate) fn new(joints: &[Joint], fixed: &[bool]) -> Self {
        let all = 0..number(fixed.len());
        let reach = vec![Reach::default(); fixed.len()];
        let mut groups = Groups { own: Vec::new(), root: all.clone().collect(), reach };
        let mut driven = Vec::new();
        for joint in joints {
            if let [Some(a), Some(b)] = joint.bodies {
                match (fixed[a], fixed[b]) {
                    (false, false) => groups.unite(number(a), number(b)),
                    (false, true) => driven.push([a, b].map(number)),
                    (true, false) => driven.push([b, a].map(number)),
                    (true, true) => {}
                }
            }
        }
        let limited = |j: &Joint| j.limits.lower.is_some() || j.limits.upper.is_some();
        groups.flatten();
        Self { root: groups.root, driven, limited: joints.iter().any(limited) }
    }
}

/// Two bodies and a lower bound of their distance, m.
pub(crate) type Link = ([u32; 2], f64);

/// The groups of a step.
#[derive(Debug, Default)]
pub(crate) struct Groups {
    own: Vec<Reach>,
    /// A member of each body's group, nearer to the one that stands for it.
    root: Vec<u32>,
    /// Of the bodies that stand for their groups.
    reach: Vec<Reach>,
}

impl Groups {
    /// Sets out from the bodies' own motion. `momentum` is p, before any impulse.
    pub(crate) fn measure(&mut self, scene: &Scene, v: &[Vector3<f64>], momentum: &[Vector3<f64>]) {
        let own = |i| Reach::own(scene, i, &v[i], &momentum[i]);
        self.own.clear();
        self.own.extend((0..v.len()).map(own));
        self.restart(scene);
    }

    /// Forgets all links but the joints.
    pub(crate) fn restart(&mut self, scene: &Scene) {
        self.root.clone_from(&scene.joined.root);
        self.reach.clone_from(&self.own);
        for body in 0..self.root.len() {
            let root = self.root[body] as usize;
            self.reach[root] = self.reach[root].joined(self.own[body]);
        }
        for [body, driver] in &scene.joined.driven {
            self.lend(*driver, *body);
        }
    }

    /// Links bodies until none is left that is in reach of another group; with a contact `distance`
    /// (m) until none is left within that.
    ///
    /// How far speed gets in one pass depends on the order of the links, so passes alternate between
    /// both directions.
    pub(crate) fn grow(
        &mut self,
        fixed: &[bool],
        links: &(impl DoubleEndedIterator<Item = Link> + Clone),
        distance: Option<f64>,
    ) {
        let mut add = |link: Link| self.add(fixed, link, distance);
        while links.clone().fold(false, |widened, link| add(link) | widened)
            && links.clone().rev().fold(false, |widened, link| add(link) | widened)
        {}
        self.flatten();
    }

    /// The greatest x and α of a body's group.
    pub(crate) fn of(&self, body: usize) -> Reach {
        self.reach[self.root[body] as usize]
    }

    /// The greatest x and α that a joint's bodies have.
    pub(crate) fn of_joint(&self, bodies: [Option<usize>; 2]) -> Reach {
        let reaches = bodies.iter().flatten().map(|body| self.of(*body));
        reaches.fold(Reach::default(), Reach::joined)
    }

    /// How far two bodies may be apart and still meet, m.
    pub(crate) fn of_pair(&self, bodies: [u32; 2]) -> f64 {
        let [a, b] = bodies.map(|body| self.of(body as usize).linear);
        a.max(b)
    }

    /// The greatest x of all bodies, m.
    pub(crate) fn greatest(&self) -> f64 {
        self.own.iter().map(|own| own.linear).fold(0.0, f64::max)
    }

    /// Links two bodies if they are in reach; whether that widens the reach of any.
    fn add(&mut self, fixed: &[bool], ([a, b], apart): Link, distance: Option<f64>) -> bool {
        let roots = [self.find(a), self.find(b)];
        if roots[0] == roots[1] {
            return false;
        }
        let [one, two] = roots.map(|root| self.reach[root as usize]);
        if apart > distance.unwrap_or(one.linear.max(two.linear)) {
            return false;
        }
        match (fixed[a as usize], fixed[b as usize]) {
            (false, false) => {
                self.unite(a, b);
                one != two
            }
            (false, true) => self.lend(b, a),
            (true, false) => self.lend(a, b),
            (true, true) => false,
        }
    }

    /// A driver's own reach to the group of a body; whether that widens it.
    fn lend(&mut self, driver: u32, body: u32) -> bool {
        let (root, own) = (self.find(body) as usize, self.own[driver as usize]);
        let before = self.reach[root];
        self.reach[root] = before.joined(own);
        self.reach[root] != before
    }

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        let (low, high) = (a.min(b), a.max(b));
        self.root[high as usize] = low;
        self.reach[low as usize] = self.reach[low as usize].joined(self.reach[high as usize]);
    }

    /// Lets every body name the lowest of its group, which is never above it.
    fn flatten(&mut self) {
        for body in 0..self.root.len() {
            self.root[body] = self.root[self.root[body] as usize];
        }
    }

    fn find(&mut self, mut i: u32) -> u32 {
        while self.root[i as usize] != i {
            self.root[i as usize] = self.root[self.root[i as usize] as usize];
            i = self.root[i as usize];
        }
        i
    }
}

/// Scenes have fewer bodies than u32 counts.
fn number(body: usize) -> u32 {
    u32::try_from(body).expect("fewer bodies than u32 counts")
}
