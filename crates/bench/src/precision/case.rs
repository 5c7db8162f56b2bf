//! The cases, with what is known about them.

use tangency_core::SceneDef;

use super::Known;
use super::known::standing;
use super::motion::{G, banked, dropped, hanging, reflected, rocked, slid, swing};
use crate::scenes;

/// A scene whose motion is known.
pub struct Case {
    /// Number in the list of validation cases.
    pub id: &'static str,
    /// What happens.
    pub title: &'static str,
    /// Where the reference comes from.
    pub source: &'static str,
    /// The scene; its dt is overridden.
    pub def: SceneDef,
    /// Duration, s; a multiple of `samples`/30.
    pub duration: f64,
    /// Number of equally spaced times at which states are compared, the end included.
    pub samples: usize,
    /// Length scale, m.
    pub length: f64,
    /// Speed scale, m/s.
    pub speed: f64,
    /// Energy scale, J.
    pub energy: f64,
    /// The exact motion: all dynamic bodies at a time, s.
    pub known: Box<dyn Fn(f64) -> Vec<Known>>,
}

impl Case {
    /// Steps of a run.
    #[must_use]
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "runs are short")]
    pub fn steps(&self, dt: f64) -> usize {
        (self.duration / dt).round() as usize
    }

    fn new(id: &'static str, title: &'static str, def: SceneDef, duration: f64) -> Self {
        let known = standing(&def);
        let source = "equilibrium";
        let known = Box::new(move |_| known.clone());
        let (length, speed, energy) = (1.0, 1.0, 1.0);
        Self { id, title, source, def, duration, samples: 4, length, speed, energy, known }
    }

    fn moving(
        self,
        source: &'static str,
        [length, speed, energy]: [f64; 3],
        known: impl Fn(f64) -> Vec<Known> + 'static,
    ) -> Self {
        Self { source, length, speed, energy, known: Box::new(known), ..self }
    }
}

/// Ten cases: jointed motion, impacts, friction, standing structures. `base` is that of the pyramid.
#[must_use]
pub fn cases(base: usize) -> Vec<Case> {
    let mut all = swinging();
    all.extend(flying());
    all.extend(upright(base));
    all
}

fn swinging() -> Vec<Case> {
    const CLOSED: &str = "equation of one angle";
    let tilt = 0.160_875_277_198_321_07;
    let n = 10;
    // n cranks of inertia 1/3 about their pins, a coupler of 1 kg: (n/3 + 1) θ″ = −(n/2 + 1) g sin θ
    let k = G * (n as f64 / 2.0 + 1.0) / (n as f64 / 3.0 + 1.0);
    let width = 0.5 * (n - 1) as f64;
    let crank = move |t: f64| {
        let state = swing(k, 1.2, t);
        let ((sin, cos), rate) = (state[0].sin_cos(), state[1]);
        let coupler = Known::new(n, [0.5 * width + sin, -cos, 0.0], [cos * rate, sin * rate, 0.0]);
        (0..n).map(|i| hanging(i, [0.5 * i as f64, 0.0], state)).chain([coupler]).collect()
    };
    vec![
        Case::new("V02", "large pendulum", scenes::pendulum(2.5), 2.0).moving(
            CLOSED,
            [1.0, 3.0, 10.0],
            |t| vec![hanging(0, [0.0; 2], swing(1.5 * G, 2.5, t))],
        ),
        Case::new("V12", "parallelogram of ten cranks", scenes::parallelogram(n, 1.2), 2.0).moving(
            CLOSED,
            [1.0, 3.0, 50.0],
            crank,
        ),
        Case::new("V17", "rocking block", scenes::rocking_box(tilt), 0.8).moving(
            "equation of one angle",
            [0.6, 1.0, 3.0],
            move |t| vec![rocked(tilt, t)],
        ),
    ]
}

fn flying() -> Vec<Case> {
    const CLOSED: &str = "closed form";
    let billiard = scenes::billiard([0.3, 0.4], [1.7, 1.1]);
    let table = |t: f64| {
        let [x, vx] = reflected(0.3, 1.7, [0.05, 1.95], t);
        let [y, vy] = reflected(0.4, 1.1, [0.05, 0.95], t);
        vec![Known::new(4, [x, y, 0.0], [vx, vy, 0.0])]
    };
    let ball = |t: f64| {
        let [height, rate] = dropped(t);
        vec![Known::new(1, [0.0, 0.1 + height, 0.0], [0.0, rate, 0.0])]
    };
    let shot = Case::new("V36", "bank shot", scenes::bank_shot(), 0.6);
    vec![
        Case::new("V04", "bouncing disc", scenes::falling_disc(1.0, 0.8), 2.0).moving(
            CLOSED,
            [1.0, 4.0, 10.0],
            ball,
        ),
        Case::new("V07", "sliding to rolling", scenes::sliding_disc(), 2.0).moving(
            CLOSED,
            [1.0, 4.0, 8.0],
            |t| vec![slid(t)],
        ),
        Case::new("V10", "billiard", billiard, 10.0).moving(CLOSED, [1.0, 2.0, 2.0], table),
        Case { samples: 3, ..shot }.moving(CLOSED, [1.0, 7.0, 25.0], |t| vec![banked(t)]),
    ]
}

fn upright(base: usize) -> Vec<Case> {
    vec![
        Case::new("V19", "1000 t on 1 kg", scenes::stack(&[1.0, 1e6]), 2.0),
        Case::new("V20", "pyramid", scenes::pyramid(base), 2.0),
        Case::new("V21", "arch of seven blocks", scenes::arch(0.2, 0.35), 2.0),
    ]
}
