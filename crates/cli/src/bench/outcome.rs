//! What came out, before it is written.

use std::fs;

use core_affinity::CoreId;
use tangency::{Scene, default_solver, load_scene};
use tangency_bench::batch::{self, Throughput, batched_scenes};
use tangency_bench::check::Check;
use tangency_bench::engine::{Engine, Refusal};
use tangency_bench::gradients::{Study, all_over_one, study};
use tangency_bench::growth::{Curve, families, grow};
use tangency_bench::lean::checks;
use tangency_bench::own::Tangency;
use tangency_bench::paths::Paths;
use tangency_bench::precision::{Case, Front, cases, sweep};
use tangency_bench::race::{Entry, heats, race};
use tangency_bench::recorded::{Score, compare, hard, problems, spread};
use tangency_bench::scenes::race_scenes;

use super::Part;
use super::engines::{all, fitting, modes, own, peers};
use super::plan::{Plan, candidates, pools};
use super::row::Row;
use super::weigh::{self, Weight};
use crate::{Console, Failure};

/// Everything that was measured.
#[derive(Default)]
pub(super) struct Outcome {
    pub(super) race: Vec<Row>,
    pub(super) paths: Vec<PathRow>,
    pub(super) precision: Vec<(Case, Vec<Front>)>,
    pub(super) growth: Vec<(&'static str, Vec<Curve>)>,
    pub(super) solvers: Vec<SolverRow>,
    pub(super) lean: Vec<Check>,
    pub(super) gradients: Vec<Study>,
    /// That a gradient costs the same by one number and by many.
    pub(super) all_over_one: Option<Check>,
    pub(super) batch: Vec<Throughput>,
    /// Memory of the tapes of the race's scenes, bytes, by scene.
    pub(super) tapes: Vec<(String, f64)>,
    /// Memory of a chain of [`MANY`] links in motion, bytes.
    pub(super) large_scene: Option<f64>,
    /// Our first engine.
    pub(super) own: String,
    /// Names of the engines and their settings.
    pub(super) settings: Vec<(String, String)>,
}

/// Which ways the steps of a scene took.
pub(super) struct PathRow {
    pub(super) engine: String,
    pub(super) scene: String,
    pub(super) dt: f64,
    pub(super) paths: Paths,
}

/// A solver at the recorded problems of a scene.
pub(super) struct SolverRow {
    /// The scene, or which of all problems.
    pub(super) scene: String,
    pub(super) problems: usize,
    /// Rows per problem.
    pub(super) rows: f64,
    pub(super) solver: &'static str,
    pub(super) tolerance: f64,
    pub(super) score: Score,
}

impl Outcome {
    /// Measures the parts of a plan.
    pub(super) fn measure(
        plan: &Plan,
        cores: &[CoreId],
        console: &Console,
    ) -> Result<Self, Failure> {
        let mut outcome = Self::default();
        let own = own();
        let others = peers(false);
        let modes = modes();
        let described =
            all(&own, &others).into_iter().chain(modes.iter().map(|e| e as &dyn Engine));
        outcome.settings = described.map(|engine| (engine.name(), engine.settings())).collect();
        outcome.own = own.first().map(Engine::name).unwrap_or_default();
        if plan.has(Part::Race) {
            outcome.race(plan, &own, console);
        }
        if plan.has(Part::Precision) {
            outcome.precision(plan, &own, &modes, console);
        }
        if plan.has(Part::Growth) {
            outcome.growth(plan, &own, console);
        }
        if plan.has(Part::Solvers) {
            outcome.solvers(plan, console)?;
        }
        if plan.has(Part::Lean)
            && let Some(engine) = own.first()
        {
            outcome.lean = checks(engine, &plan.patience).map_err(in_part("lean"))?;
        }
        if plan.has(Part::Gradients) {
            outcome.gradients(plan, &own, console).map_err(in_part("gradients"))?;
        }
        if plan.has(Part::Batch) {
            outcome.batch(plan, cores, console)?;
        }
        Ok(outcome)
    }

    fn gradients(
        &mut self,
        plan: &Plan,
        own: &[Tangency],
        console: &Console,
    ) -> Result<(), Refusal> {
        let progress = console.progress(own.len() + 1, "gradients");
        for engine in own {
            self.gradients.extend(study(engine, plan.differences)?);
            progress.inc(1);
        }
        for def in race_scenes() {
            let tape = weigh::in_own_process(Weight::Tape, &def.name);
            self.tapes.extend(tape.map(|bytes| (def.name, bytes)));
        }
        if let Some(engine) = own.first() {
            self.all_over_one = Some(all_over_one(engine, &plan.patience)?);
        }
        progress.finish_and_clear();
        Ok(())
    }

    fn batch(&mut self, plan: &Plan, cores: &[CoreId], console: &Console) -> Result<(), Failure> {
        let (pools, solver) = (pools(cores)?, default_solver().into());
        let progress = console.progress(3 * plan.environments.len(), "batches");
        for def in batched_scenes() {
            for environments in plan.environments {
                let rows = batch::measure(&def, &solver, *environments, &pools, &plan.patience);
                self.batch.extend(rows.map_err(in_part("batch"))?);
                progress.inc(1);
            }
        }
        progress.finish_and_clear();
        Ok(())
    }

    /// Memory of a scene's tape, bytes.
    pub(super) fn tape(&self, scene: &str) -> Option<f64> {
        self.tapes.iter().find(|(name, _)| name == scene).map(|(_, bytes)| *bytes)
    }

    /// A solver's time over that of the native one, which comes first, at the same tolerance.
    pub(super) fn over_native(&self, row: &SolverRow) -> Option<f64> {
        let same =
            |other: &&SolverRow| other.scene == row.scene && other.tolerance == row.tolerance;
        let native = self.solvers.iter().find(same)?;
        Some(row.score.time.least / native.score.time.least)
    }

    /// Other processes' rows, each below those of its scene.
    pub(super) fn add_guests(&mut self, guests: Vec<Row>) {
        for guest in guests {
            let same = |row: &Row| row.scene == guest.scene && row.dt == guest.dt;
            let place = self.race.iter().rposition(same).map_or(self.race.len(), |last| last + 1);
            self.race.insert(place, guest);
        }
    }

    fn race(&mut self, plan: &Plan, own: &[Tangency], console: &Console) {
        let others = peers(false);
        let heats = heats(plan.longest_chain, plan.most_rows);
        let progress = console.progress(heats.len(), "race");
        let mut entries: Vec<Entry> = Vec::new();
        for heat in &heats {
            let engines = fitting(own, &others, &heat.def);
            entries.extend(race(heat, &engines, &plan.patience, &entries));
            progress.inc(1);
        }
        progress.finish_and_clear();
        for entry in &entries {
            if let Ok(done) = &entry.result
                && let Some(paths) = done.paths
            {
                let (engine, scene) = (entry.engine.clone(), entry.heat.clone());
                self.paths.push(PathRow { engine, scene, dt: entry.dt, paths });
            }
        }
        self.race = entries.iter().map(Row::from).collect();
    }

    fn precision(&mut self, plan: &Plan, own: &[Tangency], modes: &[Tangency], console: &Console) {
        let others = peers(true);
        let cases = cases(plan.base);
        let progress = console.progress(cases.len(), "time against error");
        for case in cases {
            let engines = fitting(own.iter().chain(modes), &others, &case.def);
            let fronts = sweep(&case, &engines, plan.halvings, &plan.sweep);
            self.precision.push((case, fronts));
            progress.inc(1);
        }
        progress.finish_and_clear();
    }

    fn growth(&mut self, plan: &Plan, own: &[Tangency], console: &Console) {
        let others = peers(true);
        let families = families(plan.longest_chain, plan.most_rows);
        let progress = console.progress(families.len(), "growth");
        for family in &families {
            let Some((_, first)) = family.members.first() else { continue };
            let engines = fitting(own, &others, first);
            // phyz has points in the race; its steps among many contacts cannot be cut short.
            let engines =
                engines.into_iter().filter(|e| family.name == "chain" || e.name() != "phyz");
            let curves = engines.map(|engine| grow(family, engine, &plan.growth)).collect();
            self.growth.push((family.name, curves));
            progress.inc(1);
        }
        progress.finish_and_clear();
        if plan.longest_chain >= MANY {
            self.large_scene = weigh::in_own_process(Weight::World, &format!("chain of {MANY}"));
        }
    }

    fn solvers(&mut self, plan: &Plan, console: &Console) -> Result<(), Failure> {
        let (scenes, candidates, solver) = (shipped(plan)?, candidates(), default_solver());
        let progress = console.progress(scenes.len() + 2, "solvers");
        let (mut everything, mut difficult) = (Vec::new(), Vec::new());
        let mut measure = |scene: String, problems: &[_]| {
            progress.inc(1);
            if problems.is_empty() {
                return;
            }
            let rows: usize = problems.iter().map(|p: &tangency::lcp::Lcp| p.rows.len()).sum();
            for (candidate, score) in
                candidates.iter().zip(compare(problems, &candidates, &plan.patience))
            {
                self.solvers.push(SolverRow {
                    scene: scene.clone(),
                    problems: problems.len(),
                    rows: rows as f64 / problems.len() as f64,
                    solver: candidate.name,
                    tolerance: candidate.tolerance,
                    score,
                });
            }
        };
        let (steps, most) = plan.recorded;
        for (name, scene) in scenes {
            let recorded = problems(&scene, &*solver, steps);
            difficult.extend(spread(hard(&recorded, &*solver), most));
            let recorded = spread(recorded, most);
            measure(name, &recorded);
            everything.extend(recorded);
        }
        measure(ALL.into(), &everything);
        measure(HARD.into(), &difficult);
        progress.finish_and_clear();
        Ok(())
    }
}

/// All recorded problems together.
pub(super) const ALL: &str = "all scenes";
/// Those of them whose modes are not found at the free velocities.
pub(super) const HARD: &str = "all that need the interior point";

/// Links of the chain whose memory is told.
pub(super) const MANY: usize = 10_000;

fn in_part(part: &'static str) -> impl Fn(Refusal) -> Failure {
    move |source| Failure::Bench { part, source }
}

/// The scene files of the folder, by name.
fn shipped(plan: &Plan) -> Result<Vec<(String, Scene)>, Failure> {
    let folder = &plan.scenes;
    let unreadable = |source| Failure::Read { file: folder.clone(), source };
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        if file.extension().is_some_and(|extension| extension == "toml") {
            files.push(file);
        }
    }
    files.sort();
    let load = |file: &std::path::PathBuf| {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok((name, load_scene(file)?))
    };
    files.iter().map(load).collect()
}
