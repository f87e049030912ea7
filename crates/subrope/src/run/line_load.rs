//! Load along contact lines: what a contact does on every slice of its secondary strand.
//!
//! A slice is a layer of bricks of a generated strand. Forces are sums over the integration points of its faces, of pressure
//! times reference area as contacts are defined; so the slices of a line add up to the normal force of its pair.

use std::path::Path;

use nalgebra::Vector3;
use serde::Serialize;
use subrope_fem::analysis::Analysis;
use subrope_geometry::{Strand, StrandAxis, rope, strand};
use subrope_io::{CheckpointWriter, Column, HistoryWriter, IoError};

use super::output::{Opening, save_table};
use crate::analytic::LaidStrands;
use crate::contact;
use crate::model::{ContactCells, MeshModel, RopeModel};

/// Name of the table.
pub const FILE: &str = "line_load.csv";

const COLUMNS: [(&str, &str); 14] = [
    ("step", "-"),
    ("increment", "-"),
    ("time", "s"),
    ("pair", "-"),
    ("z", "mm"),
    ("arc_length", "mm"),
    ("length", "mm"),
    ("deformed_length", "mm"),
    ("normal_line_load", "N/mm"),
    ("normal_line_load_deformed", "N/mm"),
    ("friction_line_load", "N/mm"),
    ("friction_work_per_length", "mJ/mm"),
    ("touching_width", "mm"),
    ("smallest_gap", "mm"),
];

/// A contact on one slice of its secondary strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineSlice {
    /// Coordinate z of the strand's axis in the middle of the slice, reference \[mm\].
    pub z: f64,
    /// Arc length of the axis there, reference \[mm\].
    pub arc_length: f64,
    /// Length of the axis in the slice, reference \[mm\].
    pub length: f64,
    /// The same, current: stretched as the line through the middles of the sections.
    pub deformed_length: f64,
    /// Sum of the pressure over the reference area \[N\].
    pub normal: f64,
    /// Sum of the magnitude of friction traction over the reference area \[N\].
    pub friction: f64,
    /// Work of friction since the start, end value \[mJ\].
    pub work: f64,
    /// Reference area under pressure \[mm^2\].
    pub area: f64,
    /// Smallest gap \[mm\], negative in penetration; the reach of the search where nothing is nearer.
    pub gap: f64,
}

/// The line along which a strand touches another body.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactLine {
    /// Name of the pair.
    pub name: String,
    /// Its secondary strand, from 1.
    pub strand: usize,
    /// The slices of that strand, from its low end.
    pub slices: Vec<LineSlice>,
}

/// A contact line at the end of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LineLoadSummary {
    /// Name of the pair.
    pub name: String,
    /// Mean normal force per reference length of the strand's axis over the middle third \[N/mm\].
    pub normal_n_per_mm: f64,
    /// The same per current length.
    pub normal_n_per_deformed_mm: f64,
    /// Mean friction force per reference length over the middle third \[N/mm\].
    pub friction_n_per_mm: f64,
    /// Mean work of friction per reference length over the middle third \[mJ/mm\].
    pub friction_work_mj_per_mm: f64,
    /// Parts of the normal force that the low, middle and high third of the strand take \[-\].
    pub share_of_thirds: [f64; 3],
}

/// What thin soft strands without friction would press with, for the deformed middle third of a rope.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AnalyticLineLoad {
    /// Normal force per current length of the strand's axis \[N/mm\], [`LaidStrands::line_load`].
    pub normal_n_per_deformed_mm: f64,
    /// The textbook's, [`LaidStrands::textbook_line_load`].
    pub textbook_n_per_deformed_mm: f64,
    /// Tension along the axis of a strand, mean: its force along z over the cosine of the lay angle \[N\].
    pub strand_tension_n: f64,
    /// Lay angle, current \[degrees\].
    pub lay_angle_degrees: f64,
    /// Radius of the helices, current \[mm\].
    pub helix_radius_mm: f64,
    /// Half the distance of two axes where they are nearest, current \[mm\].
    pub tube_radius_mm: f64,
}

/// One generated strand in the numbering of the mesh.
struct Layers<'a> {
    strand: &'a Strand,
    first_cell: usize,
    /// First node, and nodes of a section.
    nodes: (usize, usize),
}

impl Layers<'_> {
    /// All generated strands; none for the mesh of a deck.
    fn of(mesh: &MeshModel) -> Vec<Layers<'_>> {
        let (strands, numbered) = match (&mesh.strand, &mesh.rope) {
            (Some(strand), _) => (std::slice::from_ref(strand), false),
            (None, Some(rope)) => (rope.strands.as_slice(), true),
            (None, None) => (&[][..], false),
        };
        let mut first_cell = 0;
        let mut out = Vec::with_capacity(strands.len());
        for (index, strand) in strands.iter().enumerate() {
            let low = strand::sets::END_A;
            let set = if numbered { rope::sets::of_strand(low, index) } else { low.to_owned() };
            let section = mesh.mesh.node_sets.get(&set).map_or(&[][..], Vec::as_slice);
            let first = section.first().map_or(0, |n| *n as usize);
            out.push(Layers { strand, first_cell, nodes: (first, section.len()) });
            first_cell += strand.cell_count();
        }
        out
    }

    fn layer(&self, cell: usize) -> usize {
        (cell - self.first_cell) / self.strand.section.cell_count()
    }

    /// Mean of the nodes between two layers \[mm\], level 0 at the low end.
    fn middle(&self, level: usize, mesh: &MeshModel, displacement: Option<&[f64]>) -> Vector3<f64> {
        let (first, count) = self.nodes;
        let step = self.strand.kind.order();
        let nodes = first + level * step * count..first + (level * step + 1) * count;
        let place = |n: usize| {
            let moved = displacement.map(|u| Vector3::from_column_slice(&u[3 * n..3 * n + 3]));
            mesh.mesh.points[n] + moved.unwrap_or_default()
        };
        nodes.map(place).sum::<Vector3<f64>>() / count as f64
    }

    /// Slices that carry nothing yet.
    fn slices(&self, mesh: &MeshModel, displacement: &[f64], gap: f64) -> Vec<LineSlice> {
        let (strand, count) = (self.strand, self.strand.layers);
        let length = strand.length / count as f64;
        let middles = |u| (0..=count).map(|level| self.middle(level, mesh, u)).collect::<Vec<_>>();
        let (before, now) = (middles(None), middles(Some(displacement)));
        let slice = |layer: usize| {
            let arc_length = strand.span().0 + length * (layer as f64 + 0.5);
            let chord = |x: &[Vector3<f64>]| (x[layer + 1] - x[layer]).norm();
            LineSlice {
                z: on_axis(&strand.axis, arc_length).z,
                arc_length,
                length,
                deformed_length: length * chord(&now) / chord(&before),
                normal: 0.0,
                friction: 0.0,
                work: 0.0,
                area: 0.0,
                gap,
            }
        };
        (0..count).map(slice).collect()
    }
}

fn on_axis(axis: &StrandAxis, s: f64) -> Vector3<f64> {
    match axis {
        StrandAxis::Straight(axis) => axis.position(0.0, 0.0, s),
        StrandAxis::Helix(helix) => helix.position(s),
    }
}

/// The contact lines of a model at its committed state, one for every pair; none for the mesh of a deck, which has no
/// strands to cut into slices.
#[must_use]
pub fn contact_lines(model: &RopeModel) -> Vec<ContactLine> {
    lines(&model.mesh, &model.contact_cells, &model.analysis)
}

pub(super) fn lines(mesh: &MeshModel, cells: &[ContactCells], analysis: &Analysis) -> Vec<ContactLine> {
    let strands = Layers::of(mesh);
    let mut out = Vec::new();
    for (pair, cells) in contact::loads(analysis).into_iter().zip(cells) {
        let first = cells.secondary.first().map_or(0, |f| f.cell as usize);
        let Some(index) = strands.iter().rposition(|s| s.first_cell <= first) else { continue };
        let strand = &strands[index];
        let mut slices = strand.slices(mesh, analysis.displacement(), pair.reach);
        for point in pair.points {
            let slice = &mut slices[strand.layer(cells.secondary[point.face].cell as usize)];
            slice.work += point.area * point.work;
            slice.gap = point.gap.map_or(slice.gap, |gap| slice.gap.min(gap));
            if point.pressure > 0.0 {
                slice.normal += point.area * point.pressure;
                slice.friction += point.area * point.friction;
                slice.area += point.area;
            }
        }
        out.push(ContactLine { name: pair.name, strand: index + 1, slices });
    }
    out
}

impl ContactLine {
    /// The third of the strand that a slice belongs to.
    fn third(&self, slice: usize) -> usize {
        (3 * (2 * slice + 1)) / (2 * self.slices.len())
    }

    /// Numbers of the line as a whole.
    #[must_use]
    pub fn summary(&self) -> LineLoadSummary {
        let sum = |third: Option<usize>, of: fn(&LineSlice) -> f64| -> f64 {
            let chosen = self.slices.iter().enumerate().filter(|(i, _)| third.is_none_or(|t| self.third(*i) == t));
            chosen.map(|(_, slice)| of(slice)).sum()
        };
        let middle = |of: fn(&LineSlice) -> f64| sum(Some(1), of);
        let per = |force: f64, length: f64| if length > 0.0 { force / length } else { 0.0 };
        let (length, deformed) = (middle(|s| s.length), middle(|s| s.deformed_length));
        let all = sum(None, |s| s.normal);
        LineLoadSummary {
            name: self.name.clone(),
            normal_n_per_mm: per(middle(|s| s.normal), length),
            normal_n_per_deformed_mm: per(middle(|s| s.normal), deformed),
            friction_n_per_mm: per(middle(|s| s.friction), length),
            friction_work_mj_per_mm: per(middle(|s| s.work), length),
            share_of_thirds: match self.slices[..] {
                // A layer that stands for all others.
                [_] => [1.0 / 3.0; 3],
                _ => [0, 1, 2].map(|third| per(sum(Some(third), |s| s.normal), all)),
            },
        }
    }
}

/// Part of the helix radius that the middle of a straight rope may leave its line by.
const STRAIGHT: f64 = 0.05;

/// The closed form for the deformed middle third of a rope; none for anything but a straight rope without core whose
/// contacts are all between strands.
pub(super) fn analytic(model: &RopeModel) -> Option<AnalyticLineLoad> {
    let rope = model.mesh.rope.as_ref()?;
    let laid = rope.strands.iter().all(|s| matches!(s.axis, StrandAxis::Helix(_)));
    if !laid || model.contact_cells.is_empty() || model.contact_cells.iter().any(|c| c.primary.is_empty()) {
        return None;
    }
    let all = Layers::of(&model.mesh);
    let layers = rope.strands.first()?.layers;
    let displacement = model.analysis.displacement();
    let (strands, levels) = match model.mesh.slice {
        Some(slice) => (slice.strands, 0..=1),
        None => (all.len(), layers.div_ceil(3)..=2 * layers / 3),
    };
    let cuts = |u| levels.clone().map(|level| Cut::new(&all, level, &model.mesh, u)).collect::<Vec<_>>();
    let (before, now) = (cuts(None), cuts(Some(displacement)));
    let mean_radius = |cuts: &[Cut]| cuts.iter().map(Cut::radius).sum::<f64>() / cuts.len() as f64;
    let helix_radius = rope.shape.helix_radius * mean_radius(&now) / mean_radius(&before);
    let (low, high) = (now.first()?, now.last()?);
    let advance = high.centre.z - low.centre.z;
    let drift = now.iter().map(|c| (c.centre - low.centre).xy().norm()).fold(0.0, f64::max);
    if advance <= 0.0 || drift > STRAIGHT * helix_radius {
        return None;
    }
    let turn: f64 = now.windows(2).map(|pair| pair[0].turn(&pair[1])).sum();
    let lay_angle = (helix_radius * turn / advance).abs().atan();
    let forces = super::strands(&model.mesh, &model.analysis);
    let strand_tension = forces.iter().map(|s| s.force_n).sum::<f64>() / forces.len() as f64 / lay_angle.cos();
    let unit = LaidStrands::touching(strands, 1.0, lay_angle).ok()?;
    let tube_radius = helix_radius / unit.helix_radius;
    let laid = LaidStrands { helix_radius, tube_radius, ..unit };
    Some(AnalyticLineLoad {
        normal_n_per_deformed_mm: laid.line_load(strand_tension),
        textbook_n_per_deformed_mm: laid.textbook_line_load(strand_tension),
        strand_tension_n: strand_tension,
        lay_angle_degrees: lay_angle.to_degrees(),
        helix_radius_mm: helix_radius,
        tube_radius_mm: tube_radius,
    })
}

/// A cut through all strands of a rope.
struct Cut {
    /// Middle of the rope \[mm\].
    centre: Vector3<f64>,
    /// From there to the middles of the strands \[mm\].
    arms: Vec<Vector3<f64>>,
}

impl Cut {
    fn new(strands: &[Layers<'_>], level: usize, mesh: &MeshModel, displacement: Option<&[f64]>) -> Self {
        let middles: Vec<_> = strands.iter().map(|s| s.middle(level, mesh, displacement)).collect();
        let mut centre = middles.iter().sum::<Vector3<f64>>() / middles.len() as f64;
        if mesh.slice.is_some() {
            // The other strands stand about the axis.
            (centre.x, centre.y) = (0.0, 0.0);
        }
        Self { centre, arms: middles.iter().map(|m| m - centre).collect() }
    }

    fn radius(&self) -> f64 {
        self.arms.iter().map(|a| a.xy().norm()).sum::<f64>() / self.arms.len() as f64
    }

    /// Mean angle about z to another cut less than half a turn away \[rad\].
    fn turn(&self, to: &Self) -> f64 {
        let angle = |(a, b): (&Vector3<f64>, &Vector3<f64>)| (a.x * b.y - a.y * b.x).atan2(a.x * b.x + a.y * b.y);
        self.arms.iter().zip(&to.arms).map(angle).sum::<f64>() / self.arms.len() as f64
    }
}

/// When a frame was taken.
#[derive(Clone, Copy, Debug, Default)]
pub struct FrameTime {
    /// Step as in the history; 0 before the first.
    pub step: usize,
    /// Increment as in the history.
    pub increment: usize,
}

/// The table while it grows; it gets rows with every frame.
pub struct LineLoadTable {
    writer: Option<HistoryWriter>,
}

impl LineLoadTable {
    /// Opens the table of a model with contact lines; an older one must not stand beside other results.
    pub fn open(model: &RopeModel, folder: &Path, opening: Opening<'_>) -> Result<Self, IoError> {
        let path = folder.join(FILE);
        if !contact::is_any(&model.analysis) || Layers::of(&model.mesh).is_empty() {
            let _ = std::fs::remove_file(&path);
            return Ok(Self { writer: None });
        }
        let columns: Vec<Column> = COLUMNS.iter().map(|(n, u)| Column::new(*n, *u)).collect();
        Ok(Self { writer: Some(opening.table(&path, "line_load", &columns)?) })
    }

    /// Keeps how far it has grown.
    pub fn save(&mut self, to: &mut CheckpointWriter) -> Result<(), IoError> {
        self.writer.as_mut().map_or(Ok(()), |table| save_table(table, "line_load", to))
    }

    /// Whether there is a table.
    pub fn is_open(&self) -> bool {
        self.writer.is_some()
    }

    /// Adds the slices of all lines.
    pub fn frame(
        &mut self,
        at: FrameTime,
        mesh: &MeshModel,
        cells: &[ContactCells],
        analysis: &Analysis,
    ) -> Result<(), IoError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        for (pair, line) in (1_u32..).zip(lines(mesh, cells, analysis)) {
            for slice in &line.slices {
                writer.row(&row(at, analysis.time(), pair, slice))?;
            }
        }
        Ok(())
    }
}

fn row(at: FrameTime, time: f64, pair: u32, slice: &LineSlice) -> [f64; COLUMNS.len()] {
    [
        at.step as f64,
        at.increment as f64,
        time,
        f64::from(pair),
        slice.z,
        slice.arc_length,
        slice.length,
        slice.deformed_length,
        slice.normal / slice.length,
        slice.normal / slice.deformed_length,
        slice.friction / slice.length,
        slice.work / slice.length,
        slice.area / slice.length,
        slice.gap,
    ]
}
