//! Strain modes of a fibre bundle: six numbers, one to one with the six components of `C`.

mod kinematics;
mod logarithm;

use nalgebra::Matrix3;

use crate::LawError;
use crate::lanes::Lanes;
pub(crate) use kinematics::{Kinematics, failure};
pub(crate) use logarithm::LogarithmFactors;

/// Physically motivated strain modes in the fibre frame `(e1, e2, e3)`, `e1` along the fibre \[-\], reference
/// configuration.
///
/// With `C = F^T F`, `g_a = C1a/C11`, `T_ab = C_ab - C1a C1b/C11` (a, b = 2, 3):
/// `I_elong = 1/2 ln C11`, `I_comp = 1/4 ln det T`, `I_dist` = deviator of `1/2 ln T` as the vector
/// `((T22 - T33)/2, T23) asinh(h)/(2 h s)` with `s = sqrt(det T)`, `h = |((T22 - T33)/2, T23)|/s`, and `I_sh = (g2,
/// g3)`. The volume ratio is `ln J = I_elong + 2 I_comp`. Invariants after Charmetant, Vidal-Salle and Boisse,
/// Composites Science and Technology 71 (2011) 1623.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainModes<V = f64> {
    /// Fibre elongation `I_elong` \[-\].
    pub elongation: V,
    /// Transverse compaction `I_comp` \[-\], negative when the section shrinks.
    pub compaction: V,
    /// Transverse distortion `I_dist = (D1, D2)` \[-\]; turning `(e2, e3)` by `w` turns it by `2 w`.
    pub distortion: [V; 2],
    /// Longitudinal shear `I_sh = (g2, g3)` \[-\]; turning `(e2, e3)` by `w` turns it by `w`.
    pub longitudinal_shear: [V; 2],
}

impl StrainModes {
    /// Strain modes of a displacement gradient `H = F - 1` given in the fibre frame.
    ///
    /// Built from `H` with `log1p`, so that they keep their relative accuracy down to strains of 1e-14, and from
    /// Gram-Schmidt on the columns of `F` with `s = det F/lambda` where the section is strongly distorted or sheared.
    ///
    /// # Errors
    /// [`LawError::NonFiniteInput`], [`LawError::Inverted`] when `det F <= 0`, [`LawError::NonFiniteResponse`] on
    /// overflow.
    pub fn from_displacement_gradient(displacement_gradient: &Matrix3<f64>) -> Result<Self, LawError> {
        let gradient = rows(displacement_gradient);
        let kinematics = Kinematics::new(&gradient);
        if kinematics.valid { Ok(kinematics.modes) } else { Err(failure(&gradient)) }
    }

    /// Charmetant's distortion invariant `|I_dist| = 1/2 ln(x + sqrt(x^2 - 1))`, `x = (I1 I4 - I5)/(2 sqrt(I3 I4))`
    /// \[-\].
    #[must_use]
    pub fn distortion_norm(&self) -> f64 {
        norm(self.distortion)
    }

    /// Charmetant's longitudinal shear invariant `|I_sh| = sqrt(I5/I4^2 - 1)` \[-\].
    #[must_use]
    pub fn longitudinal_shear_norm(&self) -> f64 {
        norm(self.longitudinal_shear)
    }

    /// Logarithm of the volume ratio, `ln J = I_elong + 2 I_comp` \[-\].
    #[must_use]
    pub fn log_volume_ratio(&self) -> f64 {
        self.elongation + 2.0 * self.compaction
    }
}

/// Length of a vector of two components; `sqrt` and not `hypot`, which is several times slower.
#[inline(always)]
pub(crate) fn norm<V: Lanes>(vector: [V; 2]) -> V {
    dot(vector, vector).sqrt()
}

/// Scalar product of two vectors of two components.
#[inline(always)]
pub(crate) fn dot<V: Lanes>(a: [V; 2], b: [V; 2]) -> V {
    a[0] * b[0] + a[1] * b[1]
}

/// A matrix by its rows.
#[inline(always)]
pub(crate) fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    let m = matrix;
    [[m.m11, m.m12, m.m13], [m.m21, m.m22, m.m23], [m.m31, m.m32, m.m33]]
}
