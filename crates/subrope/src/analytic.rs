//! Closed forms of ropes, to compare a run with.

use std::f64::consts::TAU;

/// Halvings of an interval until nothing is left of it in double precision.
const HALVINGS: usize = 60;

/// Equal round strands laid about an axis, each touching both neighbours (with two strands, the other one); all deformed.
///
/// Thin soft strands: the strand's tension alone carries, its bending and twisting resistance count for nothing, and
/// contacts press without friction.
///
/// ```
/// use subrope::analytic::LaidStrands;
/// let rope = LaidStrands::touching(3, 1.0, 20_f64.to_radians())?;
/// let line_load = rope.line_load(500.0);    // N/mm per length of strand axis and contact line, at 500 N per strand
/// assert!((rope.textbook_line_load(500.0) / line_load - 0.94).abs() < 0.01);
/// # Ok::<(), subrope_geometry::GeometryError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaidStrands {
    /// Number n of strands, at least two.
    pub strands: usize,
    /// Angle beta between the axis of a strand and that of the rope \[rad\], below a right angle.
    pub lay_angle: f64,
    /// Radius a of the helices of the axes \[mm\].
    pub helix_radius: f64,
    /// Radius r of a strand \[mm\]: half the distance of two axes where they touch.
    pub tube_radius: f64,
}

impl LaidStrands {
    /// Strands of radius `tube_radius` \[mm\] on the helices on which they touch.
    ///
    /// # Errors
    /// [`subrope_geometry::GeometryError`]: fewer than two strands, a radius that is not positive, an angle out of range.
    pub fn touching(strands: usize, tube_radius: f64, lay_angle: f64) -> Result<Self, subrope_geometry::GeometryError> {
        let helix_radius = subrope_geometry::touching_radius_at_angle(strands, tube_radius, lay_angle)?;
        Ok(Self { strands, lay_angle, helix_radius, tube_radius })
    }

    /// Angle about the rope from a point of one axis to the point of the neighbour's that touches it \[rad\]: `2 pi/n + t`
    /// with `t = -tan^2(beta) sin(2 pi/n + t)`. The touching points do not lie in one transverse plane.
    #[must_use]
    pub fn touching_angle(&self) -> f64 {
        let apart = TAU / self.strands as f64;
        let slope = self.lay_angle.tan().powi(2);
        let (mut low, mut high) = (0.0, apart);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if middle + slope * middle.sin() < apart { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Part of a contact force that points away from the rope's axis, `n_r = (a/2r) (1 - cos(touching angle))` \[-\].
    #[must_use]
    pub fn radial_part(&self) -> f64 {
        self.helix_radius / (2.0 * self.tube_radius) * (1.0 - self.touching_angle().cos())
    }

    /// Force of a contact line per length of the strand's axis \[N/mm\] at a tension \[N\] along that axis:
    /// `N = T sin^2(beta)/(2 a n_r)`; with two strands, whose one line carries all, twice that.
    #[must_use]
    pub fn line_load(&self, strand_tension: f64) -> f64 {
        let lines = if self.strands == 2 { 1.0 } else { 2.0 };
        strand_tension * self.lay_angle.sin().powi(2) / (lines * self.helix_radius * self.radial_part())
    }

    /// The textbook's line load \[N/mm\], as if strands touched in transverse planes: `T sin^2(beta)/(2 a sin(pi/n))`, with
    /// three strands `T sin^2(beta)/(sqrt(3) a)`. The limit of [`Self::line_load`] for small beta; with three touching
    /// strands that is higher by 3.0 % at 15 degrees, 5.9 % at 20 and 19.3 % at 30.
    #[must_use]
    pub fn textbook_line_load(&self, strand_tension: f64) -> f64 {
        let lines = if self.strands == 2 { 1.0 } else { 2.0 };
        let radial = (0.5 * TAU / self.strands as f64).sin();
        strand_tension * self.lay_angle.sin().powi(2) / (lines * self.helix_radius * radial)
    }
}
