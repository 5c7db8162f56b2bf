//! Wall time, taken so that engines can be compared on a machine with other things to do.
//!
//! What is compared takes turns, round by round, so that a slow minute hits all alike; a sample
//! repeats short work until it lasts; quartiles of the rounds are reported, and the least.

use std::time::{Duration, Instant};

/// Times of the same work in several rounds, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quartiles {
    /// The least.
    pub least: f64,
    /// A quarter of the rounds took less.
    pub lower: f64,
    /// Half of them did.
    pub median: f64,
    /// Three quarters did.
    pub upper: f64,
    /// Number of rounds.
    pub rounds: usize,
}

impl Quartiles {
    /// Of some times; all NaN where there are none.
    #[must_use]
    pub fn of(mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let at = |quarter: usize| {
            let last = times.len().saturating_sub(1);
            // Outwards, where a quarter falls between two rounds.
            let place = if quarter < 2 { last * quarter / 4 } else { (last * quarter).div_ceil(4) };
            times.get(place).copied().unwrap_or(f64::NAN)
        };
        Self { least: at(0), lower: at(1), median: at(2), upper: at(3), rounds: times.len() }
    }

    /// All times multiplied by a factor.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let [least, lower, median, upper] =
            [self.least, self.lower, self.median, self.upper].map(|time| factor * time);
        Self { least, lower, median, upper, rounds: self.rounds }
    }
}

/// How long to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patience {
    /// Rounds in which the candidates take turns.
    pub rounds: usize,
    /// Shortest sample; shorter work is repeated.
    pub sample: Duration,
    /// Longest single run; longer ones are cut short, or left out.
    pub cap: Duration,
}

/// One candidate's work: returns the time of the part that counts.
pub type Work<'a, E> = Box<dyn FnMut() -> Result<Duration, E> + 'a>;

/// Times candidates in turns. A candidate that fails is left out of later rounds; its error comes back.
#[must_use]
pub fn interleaved<E>(
    mut candidates: Vec<Work<'_, E>>,
    patience: &Patience,
) -> Vec<Result<Quartiles, E>> {
    let mut times: Vec<Result<Vec<f64>, E>> = candidates.iter().map(|_| Ok(Vec::new())).collect();
    for _ in 0..patience.rounds {
        for (work, times) in candidates.iter_mut().zip(&mut times) {
            let Ok(so_far) = times else { continue };
            match sample(work, patience.sample) {
                Ok(seconds) => so_far.push(seconds),
                Err(error) => *times = Err(error),
            }
        }
    }
    times.into_iter().map(|times| times.map(Quartiles::of)).collect()
}

/// The mean time of work that is repeated until it has lasted, s.
fn sample<E>(work: &mut Work<'_, E>, least: Duration) -> Result<f64, E> {
    let (mut total, mut repeats) = (Duration::ZERO, 0_u32);
    while repeats == 0 || total < least {
        total += work()?;
        repeats += 1;
    }
    Ok(total.as_secs_f64() / f64::from(repeats))
}

/// The time that something takes, and what it returns.
pub fn timed<T>(work: impl FnOnce() -> T) -> (Duration, T) {
    let start = Instant::now();
    let result = work();
    (start.elapsed(), result)
}

#[cfg(test)]
mod tests {
    use super::Quartiles;

    #[test]
    fn quartiles_of_five() {
        let found = Quartiles::of(vec![5.0, 1.0, 4.0, 2.0, 3.0]);
        let expected = Quartiles { least: 1.0, lower: 2.0, median: 3.0, upper: 4.0, rounds: 5 };
        assert_eq!(found, expected);
    }
}
