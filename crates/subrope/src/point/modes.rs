//! Deformation from strain modes.

use nalgebra::Matrix3;

/// Displacement gradient `H = F - 1` \[-\] in the fibre frame that has given strain modes (elongation, compaction, D1,
/// D2, g2, g3).
///
/// Of all deformations that differ by a rotation, the one that keeps the fibre's direction and whose section part is
/// symmetric:
///
/// `F = [[l, l g2, l g3], [0, U]]`, `l = exp(I_elong)`,
/// `U = exp(I_comp) (cosh|D| 1 + sinh|D|/|D| [[D1, D2], [D2, -D1]])`,
///
/// so that `T = U U`. Written with `expm1` and `sinh`, so that modes of 1e-14 keep their digits.
#[must_use]
pub fn displacement_gradient_of(modes: &[f64; 6]) -> Matrix3<f64> {
    let [elongation, compaction, d1, d2, g2, g3] = *modes;
    let (stretch, section) = (elongation.exp(), compaction.exp());
    let size = d1.hypot(d2);
    let shear = section * if size == 0.0 { 1.0 } else { size.sinh() / size };
    // exp(c) cosh(d) - 1 without cancellation.
    let mean = compaction.exp_m1() + section * 2.0 * (0.5 * size).sinh().powi(2);
    let (along, across) = (shear * d1, shear * d2);
    Matrix3::new(elongation.exp_m1(), stretch * g2, stretch * g3, 0.0, mean + along, across, 0.0, across, mean - along)
}

#[cfg(test)]
mod tests {
    use super::displacement_gradient_of;
    use subrope_material::StrainModes;

    #[test]
    fn modes_are_reached() {
        for scale in [1.0, 1e-3, 1e-9, 1e-14] {
            let modes = [0.3, -0.2, 0.4, -0.5, 0.6, 0.7].map(|m| scale * m);
            let found = StrainModes::from_displacement_gradient(&displacement_gradient_of(&modes)).unwrap();
            let [d1, d2] = found.distortion;
            let [g2, g3] = found.longitudinal_shear;
            let found = [found.elongation, found.compaction, d1, d2, g2, g3];
            for (a, b) in found.iter().zip(modes) {
                assert!((a - b).abs() <= 2e-14 * scale, "{found:?} for {modes:?}");
            }
        }
    }
}
