//! Laws of the bundle for tests.

use crate::{BundleLaw, BundleParameters, Compaction, Friction, Hardening, LawError, ModeParameters};

fn bundle(compaction: Compaction, hardening: [Hardening; 2], mu: f64) -> Result<BundleLaw, LawError> {
    let mode = |k, tau, hardening, x| ModeParameters::sliding(k, Friction { tau, hardening, x, mu });
    BundleLaw::new(BundleParameters {
        k_e: 2000.0,
        k_ec: 100.0,
        w_e: 0.005,
        k_c: 60.0,
        nu: 0.5,
        compaction,
        transverse: mode(15.0, 0.5, hardening[0], 2.0),
        longitudinal: mode(20.0, 1.0, hardening[1], 0.0),
    })
}

/// Laws of the bundle that between them take every way through its code: without friction; linear hardening; a power of
/// compaction with saturating hardening; lock-up with friction that grows with pressure, the last.
///
/// # Errors
/// None of them has impossible parameters.
pub fn bundles() -> Result<Vec<BundleLaw>, LawError> {
    let linear = [Hardening::Linear { h: 0.1 }, Hardening::Linear { h: 0.0 }];
    let saturating = Hardening::Saturating { h_inf: 0.4, kappa_s: 0.02 };
    let sliding = bundle(Compaction::Quadratic, linear, 0.0)?;
    Ok(vec![
        BundleLaw::new(sliding.parameters().without_friction())?,
        sliding,
        bundle(Compaction::Power { k_p: 300.0, m: 2.5 }, [saturating, linear[0]], 0.0)?,
        bundle(Compaction::LockUp { z_lock: -0.2 }, [saturating; 2], 0.3)?,
    ])
}
