//! The mesh of a result file.

use super::check::{self, Counts};
use super::storage::{Rows, create, failure, put_array, put_compressed, put_texts, write_rows};
use super::{Location, Provenance, StaticField, WriterOptions};
use crate::error::{Action, IoError};
use hdf5::types::FixedAscii;
use hdf5::{File, Group};
use std::path::Path;
use subrope_geometry::{CellKind, Mesh};

/// Version of the format written.
const VERSION: [i64; 2] = [2, 2];

/// Writes a mesh without steps, with fields at its nodes and in its cells, for a look at a mesh or at fibre frames.
///
/// # Errors
/// [`IoError::Mesh`] and [`IoError::Value`] for an inconsistent mesh, wrong names or values; [`IoError::Output`].
pub fn write_mesh_vtkhdf(
    path: &Path,
    mesh: &Mesh,
    fields: &[StaticField<'_>],
    provenance: &Provenance,
    options: WriterOptions,
) -> Result<(), IoError> {
    check::mesh(mesh)?;
    check::options(options)?;
    check::provenance(provenance)?;
    check::specs(fields.iter().map(|field| field.spec))?;
    let counts = Counts::of(mesh);
    for field in fields {
        check::values(field.spec, field.values, counts, options.precision)?;
    }
    let (file, _) = create(path)?;
    let written = put_all(&file, mesh, fields, provenance, options).and_then(|()| file.flush());
    if let Err(error) = written {
        // Closing would write the rest of the caches over what could not be written completely.
        std::mem::forget(file);
        return Err(failure(path, Action::Write)(error));
    }
    file.close().map_err(failure(path, Action::Close))
}

fn put_all(
    file: &File,
    mesh: &Mesh,
    fields: &[StaticField<'_>],
    provenance: &Provenance,
    options: WriterOptions,
) -> hdf5::Result<()> {
    put_texts(file, provenance)?;
    let root = put_mesh(file, mesh, options)?;
    let groups = [root.create_group(Location::Point.group())?, root.create_group(Location::Cell.group())?];
    for field in fields {
        let group = &groups[field.spec.location as usize];
        Rows::create(group, field.spec, Counts::of(mesh).tuples(field.spec.location), options)?
            .append(0, field.values)?;
    }
    Ok(())
}

/// Writes the group `/VTKHDF` with the mesh; gives the group.
pub(super) fn put_mesh(file: &File, mesh: &Mesh, options: WriterOptions) -> hdf5::Result<Group> {
    let root = file.create_group("VTKHDF")?;
    root.new_attr::<i64>().shape(2).create("Version")?.write_raw(&VERSION)?;
    let kind = FixedAscii::<16>::from_ascii("UnstructuredGrid").map_err(|e| hdf5::Error::Internal(e.to_string()))?;
    root.new_attr::<FixedAscii<16>>().create("Type")?.write_scalar(&kind)?;
    let nodes = mesh.kind.nodes();
    put_array(&root, "NumberOfPoints", &[mesh.point_count() as i64])?;
    put_array(&root, "NumberOfCells", &[mesh.cell_count() as i64])?;
    put_array(&root, "NumberOfConnectivityIds", &[mesh.cells.len() as i64])?;
    put_points(&root, mesh)?;
    let connectivity: Vec<i64> = mesh.cells.iter().map(|&node| i64::from(node)).collect();
    put_compressed(&root, "Connectivity", &connectivity, options.deflate)?;
    let offsets: Vec<i64> = (0..=mesh.cell_count()).map(|cell| (cell * nodes) as i64).collect();
    put_compressed(&root, "Offsets", &offsets, options.deflate)?;
    put_compressed(&root, "Types", &vec![cell_type(mesh.kind); mesh.cell_count()], options.deflate)?;
    Ok(root)
}

/// Coordinates are written once and always in double precision: an origin far away would cost single precision all
/// its digits.
fn put_points(root: &Group, mesh: &Mesh) -> hdf5::Result<()> {
    let dataset = root.new_dataset::<f64>().shape((mesh.point_count(), 3)).create("Points")?;
    write_rows(&dataset, 0..mesh.point_count(), mesh.points.iter().flat_map(|point| point.iter().copied()))
}

const fn cell_type(kind: CellKind) -> u8 {
    match kind {
        CellKind::Hex8 => 12,
        CellKind::Hex20 | CellKind::Hex20R => 25,
        CellKind::Hex27 => 29,
    }
}
