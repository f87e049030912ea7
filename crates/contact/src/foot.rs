//! The foot of a point on a surface: closest-point projection and the geometry there.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::patch::{PATCH_NODES, PatchKind, SECOND, Shape};
use crate::surface::Surface;

/// Iterations and crossings of edges before a projection is given up.
const LIMIT: usize = 60;
/// How far coordinates may leave a patch before the neighbour takes over.
const OVERLAP: f64 = 1e-9;
/// How far a facet is continued beyond its edges while its foot is looked for.
const CONTINUED: f64 = 0.7;
/// The same where the neighbour has declined the point.
const FAR: f64 = 8.0;
/// A place on the edge of the surface has been found when it moves by less.
const STILL: f64 = 0.01;

/// A place on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Patch.
    pub patch: u32,
    /// Its coordinates.
    pub xi: [f64; 2],
}

/// Positions of a surface's nodes: reference plus displacement.
#[derive(Clone, Copy)]
pub struct Posture<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// Reference positions of all nodes \[mm\].
    pub positions: &'a [Vector3<f64>],
    /// Displacements, three per node \[mm\].
    pub displacement: &'a [f64],
}

impl Posture<'_> {
    /// Current positions of a patch's nodes.
    #[must_use]
    pub fn gather(&self, patch: usize) -> [Vector3<f64>; PATCH_NODES] {
        self.surface.gather(patch, self.positions, self.displacement)
    }

    /// Position of a place.
    #[must_use]
    pub fn position(&self, place: &Place) -> Vector3<f64> {
        let shape = self.surface.shape(place.patch as usize, place.xi);
        shape.combine(&shape.value, &self.gather(place.patch as usize))
    }
}

/// Position and derivatives of a surface at a point.
#[derive(Clone, Debug)]
pub struct Local {
    /// Shape functions.
    pub shape: Shape,
    /// Position \[mm\].
    pub position: Vector3<f64>,
    /// Tangents.
    pub tangents: [Vector3<f64>; 2],
    /// Second derivatives 11, 12, 22.
    pub second: [Vector3<f64>; 3],
}

impl Local {
    /// The surface at `xi` of a patch whose nodes stand at `nodal`.
    #[must_use]
    pub fn new(shape: Shape, nodal: &[Vector3<f64>; PATCH_NODES]) -> Self {
        let position = shape.combine(&shape.value, nodal);
        let tangents = std::array::from_fn(|k| shape.combine(&shape.first[k], nodal));
        let second = std::array::from_fn(|k| shape.combine(&shape.second[k], nodal));
        Self { shape, position, tangents, second }
    }

    /// Third derivatives 111, 112, 122, 222.
    #[must_use]
    pub fn third(&self, nodal: &[Vector3<f64>; PATCH_NODES]) -> [Vector3<f64>; 4] {
        std::array::from_fn(|k| self.shape.combine(&self.shape.third[k], nodal))
    }

    /// Outward unit normal.
    #[must_use]
    pub fn normal(&self) -> Vector3<f64> {
        self.tangents[0].cross(&self.tangents[1]).normalize()
    }

    /// First fundamental form `a_i . a_j`.
    #[must_use]
    pub fn metric(&self) -> Matrix2<f64> {
        let [a, b] = &self.tangents;
        Matrix2::new(a.dot(a), a.dot(b), a.dot(b), b.dot(b))
    }

    /// Second derivatives along a vector, `v . x_,ij`.
    #[must_use]
    pub fn bending(&self, v: &Vector3<f64>) -> Matrix2<f64> {
        Matrix2::from_fn(|i, j| v.dot(&self.second[SECOND[i][j]]))
    }
}

/// Closest point of a surface to a point in space.
#[derive(Clone, Debug)]
pub struct Foot {
    /// Where.
    pub place: Place,
    /// Geometry there.
    pub local: Local,
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// Signed distance \[mm\], negative inside.
    pub gap: f64,
}

/// Projects `x` from a first guess; [`None`] when the closest point lies beyond the edge of the surface.
///
/// Newton's iteration on `(x - x(xi)) . a_i = 0`, from patch to patch. A facet is continued beyond its edges until its own
/// foot is found, which says what neighbour to go to: on facets that are no parallelograms a step on the way says little.
/// Where two facets of a convex edge both decline a point, the one that it leaves less takes it.
#[must_use]
pub fn project(posture: &Posture<'_>, x: &Vector3<f64>, from: Place) -> Option<Foot> {
    let mut at = Place { xi: start(posture, x, &from), ..from };
    let mut nodal = posture.gather(at.patch as usize);
    let mut declined: Option<(u32, f64)> = None;
    let mut clamped = false;
    for _ in 0..LIMIT {
        let kind = posture.surface.kind(at.patch as usize);
        let local = Local::new(kind.shape(at.xi), &nodal);
        let step = newton_step(&local, x)?;
        let xi = [at.xi[0] + step[0], at.xi[1] + step[1]];
        let overflow = if kind.is_unbounded() { 0.0 } else { overflow(&xi) };
        let (settled, facet) = (has_settled(&step, &at), is_facet(kind));
        if settled && (overflow <= OVERLAP || !facet) {
            return Some(foot(local, at, x));
        }
        let there = if overflow <= OVERLAP { None } else { crossing(posture.surface, at.patch, &xi) };
        let back = there.is_some_and(|there| declined.is_some_and(|(patch, _)| patch == there.patch));
        // Where the way leads back to a facet that has declined the point, the foot itself decides.
        let continued = if back { FAR } else { CONTINUED };
        if overflow <= if facet && !settled { continued } else { OVERLAP } {
            (at.xi, clamped) = (xi, false);
            continue;
        }
        match there {
            // Both sides of an edge decline the point.
            Some(there) if back => {
                let (_, left) = declined?;
                let nearer = if overflow > left { there } else { at };
                return unbounded(posture, x, nearer);
            }
            Some(there) => {
                declined = settled.then_some((at.patch, overflow));
                (at, clamped) = (there, false);
                nodal = posture.gather(at.patch as usize);
            }
            None if settled => return None,
            None => {
                let inside = xi.map(|v| v.clamp(-1.0, 1.0));
                if clamped && (inside[0] - at.xi[0]).abs().max((inside[1] - at.xi[1]).abs()) < STILL {
                    return None;
                }
                (at.xi, clamped) = (inside, true);
            }
        }
    }
    None
}

/// The place beyond the edge that coordinates leave a patch by most, or beyond the other one where the surface ends there.
fn crossing(surface: &Surface, patch: u32, xi: &[f64; 2]) -> Option<Place> {
    let axes = if xi[0].abs() >= xi[1].abs() { [0, 1] } else { [1, 0] };
    axes.into_iter().filter(|&axis| xi[axis].abs() > 1.0 + OVERLAP).find_map(|axis| {
        let (beyond, there) = surface.cross(patch as usize, edge(axis, xi[axis]), *xi)?;
        Some(Place { patch: beyond as u32, xi: there.map(|v| v.clamp(-1.0, 1.0)) })
    })
}

fn is_facet(kind: &PatchKind) -> bool {
    matches!(kind, PatchKind::Bilinear | PatchKind::Biquadratic)
}

/// Projection on the continued patch, no farther than half a patch beyond its edges.
fn unbounded(posture: &Posture<'_>, x: &Vector3<f64>, mut at: Place) -> Option<Foot> {
    let (kind, nodal) = (posture.surface.kind(at.patch as usize), posture.gather(at.patch as usize));
    for _ in 0..LIMIT {
        let local = Local::new(kind.shape(at.xi), &nodal);
        let step = newton_step(&local, x)?;
        if has_settled(&step, &at) {
            return (overflow(&at.xi) < 0.5).then(|| foot(local, at, x));
        }
        at.xi = [at.xi[0] + step[0], at.xi[1] + step[1]];
    }
    None
}

/// Whether a step is as small as rounding.
fn has_settled(step: &Vector2<f64>, at: &Place) -> bool {
    step.norm() < 1e-13 * (1.0 + at.xi[0].hypot(at.xi[1]))
}

fn foot(local: Local, place: Place, x: &Vector3<f64>) -> Foot {
    let normal = local.normal();
    let gap = (x - local.position).dot(&normal);
    Foot { place, local, normal, gap }
}

/// Newton's step, or that of Gauss and Newton where the distance has no minimum nearby; at most one patch long.
fn newton_step(local: &Local, x: &Vector3<f64>) -> Option<Vector2<f64>> {
    let r = x - local.position;
    let slope = Vector2::new(r.dot(&local.tangents[0]), r.dot(&local.tangents[1]));
    let metric = local.metric();
    let hessian = metric - local.bending(&r);
    let definite = hessian[(0, 0)] > 0.0 && hessian.determinant() > 1e-6 * metric.determinant();
    let step = if definite { hessian } else { metric }.try_inverse()? * slope;
    let length = step.amax();
    if !length.is_finite() {
        return None;
    }
    let longest = 1.0;
    Some(if length > longest { step * (longest / length) } else { step })
}

/// A first guess: closed form on rigid surfaces, where the coordinates are not patch by patch.
fn start(posture: &Posture<'_>, x: &Vector3<f64>, from: &Place) -> [f64; 2] {
    let kind = posture.surface.kind(from.patch as usize);
    let (PatchKind::Cylinder { arm, .. } | PatchKind::Plane { arm }) = kind else { return from.xi };
    let nodal = posture.gather(from.patch as usize);
    let r = x - nodal[0];
    let [u, v, w] = std::array::from_fn(|k| r.dot(&(nodal[k + 1] - nodal[0])) / arm);
    match kind {
        // The branch of the angle that continues the last one.
        PatchKind::Cylinder { .. } => {
            let angle = v.atan2(u);
            let turns = ((from.xi[0] - angle) / std::f64::consts::TAU).round();
            [angle + turns * std::f64::consts::TAU, w]
        }
        _ => [u, v],
    }
}

fn overflow(xi: &[f64; 2]) -> f64 {
    xi[0].abs().max(xi[1].abs()) - 1.0
}

/// The edge beyond which a coordinate lies.
fn edge(axis: usize, xi: f64) -> u8 {
    match (axis, xi.is_sign_positive()) {
        (0, true) => 1,
        (0, false) => 3,
        (_, true) => 2,
        (_, false) => 0,
    }
}
