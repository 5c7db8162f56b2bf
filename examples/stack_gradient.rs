//! The derivatives of a slide: ten boxes stand upon each other, and the top one slides until friction stops it.
//!
//! Asked is where it comes to rest, x = v²/(2 μ g), in steps of fixed length and in accurate ones.

#![expect(clippy::print_stdout, reason = "an example prints what it found")]

use tangency::diff::{Parameter, StateVector, gradient};
use tangency::{Scene, SceneDef, Stepping, default_solver, simulate};
use tangency_bench::scenes::race_stack;

const STEPS: usize = 200;
const TOP: usize = 10;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("                       x         dx/dv        dx/dmu");
    for (name, stepping) in
        [("fixed", Stepping::Fixed), ("accurate", Stepping::Accurate { max_events: 32 })]
    {
        let scene = Scene::new(&SceneDef { stepping, ..race_stack(10) })?;
        let run = simulate(&scene, default_solver().as_ref(), STEPS)?;
        let mut seed = StateVector::like(run.last());
        seed.q[TOP].x = 1.0;
        let found = gradient(&scene, &run, |k, _| (k == STEPS).then(|| seed.clone()))?;
        let by = |name| Parameter::parse(&scene, name).map(|it| it.gradient(&scene, &found.by));
        // The friction of a pair is √(μμ): all coefficients together change it by one.
        let (by_speed, by_friction) = (by("velocity.x:box9")?, by("friction:*")?);
        println!("{name:12} {:12.9}  {by_speed:12.9}  {by_friction:12.9}", run.last().q[TOP].x);
    }
    let (v, mu, g) = (0.5, 0.2, 9.81);
    let x = v * v / (2.0 * mu * g);
    println!("{:12} {x:12.9}  {:12.9}  {:12.9}", "closed form", 2.0 * x / v, -x / mu);
    Ok(())
}
