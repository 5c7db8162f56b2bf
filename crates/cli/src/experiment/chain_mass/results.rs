//! What came out, as numbers, tables and text.

use serde::Serialize;

use super::setup::{RECIPE, START};
use crate::gradient::relative_error;
use crate::grid::Grid;
use crate::optimise::{Iterate, Method};

/// Everything that the experiment found.
#[derive(Debug, Serialize)]
pub(super) struct Results {
    pub(super) links: usize,
    pub(super) true_mass: f64,
    pub(super) start_loss: f64,
    pub(super) start_gradient: f64,
    pub(super) start_variants: Vec<Variant>,
    /// The paper's recipe from the paper's start.
    pub(super) plain: Fit,
    /// The paper's recipe from where the original cycles.
    pub(super) plain_elsewhere: Fit,
    pub(super) better: Vec<Fit>,
    pub(super) plain_seconds: f64,
    pub(super) forward_seconds: f64,
    pub(super) reverse_seconds: f64,
    pub(super) gradient_error: f64,
    pub(super) worst_residual: f64,
    pub(super) noise: Noise,
    pub(super) link_masses: LinkMasses,
    pub(super) run_times: Vec<RunTime>,
    /// Total mass and loss.
    pub(super) landscape: Vec<(f64, f64)>,
}

/// Loss and gradient at the start when these bodies are compared.
#[derive(Debug, Serialize)]
pub(super) struct Variant {
    pub(super) compared: &'static str,
    pub(super) loss: f64,
    pub(super) gradient: f64,
}

/// A fit of the total mass.
#[derive(Debug, Serialize)]
pub(super) struct Fit {
    pub(super) method: MethodName,
    pub(super) start: f64,
    pub(super) trace: Vec<Update>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum MethodName {
    GradientDescent,
    Lbfgs,
    GaussNewton,
}

#[derive(Debug, Serialize)]
pub(super) struct Update {
    pub(super) mass: f64,
    pub(super) loss: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct Noise {
    /// Of positions and of angles (rad).
    pub(super) sigma: [f64; 2],
    pub(super) seed: u64,
    pub(super) estimates: Vec<f64>,
    pub(super) mean: f64,
    /// Standard deviation of the estimates.
    pub(super) spread: f64,
    /// What it is in theory, to first order.
    pub(super) expected_spread: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct LinkMasses {
    pub(super) true_masses: Vec<f64>,
    pub(super) found: Vec<f64>,
    pub(super) worst_relative_error: f64,
    pub(super) updates: usize,
}

/// Times of one gradient by one mass per link.
#[derive(Debug, Serialize)]
pub(super) struct RunTime {
    pub(super) links: usize,
    pub(super) forward_seconds: f64,
    /// Rollout and reverse pass.
    pub(super) analytic_seconds: f64,
    /// Two rollouts per link.
    pub(super) differences_seconds: f64,
}

impl From<Method> for MethodName {
    fn from(method: Method) -> Self {
        match method {
            Method::GradientDescent => Self::GradientDescent,
            Method::Lbfgs => Self::Lbfgs,
            Method::GaussNewton => Self::GaussNewton,
        }
    }
}

impl MethodName {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::GradientDescent => "gradient descent",
            Self::Lbfgs => "L-BFGS",
            Self::GaussNewton => "Gauss–Newton",
        }
    }
}

impl From<Iterate> for Update {
    fn from(iterate: Iterate) -> Self {
        Self { mass: iterate.values[0], loss: iterate.loss }
    }
}

impl Fit {
    /// The mass in the end.
    pub(super) fn mass(&self) -> f64 {
        self.trace[self.trace.len() - 1].mass
    }

    pub(super) fn name(&self) -> String {
        format!("{} from {}", self.method.words(), self.start)
    }
}

impl Results {
    /// The mass that the paper's recipe finds.
    pub(super) fn plain_mass(&self) -> f64 {
        self.plain.mass()
    }

    pub(super) fn json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// The figures beside what they should be.
    pub(super) fn table(&self) -> Grid {
        let mut grid = Grid::new(["figure", "value", "target"]);
        let mut row = |figure: &str, value: String, target: &str| {
            grid.row([figure.to_owned(), value, target.to_owned()]);
        };
        row("loss at the start (mass 1)", format!("{:.1}", self.start_loss), "near 9000");
        row("its gradient", format!("{:.1}", self.start_gradient), "near −4000");
        row(&self.plain.name(), format!("{:.12}", self.plain_mass()), "7");
        let elsewhere = &self.plain_elsewhere;
        row(
            &elsewhere.name(),
            format!("{:.6}", elsewhere.mass()),
            "cycles, as in the paper's code",
        );
        for fit in &self.better {
            let error = relative_error(fit.mass(), self.true_mass);
            let updates = fit.trace.len() - 1;
            let value = format!("relative error {error:.1e} after {updates} updates");
            row(&fit.name(), value, "≤ 1e-8");
        }
        row("gradient against differences", format!("{:.1e}", self.gradient_error), "≤ 1e-7");
        row("worst residual of all steps", format!("{:.1e}", self.worst_residual), "≤ 1e-10");
        let recipe = format!("the paper's {} updates", RECIPE.iterations);
        row(&recipe, format!("{:.3} s", self.plain_seconds), "≤ 1 s");
        row("rollout of 300 steps", milliseconds(self.forward_seconds), "");
        row("its reverse pass", milliseconds(self.reverse_seconds), "");
        let ratio = self.reverse_seconds / self.forward_seconds;
        row("reverse over forward", format!("{ratio:.2}"), "≤ 1.0");
        let Noise { mean, spread, expected_spread, .. } = self.noise;
        row("mass from noisy poses", format!("{mean:.4} ± {spread:.4}"), "7");
        row("spread expected", format!("{expected_spread:.4}"), "");
        let LinkMasses { worst_relative_error, updates, .. } = self.link_masses;
        let value = format!("relative error {worst_relative_error:.1e} after {updates} updates");
        row("a mass for each link, worst", value, "≤ 1e-8");
        grid
    }

    /// All of it for readers.
    pub(super) fn report(&self) -> String {
        let [sigma, sigma_angle] = self.noise.sigma;
        let estimates = self.noise.estimates.iter().map(|mass| format!("{mass:.5}"));
        let estimates = estimates.collect::<Vec<_>>().join(", ");
        format!(
            "# The mass of a chain of {} links\n\n{}\n\
             ![mass per update](mass.svg)\n\n![loss per update](loss.svg)\n\n\
             ## Start\n\nLoss and gradient at mass {START}, by what is compared:\n\n{}\n\
             ![loss over mass](landscape.svg)\n\n\
             ## Noise\n\nGaussian noise on every observed pose: σ = {sigma} on x and y (a link is \
             60 long), {sigma_angle} rad on angles. Estimates from seed {} on: {estimates}.\n\n\
             ## A mass for each link\n\n{}\n\
             ## Run time\n\nOne gradient by {} masses, one per link; differences are central, two \
             rollouts per mass, without extrapolation. Medians, one thread.\n\n{}\n\
             ![run time](runtime.svg)\n\n![film strip](filmstrip.svg)\n\n\
             The motion: [replay.html](replay.html).\n",
            self.links,
            self.table().markdown(),
            self.variants().markdown(),
            self.noise.seed,
            self.masses().markdown(),
            "n",
            self.times().markdown(),
        )
    }

    fn variants(&self) -> Grid {
        let mut grid = Grid::new(["compared", "loss", "gradient"]);
        for variant in &self.start_variants {
            let numbers = [variant.loss, variant.gradient].map(|number| format!("{number:.1}"));
            grid.row(std::iter::once(variant.compared.to_owned()).chain(numbers));
        }
        grid
    }

    fn masses(&self) -> Grid {
        let mut grid = Grid::new(["link", "true", "found"]);
        let LinkMasses { true_masses, found, .. } = &self.link_masses;
        for (link, (mass, found)) in true_masses.iter().zip(found).enumerate() {
            grid.row([link.to_string(), format!("{mass:.6}"), format!("{found:.12}")]);
        }
        grid
    }

    fn times(&self) -> Grid {
        let heading = ["links", "rollout", "gradient", "differences", "differences / gradient"];
        let mut grid = Grid::new(heading);
        for time in &self.run_times {
            let seconds = [time.forward_seconds, time.analytic_seconds, time.differences_seconds];
            let ratio = time.differences_seconds / time.analytic_seconds;
            let cells = seconds.map(milliseconds).into_iter().chain([format!("{ratio:.1}")]);
            grid.row(std::iter::once(time.links.to_string()).chain(cells));
        }
        grid
    }
}

fn milliseconds(seconds: f64) -> String {
    format!("{:.2} ms", 1e3 * seconds)
}
