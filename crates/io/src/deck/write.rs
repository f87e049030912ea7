//! Writing decks.

use super::Deck;
use crate::atomic::AtomicFile;
use crate::error::{IoError, ValueError};
use nalgebra::{Matrix3, Vector3};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;
use subrope_geometry::{CellKind, Face, GeometryError, Mesh};

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum NumberFormat {
    /// The shortest text that reads back to the same number: up to 17 significant digits.
    #[default]
    RoundTrip,
    /// At most 20 characters, all that CalculiX and Abaqus read of a number; between 12 and 17 significant digits.
    Columns20,
}

/// What to write; slices may be empty where there is nothing to say.
#[derive(Debug, Clone, Copy)]
pub struct DeckView<'a> {
    /// The mesh with sets and surfaces.
    pub mesh: &'a Mesh,
    /// Fibre frame of every cell, columns e1, e2, e3, or empty.
    pub frames: &'a [Option<Matrix3<f64>>],
    /// Material of every cell as an index into `material_names`, or empty.
    pub materials: &'a [Option<u32>],
    /// Names of the materials.
    pub material_names: &'a [String],
    /// Label and coordinates \[mm\] of further nodes that no cell uses.
    pub unused_nodes: &'a [(u64, [f64; 3])],
}

impl<'a> DeckView<'a> {
    /// A mesh without frames and materials.
    pub fn of_mesh(mesh: &'a Mesh) -> Self {
        Self { mesh, frames: &[], materials: &[], material_names: &[], unused_nodes: &[] }
    }
}

impl<'a> From<&'a Deck> for DeckView<'a> {
    fn from(deck: &'a Deck) -> Self {
        Self {
            mesh: &deck.mesh,
            frames: &deck.frames,
            materials: &deck.materials,
            material_names: &deck.material_names,
            unused_nodes: &deck.unused_nodes,
        }
    }
}

/// Writes a deck that [`read_deck`](super::read_deck) reads back to the same mesh, sets, surfaces, frames (to
/// rounding) and materials. Names come back in upper case. The file appears whole or not at all.
///
/// Frames are written as a `*DISTRIBUTION` over the elements, sections over element sets marked `INTERNAL`.
///
/// # Errors
/// [`IoError::Mesh`] for an inconsistent mesh; [`IoError::Value`] for slices of a wrong length, frames that are not
/// orthonormal and right-handed, names that a deck cannot carry or that differ only in case; [`IoError::Output`].
pub fn write_deck(path: &Path, deck: &DeckView<'_>, format: NumberFormat) -> Result<(), IoError> {
    check(deck)?;
    let mut writer = Writer { file: AtomicFile::create(path)?, line: String::new(), format };
    writer.nodes(deck)?;
    writer.elements(deck.mesh)?;
    for (name, members) in &deck.mesh.node_sets {
        writer.set(&format!("*NSET, NSET={}", quoted(name)), members, &deck.mesh.point_labels)?;
    }
    for (name, members) in &deck.mesh.element_sets {
        writer.set(&format!("*ELSET, ELSET={}", quoted(name)), members, &deck.mesh.cell_labels)?;
    }
    for (name, faces) in &deck.mesh.surfaces {
        writer.surface(name, faces, deck.mesh)?;
    }
    writer.distribution(deck)?;
    writer.sections(deck)?;
    writer.file.commit()?;
    Ok(())
}

fn check(deck: &DeckView<'_>) -> Result<(), IoError> {
    match deck.mesh.validate() {
        Err(GeometryError::UnusedPoints { .. }) | Ok(()) => {}
        Err(error) => return Err(error.into()),
    }
    let cells = deck.mesh.cell_count();
    for got in [deck.frames.len(), deck.materials.len()] {
        if got != 0 && got != cells {
            return Err(ValueError::Count { expected: cells, got }.into());
        }
    }
    let names = deck.material_names.len();
    if let Some(index) = deck.materials.iter().flatten().copied().find(|&index| index as usize >= names) {
        return Err(ValueError::Material { index, names }.into());
    }
    check_names(deck.mesh.node_sets.keys())?;
    check_names(deck.mesh.element_sets.keys())?;
    check_names(deck.mesh.surfaces.keys())?;
    check_names(deck.material_names.iter())?;
    for (i, frame) in deck.frames.iter().enumerate() {
        check_frame(deck.mesh.cell_label(i), frame.as_ref())?;
    }
    for (label, x) in deck.unused_nodes {
        if let Some(index) = x.iter().position(|c| !c.is_finite()) {
            return Err(ValueError::NotFinite { name: format!("node {label}"), index, value: x[index] }.into());
        }
    }
    Ok(())
}

fn check_names<'n>(names: impl Iterator<Item = &'n String>) -> Result<(), ValueError> {
    let mut seen = BTreeSet::new();
    for name in names {
        let numeric = name.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
        if name.trim().is_empty()
            || name.trim() != name
            || numeric
            || name.contains('"')
            || name.contains(char::is_control)
        {
            return Err(ValueError::Name { name: name.clone() });
        }
        if !seen.insert(name.to_uppercase()) {
            return Err(ValueError::DuplicateName { name: name.clone() });
        }
    }
    Ok(())
}

fn check_frame(cell_label: u64, frame: Option<&Matrix3<f64>>) -> Result<(), ValueError> {
    let Some(frame) = frame else { return Ok(()) };
    let deviation = (frame.transpose() * frame - Matrix3::identity()).amax().max((frame.determinant() - 1.0).abs());
    match deviation < 1e-9 {
        true => Ok(()),
        false => Err(ValueError::Frame { cell_label, deviation }),
    }
}

/// A name in quotation marks unless it is a plain one.
fn quoted(name: &str) -> String {
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'));
    if plain { name.to_owned() } else { format!("\"{name}\"") }
}

/// Order of the nodes of a 27-node brick in Abaqus: centre, then the faces S1 to S6, after the twenty outer nodes, which are
/// those of a 20-node brick.
const HEX27_ORDER: [usize; 27] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 26, 24, 25, 22, 21, 23, 20];

struct Writer {
    file: AtomicFile,
    line: String,
    format: NumberFormat,
}

impl Writer {
    fn put(&mut self) -> Result<(), IoError> {
        self.line.push('\n');
        let written = self.file.write(self.line.as_bytes());
        self.line.clear();
        Ok(written?)
    }

    fn text(&mut self, text: &str) -> Result<(), IoError> {
        self.line.push_str(text);
        self.put()
    }

    fn number(&mut self, x: f64) {
        let text = match self.format {
            NumberFormat::RoundTrip => shortest(x),
            NumberFormat::Columns20 => within_20(x),
        };
        self.line.push_str(", ");
        self.line.push_str(&text);
    }

    fn nodes(&mut self, deck: &DeckView<'_>) -> Result<(), IoError> {
        self.text("*NODE")?;
        let used = deck.mesh.point_labels.iter().copied().zip(deck.mesh.points.iter().copied());
        let unused = deck.unused_nodes.iter().map(|&(label, x)| (label, Vector3::from(x)));
        for (label, point) in used.chain(unused) {
            let _ = write!(self.line, "{label}");
            point.iter().for_each(|&x| self.number(x));
            self.put()?;
        }
        Ok(())
    }

    fn elements(&mut self, mesh: &Mesh) -> Result<(), IoError> {
        self.text(match mesh.kind {
            CellKind::Hex8 => "*ELEMENT, TYPE=C3D8",
            CellKind::Hex20 => "*ELEMENT, TYPE=C3D20",
            CellKind::Hex20R => "*ELEMENT, TYPE=C3D20R",
            CellKind::Hex27 => "*ELEMENT, TYPE=C3D27",
        })?;
        for (label, nodes) in mesh.cell_labels.iter().zip(mesh.cells.chunks_exact(mesh.kind.nodes())) {
            let _ = write!(self.line, "{label}");
            for (i, &slot) in HEX27_ORDER.iter().enumerate().take(nodes.len()) {
                // Sixteen entries fit on a line; the label is the first.
                let separator = if i == 15 { ",\n" } else { ", " };
                let _ = write!(self.line, "{separator}{}", mesh.point_label(nodes[slot] as usize));
            }
            self.put()?;
        }
        Ok(())
    }

    fn set(&mut self, header: &str, members: &[u32], labels: &[u64]) -> Result<(), IoError> {
        self.text(header)?;
        for row in members.chunks(16) {
            let row: Vec<String> = row.iter().filter_map(|&i| labels.get(i as usize)).map(u64::to_string).collect();
            self.text(&row.join(", "))?;
        }
        Ok(())
    }

    fn surface(&mut self, name: &str, faces: &[Face], mesh: &Mesh) -> Result<(), IoError> {
        self.text(&format!("*SURFACE, NAME={}, TYPE=ELEMENT", quoted(name)))?;
        for face in faces {
            self.text(&format!("{}, S{}", mesh.cell_label(face.cell as usize), face.face + 1))?;
        }
        Ok(())
    }

    fn distribution(&mut self, deck: &DeckView<'_>) -> Result<(), IoError> {
        if deck.frames.iter().all(Option::is_none) {
            return Ok(());
        }
        self.text("*DISTRIBUTION TABLE, NAME=FRAMES-TABLE\nCOORD3D, COORD3D")?;
        self.text("*DISTRIBUTION, NAME=FRAMES, LOCATION=ELEMENT, TABLE=FRAMES-TABLE\n, 1., 0., 0., 0., 1., 0.")?;
        for (label, frame) in deck.mesh.cell_labels.iter().zip(deck.frames) {
            let Some(frame) = frame else { continue };
            let _ = write!(self.line, "{label}");
            frame.iter().take(6).for_each(|&x| self.number(x));
            self.put()?;
        }
        self.text("*ORIENTATION, NAME=FRAMES, SYSTEM=RECTANGULAR\nFRAMES\n1, 0.")
    }

    /// One section for every pair of a material and the presence of a frame.
    fn sections(&mut self, deck: &DeckView<'_>) -> Result<(), IoError> {
        let mut groups: BTreeMap<(Option<u32>, bool), Vec<u32>> = BTreeMap::new();
        for cell in 0..deck.mesh.cell_count() {
            let material = deck.materials.get(cell).copied().flatten();
            let framed = deck.frames.get(cell).is_some_and(Option::is_some);
            if material.is_some() || framed {
                groups.entry((material, framed)).or_default().push(cell as u32);
            }
        }
        for (i, ((material, framed), cells)) in groups.iter().enumerate() {
            let name = section_name(deck.mesh, i + 1);
            self.set(&format!("*ELSET, ELSET={name}, INTERNAL"), cells, &deck.mesh.cell_labels)?;
            let material = material.and_then(|index| deck.material_names.get(index as usize));
            let material = material.map_or_else(String::new, |name| format!(", MATERIAL={}", quoted(name)));
            let orientation = if *framed { ", ORIENTATION=FRAMES" } else { "" };
            self.text(&format!("*SOLID SECTION, ELSET={name}{material}{orientation}"))?;
        }
        Ok(())
    }
}

/// A name that no set of the mesh has.
fn section_name(mesh: &Mesh, number: usize) -> String {
    let mut name = format!("_SECTION-{number}");
    while mesh.element_sets.keys().any(|other| other.eq_ignore_ascii_case(&name)) {
        name.insert(0, '_');
    }
    name
}

/// The shorter of plain and exponent notation.
fn shortest(x: f64) -> String {
    let (plain, exponent) = (format!("{x:?}"), format!("{x:e}"));
    if plain.len() <= exponent.len() { plain } else { exponent }
}

fn within_20(x: f64) -> String {
    let exact = shortest(x);
    if exact.len() <= 20 {
        return exact;
    }
    // Sign, point, exponent of up to five characters and one digit before the point leave twelve digits.
    (12..17)
        .rev()
        .map(|digits| format!("{x:.digits$e}"))
        .find(|text| text.len() <= 20)
        .unwrap_or_else(|| format!("{x:.11e}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn short_numbers_stay_short() {
        for (x, text) in [(0.0, "0.0"), (-2.785, "-2.785"), (1e-20, "1e-20"), (0.1, "0.1")] {
            assert_eq!(shortest(x), text);
            assert_eq!(within_20(x), text);
        }
    }

    proptest! {
        #[test]
        fn twenty_columns_hold_twelve_digits(x in prop::num::f64::NORMAL) {
            let text = within_20(x);
            prop_assert!(text.len() <= 20, "{}", text);
            let back: f64 = text.parse().unwrap();
            prop_assert!((back / x - 1.0).abs() < 1e-11);
        }
    }
}
