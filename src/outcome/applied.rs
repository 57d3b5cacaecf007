//! What a rule of practice says of two soils, and how far a verdict can be relied on; as they are recorded.

use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::rule_note::RuleText;

/// A filter rule, applied.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct AppliedRule {
    /// Its name for programs, as `sherard-dunnigan`.
    #[serde(default)]
    pub id: String,
    /// Whose rule it is, and what it says.
    pub name: String,
    /// Whose rule it is; empty where nobody is cited, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub authority: String,
    /// What it is a rule of.
    #[serde(default)]
    pub role: RuleRole,
    /// Whether it was made for these soils.
    #[serde(default)]
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
    #[serde(default)]
    pub unit: String,
    /// Whether `limit` is the least that the rule allows instead of the most.
    #[serde(default)]
    pub at_least: bool,
    /// Whether the true limit is not known, and is at most `limit`; on either side of it where `needs` names
    /// sieves that stand far apart.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limit_at_most: bool,
    /// Whether the value keeps the limit; `None` where the rule has no result. Of a rule of continuing
    /// erosion `true` says only that this is not reached: some or excessive erosion is not excluded.
    #[serde(alias = "meets")]
    pub met: Option<bool>,
    /// What is missing for a result; may be empty.
    #[serde(default)]
    pub needs: RuleText,
    /// Where the value is, why the rule was not made for these soils; may be empty.
    #[serde(default)]
    pub note: RuleText,
    /// What the rule was made for.
    #[serde(default)]
    pub applies_to: String,
    /// Its limit in words.
    #[serde(default)]
    pub formula: String,
    /// Where the rule is published.
    pub source: String,
    /// What is left of the filter without the greatest part that it may lose by a rule of internal stability;
    /// `None` of other rules, and in files of earlier versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_finer: Option<WithoutFiner>,
    /// Which verdicts it speaks against where it is not kept.
    #[serde(default)]
    pub speaks_against: String,
    /// Which curve of the filter it read, where that is an envelope of several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub filter_curve: String,
    /// Which curve of the base it read, where that is an envelope of several.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub base_curve: String,
}

impl AppliedRule {
    /// Whether it is a rule of practice that was made for these soils and is not kept.
    pub fn is_broken(&self) -> bool {
        self.applies && self.met == Some(false) && self.role != RuleRole::Walk
    }
}

/// On which side of a value the true one lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub struct WithoutFiner {
    /// The part that is taken out (% of the filter's mass).
    pub percent: f64,
    /// 15 % finer of what is left (mm, or D0F where sizes have no unit).
    pub d15f: f64,
}

/// What a rule limits.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
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
    /// One that is no limit of D15F.
    pub const fn named(name: &'static str) -> Self {
        Self::Named(Cow::Borrowed(name))
    }

    /// Its name for a reader, as it is written.
    pub fn name(&self) -> &str {
        match self {
            Self::D15F => "D15F",
            Self::D15FOverD85B => "D15F/D85B",
            Self::D15FOverD95B => "D15F/D95B",
            Self::Named(name) => name,
        }
    }
}

impl fmt::Display for RuleQuantity {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a rule is a rule of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RuleRole {
    /// The filter retains the base without erosion.
    #[default]
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

impl RuleRole {
    /// Which verdicts a rule of this role speaks against where it is not kept.
    pub fn speaks_against(self) -> &'static str {
        match self {
            Self::Retention => "a verdict of no erosion",
            Self::Continuation => "a verdict of no or of some erosion",
            Self::Stability => "any verdict: without its fines it is not the filter that was walked",
            Self::Drainage => "building this filter: it may not drain, which says nothing of retention",
            Self::Placing => {
                "building this filter: it may segregate when placed, which says nothing of retention"
            }
            Self::Walk => "no verdict",
        }
    }
}

/// How far a verdict can be relied on; the worst is the greatest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub enum Confidence {
    /// The model was checked for such soils, and no rule of practice speaks against the verdict.
    #[serde(rename = "within checked range")]
    Within,
    /// "No erosion", but practice would not place such a filter.
    #[serde(rename = "may segregate")]
    MaySegregate,
    /// The model was not checked for such soils.
    #[default]
    #[serde(rename = "outside checked range")]
    Outside,
    /// "No erosion", but the filter may not drain the base: that says nothing of retention.
    #[serde(rename = "may not drain")]
    MayNotDrain,
    /// The filter may lose its own fines, and is then not the filter that was walked.
    #[serde(rename = "may lose its own fines")]
    Unstable,
    /// A rule of retention, or of coarser filters, that was made for these soils speaks against it.
    #[serde(rename = "contradicted by practice")]
    Contradicted,
}

impl Confidence {
    /// All of them that are a doubt, the worst first.
    pub const DOUBTS: [Self; 5] =
        [Self::Contradicted, Self::Unstable, Self::MayNotDrain, Self::Outside, Self::MaySegregate];

    /// Whether a probability would say more than anybody can answer for.
    pub fn hides_probability(self) -> bool {
        matches!(self, Self::Outside | Self::Contradicted)
    }

    /// Its name in `outcome.json`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Within => "within checked range",
            Self::MaySegregate => "may segregate",
            Self::Outside => "outside checked range",
            Self::MayNotDrain => "may not drain",
            Self::Unstable => "may lose its own fines",
            Self::Contradicted => "contradicted by practice",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Folders and ledgers of earlier versions have three of them.
    #[test]
    fn every_label_is_read_back_by_its_words() {
        for label in Confidence::DOUBTS.into_iter().chain([Confidence::Within]) {
            let text = serde_json::to_string(&label).unwrap();
            assert_eq!(text, format!("\"{}\"", label.words()));
            assert_eq!(serde_json::from_str::<Confidence>(&text).unwrap(), label);
        }
        assert!(
            Confidence::DOUBTS.is_sorted_by(|a, b| a > b)
                && !Confidence::DOUBTS.contains(&Confidence::Within)
        );
        let old = serde_json::json!({
            "name": "Permeability", "role": "drainage", "quantity": "D15F", "value": 1.0, "limit": 2.0,
            "met": false, "source": ""
        });
        let rule: AppliedRule = serde_json::from_value(old).unwrap();
        assert!(rule.role == RuleRole::Drainage && !rule.limit_at_most);
        assert_eq!(rule.quantity, RuleQuantity::D15F);
    }

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
