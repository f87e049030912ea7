//! What contacts tell on the cells that touch.

use nalgebra::{Rotation3, Vector3};
use subrope_contact::foot::Place;
use subrope_contact::{Contact, contacts};
use subrope_fem::analysis::Analysis;
use subrope_geometry::{CellKind, Face, Mesh, Quad4, Quad8, Quad9, quadrilateral};

use super::super::{ContactCells, ContactField};

/// Values of all cells of a mesh; both sides of a pair show what happens between them.
pub fn field(kind: ContactField, mesh: &Mesh, analysis: &Analysis, cells: &[ContactCells]) -> Vec<f64> {
    use ContactField as F;
    if kind == F::Gap {
        return gaps(mesh, analysis, cells);
    }
    let mut faces = FaceMeans::new(mesh, if kind == F::Traction { 3 } else { 1 });
    for (contact, cells) in contacts(analysis).zip(cells) {
        for point in contact.points() {
            let state = point.state;
            let value = match kind {
                F::Traction => state.traction,
                F::Pressure => Vector3::new(state.pressure, 0.0, 0.0),
                F::FrictionWork => Vector3::new(state.work, 0.0, 0.0),
                F::Slip | F::Gap => Vector3::new(state.slip, 0.0, 0.0),
            };
            let pair = faces_of(contact, cells, point.patch, state.place);
            // Each side feels the other's opposite, an image turned back to the strand that it is the image of.
            let felt = if kind == F::Traction { turned_back(contact, state.place, analysis) * -value } else { value };
            for (face, value) in pair.into_iter().zip([value, felt]) {
                faces.add(face, point.area, value, kind == F::Slip);
            }
        }
    }
    faces.means()
}

/// From the image of a strand that a point touches back to the strand.
fn turned_back(contact: &Contact, place: Option<Place>, analysis: &Analysis) -> Rotation3<f64> {
    // Sixteen control points surround a patch, whose own layer begins at the sixth; a facet has only its corners.
    let nodes = place.map_or(&[][..], |at| contact.primary().nodes(at.patch as usize));
    let corner = nodes.get(if nodes.len() == 16 { 5 } else { 0 });
    let kinematics = &analysis.model().kinematics;
    let turn = corner.and_then(|&node| kinematics.turn_of_image(node as usize, analysis.coordinates()));
    Rotation3::from_axis_angle(&Vector3::z_axis(), -turn.unwrap_or_default())
}

/// Friction work per area of all points since some earlier state \[mJ/mm^2\], mid-point values, as means of faces.
pub fn friction_work_since(before: &[Vec<f64>], mesh: &Mesh, analysis: &Analysis, cells: &[ContactCells]) -> Vec<f64> {
    let mut faces = FaceMeans::new(mesh, 1);
    for ((contact, cells), before) in contacts(analysis).zip(cells).zip(before) {
        for (point, before) in contact.points().zip(before) {
            let value = Vector3::new(point.state.work_mid - before, 0.0, 0.0);
            for face in faces_of(contact, cells, point.patch, point.state.place) {
                faces.add(face, point.area, value, false);
            }
        }
    }
    faces.means()
}

/// Friction work per area of all points so far \[mJ/mm^2\], mid-point values, contact by contact.
pub fn friction_work(analysis: &Analysis) -> Vec<Vec<f64>> {
    contacts(analysis).map(|contact| contact.points().map(|p| p.state.work_mid).collect()).collect()
}

/// The face that carries a point, and the one that it touches.
fn faces_of(contact: &Contact, cells: &ContactCells, patch: usize, place: Option<Place>) -> [Option<Face>; 2] {
    let own = cells.secondary.get(contact.secondary().face(patch));
    let other = place.and_then(|at| cells.primary.get(contact.primary().face(at.patch as usize)));
    [own.copied(), other.copied()]
}

fn gaps(mesh: &Mesh, analysis: &Analysis, cells: &[ContactCells]) -> Vec<f64> {
    let reach = contacts(analysis).map(|c| c.options().reach).fold(0.0, f64::max);
    let mut out = vec![reach; mesh.cell_count()];
    for (contact, cells) in contacts(analysis).zip(cells) {
        for (point, foot) in contact.points().zip(contact.gaps(analysis.displacement())) {
            let Some((place, gap)) = foot else { continue };
            for face in faces_of(contact, cells, point.patch, Some(place)).into_iter().flatten() {
                let smallest = &mut out[face.cell as usize];
                *smallest = smallest.min(gap);
            }
        }
    }
    out
}

/// Sums over the faces of cells, to become means.
struct FaceMeans<'a> {
    mesh: &'a Mesh,
    components: usize,
    sums: Vec<f64>,
    areas: Vec<f64>,
}

impl<'a> FaceMeans<'a> {
    fn new(mesh: &'a Mesh, components: usize) -> Self {
        let count = mesh.cell_count();
        Self { mesh, components, sums: vec![0.0; components * count], areas: vec![0.0; count] }
    }

    /// Adds a point; the mean is over the whole face, or over the points that are not zero.
    fn add(&mut self, face: Option<Face>, area: f64, value: Vector3<f64>, of_points: bool) {
        let Some(face) = face.filter(|_| value != Vector3::zeros()) else { return };
        let cell = face.cell as usize;
        let sums = &mut self.sums[self.components * cell..self.components * (cell + 1)];
        sums.iter_mut().zip(&value).for_each(|(sum, v)| *sum += area * v);
        if of_points {
            self.areas[cell] += area;
        } else if self.areas[cell] == 0.0 {
            self.areas[cell] = face_area(self.mesh, face);
        }
    }

    fn means(mut self) -> Vec<f64> {
        for (sums, area) in self.sums.chunks_exact_mut(self.components).zip(&self.areas) {
            if *area > 0.0 {
                sums.iter_mut().for_each(|s| *s /= area);
            }
        }
        self.sums
    }
}

fn face_area(mesh: &Mesh, face: Face) -> f64 {
    match mesh.kind {
        CellKind::Hex8 => mesh.face_points(face).map_or(0.0, |x| quadrilateral::face_area::<Quad4, 4>(&x)),
        CellKind::Hex20 | CellKind::Hex20R => {
            mesh.face_points(face).map_or(0.0, |x| quadrilateral::face_area::<Quad8, 8>(&x))
        }
        CellKind::Hex27 => mesh.face_points(face).map_or(0.0, |x| quadrilateral::face_area::<Quad9, 9>(&x)),
    }
}
