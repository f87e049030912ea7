//! Difference quotients that do not step over a kink.

use nalgebra::SVector;

use super::walk::regime;
use crate::LawError;
use crate::law::{Law, PointInput, Request, Response};

/// Step of the difference quotients in strain.
pub(super) const STEP: f64 = 2.5e-7;

/// Numbers of a law whose derivative is wanted: stress, potential, fibre stress.
pub(super) type Sample = SVector<f64, 8>;

/// A sample and the branch of the law it was taken on.
#[derive(Clone, Copy, Debug)]
struct Probe {
    sample: Sample,
    regime: ([bool; 2], bool),
}

/// Relative difference between the quotients of two steps beyond which neither is believed.
const COARSE: f64 = 1e-5;

/// Derivative of the sample along `moved`, which takes a step to an input.
///
/// `None` where a difference quotient says nothing: both sides cross a kink, or the quotients of two steps differ (near
/// the apex of a yield cone, or where the compaction pressure sets in).
pub(super) fn derivative(
    law: &dyn Law,
    old: &[f64],
    moved: impl Fn(f64) -> Result<PointInput, LawError>,
) -> Result<Option<Sample>, LawError> {
    let mut new = old.to_vec();
    let mut probe = |step: f64| probe(law, &moved(step)?, old, &mut new);
    let here = probe(0.0)?;
    let [behind2, behind, ahead, ahead2] = [probe(-2.0 * STEP)?, probe(-STEP)?, probe(STEP)?, probe(2.0 * STEP)?];
    let same = |probes: &[Probe]| probes.iter().all(|probe| probe.regime == here.regime);
    if same(&[behind2, behind, ahead, ahead2]) {
        let fine = (ahead.sample - behind.sample) / (2.0 * STEP);
        let coarse = (ahead2.sample - behind2.sample) / (4.0 * STEP);
        let believed = (fine - coarse).amax() <= COARSE * fine.amax();
        return Ok(believed.then(|| (fine * 4.0 - coarse) / 3.0));
    }
    for (side, near, far) in [(1.0, ahead, ahead2), (-1.0, behind, behind2)] {
        if same(&[near, far]) {
            return Ok(one_sided(side, [&here.sample, &near.sample, &far.sample]));
        }
    }
    Ok(None)
}

/// Second-order one-sided quotient from samples at 0, `side STEP` and `2 side STEP`.
fn one_sided(side: f64, [here, near, far]: [&Sample; 3]) -> Option<Sample> {
    let first = (near - here) / (side * STEP);
    let second = (far - near) / (side * STEP);
    ((first - second).amax() <= COARSE * first.amax()).then(|| (first * 3.0 - second) * 0.5)
}

fn probe(law: &dyn Law, input: &PointInput, old: &[f64], new: &mut [f64]) -> Result<Probe, LawError> {
    let mut out = Response::default();
    law.evaluate(input, old, new, Request::Stress, &mut out)?;
    let mut sample = Sample::zeros();
    sample.fixed_rows_mut::<6>(0).copy_from(&out.second_piola);
    sample[6] = out.incremental_potential.unwrap_or(0.0);
    sample[7] = out.fibre.fibre_stress;
    Ok(Probe { sample, regime: regime(law, old, new) })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parabola on either side of a kink at 0, which a quotient across it would not see.
    #[test]
    fn one_sided_quotients_are_those_of_the_parabola() {
        for side in [1.0, -1.0] {
            let sample = |x: f64| Sample::from_fn(|i, _| i as f64 + 3.0 * x + 2.0 * x * x);
            let [here, near, far] = [0.0, side * STEP, 2.0 * side * STEP].map(sample);
            let slope = one_sided(side, [&here, &near, &far]);
            assert!(slope.is_some_and(|s| s.iter().all(|v| (v - 3.0).abs() < 1e-7)), "{slope:?}");
            // Another slope beyond: the kink lies between.
            assert_eq!(one_sided(side, [&here, &near, &(near + far)]), None);
        }
    }
}
