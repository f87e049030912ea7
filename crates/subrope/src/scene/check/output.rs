//! Checks of where results go, and of the names that stand in them.

use std::path::Component;

use super::{Checker, top};
use crate::document::Location;

impl Checker<'_> {
    /// A scene may come from anywhere: what it names lies beside it. Any other folder is for the command line to choose.
    pub(super) fn output(&mut self) {
        let Some(folder) = &self.scene.output.folder else { return };
        let inside = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        if !folder.components().all(inside) || folder.as_os_str().is_empty() {
            let cause = format!("the folder \"{}\" does not lie below that of the scene", folder.display());
            let help = "give a relative path without \"..\"; `subrope run --out FOLDER` writes anywhere";
            self.inconsistent(&top("output").at("folder"), cause, help);
        }
    }

    /// A name that stands at the top of columns.
    pub(super) fn heading(&mut self, at: &Location, name: &str, help: &str) {
        if name.contains(|c: char| !(c.is_alphanumeric() || "_-+ ".contains(c)))
            || name.trim() != name
            || name.is_empty()
        {
            let cause = format!("the name \"{name}\" cannot head a column of history.csv");
            self.inconsistent(at, cause, help);
        }
    }
}
