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
        true
    }

    fn evaluate(
        &self,
        input: &PointInput,
        old: &[f64],
        new: &mut [f64],
        request: Request,
        out: &mut Response,
    ) -> Result<(), LawError> {
        let result = self.0.evaluate(input, old, new, request, out);
        match self.1 {
            Fault::Tangent => out.tangent[(3, 3)] *= 1.001,
            Fault::Stress => out.second_piola[1] *= 1.001,
            Fault::Stiffening => out.incremental_potential = out.incremental_potential.map(|w| w * 1.001),
            Fault::FibreStiffness => out.fibre.fibre_stiffness *= 1.001,
            Fault::CouplingToFibre => out.fibre.stress_by_elongation[2] *= 1.001,
            Fault::StateDrifts => new[2] += 1e-9,
            Fault::Heals => new[7] -= 1e-9,
            Fault::ForgetsInversion if result == Err(LawError::Inverted { jacobian: 0.0 }) => return Ok(()),
            Fault::ForgetsInversion => {}
        }
        result
    }
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

#[test]
fn the_failure_names_the_worst_entry() {
    let failure = testkit::tangent_is_derivative(&Faulty(law(), Fault::Tangent), &Path::standard(0.08)[1]).unwrap_err();
    let TestkitFailure::Mismatch { entry, .. } = failure else { panic!("{failure}") };
    assert_eq!((entry.row, entry.column), (3, 3));
}
