//! Consistency of a mesh before anything is computed on it.

use super::Mesh;
use crate::GeometryError;

impl Mesh {
    /// Checks lengths, labels, indices, coordinates, repeated nodes in a cell, sets, and nodes without a cell.
    ///
    /// Nodes that belong to no cell are looked for last: a caller that allows them (reference nodes of a rigid body)
    /// may ignore [`GeometryError::UnusedPoints`]. Inverted cells are found by [`crate::quality::check_orientation`].
    ///
    /// # Errors
    /// The first violation found, with labels and numbers.
    pub fn validate(&self) -> Result<(), GeometryError> {
        self.check_lengths()?;
        check_labels(&self.point_labels)?;
        check_labels(&self.cell_labels)?;
        self.check_coordinates()?;
        self.check_cells()?;
        self.check_sets()?;
        self.check_surfaces()?;
        match self.unused_points().as_slice() {
            [] => Ok(()),
            unused @ [first, ..] => {
                Err(GeometryError::UnusedPoints { count: unused.len(), first_label: self.point_label(*first as usize) })
            }
        }
    }

    fn check_lengths(&self) -> Result<(), GeometryError> {
        let nodes = self.kind.nodes();
        if !self.cells.len().is_multiple_of(nodes) {
            return Err(GeometryError::ConnectivityLength { length: self.cells.len(), nodes });
        }
        let pairs = [(self.point_labels.len(), self.point_count()), (self.cell_labels.len(), self.cell_count())];
        match pairs.into_iter().find(|(labels, items)| labels != items) {
            Some((labels, items)) => Err(GeometryError::LabelCount { labels, items }),
            None => Ok(()),
        }
    }

    fn check_coordinates(&self) -> Result<(), GeometryError> {
        match self.points.iter().position(|x| !x.iter().all(|c| c.is_finite())) {
            Some(i) => {
                let [x, y, z]: [f64; 3] = self.points[i].into();
                Err(GeometryError::Coordinate { point_label: self.point_label(i), x, y, z })
            }
            None => Ok(()),
        }
    }

    fn check_cells(&self) -> Result<(), GeometryError> {
        let points = self.points.len();
        for (cell, nodes) in self.cells.chunks_exact(self.kind.nodes()).enumerate() {
            for (a, &index) in nodes.iter().enumerate() {
                let cell_label = self.cell_label(cell);
                if index as usize >= points {
                    return Err(GeometryError::PointIndex { cell_label, index, points });
                }
                if nodes[..a].contains(&index) {
                    let point_label = self.point_label(index as usize);
                    return Err(GeometryError::DuplicatePoint { cell_label, point_label });
                }
            }
        }
        Ok(())
    }

    fn check_sets(&self) -> Result<(), GeometryError> {
        for (sets, items) in [(&self.node_sets, self.point_count()), (&self.element_sets, self.cell_count())] {
            if let Some(&index) = sets.values().flatten().find(|&&index| index as usize >= items) {
                return Err(GeometryError::SetIndex { index, items });
            }
        }
        Ok(())
    }

    fn check_surfaces(&self) -> Result<(), GeometryError> {
        let cells = self.cell_count();
        match self.surfaces.values().flatten().find(|f| f.cell as usize >= cells || f.face > 5) {
            Some(f) => Err(GeometryError::FaceIndex { cell: f.cell, face: f.face, cells }),
            None => Ok(()),
        }
    }
}

fn check_labels(labels: &[u64]) -> Result<(), GeometryError> {
    let mut sorted = labels.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(GeometryError::DuplicateLabel { label: pair[0] }),
        None => Ok(()),
    }
}
