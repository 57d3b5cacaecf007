//! Rules of practice applied to two soils, as they are recorded.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::rule_note::RuleNote;

/// A filter rule, applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct AppliedRule {
    /// Its name for programs, as `sherard-dunnigan`.
    pub id: String,
    /// Whose rule it is, and what it says.
    pub name: String,
    /// Whose rule it is; empty where nobody is cited.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub authority: String,
    /// Authorities whose texts state it besides; may be empty.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stated_by: Vec<String>,
    /// What it is a rule of.
    pub role: RuleRole,
    /// Whether it was made for these soils.
    pub applies: bool,
    /// What it limits, as `D15F/D85B`.
    pub quantity: RuleQuantity,
    /// Its value for these inputs; `None` where they do not give it.
    pub value: Option<f64>,
    /// On which side of `value` the true one lies, where sieves give only a bound; `None` where it is the
    /// value itself.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value_bound: Option<ValueBound>,
    /// The most, or the least, that the rule allows; `None` where no number is known.
    pub limit: Option<f64>,
    /// Unit of value and limit: `mm`, `D0F`, `%`; empty for a ratio.
    #[cfg_attr(feature = "schemas", schemars(with = "String"))]
    pub unit: RuleUnit,
    /// Whether `limit` is the least that the rule allows instead of the most.
    pub at_least: bool,
    /// Whether the true limit is not known, and is at most `limit`; on either side of it where `needs` names
    /// sieves that stand far apart.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// Whether the value keeps the limit; `None` where the rule has no result. Of a rule of continuing
    /// erosion `true` says only that this is not reached: some or excessive erosion is not excluded.
    pub met: Option<bool>,
    /// What is missing for a result; may be empty.
    pub needs: Vec<RuleNote>,
    /// Where the value is, why the rule was not made for these soils; may be empty.
    pub notes: Vec<RuleNote>,
    /// What the rule was made for.
    pub applies_to: String,
    /// Its limit in words.
    pub formula: String,
    /// Where the rule is published.
    pub source: String,
    /// What is left of the filter without the greatest part that it may lose by a rule of internal stability;
    /// `None` of other rules.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_finer: Option<WithoutFiner>,
    /// Which curve of the filter it read, where that is an envelope of several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub filter_curve: String,
    /// Which curve of the base it read, where that is an envelope of several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub base_curve: String,
}

impl AppliedRule {
    /// Authorities that state the rule: its own first; empty for a check of this program.
    pub fn authorities(&self) -> Vec<&str> {
        let stated_by = self.stated_by.iter().map(String::as_str);
        std::iter::once(self.authority.as_str()).chain(stated_by).filter(|name| !name.is_empty()).collect()
    }

    /// True for a rule of practice that was made for these soils and is not kept.
    pub fn is_broken(&self) -> bool {
        self.applies && self.met == Some(false) && self.role != RuleRole::Walk
    }
}

/// The unit of a rule's value and limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RuleUnit {
    /// Sizes in mm.
    #[serde(rename = "mm")]
    Mm,
    /// Sizes as multiples of D0F.
    #[serde(rename = "D0F")]
    D0f,
    /// A ratio.
    #[serde(rename = "")]
    One,
    /// Percent of the mass.
    #[serde(rename = "%")]
    Percent,
}

impl RuleUnit {
    /// Name of the unit as written.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::D0f => "D0F",
            Self::One => "",
            Self::Percent => "%",
        }
    }
}

/// On which side of a value the true one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum ValueBound {
    /// It is no more than the value.
    #[serde(rename = "at most")]
    AtMost,
    /// It is no less than the value.
    #[serde(rename = "at least")]
    AtLeast,
}

/// What is left of a filter without its finer part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub struct WithoutFiner {
    /// The part that is taken out (% of the filter's mass).
    pub percent: f64,
    /// 15 % finer of what is left (mm, or D0F where sizes have no unit).
    pub d15f: f64,
}

/// What a rule limits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
pub enum RuleQuantity {
    /// A size of the filter.
    D15F,
    /// The filter's size over one of the base.
    #[serde(rename = "D15F/D85B")]
    D15FOverD85B,
    /// The filter's size over one of the base.
    #[serde(rename = "D15F/D95B")]
    D15FOverD95B,
    /// Anything that is no limit of D15F, by its name.
    #[serde(untagged)]
    Named(Cow<'static, str>),
}

impl RuleQuantity {
    /// A quantity that is not a limit of D15F.
    ///
    /// # Panics
    /// The name belongs to a limit of D15F: a record that is read back would be taken for that limit. For a
    /// rule, which is a constant, this is a compile error.
    pub const fn named(name: &'static str) -> Self {
        let limits = ["D15F", "D15F/D85B", "D15F/D95B"];
        let mut at = 0;
        while at < limits.len() {
            assert!(!is_same(name, limits[at]), "this name is that of a limit of D15F");
            at += 1;
        }
        Self::Named(Cow::Borrowed(name))
    }

    /// Name for a reader.
    pub fn name(&self) -> &str {
        match self {
            Self::D15F => "D15F",
            Self::D15FOverD85B => "D15F/D85B",
            Self::D15FOverD95B => "D15F/D95B",
            Self::Named(name) => name,
        }
    }
}

/// Compares two texts in a constant.
const fn is_same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    let mut at = 0;
    while at < a.len() && at < b.len() && a[at] == b[at] {
        at += 1;
    }
    at == a.len() && at == b.len()
}

impl fmt::Display for RuleQuantity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a rule is a rule of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemas", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RuleRole {
    /// The filter retains the base without erosion.
    Retention,
    /// A coarser filter: erosion ends.
    Continuation,
    /// The filter drains the base.
    Drainage,
    /// The filter can be placed without segregating.
    Placing,
    /// The filter holds its own fines.
    Stability,
    /// The walk itself: it is checked by this, not the filter.
    Walk,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantity_is_written_by_its_name_and_read_back() {
        let sizes = [RuleQuantity::D15F, RuleQuantity::D15FOverD85B, RuleQuantity::D15FOverD95B];
        for quantity in sizes.into_iter().chain([RuleQuantity::named("D100F")]) {
            let text = serde_json::to_string(&quantity).unwrap();
            assert_eq!(text, format!("\"{quantity}\""));
            assert_eq!(serde_json::from_str::<RuleQuantity>(&text).unwrap(), quantity);
        }
    }
}
