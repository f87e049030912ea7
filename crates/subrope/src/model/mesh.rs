//! The mesh of a scene with its fibre frames, generated or from a deck.

use nalgebra::{Matrix3, Vector3};
use subrope_geometry::{
    Axis, CellKind, HelicalFibres, Hex8, Hex20, Hex27, Hexahedron, Lay, Mesh, MeshLines, Parallel, PerCellFrames,
    RopeMesh, RopeShape, Strand, StrandOrigin, fibre_frames, frame_from_directions, map_point, quality, strand,
};
use subrope_io::{Ignored, read_deck};

use super::{ModelError, SliceShape};
use crate::scene::{self, Deck, End, Fibres, Formulation, Scene};

/// Mesh, fibre frames and what they were made from.
#[derive(Debug)]
pub struct MeshModel {
    /// The mesh with its sets.
    pub mesh: Mesh,
    /// Fibre frame of every integration point, element by element; columns e1 e2 e3.
    pub frames: Vec<Matrix3<f64>>,
    /// The generated strand, if it is one.
    pub strand: Option<Strand>,
    /// The generated rope, if it is one: the strand of every cell, and what its shape came to.
    pub rope: Option<RopeModelShape>,
    /// What the mesh stands for, when it is one layer of one strand; the strand of `rope` is that layer then.
    pub slice: Option<SliceShape>,
}

/// What a generated rope adds to its mesh.
#[derive(Debug)]
pub struct RopeModelShape {
    /// Zero-based strand of every cell.
    pub strand_of_cell: Vec<u32>,
    /// Strands, the core last.
    pub strands: Vec<Strand>,
    /// Helix radius, lay angle, diameter, gaps.
    pub shape: RopeShape,
}

impl MeshModel {
    /// Makes or reads the mesh of a scene.
    ///
    /// # Errors
    /// [`ModelError::Geometry`], [`ModelError::Deck`], [`ModelError::MissingFibres`], [`ModelError::WrongElement`].
    pub fn new(scene: &Scene, deck: Option<&std::path::Path>) -> Result<(Self, Vec<Ignored>), ModelError> {
        crate::estimate::refuse_scene(scene)?;
        let kind = cell_kind(scene.element.formulation);
        let (model, ignored) = match (&scene.strand, &scene.rope, &scene.deck, deck) {
            (Some(strand), ..) => (Self::generate(strand, kind)?, Vec::new()),
            (None, Some(rope), ..) if rope.is_slice() => (Self::generate_slice(scene, rope, kind)?, Vec::new()),
            (None, Some(rope), ..) => (Self::generate_rope(scene, rope, kind)?, Vec::new()),
            (None, None, Some(entry), Some(path)) => Self::read(entry, path, kind)?,
            _ => return Err(ModelError::UnknownSet { kind: "mesh", name: String::new(), available: Vec::new() }),
        };
        if scene.deck.is_some() {
            let (elements, nodes) = (model.mesh.cell_count(), model.mesh.point_count());
            crate::estimate::refuse_mesh(scene.element.formulation, elements, nodes)?;
        }
        let found = model.mesh.kind.nodes();
        if model.mesh.kind != kind {
            let formulation = scene.element.formulation.word();
            return Err(ModelError::WrongElement { formulation, needed: kind.nodes(), found });
        }
        Ok((model, ignored))
    }

    /// Frees the fibre frames: bricks have theirs once they are made.
    pub(crate) fn drop_frames(&mut self) {
        self.frames = Vec::new();
    }

    fn generate(entry: &scene::Strand, kind: CellKind) -> Result<Self, ModelError> {
        let strand = strand_of(entry, kind)?;
        let mut mesh = strand.mesh()?;
        add_sets(&mut mesh);
        let frames = fibre_frames(&mesh, &strand.fibres())?;
        Ok(Self { mesh, frames, strand: Some(strand), rope: None, slice: None })
    }

    fn generate_rope(scene: &Scene, entry: &scene::Rope, kind: CellKind) -> Result<Self, ModelError> {
        let meshed = super::rope::rope_mesh(scene, entry, kind)?;
        let frames = meshed.frames()?;
        let RopeMesh { mesh, strand_of_cell, strands, shape, .. } = meshed;
        let rope = Some(RopeModelShape { strand_of_cell, strands, shape });
        Ok(Self { mesh, frames, strand: None, rope, slice: None })
    }

    fn generate_slice(scene: &Scene, entry: &scene::Rope, kind: CellKind) -> Result<Self, ModelError> {
        let layer = super::rope::rope_of(scene, entry, kind).slice()?;
        let frames = fibre_frames(&layer.mesh, &layer.strand.fibres())?;
        let slice = SliceShape::new(&layer, entry.strands, entry.mesh.layers);
        let strand_of_cell = vec![0; layer.mesh.cell_count()];
        let rope = RopeModelShape { strand_of_cell, strands: vec![layer.strand], shape: layer.shape };
        Ok(Self { mesh: layer.mesh, frames, strand: None, rope: Some(rope), slice: Some(slice) })
    }

    /// Volume of the smooth strands \[mm^3\], for a generated mesh.
    #[must_use]
    pub fn exact_volume(&self) -> Option<f64> {
        let rope = self.rope.as_ref().map(|r| r.strands.iter().map(Strand::volume).sum());
        self.strand.as_ref().map(Strand::volume).or(rope)
    }

    fn read(entry: &Deck, path: &std::path::Path, kind: CellKind) -> Result<(Self, Vec<Ignored>), ModelError> {
        crate::estimate::refuse_deck(std::fs::metadata(path).map_or(0, |about| about.len()))?;
        let deck = read_deck(path)?;
        let mut mesh = deck.mesh;
        if mesh.kind.nodes() == kind.nodes() {
            // Where bricks are integrated is for the scene to say, as what they average is.
            mesh.kind = kind;
        }
        mesh.validate()
            .and_then(|()| quality::check_orientation(&mesh))
            .map_err(|cause| ModelError::DeckMesh { path: path.to_path_buf(), cause: Box::new(cause) })?;
        let frames = match &entry.fibres {
            Fibres::Deck => fibre_frames(&mesh, &per_cell(&mesh, &deck.frames)?)?,
            Fibres::Parallel(direction) => fibre_frames(&mesh, &Parallel::new(frame_along(direction)?)?)?,
            Fibres::Helix(helix) => fibre_frames(&mesh, &helical(helix)?)?,
        };
        rename_sets(&mut mesh, entry)?;
        add_all(&mut mesh);
        Ok((Self { mesh, frames, strand: None, rope: None, slice: None }, deck.ignored))
    }

    /// Moves all nodes \[mm\]; what the mesh was generated from stays where it was.
    pub fn shift(&mut self, by: Vector3<f64>) {
        self.mesh.points.iter_mut().for_each(|point| *point += by);
    }

    /// How often a layer of a slice counts along a strand; once where the whole strand is meshed.
    #[must_use]
    pub fn layers_per_strand(&self) -> f64 {
        self.slice.map_or(1.0, |slice| slice.layers as f64)
    }

    /// A node set by name.
    ///
    /// # Errors
    /// [`ModelError::UnknownSet`].
    pub fn node_set(&self, name: &str) -> Result<&[u32], ModelError> {
        let sets = &self.mesh.node_sets;
        let found = sets.get(name).or_else(|| sets.get(&name.to_uppercase()));
        found.map(Vec::as_slice).ok_or_else(|| ModelError::UnknownSet {
            kind: "node set",
            name: name.into(),
            available: sets.keys().cloned().collect(),
        })
    }

    /// Mean position of nodes \[mm\].
    #[must_use]
    pub fn centroid(&self, nodes: &[u32]) -> Vector3<f64> {
        let Some(&first) = nodes.first() else { return Vector3::zeros() };
        // Relative to the first node: no digits are lost far from the origin.
        let origin = self.mesh.points[first as usize];
        let sum: Vector3<f64> = nodes.iter().map(|&n| self.mesh.points[n as usize] - origin).sum();
        origin + sum / nodes.len() as f64
    }

    /// Unit normal of the plane that fits the nodes of a section best.
    pub(super) fn section_normal(&self, nodes: &[u32], end: &End) -> Result<Vector3<f64>, ModelError> {
        let centre = self.centroid(nodes);
        let mut spread = Matrix3::zeros();
        for &n in nodes {
            let arm = self.mesh.points[n as usize] - centre;
            spread += arm * arm.transpose();
        }
        let eigen = spread.symmetric_eigen();
        let least = eigen.eigenvalues.imin();
        let second = eigen.eigenvalues.iter().enumerate().filter(|(i, _)| *i != least).map(|(_, v)| *v);
        if second.fold(f64::INFINITY, f64::min) <= 1e-12 * eigen.eigenvalues.max() {
            return Err(ModelError::NoSectionNormal { name: end.name.clone() });
        }
        Ok(eigen.eigenvectors.column(least).into_owned())
    }

    /// Share of volume of every node \[mm^3\].
    ///
    /// # Errors
    /// [`ModelError::Geometry`] for an inverted element.
    pub fn node_volumes(&self) -> Result<Vec<f64>, ModelError> {
        let mut out = vec![0.0; self.mesh.point_count()];
        match self.mesh.kind {
            CellKind::Hex8 => add_volumes::<Hex8, 8>(&self.mesh, &mut out),
            CellKind::Hex20 | CellKind::Hex20R => add_volumes::<Hex20, 20>(&self.mesh, &mut out),
            CellKind::Hex27 => add_volumes::<Hex27, 27>(&self.mesh, &mut out),
        }
        Ok(out)
    }
}

fn add_volumes<H: Hexahedron<N>, const N: usize>(mesh: &Mesh, out: &mut [f64]) {
    for cell in 0..mesh.cell_count() {
        let Some(x) = mesh.cell_points::<N>(cell) else { continue };
        let points = H::quadrature().iter().filter_map(|q| Some((q.weight, map_point::<H, N>(&x, q.xi).ok()?)));
        let volume: f64 = points.map(|(weight, map)| weight * map.determinant).sum();
        for &node in mesh.cell(cell) {
            out[node as usize] += volume / N as f64;
        }
    }
}

/// Nodes of the bricks of a formulation.
fn cell_kind(formulation: Formulation) -> CellKind {
    match formulation {
        Formulation::Hex8 | Formulation::Hex8MeanVolume | Formulation::Hex8MeanElongation => CellKind::Hex8,
        Formulation::Hex20 => CellKind::Hex20,
        Formulation::Hex20R => CellKind::Hex20R,
        Formulation::Hex27 => CellKind::Hex27,
    }
}

fn strand_of(entry: &scene::Strand, kind: CellKind) -> Result<Strand, ModelError> {
    Ok(Strand {
        radius: entry.radius,
        length: entry.length,
        layers: entry.mesh.layers,
        kind,
        section: super::rope::section(&entry.mesh),
        lay: Lay::from_rate(entry.surface_tangent() / entry.radius)?,
        origin: match entry.origin {
            scene::Origin::Middle => StrandOrigin::Middle,
            scene::Origin::Bottom => StrandOrigin::Bottom,
        },
        lines: match entry.mesh.lines {
            scene::MeshLines::Axis => MeshLines::Axis,
            scene::MeshLines::Yarns => MeshLines::Yarns,
        },
        ..Strand::default()
    })
}

/// The sets that a scene may name on a generated strand.
fn add_sets(mesh: &mut Mesh) {
    if let Some(lateral) = mesh.node_sets.get(strand::sets::SURFACE_NODES).cloned() {
        mesh.node_sets.insert(strand::sets::LATERAL.into(), lateral);
    }
    add_all(mesh);
}

/// The set of all nodes, unless a deck has its own of that name.
fn add_all(mesh: &mut Mesh) {
    let count = mesh.point_count() as u32;
    mesh.node_sets.entry("ALL".into()).or_insert_with(|| (0..count).collect());
}

fn per_cell(mesh: &Mesh, frames: &[Option<Matrix3<f64>>]) -> Result<PerCellFrames, ModelError> {
    let missing: Vec<usize> = frames.iter().enumerate().filter(|(_, f)| f.is_none()).map(|(e, _)| e).collect();
    match missing.first() {
        Some(&first) => Err(ModelError::MissingFibres { first: mesh.cell_label(first), count: missing.len() }),
        None => Ok(PerCellFrames::new(frames.iter().copied().flatten().collect())?),
    }
}

fn frame_along(direction: &[f64; 3]) -> Result<Matrix3<f64>, ModelError> {
    let fibre = Vector3::from(*direction);
    let second = Vector3::ith(fibre.iamin(), 1.0);
    Ok(frame_from_directions(&fibre, &second)?)
}

fn helical(entry: &scene::HelixFibres) -> Result<HelicalFibres, ModelError> {
    let axis = Axis::new(Vector3::from(entry.point), Vector3::from(entry.axis))?;
    Ok(HelicalFibres::new(axis, Lay::from_rate(entry.tangent_per_radius())?))
}

fn rename_sets(mesh: &mut Mesh, entry: &Deck) -> Result<(), ModelError> {
    for (new, old) in &entry.sets {
        let old = old.to_uppercase();
        let nodes = mesh.node_sets.get(&old).cloned();
        let faces = mesh.surfaces.get(&old).cloned();
        if nodes.is_none() && faces.is_none() {
            let available = mesh.node_sets.keys().chain(mesh.surfaces.keys()).cloned().collect();
            return Err(ModelError::UnknownSet { kind: "set or surface", name: old, available });
        }
        nodes.into_iter().for_each(|n| drop(mesh.node_sets.insert(new.clone(), n)));
        faces.into_iter().for_each(|f| drop(mesh.surfaces.insert(new.clone(), f)));
    }
    Ok(())
}
