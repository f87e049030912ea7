//! The parsers on bytes in memory. Each of them may answer anything but a panic; none opens or writes a file.
//!
//! The tests of the workspace run the same functions on the corpus.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use subrope::estimate::SizeEstimate;
use subrope::model::RopeModel;
use subrope::point::{self, FailedPointFile, PathFile, PathScene};
use subrope::scene::{Program, Scene, SceneFile};
use subrope::study::StudyFile;
use subrope_fem::{FemError, StateError, StateReader};
use subrope_io::{CheckpointReader, parse_deck_of, parse_history};

/// A small strand with friction, the model that checkpoints are taken up by.
const TINY: &str = r#"title = "tiny"
[strand]
radius = 2.0
length = 3.0
surface_angle = 20.0
mesh = { core = 2, rings = 1, layers = 1 }
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
K_c = 60.0
K_t = 15.0
K_l = 20.0
tau_t = 0.05
tau_l = 1.0
[[end]]
name = "END_A"
[[end]]
name = "END_B"
[[step]]
name = "pull"
tension = { elongation = 0.01 }
"#;

/// A deck of one brick, for scenes that name one.
const BRICK: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n\
                     *ELEMENT,TYPE=C3D8\n1,1,2,3,4,5,6,7,8\n*NSET,NSET=END_A\n1,2,3,4\n*NSET,NSET=END_B\n5,6,7,8\n";

/// Elements and steps up to which a scene is made into a model.
const FEW: f64 = 64.0;

/// A scene: read, checked, counted; made into a model when it is a small strand.
pub fn scene(data: &[u8]) {
    let path = Path::new("scene.toml");
    let file = match SceneFile::of_bytes(path, data.to_vec(), |_| Ok(BRICK.as_bytes().to_vec())) {
        Ok(file) => file,
        Err(error) => return told(&error.plain()),
    };
    let folder = file.output_folder();
    assert!(folder.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)), "{folder:?}");
    let size = SizeEstimate::of(&file.scene);
    assert!(size.bytes > 0.0, "{size:?}");
    if size.steps <= FEW {
        let program = Program::new(&file.scene);
        for motion in program.steps.iter().flat_map(|step| &step.motions) {
            let _ = motion.path.value(0.5, 0.0);
        }
    }
    // Strands of a rope that touch take a search, a hundred times the rest.
    if file.scene.strand.is_some()
        && size.elements <= FEW
        && size.steps <= FEW
        && let Err(error) = RopeModel::new(&file, Some(1))
    {
        told(&error.to_string());
    }
}

/// A deck, and after lines `//// NAME` the files it may include; or, after `!`, what a scene wants to know of one.
pub fn deck(data: &[u8]) {
    if let Some(deck) = data.strip_prefix(b"!") {
        let (begin, _) = TINY.split_once("[strand]").unwrap_or_default();
        let (_, end) = TINY.split_once("[law]").unwrap_or_default();
        let scene = format!("{begin}deck = {{ file = \"a.inp\", fibres = \"deck\" }}\n[law]{end}");
        if let Err(error) = SceneFile::of_bytes(Path::new("a.toml"), scene.into_bytes(), |_| Ok(deck.to_vec())) {
            told(&error.plain());
        }
        return;
    }
    let (mut texts, mut name) = (BTreeMap::new(), PathBuf::from("main.inp"));
    for line in data.split_inclusive(|byte| *byte == b'\n') {
        match line.strip_prefix(b"//// ") {
            Some(next) => name = PathBuf::from(String::from_utf8_lossy(next).trim()),
            None => texts.entry(name.clone()).or_insert_with(Vec::new).extend_from_slice(line),
        }
    }
    match parse_deck_of(Path::new("main.inp"), &texts) {
        Err(error) => told(&error.to_string()),
        // What the parser accepts is whole; whether bricks are inverted is for the mesh to tell.
        Ok(deck) => deck.mesh.validate().unwrap_or_else(|error| panic!("{error}")),
    }
}

/// Tables of numbers and files of points and studies; the first byte says which.
pub fn table(data: &[u8]) {
    let Some((first, rest)) = data.split_first() else { return };
    let Ok(text) = std::str::from_utf8(rest) else { return };
    match first {
        b'f' => match FailedPointFile::from_toml("failed_point.toml", text) {
            Ok(file) => file.iter().for_each(|file| told(&file.replay().unwrap_or_else(|error| error.to_string()))),
            Err(error) => told(&subrope::Error::from(error).plain()),
        },
        b't' => match PathScene::from_toml("point.toml", text) {
            Ok(scene) if scene.steps() <= FEW => {
                if let Ok(paths) = scene.path_file("point.toml") {
                    point_answers(&paths);
                }
            }
            Ok(_) => {}
            Err(error) => told(&subrope::Error::from(error).plain()),
        },
        b'j' => match point::parse_json("point.json", text) {
            Ok(paths) => point_answers(&paths),
            Err(error) => told(&subrope::Error::from(error).plain()),
        },
        b's' => {
            let read = |_: &Path| Ok(TINY.as_bytes().to_vec());
            let load = |path: &Path| SceneFile::of_bytes(path, TINY.as_bytes().to_vec(), |_| Ok(Vec::new()));
            if let Err(error) = StudyFile::of_text(Path::new("study.toml"), text, read, load) {
                told(&error.plain());
            }
        }
        _ => match parse_history(Path::new("history.csv"), text) {
            Ok(history) => assert!(history.rows.iter().all(|row| row.len() == history.columns.len())),
            Err(error) => told(&error.to_string()),
        },
    }
}

/// A law asked along the paths, when these are short, and what it answers written as text.
fn point_answers(paths: &PathFile) {
    if paths.paths.iter().map(|path| path.steps.len()).sum::<usize>() > FEW as usize {
        return;
    }
    match point::compute("point", paths, false) {
        Ok(computed) => {
            told(&point::to_csv(&computed));
            let _ = point::to_json(&computed);
        }
        Err(error) => told(&error.to_string()),
    }
}

/// A checkpoint: read whole, every section asked for, and taken up by a small model.
pub fn checkpoint(data: &[u8]) {
    let reader = match CheckpointReader::of_bytes(Path::new("checkpoint"), data.to_vec()) {
        Ok(reader) => reader,
        Err(error) => return told(&error.to_string()),
    };
    for name in ["version", "scene", "stable", "elapsed"] {
        let _ = (reader.text(name), reader.counts(name), reader.numbers(name));
    }
    if let Err(error) = taken_up(&Sections(&reader)) {
        told(&error.to_string());
    }
}

/// A state taken up by the small model, made once.
pub fn taken_up(state: &dyn StateReader) -> Result<(), FemError> {
    thread_local! {
        static MODEL: RefCell<Option<RopeModel>> = const { RefCell::new(None) };
    }
    MODEL.with_borrow_mut(|model| model.get_or_insert_with(tiny).analysis.restore(state))
}

/// The model of [`checkpoint`], for whoever makes seeds.
pub fn tiny() -> RopeModel {
    let scene = Scene::from_toml("tiny.toml", TINY).unwrap_or_else(|error| panic!("{}", error.plain()));
    RopeModel::from_scene(&scene, None, Some(1)).unwrap_or_else(|error| panic!("{error}"))
}

/// The sections of a checkpoint as a state.
pub struct Sections<'a>(pub &'a CheckpointReader);

impl StateReader for Sections<'_> {
    fn numbers(&self, name: &str) -> Result<Vec<f64>, StateError> {
        self.0.numbers(name).map_err(StateError::access)
    }

    fn read_numbers(&self, name: &str, into: &mut [f64]) -> Result<(), StateError> {
        self.0.read_numbers(name, into).map_err(StateError::access)
    }

    fn counts(&self, name: &str) -> Result<Vec<u64>, StateError> {
        self.0.counts(name).map_err(StateError::access)
    }
}

/// A message says something.
fn told(message: &str) {
    assert!(!message.trim().is_empty(), "an empty message");
}
