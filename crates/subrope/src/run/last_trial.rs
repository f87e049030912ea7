//! Where an attempt that failed stood last, as a file to look at.

use std::path::{Path, PathBuf};

use subrope_fem::analysis::Analysis;
use subrope_fem::kinematics::NodeRule;
use subrope_io::{FieldSpec, IoError, Precision, ResultWriter, WriterOptions};

use crate::model::MeshModel;

/// Name of the file.
pub const FILE: &str = "last_trial.vtkhdf";

/// Writes the committed state and, after it, the last iterate of the attempt that failed: displacement \[mm\] and the
/// forces \[N\] that are not in balance at the nodes, zero at nodes that follow a reference point.
///
/// # Errors
/// [`IoError`].
pub fn write(folder: &Path, mesh: &MeshModel, analysis: &Analysis) -> Result<PathBuf, IoError> {
    let path = folder.join(FILE);
    let specs = [FieldSpec::point("displacement", 3), FieldSpec::point("residual", 3)];
    let options = WriterOptions { precision: Precision::F64, deflate: Some(4) };
    let mut file = ResultWriter::create(&path, &mesh.mesh, &specs, &[].into(), options)?;
    let nodes = 3 * mesh.mesh.point_count();
    let balanced = vec![0.0; nodes];
    file.append(analysis.time(), &[&analysis.displacement()[..nodes], &balanced])?;
    let trial = analysis.last_trial();
    let residual = nodal(analysis, trial.residual, nodes);
    if finite(trial.displacement) && finite(&residual) {
        file.append(analysis.time() + trial.time_increment, &[&trial.displacement[..nodes], &residual])?;
    }
    file.close()?;
    Ok(path)
}

fn finite(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_finite())
}

/// Forces of the free nodes among generalised ones.
fn nodal(analysis: &Analysis, residual: &[f64], length: usize) -> Vec<f64> {
    let rules = analysis.model().kinematics.rules();
    let mut out = vec![0.0; length];
    for (target, rule) in out.chunks_exact_mut(3).zip(rules) {
        if let NodeRule::Free { first } = rule {
            target.copy_from_slice(&residual[*first as usize..*first as usize + 3]);
        }
    }
    out
}
