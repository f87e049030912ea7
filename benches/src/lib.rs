//! Models and points that the benches share.

use nalgebra::{Matrix3, Vector3};
use subrope::model::RopeModel;
use subrope::scene::Scene;
use subrope_fem::Contribution;
use subrope_fem::analysis::Model;
use subrope_fem::kinematics::{Kinematics, Section, SectionKind};
use subrope_fem::solid::{Formulation, SolidBlock, SolidMesh};
use subrope_geometry::{Hex8, Mesh, Strand, fibre_frames};
use subrope_material::{
    BundleLaw, BundleParameters, Compaction, EngineeringConstants, Friction, Law, LawError, ModeParameters, PointInput,
    StVenantKirchhoff,
};

/// The bundle law of the bent strand; `tau` scales its thresholds (infinite: never slides), `mu` adds pressure friction.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn bundle(tau: f64, mu: f64) -> Result<BundleLaw, LawError> {
    let mode = |k, threshold: f64, h| {
        let friction = Friction { mu, ..Friction::isotropic(threshold * tau, h) };
        ModeParameters::sliding(k, friction)
    };
    BundleLaw::new(BundleParameters {
        k_e: 2000.0,
        k_ec: 100.0,
        w_e: 0.005,
        k_c: 60.0,
        nu: 0.5,
        compaction: Compaction::Quadratic,
        transverse: mode(15.0, 0.05, 0.1),
        longitudinal: mode(20.0, 1.0, 0.3),
    })
}

/// The orthotropic law of the race against other codes.
///
/// # Errors
/// [`LawError::Parameter`].
pub fn orthotropic() -> Result<StVenantKirchhoff, LawError> {
    StVenantKirchhoff::orthotropic(&EngineeringConstants {
        e1: 300.0,
        e2: 60.0,
        e3: 60.0,
        nu12: 0.3,
        nu13: 0.3,
        nu23: 0.3,
        g12: 50.0,
        g13: 50.0,
        g23: 60.0 / 2.6,
    })
}

/// Displacement gradients that differ from point to point, of the given size.
#[must_use]
pub fn gradients(count: usize, size: f64) -> Vec<PointInput> {
    let entry = |point: usize, i: usize, j: usize| ((point * 31 + i * 7 + j * 13) as f64 * 0.7531).sin();
    (0..count).map(|point| PointInput::new(Matrix3::from_fn(|i, j| size * entry(point, i, j)))).collect()
}

/// The default strand (2400 bricks) refined `refine` times in every direction.
#[must_use]
pub fn strand(refine: usize) -> Strand {
    let mut strand = Strand::default();
    strand.section.core_cells *= refine;
    strand.section.rings *= refine;
    strand.layers *= refine;
    strand
}

/// A block of eight-node bricks of a strand.
///
/// # Errors
/// Any of mesh, frames and block.
pub fn block<L: Law + 'static, F: Formulation<8>>(
    strand: &Strand,
    law: L,
) -> Result<(Mesh, SolidBlock<8, L, F>), Box<dyn std::error::Error>> {
    let mesh = strand.mesh()?;
    let frames = fibre_frames(&mesh, &strand.fibres())?;
    let solid = SolidMesh { positions: &mesh.points, cells: &mesh.cells, labels: &mesh.cell_labels, frames: &frames };
    let block = SolidBlock::new::<Hex8>(&solid, law)?;
    Ok((mesh, block))
}

/// A strand with both ends tied to rigid sections.
///
/// # Errors
/// As the ties.
pub fn model(mesh: &Mesh, block: Box<dyn Contribution>) -> Result<Model, Box<dyn std::error::Error>> {
    let section = |name: &str| {
        let nodes = mesh.node_sets.get(name).cloned().unwrap_or_default();
        let position = nodes.iter().map(|&n| mesh.points[n as usize]).sum::<Vector3<f64>>() / nodes.len().max(1) as f64;
        Section { name: name.into(), position, axis: Vector3::z(), nodes, kind: SectionKind::Rigid }
    };
    let kinematics = Kinematics::new(mesh.points.clone(), vec![section("END_A"), section("END_B")])?;
    Ok(Model { kinematics, contributions: vec![block] })
}

/// A displacement field that bends and stretches: `size` \[mm\] at its largest.
#[must_use]
pub fn displacement(mesh: &Mesh, size: f64) -> Vec<f64> {
    mesh.points
        .iter()
        .flat_map(|p| [size * (0.05 * p.z).sin(), size * (0.07 * p.z).cos() * 0.5, size * 0.1 * (0.9 * p.x).sin()])
        .collect()
}

/// A scene made ready from its text.
///
/// # Errors
/// As the scene or the model.
pub fn scene(text: &str, threads: usize) -> Result<RopeModel, Box<dyn std::error::Error>> {
    let scene = Scene::from_toml("bench", text)?;
    Ok(RopeModel::from_scene(&scene, None, Some(threads))?)
}
