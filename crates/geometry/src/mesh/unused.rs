//! Nodes that belong to no cell.

use super::Mesh;

impl Mesh {
    /// Indices of the nodes that belong to no cell, ascending.
    pub fn unused_points(&self) -> Vec<u32> {
        let mut used = vec![false; self.points.len()];
        for &node in &self.cells {
            if let Some(flag) = used.get_mut(node as usize) {
                *flag = true;
            }
        }
        (0_u32..).zip(used).filter(|&(_, flag)| !flag).map(|(node, _)| node).collect()
    }

    /// Takes the nodes that belong to no cell out of the mesh and of its sets; the others keep their order and their
    /// labels. Gives the former indices of those that stay, ascending.
    ///
    /// # Panics
    /// When a cell or a set refers to a node that does not exist.
    pub fn drop_unused_points(&mut self) -> Vec<u32> {
        let mut new: Vec<Option<u32>> = vec![Some(0); self.point_count()];
        self.unused_points().iter().for_each(|&node| new[node as usize] = None);
        let kept: Vec<u32> = (0_u32..).zip(&new).filter(|(_, stays)| stays.is_some()).map(|(node, _)| node).collect();
        (0_u32..).zip(&kept).for_each(|(index, &node)| new[node as usize] = Some(index));
        self.points = kept.iter().map(|&node| self.points[node as usize]).collect();
        self.point_labels = kept.iter().map(|&node| self.point_label(node as usize)).collect();
        let renumber = |nodes: &mut Vec<u32>| *nodes = nodes.iter().filter_map(|&node| new[node as usize]).collect();
        renumber(&mut self.cells);
        self.node_sets.values_mut().for_each(renumber);
        kept
    }
}
