//! What belongs to a sheet that is handed in: for whom and by whom it is, and of which day.

use serde::{Deserialize, Serialize};

/// The cover of a sheet, as its author states it.
///
/// ```
/// use voidwalk::outcome::record::SheetCover;
/// let stated = SheetCover { project: Some("Main dam".into()), ..SheetCover::default() };
/// let dated = stated.clone().dated(Some("2026-11-25".into()));
/// assert_eq!(dated.date.as_deref(), Some("2026-11-25"));
/// assert_eq!(SheetCover { date: None, ..dated }, stated);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(default)]
pub struct SheetCover {
    /// The project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub project: Option<String>,
    /// The number of the project.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<String>,
    /// What the sheet is for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub purpose: Option<String>,
    /// The client.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub client: Option<String>,
    /// The author.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author: Option<String>,
    /// Who checked it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checker: Option<String>,
    /// The revision of the sheet.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub revision: Option<String>,
    /// The date on the sheet: the one that is stated, else the day of its results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub date: Option<String>,
}

impl SheetCover {
    /// Whether it says nothing.
    pub fn is_unset(&self) -> bool {
        *self == Self::default()
    }

    /// With the day of its results, where no date is stated.
    pub fn dated(self, day: Option<String>) -> Self {
        Self { date: self.date.or(day), ..self }
    }

    /// What several covers say alike.
    pub fn in_common(all: impl IntoIterator<Item = Self>) -> Self {
        let same = |a: Option<String>, b: Option<String>| a.filter(|a| Some(a) == b.as_ref());
        let both = |a: Self, b: Self| Self {
            project: same(a.project, b.project),
            number: same(a.number, b.number),
            purpose: same(a.purpose, b.purpose),
            client: same(a.client, b.client),
            author: same(a.author, b.author),
            checker: same(a.checker, b.checker),
            revision: same(a.revision, b.revision),
            date: same(a.date, b.date),
        };
        all.into_iter().reduce(both).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn several_covers_have_in_common_what_all_of_them_say() {
        let of = |project: &str, client: Option<&str>| SheetCover {
            project: Some(project.into()),
            client: client.map(str::to_owned),
            ..SheetCover::default()
        };
        let common = SheetCover::in_common([of("Dam", Some("Board")), of("Dam", Some("Board"))]);
        assert_eq!(common, of("Dam", Some("Board")));
        let common = SheetCover::in_common([of("Dam", Some("Board")), of("Dam", None)]);
        assert_eq!(common, of("Dam", None));
        assert!(SheetCover::in_common([of("Dam", None), of("Weir", None)]).is_unset());
        assert!(SheetCover::in_common([]).is_unset());
    }
}
