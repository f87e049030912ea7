//! A scene file with what belongs to it.

use std::path::{Path, PathBuf};

use sha2::{Digest as _, Sha256};
use subrope_io::input;

use super::check;
use super::sets::DeckNames;
use super::{Scene, SceneError};
use crate::document::{self, Document, InvalidDocument, Location, Problem, ProblemKind};

/// A checked scene, where it came from, and the fingerprint of everything it depends on.
#[derive(Clone, Debug)]
pub struct SceneFile {
    /// The scene.
    pub scene: Scene,
    /// The file.
    pub path: PathBuf,
    /// Its text, for provenance.
    pub text: String,
    /// The deck, if there is one, relative to the working folder.
    pub deck: Option<PathBuf>,
    /// SHA-256 of the bytes of the scene file followed by those of the deck, in hexadecimal.
    pub hash: String,
}

impl SceneFile {
    /// Reads and checks a scene file and looks into the deck it refers to.
    ///
    /// # Errors
    /// [`SceneError::Read`] when the file cannot be read, [`SceneError::Invalid`] with all problems found in it.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        let bytes = input::read_bytes(path, input::MAX_TEXT);
        let bytes = bytes.map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
        Self::of_bytes(path, bytes, |deck| input::read_bytes(deck, MAX_DECK))
    }

    /// The same from bytes; `read` gives those of the deck.
    ///
    /// # Errors
    /// As [`SceneFile::load`].
    pub fn of_bytes(
        path: &Path,
        bytes: Vec<u8>,
        read: impl FnOnce(&Path) -> std::io::Result<Vec<u8>>,
    ) -> Result<Self, SceneError> {
        let name = path.display().to_string();
        let text = text_of(&name, bytes)?;
        let (scene, document) = document::read::<Scene>(&name, &text)?;
        let deck = scene.deck.as_ref().map(|deck| folder_of(path).join(&deck.file));
        let content = match &deck {
            Some(file) => Some(deck_content(file, read(file), &document)?),
            None => None,
        };
        document.reject(check::check(&scene, &document, content.as_ref().map(|c| &c.names)))?;
        let hash = fingerprint([text.as_bytes(), content.as_ref().map_or(&[], |c| c.bytes.as_slice())]);
        Ok(Self { scene, path: path.to_owned(), text, deck, hash })
    }

    /// The folder that relative paths in the scene start from.
    #[must_use]
    pub fn folder(&self) -> &Path {
        folder_of(&self.path)
    }

    /// The folder for results: the scene's own choice, or `out/NAME` beside the scene NAME.toml.
    #[must_use]
    pub fn output_folder(&self) -> PathBuf {
        let stem = self.path.file_stem().unwrap_or_default();
        let own = self.scene.output.folder.clone().unwrap_or_else(|| Path::new("out").join(stem));
        self.folder().join(own)
    }
}

/// Longest deck \[bytes\].
const MAX_DECK: u64 = 4 << 30;

/// A deck's bytes and the names in it.
struct DeckContent {
    bytes: Vec<u8>,
    names: DeckNames,
}

fn folder_of(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

/// Scene text is UTF-8; a byte that is not is shown where it stands.
fn text_of(name: &str, bytes: Vec<u8>) -> Result<String, SceneError> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
        let kind = ProblemKind::Syntax { message: "the file is not UTF-8 text".to_owned() };
        InvalidDocument::at(name, &text, valid, kind).into()
    })
}

fn deck_content(file: &Path, bytes: std::io::Result<Vec<u8>>, document: &Document) -> Result<DeckContent, SceneError> {
    let refused = |cause, help| document.invalid(vec![unusable(document, cause, help)]);
    let bytes = bytes.map_err(|error| {
        refused(format!("cannot read the deck {}: {error}", file.display()), "the path is relative to the scene file")
    })?;
    let names = DeckNames::scan(&String::from_utf8_lossy(&bytes));
    if names.lacks_mesh() {
        let cause = format!("{} is no deck: it holds no *NODE and no *ELEMENT", file.display());
        return Err(refused(cause, "a deck is the text of an Abaqus or CalculiX input file (.inp)").into());
    }
    Ok(DeckContent { bytes, names })
}

fn unusable(document: &Document, cause: String, help: &str) -> Problem {
    let at = Location::root().at("deck").at("file");
    document.problem(&at, ProblemKind::UnusableFile { cause }).help(help)
}

fn fingerprint(parts: [&[u8]; 2]) -> String {
    let mut hasher = Sha256::new();
    for part in parts {
        hasher.update(part);
    }
    hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
