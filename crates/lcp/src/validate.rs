//! What a problem must be before a solver sees it.

#![expect(non_snake_case, reason = "matrices carry their names from the notes")]

use std::ops::RangeInclusive;

use nalgebra::Vector3;

use crate::{Law, Lcp, LcpError, NO_BODY, Row};

impl Lcp {
    /// Checks sizes, indices, signs, finiteness, and that squares do not over- or underflow.
    ///
    /// # Errors
    /// The first offence, with the item and field.
    pub fn validate(&self) -> Result<(), LcpError> {
        if self.is_ordinary() {
            return Ok(());
        }
        self.find_offence()
    }

    /// Whether nothing can be wrong, told without looking for what.
    fn is_ordinary(&self) -> bool {
        let bodies = self.mass.len();
        let sized = |value: f64| SIZES.contains(&value);
        let most = *SIZES.end();
        self.momentum.len() == bodies
            && self.mass.iter().all(|m| sized(m.x) && sized(m.y) && sized(m.z))
            && self.momentum.iter().all(|p| p.x.abs() + p.y.abs() + p.z.abs() <= most)
            && self.rows.iter().enumerate().all(|(index, row)| self.is_ordinary_row(index, row))
    }

    fn is_ordinary_row(&self, index: usize, row: &Row) -> bool {
        let size = |J: &Vector3<f64>| J.x.abs() + J.y.abs() + J.z.abs();
        let [a, b] = [0, 1].map(|side| size(&row.jacobian[side]));
        let fits = |body: u32, size: f64| {
            (body as usize) < self.mass.len() || (body == NO_BODY && size == 0.0)
        };
        let law = match row.law {
            Law::Equality | Law::Unilateral => true,
            Law::Bounded { .. } => false,
            Law::Friction { normal, mu } => {
                (normal as usize) < index
                    && SIZES.contains(&mu)
                    && self.rows[normal as usize].law == Law::Unilateral
            }
        };
        law && a + b + row.rhs.abs() + row.compliance <= *SIZES.end()
            && row.compliance >= 0.0
            && row.bodies[0] != row.bodies[1]
            && fits(row.bodies[0], a)
            && fits(row.bodies[1], b)
    }

    fn find_offence(&self) -> Result<(), LcpError> {
        let (expected, found) = (self.mass.len(), self.momentum.len());
        if expected != found {
            return Err(LcpError::DimensionMismatch { what: "momentum", expected, found });
        }
        for (index, (mass, momentum)) in self.mass.iter().zip(&self.momentum).enumerate() {
            for &value in mass {
                finite("mass", index, value)?;
                in_range("mass", index, value, SIZES.contains(&value))?;
            }
            momentum.iter().try_for_each(|&value| finite("momentum", index, value))?;
        }
        (0..self.rows.len()).try_for_each(|row| self.validate_row(row))
    }

    fn validate_row(&self, index: usize) -> Result<(), LcpError> {
        let row = &self.rows[index];
        self.validate_blocks(index, row)?;
        finite("row.rhs", index, row.rhs)?;
        finite("row.compliance", index, row.compliance)?;
        in_range("row.compliance", index, row.compliance, row.compliance >= 0.0)?;
        match row.law {
            Law::Equality | Law::Unilateral => Ok(()),
            Law::Bounded { max } => {
                finite("row.law.max", index, max)?;
                in_range("row.law.max", index, max, max >= *SIZES.start())
            }
            Law::Friction { normal, mu } => {
                finite("row.law.mu", index, mu)?;
                in_range("row.law.mu", index, mu, mu >= *SIZES.start())?;
                self.validate_normal(index, normal as usize)
            }
        }
    }

    fn validate_blocks(&self, index: usize, row: &Row) -> Result<(), LcpError> {
        for side in 0..2 {
            let (body, block) = (row.bodies[side], &row.jacobian[side]);
            block.iter().try_for_each(|&value| finite("row.jacobian", index, value))?;
            if body == NO_BODY {
                if block.iter().any(|&value| value != 0.0) {
                    return Err(LcpError::BlockWithoutBody { row: index, side });
                }
            } else if body as usize >= self.mass.len() {
                let (body, bodies) = (body as usize, self.mass.len());
                return Err(LcpError::NoSuchBody { row: index, body, bodies });
            }
        }
        if row.bodies[0] == row.bodies[1] && row.bodies[0] != NO_BODY {
            return Err(LcpError::SameBody { row: index, body: row.bodies[0] as usize });
        }
        Ok(())
    }

    fn validate_normal(&self, row: usize, normal: usize) -> Result<(), LcpError> {
        if normal >= row {
            return Err(LcpError::NormalNotEarlier { row, normal });
        }
        if self.rows[normal].law != Law::Unilateral {
            return Err(LcpError::NormalNotUnilateral { row, normal });
        }
        Ok(())
    }
}

/// Numbers outside this range are refused: their squares, which every residual needs, over- or
/// underflow.
pub(crate) const SIZES: RangeInclusive<f64> = 1e-150..=1e150;

/// Refuses what is not finite, or too large to compute with.
pub(crate) fn finite(what: &'static str, index: usize, value: f64) -> Result<(), LcpError> {
    if !value.is_finite() {
        return Err(LcpError::NotFinite { what, index });
    }
    in_range(what, index, value, value.abs() <= *SIZES.end())
}

fn in_range(what: &'static str, index: usize, value: f64, valid: bool) -> Result<(), LcpError> {
    if valid { Ok(()) } else { Err(LcpError::OutOfRange { what, index, value }) }
}
