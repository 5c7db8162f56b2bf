//! A number that was found, and what it should be.

/// A number, and what it should be.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What is counted or compared.
    pub what: String,
    /// What was found; `None` if it was not measured.
    pub found: Option<f64>,
    /// How that should be to the goal.
    pub relation: Relation,
    /// The goal.
    pub goal: f64,
}

/// How a number should be to its goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// Equal: a count.
    Equal,
    /// Not above it.
    AtMost,
    /// Not below it.
    AtLeast,
}

impl Check {
    /// A count that must be equal.
    #[must_use]
    pub fn exactly(what: &str, found: usize, goal: usize) -> Self {
        let (what, found, goal) = (what.into(), Some(found as f64), goal as f64);
        Self { what, found, relation: Relation::Equal, goal }
    }

    /// A number that should not be above its goal.
    #[must_use]
    pub fn at_most(what: impl Into<String>, found: impl Into<Option<f64>>, goal: f64) -> Self {
        Self { what: what.into(), found: found.into(), relation: Relation::AtMost, goal }
    }

    /// A number that should not be below its goal.
    #[must_use]
    pub fn at_least(what: impl Into<String>, found: impl Into<Option<f64>>, goal: f64) -> Self {
        Self { what: what.into(), found: found.into(), relation: Relation::AtLeast, goal }
    }

    /// Whether the goal is met; `None` if nothing was measured.
    #[must_use]
    pub fn holds(&self) -> Option<bool> {
        let Self { found, relation, goal, .. } = self;
        found.map(|found| match relation {
            Relation::Equal => found == *goal,
            Relation::AtMost => found <= *goal,
            Relation::AtLeast => found >= *goal,
        })
    }
}

impl Relation {
    /// Its sign.
    #[must_use]
    pub fn sign(self) -> char {
        match self {
            Self::Equal => '=',
            Self::AtMost => '≤',
            Self::AtLeast => '≥',
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Check;

    #[test]
    fn goals_are_met_or_missed_or_not_measured() {
        assert_eq!(Check::exactly("rows", 2, 2).holds(), Some(true));
        assert_eq!(Check::exactly("rows", 3, 2).holds(), Some(false));
        for (found, most, least) in [(1.0, true, false), (2.0, true, true), (3.0, false, true)] {
            assert_eq!(Check::at_most("", found, 2.0).holds(), Some(most));
            assert_eq!(Check::at_least("", found, 2.0).holds(), Some(least));
        }
        assert_eq!(Check::at_most("", f64::NAN, 2.0).holds(), Some(false));
        assert_eq!(Check::at_least("", None, 2.0).holds(), None);
    }
}
