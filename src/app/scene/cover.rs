//! Cover of the sheet that is handed in, from a scene.

use super::About;
use voidwalk_practice::quantity::SizeUnit;
use voidwalk_practice::{AboutPage, SheetCover};

/// Settings of the sheet that are one of a few words, or of the figure: they are not on the cover.
const NO_COVER: [&str; 2] = ["coarse_left", "units"];

impl About {
    /// The full names of the settings of the cover, which are texts.
    pub fn texts() -> Vec<String> {
        let of_cover = Self::keys().into_iter().filter(|key| !NO_COVER.contains(&key.name));
        of_cover.map(|key| key.full_name()).collect()
    }

    /// The page of a run, whose sizes may be multiples of D0F.
    pub fn page(&self, scale_free: bool) -> AboutPage {
        let unit = SizeUnit::of(scale_free, self.shows_inches());
        AboutPage { cover: self.cover(), coarse_left: self.coarse_left == Some(true), unit }
    }

    /// The cover of the sheet; it has no date if the scene states no date.
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
