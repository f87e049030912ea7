//! The helix radius at which equal round strands laid together touch.

use super::{Lay, kepler};
use crate::{GeometryError, Parameter, check};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Helix radius a \[mm\] at which `strands` equal tubes of radius `radius` \[mm\], laid at the angle `angle` \[rad\] of
/// their axes, touch their neighbours.
///
/// Two helices of radius a and twist rate k, an angle Delta apart, are at least
/// d = min over u of sqrt(2 a^2 (1 - cos u) + (u - Delta)^2/k^2) apart; the minimum solves
/// u + (a k)^2 sin(u) = Delta, and tubes touch where d = 2 r. Three strands at 20 deg: a = 1.17562992 r.
///
/// # Errors
/// When there are fewer than two strands, the radius is not positive, or the angle is not in \[0, pi/2).
pub fn touching_radius_at_angle(strands: usize, radius: f64, angle: f64) -> Result<f64, GeometryError> {
    check::count(Parameter::Strands, strands, 2)?;
    check::positive(Parameter::Radius, radius)?;
    check::range(Parameter::Angle, angle, 0.0, FRAC_PI_2)?;
    Ok(2.0 * radius / least_distance(strands, 1.0, angle.tan()))
}

/// As [`touching_radius_at_angle`] for a given lay \[mm\] instead of the angle.
///
/// # Errors
/// When there are fewer than two strands or the radius is not positive; [`GeometryError::StrandsDoNotFit`] when
/// neighbours touch along the rope at every helix radius (2 r n reaches the lay length).
pub fn touching_radius(strands: usize, radius: f64, lay: Lay) -> Result<f64, GeometryError> {
    check::count(Parameter::Strands, strands, 2)?;
    check::positive(Parameter::Radius, radius)?;
    // The distance grows with the helix radius, towards lay length / n.
    let too_close = |a: f64| least_distance(strands, a, lay.rate()) < 2.0 * radius;
    let (mut low, mut high) = (0.0, radius);
    while too_close(high) {
        if high > 1e6 * radius {
            return Err(GeometryError::StrandsDoNotFit { strands, radius, lay_length: lay.lay_length() });
        }
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if too_close(middle) { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

/// Helix radii \[mm\] of two strands of any radii \[mm\] that lie opposite to each other and touch.
///
/// Strands of one material carry tension in proportion to their sections and press equally on each other, so that
/// T_1 a_1 = T_2 a_2 for small lay angles: a_1 = (r_1 + r_2) r_2^2/(r_1^2 + r_2^2), a_2 likewise, and the thin strand winds
/// about the thick one. Opposite strands are nearest, a_1 + a_2 apart, in a plane normal to the axis as long as
/// a_1 a_2 k^2 <= 1. Two of a kind have [`touching_radius`].
///
/// # Errors
/// When a radius is not positive; [`GeometryError::StrandsDoNotFit`] when the lay length is so short that the strands
/// touch elsewhere first.
pub fn touching_pair(radii: [f64; 2], lay: Lay) -> Result<[f64; 2], GeometryError> {
    for radius in radii {
        check::positive(Parameter::Radius, radius)?;
    }
    let [first, second] = radii.map(|radius| radius * radius);
    let apart = radii[0] + radii[1];
    let helices = [apart * second / (first + second), apart * first / (first + second)];
    if helices[0] * helices[1] * lay.rate().powi(2) > 1.0 {
        let lay_length = lay.lay_length();
        return Err(GeometryError::StrandsDoNotFit { strands: 2, radius: 0.5 * apart, lay_length });
    }
    Ok(helices)
}

/// Least distance \[mm\] between the axis of one strand and those of the others: helix radius `a` \[mm\], twist rate
/// `k`.
fn least_distance(strands: usize, a: f64, k: f64) -> f64 {
    (1..strands).map(|j| distance(a, k, TAU * j as f64 / strands as f64)).fold(f64::INFINITY, f64::min)
}

fn distance(a: f64, k: f64, delta: f64) -> f64 {
    let u = kepler((a * k).powi(2), delta);
    // (u - Delta)/k = -a^2 k sin(u) holds for k = 0 too.
    (2.0 * a * (0.5 * u).sin()).hypot(a * a * k * u.sin())
}
