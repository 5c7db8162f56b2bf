//! One measured quantity beside the number that it should be.

/// What must reach a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grade {
    /// Plain fixed stepping.
    Step,
    /// The stepping that is recommended for accuracy.
    Fine,
    /// A derivative through an impact, which needs the time of impact located.
    Impact,
}

/// How a quantity is compared with what is expected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Relation {
    /// |got − expected| ≤ tolerance.
    Near,
    /// got ≥ expected.
    AtLeast,
    /// got ≤ expected.
    AtMost,
}

/// What came of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within its tolerance.
    Passed,
    /// Outside its tolerance.
    Failed,
    /// Outside its tolerance, and of a grade that the engine does not promise yet.
    NotReached,
    /// The backend said that the problem is not of the class that it solves.
    Refused,
}

/// One measured quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The case, as in `V05`.
    pub case: &'static str,
    /// What was measured, with its parameters.
    pub quantity: String,
    /// What must reach it.
    pub grade: Grade,
    /// How it is compared.
    pub relation: Relation,
    /// The number from outside the engine.
    pub expected: f64,
    /// The engine's number.
    pub got: f64,
    /// Distance from what is expected; 0 where an inequality holds.
    pub error: f64,
    /// Greatest distance that passes.
    pub tolerance: f64,
    /// What came of it.
    pub verdict: Verdict,
    /// Why there is no number, where there is none.
    pub note: String,
}

impl Figure {
    /// Judges a number.
    #[must_use]
    pub fn new(
        case: &'static str,
        quantity: String,
        grade: Grade,
        relation: Relation,
        [got, expected, tolerance]: [f64; 3],
    ) -> Self {
        let error = match relation {
            Relation::AtLeast if got >= expected => 0.0,
            Relation::AtMost if got <= expected => 0.0,
            Relation::Near | Relation::AtLeast | Relation::AtMost => (got - expected).abs(),
        };
        let verdict = match grade {
            _ if error <= tolerance => Verdict::Passed, // NaN does not
            Grade::Step => Verdict::Failed,
            Grade::Fine | Grade::Impact => Verdict::NotReached,
        };
        let note = String::new();
        Self { case, quantity, grade, relation, expected, got, error, tolerance, verdict, note }
    }

    /// A quantity without a number.
    #[must_use]
    pub fn missing(
        case: &'static str,
        quantity: String,
        grade: Grade,
        verdict: Verdict,
        note: String,
    ) -> Self {
        let (relation, nan) = (Relation::Near, f64::NAN);
        let [expected, got, error, tolerance] = [nan; 4];
        Self { case, quantity, grade, relation, expected, got, error, tolerance, verdict, note }
    }
}
