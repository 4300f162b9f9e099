//! The source of a case: the text of its file, and the settings that lie over it.

use std::path::Path;

use super::mistake::{CaseError, CaseMistake, Place};

/// A file, its text, and what is set over it. Places in the settings come after those in the text.
#[derive(Clone, Copy)]
pub struct Source<'s> {
    pub file: &'s Path,
    pub text: &'s str,
    pub settings: &'s [String],
}

impl<'s> Source<'s> {
    /// `mistake` at the byte `start`, or in the file as a whole.
    pub fn wrong(&self, start: Option<usize>, mistake: CaseMistake) -> CaseError {
        let setting = start.and_then(|start| self.setting_at(start));
        let before = start.and_then(|start| self.text.get(..start));
        let place = match (setting, before) {
            (Some(setting), _) => Place::Setting(setting.to_owned()),
            (None, Some(before)) => Place::Line(before.matches('\n').count() + 1),
            (None, None) => Place::File,
        };
        CaseError { file: self.file.to_owned(), place, mistake: Box::new(mistake) }
    }

    /// The setting in which the byte `start` lies, if it lies behind the file.
    pub fn setting_at(&self, start: usize) -> Option<&'s str> {
        let mut end = self.text.len();
        self.settings.iter().map(String::as_str).find(|setting| {
            let begin = end;
            end += 1 + setting.len();
            // A word in quotes that it was given without reaches two bytes further; no key or value begins there.
            begin < start && start <= end
        })
    }
}
