//! Checks of law parameters.

use super::{Checker, top};
use crate::document::{Document, Location, Problem, ProblemKind};
use crate::scene::{BundleLaw, Compaction, Law, OrthotropicLaw};

impl Checker<'_> {
    pub(super) fn law(&mut self) {
        let found = check_law(&self.scene.law, self.document);
        self.problems.extend(found);
    }
}

/// Problems of the table `[law]` of any document.
pub(crate) fn check_law(law: &Law, document: &Document) -> Vec<Problem> {
    match law {
        Law::Bundle(bundle) => {
            let mut problems = compaction(bundle, document);
            if bundle.friction {
                problems.extend(friction(bundle, document));
            }
            problems
        }
        Law::Orthotropic(orthotropic) => positive_definite(orthotropic, document).into_iter().collect(),
        _ => Vec::new(),
    }
}

fn missing(document: &Document, key: &str, help: &str) -> Problem {
    let table = "[law]".to_owned();
    document.problem(&top("law"), ProblemKind::MissingKey { key: key.to_owned(), table }).help(help)
}

fn compaction(law: &BundleLaw, document: &Document) -> Vec<Problem> {
    let own: &[&str] = match law.compaction {
        Compaction::Quadratic => &[],
        Compaction::Power => &["K_p", "m"],
        Compaction::LockUp => &["z_lock"],
    };
    let given = [("K_p", law.K_p.is_some()), ("m", law.m.is_some()), ("z_lock", law.z_lock.is_some())];
    let choice = "compaction = \"power\" reads K_p and m, \"lock_up\" reads z_lock, \"quadratic\" neither";
    let mut problems = Vec::new();
    for (key, given) in given {
        match (own.contains(&key), given) {
            (true, false) => problems.push(missing(document, key, choice)),
            (false, true) => {
                let cause = format!("`{key}` is not read with this `compaction`");
                let kind = ProblemKind::Inconsistent { cause };
                problems.push(document.problem(&top("law").at(key), kind).help(choice));
            }
            _ => {}
        }
    }
    problems
}

fn friction(law: &BundleLaw, document: &Document) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (key, given) in [("tau_t", law.tau_t), ("tau_l", law.tau_l)] {
        if given.is_none() {
            problems.push(missing(document, key, "threshold of sliding (MPa); friction = false makes the law elastic"));
        }
    }
    let hardening = [("t", law.H_t, law.H_inf_t, law.kappa_s_t), ("l", law.H_l, law.H_inf_l, law.kappa_s_l)];
    for (mode, linear, saturating, slip) in hardening {
        if slip.is_none() && saturating > 0.0 {
            let help = format!("slip over which H_inf_{mode} develops");
            problems.push(missing(document, &format!("kappa_s_{mode}"), &help));
        }
        if linear > 0.0 && saturating > 0.0 {
            let cause = format!("`H_{mode}` and `H_inf_{mode}` exclude each other");
            let kind = ProblemKind::Inconsistent { cause };
            let at = top("law").at(format!("H_inf_{mode}").as_str());
            problems.push(document.problem(&at, kind).help("hardening is either linear or saturating"));
        }
    }
    problems
}

/// The compliance matrix of the normal strains must be positive definite.
fn positive_definite(law: &OrthotropicLaw, document: &Document) -> Option<Problem> {
    let (s12, s13) = (-law.nu12 / law.E1, -law.nu13 / law.E1);
    let (s11, s22, s33, s23) = (1.0 / law.E1, 1.0 / law.E2, 1.0 / law.E3, -law.nu23 / law.E2);
    let minors = [
        ("nu12", s11 * s22 - s12 * s12, "nu12^2 < E1/E2"),
        ("nu13", s11 * s33 - s13 * s13, "nu13^2 < E1/E3"),
        ("nu23", s22 * s33 - s23 * s23, "nu23^2 < E2/E3"),
    ];
    let determinant = s11 * (s22 * s33 - s23 * s23) - s12 * (s12 * s33 - s23 * s13) + s13 * (s12 * s23 - s22 * s13);
    let whole = ("nu12", determinant, "the three contractions together leave the stiffness positive definite");
    let (key, _, requirement) = minors.into_iter().chain([whole]).find(|(_, value, _)| *value <= 0.0)?;
    let at: Location = top("law").at(key);
    let cause = format!("the stiffness is not positive definite: `{key}` is too large");
    Some(document.problem(&at, ProblemKind::Inconsistent { cause }).help(format!("required: {requirement}")))
}
