//! Checks of scalar parameters, one error each.

use crate::{GeometryError, Parameter};

pub(crate) fn positive(parameter: Parameter, value: f64) -> Result<f64, GeometryError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(GeometryError::NotPositive { parameter, value }) }
}

pub(crate) fn finite(parameter: Parameter, value: f64) -> Result<f64, GeometryError> {
    if value.is_finite() { Ok(value) } else { Err(GeometryError::NotFinite { parameter, value }) }
}

/// Checks `least <= value < greatest`.
pub(crate) fn range(parameter: Parameter, value: f64, least: f64, greatest: f64) -> Result<f64, GeometryError> {
    if (least..greatest).contains(&value) {
        Ok(value)
    } else {
        Err(GeometryError::OutOfRange { parameter, value, least, greatest })
    }
}

pub(crate) fn count(parameter: Parameter, value: usize, least: usize) -> Result<usize, GeometryError> {
    const GREATEST: usize = 1 << 20;
    if (least..=GREATEST).contains(&value) {
        Ok(value)
    } else {
        Err(GeometryError::Count { parameter, value, least, greatest: GREATEST })
    }
}
