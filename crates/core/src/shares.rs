//! Islands shared out over threads, where that pays.
//!
//! They are cut, in their order, into shares of about equally many rows, one for each thread of rayon's
//! pool. Each share has memory of its own, which never changes a solution: neither does the number of
//! threads.

use tangency_lcp::{Guess, LcpError, LcpSolver, Scratch};

use crate::island::Island;
use crate::record::IslandRecord;
use crate::row::RowContext;
use crate::solve::solve_island;

/// Rows that others must have to solve beside the largest island: a thread wakes up in the time that
/// about a hundred rows take.
const WORTH: usize = 256;

/// An island that is to be solved.
#[derive(Debug, Default)]
struct Task {
    island: Option<Island>,
    /// The guess of its modes, if `guessed`.
    guess: Guess,
    guessed: bool,
    answer: Option<Result<IslandRecord, (Vec<u32>, LcpError)>>,
}

/// Memory of the shares.
#[derive(Debug, Default)]
pub(crate) struct Shares {
    tasks: Vec<Task>,
    memories: Vec<Scratch>,
}

/// Whether solving the islands side by side is worth waking up threads.
pub(crate) fn pays(islands: &[Island]) -> bool {
    let rows = islands.iter().map(|island| island.sources.len());
    let [all, largest] = rows.fold([0, 0], |[all, most], rows| [all + rows, most.max(rows)]);
    all - largest >= WORTH && rayon::current_num_threads() > 1
}

impl Shares {
    /// Adds an island; `guess` writes a guess of its modes, and tells whether there is one.
    pub(crate) fn add(
        &mut self,
        at: usize,
        island: Island,
        guess: impl FnOnce(&Island, &mut Guess) -> bool,
    ) {
        if self.tasks.len() <= at {
            self.tasks.push(Task::default());
        }
        let task = &mut self.tasks[at];
        task.guessed = guess(&island, &mut task.guess);
        task.island = Some(island);
    }

    /// Solves the first `count` islands that were added; `scratch` has the memory of solutions before.
    pub(crate) fn solve(
        &mut self,
        context: &RowContext<'_>,
        solver: &dyn LcpSolver,
        count: usize,
        scratch: &mut Scratch,
    ) -> impl Iterator<Item = Result<IslandRecord, (Vec<u32>, LcpError)>> {
        self.memories.resize_with(rayon::current_num_threads().max(1), Scratch::default);
        std::mem::swap(&mut self.memories[0], scratch);
        even_out(&mut self.memories);
        let tasks = &mut self.tasks[..count];
        share_out(tasks, &mut self.memories, &|task, scratch| task.run(context, solver, scratch));
        std::mem::swap(&mut self.memories[0], scratch);
        self.tasks[..count].iter_mut().filter_map(|task| task.answer.take())
    }
}

impl Task {
    fn run(&mut self, context: &RowContext<'_>, solver: &dyn LcpSolver, scratch: &mut Scratch) {
        let guess = self.guessed.then_some(&self.guess);
        let island = self.island.take();
        self.answer = island.map(|island| solve_island(context, solver, island, guess, scratch));
    }

    fn rows(&self) -> usize {
        self.island.as_ref().map_or(0, |island| island.sources.len())
    }
}

/// Shares the memory that the first one has got back from solutions.
fn even_out(memories: &mut [Scratch]) {
    if let Some((first, others)) = memories.split_first_mut() {
        others.iter_mut().rev().for_each(|other| first.even_out(other));
    }
}

/// Runs tasks in as many shares as there are memories.
fn share_out(
    tasks: &mut [Task],
    memories: &mut [Scratch],
    run: &(impl Fn(&mut Task, &mut Scratch) + Sync),
) {
    if let [memory] = memories {
        return tasks.iter_mut().for_each(|task| run(task, memory));
    }
    let half = memories.len() / 2;
    let at = cut(tasks, half, memories.len());
    let (ours, theirs) = memories.split_at_mut(half);
    let (first, second) = tasks.split_at_mut(at);
    rayon::join(|| share_out(first, ours, run), || share_out(second, theirs, run));
}

/// How many tasks have `part` of `whole` of the rows.
fn cut(tasks: &[Task], part: usize, whole: usize) -> usize {
    let all: usize = tasks.iter().map(Task::rows).sum();
    let mut before = 0;
    let within = |task: &&Task| {
        before += task.rows();
        before * whole <= all * part
    };
    tasks.iter().take_while(within).count()
}
