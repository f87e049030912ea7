//! How strands are laid and how their yarns are wound: the ways a user may say it.

use crate::{GeometryError, Handedness, Lay};

/// What gives the lay of the strands about the axis of the rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LayBy {
    /// Length of rope axis per turn \[mm\].
    Length(f64),
    /// Angle \[rad\] between the axis of a strand and that of the rope, in \[0, pi/2).
    Angle(f64),
    /// Outer diameter 2 (a + r) \[mm\] of the rope: of strands of radius r that touch at the helix radius a, this is a
    /// measure of the lay, since a grows with the angle (1.1547 r at 0 deg, 1.2146 r at 30 deg for three).
    OuterDiameter(f64),
}

/// Lay of the strands about the axis of the rope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RopeLay {
    /// What gives it.
    pub by: LayBy,
    /// Its sense.
    pub handedness: Handedness,
}

/// Radius of the helices on which the axes of the strands lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum HelixRadius {
    /// Such that the smooth contact surfaces of neighbours (of every outer strand and the core, where there is one)
    /// are `gap` times the radius of an outer strand apart; 0 touches, negative values overlap.
    Touching {
        /// Distance over radius, greater than -1.
        gap: f64,
    },
    /// The radius itself \[mm\].
    Given(f64),
}

impl Default for HelixRadius {
    fn default() -> Self {
        Self::Touching { gap: 0.0 }
    }
}

/// Sense of the yarns in a strand against that of the strands in the rope.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Sense {
    /// The yarns turn as the strands do (lang lay).
    Same,
    /// The yarns turn against the strands (ordinary lay): torques balance in part.
    #[default]
    Opposite,
}

/// What gives the winding of the yarns about the axis of their strand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum YarnLayBy {
    /// Angle \[rad\] at the surface of the strand between its yarns and its axis.
    SurfaceAngle(f64),
    /// Arc length of the axis of the strand per turn against its Frenet normal \[mm\].
    Pitch(f64),
    /// No turn against the Frenet normal.
    Parallel,
}

/// Winding of the yarns of a strand: the yarn at the radius r has the angle phi_0 + 2 pi s/p_s against the Frenet
/// normal of the axis of the strand, s the arc length of that axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YarnLay {
    /// What gives it.
    pub by: YarnLayBy,
    /// Its sense against that of the rope.
    pub sense: Sense,
}

impl YarnLay {
    /// The lay in a strand of radius `radius` \[mm\] of a rope whose strands turn by `rope`.
    ///
    /// # Errors
    /// When the angle is not in \[0, pi/2), or the pitch or the radius is not positive.
    pub fn lay(&self, radius: f64, rope: Handedness) -> Result<Lay, GeometryError> {
        let handedness = match self.sense {
            Sense::Same => rope,
            Sense::Opposite => rope.opposite(),
        };
        match self.by {
            YarnLayBy::SurfaceAngle(angle) => Lay::from_angle(radius, angle, handedness),
            YarnLayBy::Pitch(pitch) => Lay::from_lay_length(pitch, handedness),
            YarnLayBy::Parallel => Ok(Lay::PARALLEL),
        }
    }
}
