//! The file with the fields during a run.

use std::path::Path;

use subrope_fem::analysis::Analysis;
use subrope_io::{
    CheckpointReader, CheckpointWriter, FieldSpec, IoError, Precision, Provenance, ResultImage, ResultWriter,
    WriterOptions,
};

use super::fields::{self, CycleStart, FieldArray, Place};
use super::output::{Opening, Scenery, counts};
use crate::model::{CycleStep, RopeModel};
use crate::scene::SceneFile;

/// Name of the file.
pub const RESULTS: &str = "results.vtkhdf";

/// The file with the fields.
pub struct Fields {
    pub results: ResultWriter,
    arrays: Vec<FieldArray>,
    /// Where the cycle that runs began, if a field wants to know.
    cycle: Option<CycleStart>,
    /// Frames left out because a stress could not be evaluated again.
    pub lost_frames: usize,
}

impl Fields {
    /// Opens the file.
    pub fn open(file: &SceneFile, model: &RopeModel, folder: &Path, opening: Opening<'_>) -> Result<Self, IoError> {
        let scene = &file.scene;
        let arrays = fields::arrays(&scene.output.fields, model);
        let specs: Vec<FieldSpec> = arrays.iter().map(spec).collect();
        let provenance: Provenance = [
            ("version", env!("CARGO_PKG_VERSION").to_string()),
            ("scene", file.text.clone()),
            ("scene_hash", file.hash.clone()),
        ]
        .map(|(name, text)| (name.to_string(), text))
        .into();
        let options = WriterOptions {
            precision: match scene.output.precision {
                crate::scene::Precision::F32 => Precision::F32,
                crate::scene::Precision::F64 => Precision::F64,
            },
            deflate: (scene.output.compression > 0).then_some(scene.output.compression),
        };
        let (path, options) = (folder.join(RESULTS), (options, opening.writes));
        let Some(checkpoint) = opening.from else {
            let results = ResultWriter::create_with(&path, &model.mesh.mesh, &specs, &provenance, options)?;
            return Ok(Self { results, arrays, cycle: None, lost_frames: 0 });
        };
        let image = image(checkpoint, &path)?;
        let mut rest = checkpoint.bytes("results")?;
        let results = ResultWriter::resume(&path, &model.mesh.mesh, &specs, (&image, &mut rest), options)?;
        let [lost_frames] = counts(checkpoint, "lost_frames")?;
        Ok(Self { results, arrays, cycle: cycle_start(checkpoint)?, lost_frames: lost_frames as usize })
    }

    /// Keeps the state of the file, which is closed until its writer goes on, and where the cycle began.
    pub fn save(&mut self, to: &mut CheckpointWriter) -> Result<(), IoError> {
        let image = self.results.pause()?;
        let (value, steps) = (image.last_value.unwrap_or(f64::NAN), image.steps as u64);
        to.counts("results_size", 2, &mut [image.length, steps].into_iter())?;
        to.numbers("results_value", 1, &mut std::iter::once(value))?;
        to.counts("results_places", 2 * image.settled.len(), &mut image.settled.iter().flatten().copied())?;
        to.bytes("results", image.rest_length(), &mut image.rest()?)?;
        to.counts("lost_frames", 1, &mut std::iter::once(self.lost_frames as u64))?;
        let (sliding, friction) = self.cycle.as_ref().map_or((&[][..], &[][..]), CycleStart::parts);
        to.counts("cycle_contacts", 2, &mut [u64::from(self.cycle.is_some()), friction.len() as u64].into_iter())?;
        to.numbers("cycle_sliding", 2 * sliding.len(), &mut sliding.iter().flatten().copied())?;
        for (index, friction) in friction.iter().enumerate() {
            to.numbers(&format!("cycle_friction_{index}"), friction.len(), &mut friction.iter().copied())?;
        }
        Ok(())
    }

    /// Notes where a cycle begins.
    pub fn begin_step(&mut self, half: Option<&CycleStep>, analysis: &Analysis) {
        match half {
            None => self.cycle = None,
            Some(step) if !step.half.rising && fields::want_cycles(&self.arrays) => {
                self.cycle = Some(CycleStart::new(analysis));
            }
            Some(_) => {}
        }
    }

    /// Adds a frame.
    pub fn frame(&mut self, scenery: Scenery<'_>, analysis: &Analysis) -> Result<(), IoError> {
        let cycle = self.cycle.as_ref();
        // The committed state was evaluated a moment ago: a law that fails here would be at the very edge of its range.
        let Ok(values) = fields::values(&self.arrays, scenery.mesh, scenery.cells, analysis, cycle) else {
            self.lost_frames += 1;
            return Ok(());
        };
        let slices: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
        self.results.append(analysis.time(), &slices)
    }
}

fn spec(array: &FieldArray) -> FieldSpec {
    match array.place {
        Place::Node => FieldSpec::point(array.name, array.components),
        Place::Element => FieldSpec::cell(array.name, array.components),
    }
}

/// What brings the file back to a checkpoint.
fn image(checkpoint: &CheckpointReader, path: &Path) -> Result<ResultImage, IoError> {
    let [length, steps] = counts(checkpoint, "results_size")?;
    let mut last = [0.0];
    checkpoint.read_numbers("results_value", &mut last)?;
    let places = checkpoint.counts("results_places")?.as_chunks::<2>().0.to_vec();
    let mut image = ResultImage::new(path, length, places);
    (image.steps, image.last_value) = (steps as usize, Some(last[0]).filter(|v| !v.is_nan()));
    Ok(image)
}

fn cycle_start(checkpoint: &CheckpointReader) -> Result<Option<CycleStart>, IoError> {
    let [known, contacts] = counts(checkpoint, "cycle_contacts")?;
    if known == 0 {
        return Ok(None);
    }
    let sliding = checkpoint.numbers("cycle_sliding")?.as_chunks::<2>().0.to_vec();
    let friction = (0..contacts).map(|i| checkpoint.numbers(&format!("cycle_friction_{i}")));
    Ok(Some(CycleStart::of_parts(sliding, friction.collect::<Result<_, _>>()?)))
}
