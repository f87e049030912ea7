//! The relations between the quantities of a hierarchy.

use super::Quantity;
use crate::touching_radius_at_angle;
use std::f64::consts::{PI, TAU};
use std::fmt;

/// A relation between quantities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Relation {
    /// tex of a yarn = tex of a filament x filaments.
    Yarn,
    /// tex of a filament = density x pi d^2/4: 1 g/km is 1 kg/m^3 on 1 mm^2.
    Filament,
    /// tex of all yarns = tex of a yarn x yarns x rope-yarns x strands.
    Fibre,
    /// tex of the rope = tex of all yarns x (1 + coating) x [`strand_contraction`]/cos(lay angle).
    Contraction,
    /// tex of the rope x cos(lay angle) = density x packing x strands x pi r^2.
    Packing,
    /// Outer diameter = 2 (a + r), a the helix radius of touching circles at the lay angle.
    Touching,
    /// Lay length x tan(lay angle) = 2 pi a, a as before.
    Lay,
}

/// Length of rope-yarn per length of strand, averaged over a section with evenly spread rope-yarns:
/// (2/3)((1 + t^2)^(3/2) - 1)/t^2, t the tangent of the angle at the surface \[rad\]. 1.0792 at 30 deg.
pub fn strand_contraction(surface_angle: f64) -> f64 {
    let u = surface_angle.tan().powi(2);
    if u > 0.0 { (1.5 * u.ln_1p()).exp_m1() / (1.5 * u) } else { 1.0 }
}

impl Relation {
    /// All of them, in the order in which they are used.
    pub const ALL: [Self; 7] =
        [Self::Yarn, Self::Filament, Self::Fibre, Self::Contraction, Self::Packing, Self::Touching, Self::Lay];

    /// Whether it takes the helix radius from touching circles.
    pub(super) fn needs_touching(self) -> bool {
        matches!(self, Self::Touching | Self::Lay)
    }

    /// The quantities that it binds; the first one is told when the relation is redundant.
    pub fn quantities(self) -> &'static [Quantity] {
        use Quantity as Q;
        match self {
            Self::Yarn => &[Q::YarnTex, Q::FilamentDtex, Q::FilamentsPerYarn],
            Self::Filament => &[Q::FilamentDiameter, Q::FilamentDtex, Q::Density],
            Self::Fibre => &[Q::FibreTex, Q::YarnTex, Q::YarnsPerRopeYarn, Q::RopeYarnsPerStrand, Q::Strands],
            Self::Contraction => &[Q::RopeTex, Q::FibreTex, Q::Coating, Q::StrandAngle, Q::LayAngle],
            Self::Packing => &[Q::Packing, Q::RopeTex, Q::Density, Q::LayAngle, Q::StrandRadius, Q::Strands],
            Self::Touching => &[Q::OuterDiameter, Q::StrandRadius, Q::LayAngle, Q::Strands],
            Self::Lay => &[Q::LayLength, Q::StrandRadius, Q::LayAngle, Q::Strands],
        }
    }

    /// Logarithm of the left side over the right side; monotonic in every quantity. `gap` is that of the strands.
    pub(super) fn residual(self, gap: f64, value: impl Fn(Quantity) -> f64) -> f64 {
        use Quantity as Q;
        let ln = |quantity| value(quantity).ln();
        match self {
            Self::Yarn => ln(Q::YarnTex) - (0.1 * value(Q::FilamentDtex)).ln() - ln(Q::FilamentsPerYarn),
            Self::Filament => {
                (0.1 * value(Q::FilamentDtex)).ln() - ln(Q::Density) - 2.0 * ln(Q::FilamentDiameter) - (PI / 4.0).ln()
            }
            Self::Fibre => {
                let counts = ln(Q::YarnsPerRopeYarn) + ln(Q::RopeYarnsPerStrand) + ln(Q::Strands);
                ln(Q::FibreTex) - ln(Q::YarnTex) - counts
            }
            Self::Contraction => {
                let contraction = strand_contraction(value(Q::StrandAngle)) / value(Q::LayAngle).cos();
                ln(Q::RopeTex) - ln(Q::FibreTex) - value(Q::Coating).ln_1p() - contraction.ln()
            }
            Self::Packing => {
                let area = value(Q::Strands) * PI * value(Q::StrandRadius).powi(2) / value(Q::LayAngle).cos();
                ln(Q::RopeTex) - ln(Q::Density) - ln(Q::Packing) - area.ln()
            }
            Self::Touching => {
                let ratio = helix_radius(gap, &value);
                ln(Q::OuterDiameter) - ln(Q::StrandRadius) - (2.0 * (1.0 + ratio)).ln()
            }
            Self::Lay => {
                let around = TAU * helix_radius(gap, &value);
                ln(Q::LayLength) + value(Q::LayAngle).tan().ln() - ln(Q::StrandRadius) - around.ln()
            }
        }
    }

    /// The value of `unknown` that fulfils the relation, `known` giving the others; `None` when there is none.
    pub(super) fn solve(self, unknown: Quantity, gap: f64, known: impl Fn(Quantity) -> f64) -> Option<f64> {
        let residual = |t: f64| self.residual(gap, |q| if q == unknown { unknown.at(t) } else { known(q) });
        let (mut low, mut high) = (0.0, 1.0);
        let (at_low, at_high) = (residual(low), residual(high));
        // An angle of exactly zero leaves a residual of rounding.
        if at_low.abs() < 1e-13 {
            return Some(unknown.at(low));
        }
        if at_low.is_nan() || at_high.is_nan() || at_low.signum() == at_high.signum() {
            return None;
        }
        for _ in 0..64 {
            let middle = 0.5 * (low + high);
            if residual(middle).signum() == at_low.signum() { low = middle } else { high = middle }
        }
        Some(unknown.at(0.5 * (low + high)))
    }
}

/// Helix radius over the radius of the strands, which are `gap` radii apart.
fn helix_radius(gap: f64, value: &impl Fn(Quantity) -> f64) -> f64 {
    let strands = value(Quantity::Strands) as usize;
    touching_radius_at_angle(strands, 1.0 + 0.5 * gap, value(Quantity::LayAngle)).unwrap_or(f64::NAN)
}

impl fmt::Display for Relation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Yarn => "yarn = filaments",
            Self::Filament => "filament = density x area",
            Self::Fibre => "rope = yarns",
            Self::Contraction => "contraction by twist and coating",
            Self::Packing => "solid area of the strands",
            Self::Touching => "touching circular strands",
            Self::Lay => "lay of touching circular strands",
        })
    }
}
