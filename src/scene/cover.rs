//! What a scene says of the sheet that is handed in.

use super::About;
use crate::outcome::record::SheetCover;

impl About {
    /// The cover of the sheet, without a date where none is stated.
    pub fn cover(&self) -> SheetCover {
        SheetCover {
            project: self.project.clone(),
            number: self.number.clone(),
            purpose: self.purpose.clone(),
            client: self.client.clone(),
            author: self.author.clone(),
            checker: self.checker.clone(),
            revision: self.revision.clone(),
            date: self.date.clone(),
        }
    }
}
