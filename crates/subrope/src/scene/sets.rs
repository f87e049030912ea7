//! Names of the sets in an Abaqus deck, found without reading the mesh.

use std::collections::BTreeSet;

/// Names in a deck, as written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct DeckNames {
    /// Node sets.
    pub sets: BTreeSet<String>,
    /// Surfaces.
    pub surfaces: BTreeSet<String>,
    /// Whether the deck includes other files, whose names are not seen.
    pub includes: bool,
    /// Whether nodes or elements were seen.
    mesh: bool,
}

impl DeckNames {
    /// Scans the keyword lines of a deck.
    pub fn scan(text: &str) -> Self {
        let mut names = Self::default();
        for line in text.lines().filter(|l| l.starts_with('*') && !l.starts_with("**")) {
            let mut parts = line.split(',').map(str::trim);
            let keyword = parts.next().unwrap_or_default().to_ascii_uppercase();
            names.includes |= keyword == "*INCLUDE";
            names.mesh |= keyword == "*NODE" || keyword == "*ELEMENT";
            for (parameter, value) in parts.filter_map(|p| p.split_once('=')) {
                names.note(&keyword, &parameter.trim().to_ascii_uppercase(), value.trim().trim_matches('"'));
            }
        }
        names
    }

    /// Whether there is no mesh, neither in the deck nor possibly in a file it includes.
    pub fn lacks_mesh(&self) -> bool {
        !self.mesh && !self.includes
    }

    fn note(&mut self, keyword: &str, parameter: &str, value: &str) {
        match (keyword, parameter) {
            ("*NODE" | "*NSET", "NSET") => self.sets.insert(value.to_owned()),
            ("*SURFACE", "NAME") => self.surfaces.insert(value.to_owned()),
            _ => false,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::DeckNames;

    #[test]
    fn names_are_found() {
        let deck = "*HEADING\nx\n*NODE, NSET=all_nodes\n1, 0, 0, 0\n** *NSET, NSET=NOT\n\
                    *element, type=C3D8, elset = STRAND\n*NSET, NSET=END_A, GENERATE\n\
                    *SURFACE, NAME=\"Top face\", TYPE=ELEMENT\n";
        let names = DeckNames::scan(deck);
        assert_eq!(names.sets.iter().map(String::as_str).collect::<Vec<_>>(), ["END_A", "all_nodes"]);
        assert!(names.surfaces.contains("Top face"));
        assert!(!names.includes && !names.lacks_mesh());
        assert!(DeckNames::scan("title = \"a scene\"\n").lacks_mesh());
        assert!(!DeckNames::scan("*Include, input=mesh.inp\n").lacks_mesh());
    }
}
