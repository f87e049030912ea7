//! Errors on a terminal, with colours and frames.

use std::fmt;

use miette::{Diagnostic, GraphicalReportHandler, LabeledSpan, SourceCode};

use crate::Error;
use crate::document::{InvalidDocument, Problem};
use crate::point::PointError;
use crate::scene::SceneError;
use crate::stress::StressError;
use crate::study::StudyError;

/// The whole error; the problems of a document one after the other, each with its place.
pub(super) fn graphical(error: &Error) -> Result<String, fmt::Error> {
    let handler = GraphicalReportHandler::new();
    let mut text = String::new();
    match error {
        Error::Scene(SceneError::Invalid(document))
        | Error::Point(PointError::Invalid(document))
        | Error::Study(StudyError::Invalid(document))
        | Error::Stress(StressError::Invalid(document)) => {
            located(document).try_for_each(|problem| handler.render_report(&mut text, &problem))?;
        }
        other => handler.render_report(&mut text, other)?,
    }
    Ok(text)
}

fn located(document: &InvalidDocument) -> impl Iterator<Item = Located<'_>> {
    document.problems().iter().map(|problem| Located { problem, document })
}

/// A problem together with the text it stands in.
#[derive(Debug)]
struct Located<'a> {
    problem: &'a Problem,
    document: &'a InvalidDocument,
}

impl fmt::Display for Located<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.problem.fmt(f)
    }
}

impl std::error::Error for Located<'_> {}

impl Diagnostic for Located<'_> {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.problem.help()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        self.problem.labels()
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.document.source_code()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_is_told_once_with_its_line() {
        let wrong = "title = \"x\"\n[strand]\nradus = 1.0\n";
        let error = Error::from(crate::scene::Scene::from_toml("bad.toml", wrong).unwrap_err());
        let text = graphical(&error).unwrap();
        assert_eq!(text.matches("unknown key `radus`").count(), 1, "{text}");
        assert!(text.contains("bad.toml:3:1") && text.contains("radus = 1.0"), "{text}");
    }
}
