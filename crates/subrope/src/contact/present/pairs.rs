//! The contacts of a scene, ready to be solved.

use nalgebra::Vector3;
use subrope_contact::{Contact, ContactError, ContactOptions, FrictionTangent, Method, Smoothing, Surface};
use subrope_fem::kinematics::Screw;
use subrope_geometry::{Face, Mesh, surface_area};
use subrope_material::transverse_modulus;

use super::super::{ContactCells, Pair};
use super::images::{self, SliceContact};
use crate::model::{MeshModel, ModelError, RigidBody, size};
use crate::scene::{self, ContactMethod, ContactSmoothing, ContactTangent, RigidShape, Scene};

/// Most rounds of an augmented Lagrangian.
const ROUNDS: usize = 30;
/// Candidates of contact are searched up to this part of the radius.
const REACH: f64 = 0.1;

/// All contacts of a scene; one that names no surfaces stands for all neighbouring strands.
pub fn contacts(
    scene: &Scene,
    mesh: &MeshModel,
    bodies: &[RigidBody],
    positions: &[Vector3<f64>],
) -> Result<Vec<Pair>, ModelError> {
    if scene.contact.is_empty() {
        return Ok(Vec::new());
    }
    let modulus = transverse_modulus(&*crate::law::build(&scene.law)?)?;
    let mut out: Vec<Pair> = Vec::new();
    for entry in &scene.contact {
        for (name, primary, secondary) in pairs(scene, entry) {
            let smoothing = smoothing(entry);
            let first = match scene.rigid.iter().position(|r| r.name == primary) {
                Some(index) => rigid_surface(&bodies[index]),
                None => surface(&mesh.mesh, &primary, smoothing)?,
            };
            let second = surface(&mesh.mesh, &secondary, smoothing)?;
            let size = surface_size(scene, &mesh.mesh, &secondary)?;
            let options = options(scene, entry, modulus, size);
            let contact = Contact::new(&name, first, second, positions, options).map_err(refused)?;
            let primary = faces(&mesh.mesh, &primary).map(<[Face]>::to_vec).unwrap_or_default();
            let secondary = faces(&mesh.mesh, &secondary)?.to_vec();
            out.push((Box::new(contact), ContactCells { primary, secondary }));
        }
    }
    Ok(out)
}

/// The contact of a slice, if its scene has one.
pub fn slice_contact(
    scene: &Scene,
    mesh: &MeshModel,
    screw: &mut Screw,
    positions: &mut Vec<Vector3<f64>>,
) -> Result<Option<Pair>, ModelError> {
    let Some(entry) = scene.contact.first() else { return Ok(None) };
    let modulus = transverse_modulus(&*crate::law::build(&scene.law)?)?;
    let wanted = SliceContact {
        name: &entry.name,
        smoothing: smoothing(entry),
        options: options(scene, entry, modulus, size(scene, mesh)),
    };
    images::contact(mesh, screw, &wanted, positions).map(Some)
}

fn smoothing(entry: &scene::Contact) -> Smoothing {
    match entry.smoothing {
        ContactSmoothing::Spline => Smoothing::Spline,
        ContactSmoothing::None => Smoothing::None,
    }
}

fn refused(cause: ContactError) -> ModelError {
    ModelError::Contact(cause)
}

fn pairs(scene: &Scene, entry: &scene::Contact) -> Vec<(String, String, String)> {
    if let (Some(primary), Some(secondary)) = (&entry.primary, &entry.secondary) {
        return vec![(entry.name.clone(), primary.clone(), secondary.clone())];
    }
    let neighbours = scene.rope.as_ref().map(scene::Rope::neighbours).unwrap_or_default();
    let named = |(a, b)| (format!("{}_{a}_{b}", entry.name), format!("LATERAL_{a}"), format!("LATERAL_{b}"));
    neighbours.into_iter().map(named).collect()
}

fn options(scene: &Scene, entry: &scene::Contact, modulus: f64, size: f64) -> ContactOptions {
    let base = ContactOptions::new(modulus, size);
    let penalty = entry.penalty.unwrap_or(base.penalty);
    ContactOptions {
        penalty,
        toe: entry.toe * size,
        tangential_penalty: entry.tangential_ratio * penalty,
        friction: entry.friction,
        method: match entry.method {
            ContactMethod::Penalty => Method::Penalty,
            ContactMethod::Augmented => Method::Augmented { penetration: entry.penetration * size, rounds: ROUNDS },
        },
        tangent: match entry.tangent {
            ContactTangent::Exact => FrictionTangent::Exact,
            ContactTangent::Symmetric => FrictionTangent::Symmetric,
        },
        points: entry.points,
        reach: REACH * size,
        ramp: entry.ramp.unwrap_or_else(|| scene.step.first().map_or(0.0, |s| s.duration)),
    }
}

fn rigid_surface(body: &RigidBody) -> Surface {
    match body.shape {
        RigidShape::Cylinder => Surface::cylinder(body.nodes, body.radius, body.arm),
        RigidShape::Plane => Surface::plane(body.nodes, body.arm),
    }
}

fn faces<'a>(mesh: &'a Mesh, name: &str) -> Result<&'a [Face], ModelError> {
    let found = mesh.surfaces.get(name).or_else(|| mesh.surfaces.get(&name.to_uppercase()));
    found.map(Vec::as_slice).ok_or_else(|| ModelError::UnknownSet {
        kind: "surface",
        name: name.into(),
        available: mesh.surfaces.keys().cloned().collect(),
    })
}

fn surface(mesh: &Mesh, name: &str, smoothing: Smoothing) -> Result<Surface, ModelError> {
    Surface::new(mesh, faces(mesh, name)?, smoothing).map_err(refused)
}

/// Radius of a generated strand; of a surface of a deck 2.5 times the side of a mean face, as on a ring of sixteen.
fn surface_size(scene: &Scene, mesh: &Mesh, name: &str) -> Result<f64, ModelError> {
    match scene.strand_radius() {
        Some(radius) => Ok(radius),
        None => {
            let faces = faces(mesh, name)?;
            Ok(2.5 * (surface_area(mesh, faces)? / faces.len().max(1) as f64).sqrt())
        }
    }
}
