//! All members once, then all again: a machine that gets slower or faster meanwhile does so for all of them.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

use subrope_io::atomic::write_atomically;

use super::child::{self, Launch};
use super::file::{ReferenceKind, StudyFile};
use super::machine::Machine;
use super::sample::Sample;
use super::{StudyError, StudyObserver};
use crate::scene::SceneFile;

/// What the runs of a member gave.
#[derive(Clone, Debug, Default)]
pub(super) struct Runs {
    /// One per run that ended well.
    pub samples: Vec<Sample>,
    /// Why it failed.
    pub failure: Option<String>,
}

/// A study that runs.
pub(super) struct Rounds<'a> {
    pub file: &'a StudyFile,
    /// The `subrope` program.
    pub program: &'a Path,
    pub folder: &'a Path,
    pub repeats: usize,
    /// Take what an earlier study in the folder has finished.
    pub resume: bool,
    pub interrupt: Option<&'a AtomicBool>,
}

impl Rounds<'_> {
    /// Writes the scenes of all members and runs them; whether the user stopped it.
    pub fn run(
        &self,
        machine: &mut Machine,
        observer: &mut dyn StudyObserver,
    ) -> Result<(Vec<Runs>, bool), StudyError> {
        let scenes = self.file.members.iter().map(|m| self.write_scene(m)).collect::<Result<Vec<_>, _>>()?;
        let once = self.reference_member();
        let mut runs = vec![Runs::default(); scenes.len()];
        for round in 0..self.repeats {
            machine.calibrate();
            for (index, scene) in scenes.iter().enumerate() {
                if runs[index].failure.is_some() || (round > 0 && (once == Some(index) || self.is_long(&runs[index]))) {
                    continue;
                }
                observer.on_run(&self.file.members[index].name, round + 1, self.repeats);
                let result = self.one(index, round, scene)?;
                if self.stopped() && result.is_err() {
                    observer.on_result(Err("interrupted"));
                    return Ok((runs, true));
                }
                observer.on_result(
                    result.as_ref().map(|s| s.cpu().or(s.wall()).unwrap_or_default()).map_err(String::as_str),
                );
                match result {
                    Ok(sample) => runs[index].samples.push(sample),
                    Err(reason) => runs[index].failure = Some(reason),
                }
                if self.stopped() {
                    return Ok((runs, true));
                }
            }
        }
        machine.calibrate();
        Ok((runs, false))
    }

    fn stopped(&self) -> bool {
        self.interrupt.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Whether a member takes so long that one run tells enough.
    fn is_long(&self, runs: &Runs) -> bool {
        let limit = self.file.study.repeat_below.unwrap_or(f64::INFINITY);
        runs.samples.first().and_then(Sample::wall).is_some_and(|seconds| seconds > limit)
    }

    /// The member that all others are compared with; its own time is of no use.
    fn reference_member(&self) -> Option<usize> {
        let study = &self.file.study;
        let reference = study.reference.as_ref().filter(|r| r.kind == ReferenceKind::Finest)?;
        if study.quantity.iter().any(|q| q.value.is_some()) {
            return None;
        }
        let family =
            self.file.families.iter().find(|f| reference.series.as_ref().is_none_or(|name| f.name == *name))?;
        family.members.last().copied()
    }

    fn member_folder(&self, member: &super::Member) -> PathBuf {
        self.folder.join("members").join(&member.folder)
    }

    /// A scene that stands there already is left alone.
    fn write_scene(&self, member: &super::Member) -> Result<PathBuf, StudyError> {
        let folder = self.member_folder(member);
        std::fs::create_dir_all(&folder).map_err(|source| StudyError::File { path: folder.clone(), source })?;
        let path = folder.join("scene.toml");
        if std::fs::read_to_string(&path).is_ok_and(|text| text == member.text) {
            return Ok(path);
        }
        write_atomically(&path, member.text.as_bytes()).map_err(subrope_io::IoError::from)?;
        Ok(path)
    }

    fn one(&self, index: usize, round: usize, scene: &Path) -> Result<Result<Sample, String>, StudyError> {
        let study = &self.file.study;
        let folder = self.member_folder(&self.file.members[index]).join(format!("run_{}", round + 1));
        if self.resume
            && let Ok(file) = SceneFile::load(scene)
            && let Some(sample) = Sample::read_again(&folder, &file.hash)
        {
            return Ok(Ok(sample));
        }
        let (threads, time_limit) = (study.threads, study.time_limit);
        let launch = Launch { program: self.program, scene, folder: &folder, threads, time_limit };
        Ok(child::run(launch)?.and_then(|()| Sample::read(&folder)))
    }
}
