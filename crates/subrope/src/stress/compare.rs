//! How far the dimensionless results of two runs are apart.

use serde::Serialize;

use super::{Ended, Run, Twin};

/// What two runs of a member say together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Largest relative difference of displacements, forces and energies \[-\]; none where one of them gave nothing.
    pub difference: Option<f64>,
    /// Whether both ended in the same way.
    pub ended_alike: bool,
}

impl Outcome {
    /// Compares a run with that of its twin.
    #[must_use]
    pub fn of(run: &Run, other: &Run, twin: Twin) -> Self {
        let alike = std::mem::discriminant(&run.ended) == std::mem::discriminant(&other.ended);
        let gave = |r: &Run| r.measured.increments > 0 && !matches!(r.ended, Ended::Panicked(_) | Ended::NotFinite(_));
        let difference = (gave(run) && gave(other)).then(|| difference(run, other, twin));
        Self { difference, ended_alike: alike }
    }
}

/// Largest relative difference \[-\] of the fields of a run and of its twin, each in the Euclidean norm: displacements over
/// the factor of lengths, forces and moments over that of forces, energies over theirs, and the load reached.
#[must_use]
pub fn difference(run: &Run, other: &Run, twin: Twin) -> f64 {
    let (a, b) = (&run.measured, &other.measured);
    let fields = [
        relative(&a.displacement, &b.displacement, twin.length),
        relative(&a.forces, &b.forces, twin.force()),
        relative(&a.energies, &b.energies, twin.energy()),
        (a.reached - b.reached).abs(),
    ];
    // A number that is none must not vanish in a maximum.
    fields.into_iter().fold(0.0, |largest, f| if f.is_nan() || f > largest { f } else { largest })
}

fn relative(a: &[f64], b: &[f64], factor: f64) -> f64 {
    if a.len() != b.len() {
        return 1.0;
    }
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    let distance = norm(&mut a.iter().zip(b).map(|(a, b)| a - b / factor));
    let scale = norm(&mut a.iter().copied()).max(norm(&mut b.iter().map(|b| b / factor)));
    if distance == 0.0 { 0.0 } else { distance / scale }
}

/// Digits lost \[-\]: decimal logarithm of a relative difference over the distance of neighbouring numbers, 2.2e-16.
#[must_use]
pub fn digits_lost(difference: f64) -> f64 {
    if difference <= f64::EPSILON { 0.0 } else { (difference / f64::EPSILON).log10() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::Measured;

    fn run(reached: f64, force: f64) -> Run {
        let measured = Measured {
            reached,
            increments: 1,
            displacement: vec![1.0, 2.0],
            forces: vec![force, 4.0],
            energies: vec![1.0],
            ..Measured::default()
        };
        Run { ended: Ended::Done, measured }
    }

    #[test]
    fn units_are_taken_out() {
        let twin = Twin { length: 10.0, stress: 2.0, shift: [0.0; 3] };
        let mut other = run(1.0, 3.0);
        other.measured.displacement.iter_mut().for_each(|u| *u *= 10.0);
        other.measured.forces.iter_mut().for_each(|f| *f *= 200.0);
        other.measured.energies.iter_mut().for_each(|e| *e *= 2000.0);
        assert_eq!(difference(&run(1.0, 3.0), &other, twin), 0.0);
        other.measured.forces[0] *= 1.0 + 1e-6;
        let found = difference(&run(1.0, 3.0), &other, twin);
        assert!((found - 0.6e-6).abs() < 1e-11, "{found}");
        assert!((digits_lost(found) - 9.43).abs() < 0.01, "{}", digits_lost(found));
        assert!(difference(&run(1.0, 3.0), &run(0.5, 3.0), Twin::NONE) >= 0.5);
        assert!(difference(&run(1.0, 3.0), &run(1.0, f64::NAN), Twin::NONE).is_nan());
    }
}
