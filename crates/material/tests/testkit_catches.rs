//! The battery must fail laws that are wrong on purpose.
#![allow(clippy::unwrap_used, clippy::panic)]

use subrope_material::testkit::{self, Path, TestkitFailure};
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, Friction, Law, LawError, ModeParameters, PointInput, Request, Response,
    StateVariable,
};

/// A fault planted in a correct law.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    Tangent,
    Stress,
    Stiffening,
    FibreStiffness,
    CouplingToFibre,
    StateDrifts,
    Heals,
    ForgetsInversion,
    /// Stressed at rest.
    Prestressed,
    /// The energy is negative.
    Negative,
    /// The stress jumps where the transverse mode slides for the first time.
    Jumps,
    /// The tangent is not symmetric.
    Skew,
    /// The stress alone is another one than with the tangent.
    StressAlone,
    /// What the output held before shows.
    KeepsOutput,
    /// The stress feels a rotation.
    Turns,
    /// The tangent alone does.
    TangentTurns,
    /// A number is not finite at a large deformation.
    NotFinite(usize),
    AcceptsMissingElongation,
    AcceptsMissingState,
    ClaimsNoFibreTerm,
}

#[derive(Debug)]
struct Faulty(BundleLaw, Fault);

impl Law for Faulty {
    fn name(&self) -> &'static str {
        "faulty"
    }

    fn state_variables(&self) -> &[StateVariable] {
        self.0.state_variables()
    }

    fn is_symmetric(&self) -> bool {
        self.0.is_symmetric()
    }

    fn has_potential(&self) -> bool {
        self.0.has_potential()
    }

    fn has_fibre_term(&self) -> bool {
        self.1 != Fault::ClaimsNoFibreTerm
    }

    fn evaluate(
        &self,
        input: &PointInput,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut Response,
    ) -> Result<(), LawError> {
        let before = out.second_piola[5];
        let result = self.0.evaluate(input, old, new, request, out);
        let h = &input.displacement_gradient;
        match self.1 {
            Fault::Tangent => out.tangent[(3, 3)] *= 1.001,
            Fault::Stress => out.second_piola[1] *= 1.001,
            Fault::Stiffening => out.incremental_potential = out.incremental_potential.map(|w| w * 1.001),
            Fault::FibreStiffness => out.fibre.fibre_stiffness *= 1.001,
            Fault::CouplingToFibre => out.fibre.stress_by_elongation[2] *= 1.001,
            Fault::StateDrifts => new[2] += 1e-9,
            Fault::Heals => new[7] -= 1e-9,
            Fault::ForgetsInversion if result == Err(LawError::Inverted { jacobian: 0.0 }) => return Ok(()),
            Fault::Prestressed => out.second_piola[0] += 1e-9,
            Fault::Negative => out.stored_energy -= 1.0,
            Fault::Jumps if new[4] > 0.0 => out.second_piola[0] += 1e-6,
            Fault::Skew => out.tangent[(0, 1)] += 1e-3,
            Fault::StressAlone if request == Request::Stress => out.second_piola[2] *= 1.0 + 1e-12,
            Fault::KeepsOutput if before > 1e20 => out.second_piola[5] = before,
            Fault::Turns => out.second_piola[3] += 1e-6 * (h.m12 - h.m21),
            Fault::TangentTurns => out.tangent[(3, 3)] *= 1.0 + 1e-2 * (h.m12 - h.m21),
            Fault::NotFinite(which) if h.amax() > 500.0 => spoil(which, new, out),
            Fault::AcceptsMissingElongation if input.mean_elongation.is_some_and(f64::is_nan) => return Ok(()),
            Fault::AcceptsMissingState if old[0].is_nan() => return Ok(()),
            _ => {}
        }
        result
    }
}

/// One number of an answer that is not finite.
fn spoil(which: usize, new: &mut [f64], out: &mut Response) {
    let number = match which {
        0 => &mut out.second_piola[3],
        1 => &mut out.tangent[(2, 4)],
        2 => &mut out.fibre.stress_by_elongation[1],
        3 => &mut out.fibre.fibre_stress,
        4 => &mut out.fibre.fibre_stiffness,
        5 => &mut out.stored_energy,
        6 => &mut out.dissipated_mid[1],
        _ => &mut new[3],
    };
    *number = f64::INFINITY;
}

fn law() -> BundleLaw {
    let mode = ModeParameters::sliding(20.0, Friction::isotropic(0.1, 0.3));
    BundleLaw::new(BundleParameters {
        k_e: 200.0,
        k_ec: 50.0,
        w_e: 0.02,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::Quadratic,
        transverse: mode,
        longitudinal: mode,
    })
    .unwrap()
}

#[test]
fn planted_faults_are_found() {
    let paths = Path::standard(0.08);
    testkit::check(&law(), &paths).unwrap();
    for fault in [
        Fault::Tangent,
        Fault::Stress,
        Fault::Stiffening,
        Fault::FibreStiffness,
        Fault::CouplingToFibre,
        Fault::StateDrifts,
        Fault::Heals,
        Fault::ForgetsInversion,
    ] {
        let result = testkit::check(&Faulty(law(), fault), &paths);
        assert!(result.is_err(), "{fault:?} passed");
    }
}

/// One check alone, over all paths.
fn alone(fault: Fault, check: fn(&dyn Law, &Path) -> Result<(), TestkitFailure>) -> Result<(), TestkitFailure> {
    Path::standard(0.08).iter().try_for_each(|path| check(&Faulty(law(), fault), path))
}

/// Every check by itself finds what it is there for, and lets pass what is another check's business.
#[test]
fn every_check_finds_its_own_fault() {
    let found = |result: Result<(), TestkitFailure>, what: &str| {
        assert!(matches!(result, Err(TestkitFailure::Mismatch { .. })), "{what}: {result:?}");
    };
    found(alone(Fault::Stress, testkit::stress_is_gradient), "stress");
    found(alone(Fault::Stiffening, testkit::stress_is_gradient), "potential");
    found(alone(Fault::Tangent, testkit::tangent_is_derivative), "tangent");
    found(alone(Fault::Tangent, testkit::yield_edge), "tangent at the edge");
    found(alone(Fault::Tangent, testkit::rotated_frame), "tangent in another frame");
    found(alone(Fault::Jumps, testkit::yield_edge), "jump");
    found(alone(Fault::StateDrifts, testkit::yield_edge), "drift");
    found(alone(Fault::Skew, testkit::symmetry), "symmetry");
    found(alone(Fault::CouplingToFibre, testkit::symmetry), "symmetry of the fibre response");
    found(alone(Fault::StressAlone, testkit::idempotence), "stress alone");
    found(alone(Fault::KeepsOutput, testkit::idempotence), "output kept");
    found(alone(Fault::Turns, testkit::objectivity), "rotation");
    found(alone(Fault::TangentTurns, testkit::objectivity), "rotation of the tangent");
    found(alone(Fault::Stress, testkit::transverse_isotropy), "anisotropy");
    found(alone(Fault::CouplingToFibre, testkit::mean_elongation_split), "split");
    found(alone(Fault::CouplingToFibre, testkit::mean_elongation_derivatives), "coupling");
    found(alone(Fault::FibreStiffness, testkit::mean_elongation_derivatives), "fibre stiffness");
    found(testkit::rest(&Faulty(law(), Fault::Prestressed)), "rest");
    found(testkit::rest(&Faulty(law(), Fault::StateDrifts)), "rest of the state");
    for (fault, check) in [
        (Fault::Jumps, testkit::tangent_is_derivative as fn(&dyn Law, &Path) -> _),
        (Fault::Tangent, testkit::stress_is_gradient),
        (Fault::Stiffening, testkit::tangent_is_derivative),
        (Fault::Turns, testkit::symmetry),
        (Fault::Skew, testkit::dissipation),
    ] {
        assert_eq!(alone(fault, check), Ok(()), "{fault:?}");
    }
}

#[test]
fn dissipation_and_energy_do_not_fall() {
    for fault in [Fault::Heals, Fault::Negative] {
        let result = alone(fault, testkit::dissipation);
        assert!(matches!(result, Err(TestkitFailure::Dissipation { value, .. }) if value < 0.0), "{result:?}");
    }
}

#[test]
fn extremes_are_looked_at_number_by_number() {
    assert_eq!(testkit::extremes(&law()), Ok(()));
    for which in 0..8 {
        let result = testkit::extremes(&Faulty(law(), Fault::NotFinite(which)));
        assert!(matches!(result, Err(TestkitFailure::NotFinite { .. })), "{which}: {result:?}");
    }
    for fault in [Fault::AcceptsMissingElongation, Fault::AcceptsMissingState, Fault::ClaimsNoFibreTerm] {
        let result = testkit::extremes(&Faulty(law(), fault));
        assert!(matches!(result, Err(TestkitFailure::Contradiction { .. })), "{fault:?}: {result:?}");
    }
}

#[test]
fn the_failure_names_the_worst_entry() {
    let failure = testkit::tangent_is_derivative(&Faulty(law(), Fault::Tangent), &Path::standard(0.08)[1]).unwrap_err();
    let TestkitFailure::Mismatch { entry, .. } = failure else { panic!("{failure}") };
    assert_eq!((entry.row, entry.column), (3, 3));
}
