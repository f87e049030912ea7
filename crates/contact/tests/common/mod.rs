//! Two bodies, a sink that keeps what it is given, and random displacements.
#![allow(dead_code, missing_docs)]
#![allow(clippy::expect_used, reason = "a helper of tests fails by panicking")]

use nalgebra::{Rotation3, Vector3};
use subrope_contact::{Contact, ContactOptions, Smoothing, Surface};
use subrope_fem::{Configuration, Contribution, Energies, FemError, Product, Request, Sink};
use subrope_geometry::{CellKind, Mesh, Strand, StrandOrigin, strand};

/// Small pseudo-random numbers in \[-1, 1\].
pub struct Noise(pub u64);

impl Noise {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    pub fn vector(&mut self, n: usize, scale: f64) -> Vec<f64> {
        (0..n).map(|_| scale * self.next()).collect()
    }
}

/// Two meshes as one.
pub fn join(first: &Mesh, second: &Mesh) -> Mesh {
    let mut out = first.clone();
    let (nodes, cells) = (out.points.len() as u32, out.cell_count() as u32);
    out.points.extend_from_slice(&second.points);
    out.cells.extend(second.cells.iter().map(|n| n + nodes));
    out.point_labels = (1..=out.points.len() as u64).collect();
    out.cell_labels = (1..=out.cell_count() as u64).collect();
    for (name, faces) in &second.surfaces {
        let mut faces = faces.clone();
        faces.iter_mut().for_each(|f| f.cell += cells);
        out.surfaces.insert(format!("{name}_2"), faces);
    }
    out
}

/// Two equal straight strands of radius 1 that cross at an angle \[rad\] with their smooth surfaces `gap` apart.
pub fn crossed(angle: f64, gap: f64, kind: CellKind) -> Mesh {
    let strand =
        Strand { radius: 1.0, length: 4.0, layers: 8, kind, origin: StrandOrigin::Middle, ..Strand::default() };
    let first = strand.mesh().expect("a mesh");
    let mut second = first.clone();
    let turn = Rotation3::from_axis_angle(&Vector3::x_axis(), angle);
    let apart = 2.0 * smooth_radius(&first, 1.0) + gap;
    second.points.iter_mut().for_each(|p| *p = turn * *p + Vector3::x() * apart);
    join(&first, &second)
}

/// Radius of the smooth surface of a straight strand in the direction of its outer nodes.
pub fn smooth_radius(mesh: &Mesh, fallback: f64) -> f64 {
    let faces = &mesh.surfaces[strand::sets::LATERAL];
    let surface = Surface::new(mesh, faces, Smoothing::Spline).expect("a surface");
    let rest = vec![0.0; 3 * mesh.points.len()];
    let middle = surface.patch_count() / 2;
    let shape = surface.shape(middle, [0.0, 0.0]);
    let at = shape.combine(&shape.value, &surface.gather(middle, &mesh.points, &rest));
    let radius = at.x.hypot(at.y);
    if radius > 0.0 { radius } else { fallback }
}

/// The contact of the two strands of [`crossed`].
pub fn contact(mesh: &Mesh, smoothing: Smoothing, options: ContactOptions) -> Contact {
    let surface = |name: &str| Surface::new(mesh, &mesh.surfaces[name], smoothing).expect("a surface");
    Contact::new("pair", surface("LATERAL"), surface("LATERAL_2"), &mesh.points, options).expect("a contact")
}

/// Keeps nodal forces and, in full, the stiffness.
pub struct Keep {
    pub force: Vec<f64>,
    /// Products of the stiffness with a direction.
    pub product: Vec<f64>,
    pub direction: Vec<f64>,
    nodes: Vec<Vec<u32>>,
}

impl Sink for Keep {
    fn add(&mut self, element: usize, force: &[f64], stiffness: Option<&[f64]>) {
        let nodes = &self.nodes[element];
        let n = nodes.len();
        for k in 0..3 {
            for (a, &node) in nodes.iter().enumerate() {
                self.force[3 * node as usize + k] += force[k * n + a];
                let Some(matrix) = stiffness else { continue };
                for m in 0..3 {
                    for (b, &column) in nodes.iter().enumerate() {
                        let at = if a <= b { ((k * n + a) * 3 + m) * n + b } else { ((m * n + b) * 3 + k) * n + a };
                        self.product[3 * node as usize + k] += matrix[at] * self.direction[3 * column as usize + m];
                    }
                }
            }
        }
    }

    fn add_products(&mut self, element: usize, products: &[Product<'_>]) {
        let nodes = &self.nodes[element];
        let entries: Vec<usize> = (0..3).flat_map(|k| nodes.iter().map(move |&n| 3 * n as usize + k)).collect();
        for product in products {
            let factor: f64 = entries.iter().zip(product.column).map(|(&at, c)| c * self.direction[at]).sum();
            entries.iter().zip(product.row).for_each(|(&at, r)| self.product[at] += r * factor);
        }
    }
}

/// Forces, `K direction` and energies at a displacement.
pub fn evaluate(
    contact: &mut Contact,
    displacement: &[f64],
    committed: &[f64],
    direction: &[f64],
) -> Result<(Vec<f64>, Vec<f64>, Energies), FemError> {
    let nodes = (0..contact.element_count()).map(|e| contact.element_nodes(e).to_vec()).collect();
    let n = displacement.len();
    let mut keep = Keep { force: vec![0.0; n], product: vec![0.0; n], direction: direction.to_vec(), nodes };
    let configuration = Configuration {
        displacement,
        committed,
        time_increment: 1.0,
        time: 1.0,
        temperature: 293.15,
        predicting: false,
        parallel: false,
    };
    let energies = contact.assemble(&configuration, Request::Tangent, &mut keep)?;
    Ok((keep.force, keep.product, energies))
}
