//! The mesh of a scene as a file, for other programs.

use std::path::Path;

use nalgebra::{Matrix3, Vector3};
use subrope_geometry::frame_from_directions;
use subrope_io::{DeckView, NumberFormat, write_deck};

use crate::Error;
use crate::model::{MeshModel, ModelError};
use crate::run::RunError;
use crate::scene::SceneFile;

/// Writes the mesh of a scene with its sets and one fibre frame per element: `.inp` (Abaqus deck) or `.vtkhdf`
/// (ParaView, needs the feature `hdf5`).
///
/// # Errors
/// [`Error::MeshFormat`] for another ending, [`Error::Model`] when the scene makes no mesh, [`Error::Run`] when the
/// file cannot be written.
pub fn write_mesh(file: &SceneFile, output: &Path) -> Result<(), Error> {
    let ending = output.extension().unwrap_or_default().to_ascii_lowercase();
    match ending.to_str() {
        Some("inp") => write_inp(&mesh(file)?, output),
        #[cfg(feature = "hdf5")]
        Some("vtkhdf") => write_vtkhdf(&mesh(file)?, file, output),
        _ => Err(Error::MeshFormat { path: output.to_owned() }),
    }
}

fn mesh(file: &SceneFile) -> Result<MeshModel, Error> {
    Ok(MeshModel::new(&file.scene, file.deck.as_deref())?.0)
}

fn write_inp(model: &MeshModel, output: &Path) -> Result<(), Error> {
    let frames = cell_frames(model)?.into_iter().map(Some).collect::<Vec<_>>();
    let view = DeckView { frames: &frames, ..DeckView::of_mesh(&model.mesh) };
    Ok(write_deck(output, &view, NumberFormat::RoundTrip).map_err(RunError::Output)?)
}

#[cfg(feature = "hdf5")]
fn write_vtkhdf(model: &MeshModel, file: &SceneFile, output: &Path) -> Result<(), Error> {
    use subrope_io::{FieldSpec, Precision, Provenance, StaticField, WriterOptions, write_mesh_vtkhdf};
    let spec = FieldSpec::cell("fibre", 3);
    let values: Vec<f64> = cell_frames(model)?.iter().flat_map(|f| [f.m11, f.m21, f.m31]).collect();
    let texts = [("scene", file.text.clone()), ("scene_sha256", file.hash.clone())];
    let provenance: Provenance = texts.into_iter().map(|(name, text)| (name.to_owned(), text)).collect();
    let options = WriterOptions { precision: Precision::F64, ..WriterOptions::default() };
    let fields = [StaticField { spec: &spec, values: &values }];
    Ok(write_mesh_vtkhdf(output, &model.mesh, &fields, &provenance, options).map_err(RunError::Output)?)
}

/// One frame per element: the mean directions e1 and e2 over its integration points, made orthonormal.
fn cell_frames(model: &MeshModel) -> Result<Vec<Matrix3<f64>>, ModelError> {
    let points = (model.frames.len() / model.mesh.cell_count().max(1)).max(1);
    let mean =
        |frames: &[Matrix3<f64>], axis: usize| frames.iter().map(|f| f.column(axis).into_owned()).sum::<Vector3<f64>>();
    let cells = model.frames.chunks_exact(points);
    cells.map(|frames| Ok(frame_from_directions(&mean(frames, 0), &mean(frames, 1))?)).collect()
}
