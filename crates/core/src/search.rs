//! The time of an event, by intervals and secants.

use crate::StepError;
use crate::record::StepRecord;

/// Parts of a step by which times differ that are the same.
const INSTANT: f64 = 1e-16;

/// Steps of a search for the time of an event, at most.
const MOST: usize = 80;

/// A search for the length of a flow at which a value is zero: positive at the start, negative at `within`.
pub(crate) struct Search {
    pub(crate) start: f64,
    pub(crate) within: f64,
}

impl Search {
    /// `look` gives the value after a length, how near to zero is zero, and the flow. Secants of an interval
    /// (Dowell & Jarratt 1971), halved where they creep. `None` if the value is not negative in the end.
    pub(crate) fn find(
        &self,
        dt: f64,
        mut look: impl FnMut(f64) -> Result<(f64, f64, StepRecord), StepError>,
    ) -> Result<Option<StepRecord>, StepError> {
        let (value, zero, flow) = look(self.within)?;
        if value.abs() <= zero {
            return Ok(Some(flow));
        }
        if value > 0.0 {
            return Ok(None);
        }
        let (mut low, mut high) = ((0.0, self.start.max(zero)), (self.within, value));
        let (mut last, mut side) = (flow, 0);
        for count in 0..MOST {
            let width = high.0 - low.0;
            if width <= INSTANT * dt {
                break;
            }
            let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let at = if count % 4 == 3 { low.0 + 0.5 * width } else { secant };
            let (value, zero, flow) = look(at)?;
            if value.abs() <= zero {
                return Ok(Some(flow));
            }
            if value > 0.0 {
                high.1 *= if side == 1 { 0.5 } else { 1.0 };
                (low, side) = ((at, value), 1);
            } else {
                low.1 *= if side == -1 { 0.5 } else { 1.0 };
                (high, side, last) = ((at, value), -1, flow);
            }
        }
        Ok(Some(last))
    }
}
