//! Writes the seeds of fuzzing that are no files of the project: a checkpoint of the small model, a deck with an included
//! file, a study, points: `cargo test --test fuzz_seeds -- --ignored`.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

#[allow(dead_code, reason = "only its model is needed")]
#[path = "../../fuzz/src/parsers.rs"]
mod parsers;

use std::path::{Path, PathBuf};

use subrope_fem::analysis::{Analysis, Control, IncrementRecord, Observer};
use subrope_fem::{FemError, StateError, StateWriter};
use subrope_io::{CheckpointWriter, Writes};

const DECK: &str = "*HEADING\nA brick\n*NODE, NSET=ALL_NODES\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n\
    *INCLUDE, INPUT=top.inp\n*ELEMENT, TYPE=C3D8, ELSET=BRICKS\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=END_A, GENERATE\n1,4,1\n\
    *NSET, NSET=END_B\n5,6,\n7,8\n*NSET, NSET=OF, ELSET=BRICKS\n*ELSET, ELSET=MORE\nBRICKS\n\
    *SURFACE, NAME=TOP, TYPE=ELEMENT\nBRICKS, S2\n*DISTRIBUTION TABLE, NAME=T\nCOORD3D, COORD3D\n\
    *DISTRIBUTION, NAME=D, LOCATION=ELEMENT, TABLE=T\n, 1.,0.,0.,0.,1.,0.\nBRICKS, 0.,0.,1.,1.,0.,0.\n\
    *ORIENTATION, NAME=O, DEFINITION=COORDINATES\nD\n3, 30.\n\
    *SOLID SECTION, ELSET=BRICKS, MATERIAL=YARN, ORIENTATION=O\n,\n*STEP\n//// top.inp\n\
    *NODE, NSET=ALL_NODES\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";

const STUDY: &str = r#"stitle = "A study"
scene = "strand.toml"
repeats = 2
target = 0.01
set = { "solver.growth" = 2.0 }
[reference]
kind = "finest"
series = "layers"
[[quantity]]
name = "force"
[[quantity]]
name = "own"
from = "history:END_B_fz"
at = { column = "time", value = 0.5 }
[[series]]
name = "layers"
levels = { "strand.mesh.layers" = [1, 2, 3] }
sizes = [3.0, 2.0, 1.0]
[[series]]
name = "loads"
each = { "step[0].tension.elongation" = [0.01, 0.02] }
"#;

const PATHS: &str = r#"j{"paths": [{"name": "a", "params": {"K_e": 2000.0, "K_ec": 100.0, "w_e": 0.005, "K_c": 60.0, "nu": 0.5,
"comp_type": 1, "K_p": 10.0, "p_exp": 3.0, "K_t": 15.0, "tau_t0": 0.05, "H_t": 0.1, "mu_t": 0.1, "K_l": 20.0, "tau_l0": 1.0,
"H_inf_l": 0.3, "kappa_s_l": 0.1, "X_l": 1.0}, "frame": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
"state0": [0, 0, 0, 0, 0, 0, 0, 0], "steps": [{"F": [[1.1, 0, 0.2], [0, 1, 0], [0, 0, 0.9]]},
{"H": [[1e-9, 0, 0], [0, 0, 0], [0, 0, 0]]}, {"modes": [0.1, -0.1, 0.2, 0, 0.3, 0]}]}]}"#;

const FAILED: &str = r#"ftitle = "a"
[failure]
message = "m"
element = 1
point = 2
step = 1
increment = 3
time = 0.5
[asked]
H = [[-1.5, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
H_committed = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
mean_elongation = 0.1
frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
state = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
time_increment = 0.1
temperature = 293.15
[law]
kind = "bundle"
K_e = 2000.0
K_ec = 100.0
K_c = 60.0
K_t = 15.0
K_l = 20.0
tau_t = 0.05
tau_l = 1.0
"#;

struct ToFile<'a>(&'a mut CheckpointWriter);

impl StateWriter for ToFile<'_> {
    fn numbers(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = f64>) -> Result<(), StateError> {
        self.0.numbers(name, count, values).map_err(StateError::access)
    }

    fn counts(&mut self, name: &str, count: usize, values: &mut dyn Iterator<Item = u64>) -> Result<(), StateError> {
        self.0.counts(name, count, values).map_err(StateError::access)
    }
}

/// Writes a checkpoint after the first increment and stops.
struct Keep(PathBuf);

impl Observer for Keep {
    fn converged(&mut self, analysis: &Analysis, _: &IncrementRecord) -> Result<Control, FemError> {
        let mut file = CheckpointWriter::create(&self.0, &Writes::default()).unwrap();
        file.bytes("version", 1, &mut "0".as_bytes()).unwrap();
        file.counts("stable", 1, &mut std::iter::once(1)).unwrap();
        analysis.save(&mut ToFile(&mut file))?;
        file.commit().unwrap();
        Ok(Control::Stop)
    }
}

#[test]
#[ignore = "writes into fuzz/seeds"]
fn seeds_are_written() {
    let place = |target: &str, name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/seeds").join(target);
        std::fs::create_dir_all(&folder).unwrap();
        folder.join(name)
    };
    std::fs::write(place("deck", "with_an_include"), DECK).unwrap();
    std::fs::write(place("table", "study"), STUDY).unwrap();
    std::fs::write(place("table", "history"), "htime [s],force [N]\n0.5,-1e-9\n1,2\n").unwrap();
    let point = include_str!("../../scenes/points/friction_loop.toml");
    std::fs::write(place("table", "point"), format!("t{point}")).unwrap();
    std::fs::write(place("table", "paths"), PATHS).unwrap();
    std::fs::write(place("table", "failed"), FAILED).unwrap();
    let mut model = parsers::tiny();
    let step = model.steps[0].clone();
    let stopped = model.analysis.run_step(&step, &mut Keep(place("checkpoint", "tiny")));
    assert!(matches!(stopped, Err(FemError::Interrupted)), "{stopped:?}");
    // The seed that was there before, kept as a run keeps it.
    let _ = std::fs::remove_file(place("checkpoint", "tiny.previous"));
}
