//! The answer of a design: how coarse the filter may be, which of walk and practice set it, and why.
//!
//! The limit of practice is the strictest rule of retention that was made for the base: as a rule Sherard and
//! Dunnigan's limit of design, and Foster and Fell's boundary of no erosion where that is lower, as for 35 to
//! 40 % fines. No specification allows a filter with which tests saw erosion.

mod case;
mod sizes;
#[cfg(test)]
mod tests;
mod words;

use super::specification::DESIGN_AGAIN;
use super::washout::washout;
use crate::outcome::design::band::SetBy;
use crate::outcome::design::{Design, DesignAnswer, Specification};
use crate::outcome::record::{AppliedRule, WithoutFiner};
use case::Case;
pub use case::FinestBase;
use sizes::Sizes;
use words::{CaseWords, words};

/// The answer of a design whose boundaries and rules are known; `finest` is what practice says for the
/// inverse, where that was searched.
pub fn design_answer(design: &Design, finest: Option<&FinestBase>) -> DesignAnswer {
    let sizes = Sizes::of(design);
    let case = Case::of(design, &sizes, finest);
    let ratio = case.ratio();
    let size = |ratio: f64| sizes.mm(ratio);
    let CaseWords { limit, walk } = words(&case, design, &sizes);
    let answer = DesignAnswer {
        d15f_max_mm: ratio.filter(|_| !design.inverse).and_then(size),
        d85b_min_mm: ratio.filter(|_| design.inverse).and_then(size),
        d15f_over_d85b: ratio,
        set_by: if case.rule().is_some() { SetBy::Practice } else { SetBy::Walk },
        rule: case.rule().map(|rule| rule.id.clone()),
        limit,
        washout: of_washout(&case, design, finest),
        margin: None,
        walk,
        if_dispersive: None,
        said: String::new(),
    };
    answer.joined()
}

/// What is left of a filter of the shape as given at the limit of a case, where it is not internally stable
/// and then too coarse; for the inverse what `finest` counted of it.
fn of_washout(case: &Case, design: &Design, finest: Option<&FinestBase>) -> Option<String> {
    if let Some(of) = finest {
        return of.washout.clone();
    }
    // A filter of one shape keeps it at every size: what is left grows with its D15F.
    let times = case.spoken_of().filter(|_| design.rules_at > 0.0)? / design.rules_at;
    let scaled = |rule: &AppliedRule| {
        let left = rule.without_finer.map(|left| WithoutFiner { d15f: times * left.d15f, ..left });
        AppliedRule { without_finer: left.filter(|_| !design.inverse).or(rule.without_finer), ..rule.clone() }
    };
    let rules: Vec<AppliedRule> = design.rules.iter().map(scaled).collect();
    let of = washout(&rules)?;
    Some(format!("The filter as given is not internally stable: it has this D15F{}", of.as_placed()))
}

impl DesignAnswer {
    /// The same, with what stands beside it where the specification knows the base: that its limit has no
    /// margin, and what holds if the base is dispersive.
    pub fn specified(self, specification: Option<&Specification>) -> Self {
        let margin = specification.and_then(Specification::without_margin_in_words);
        let if_dispersive = specification.and_then(|of| of.if_dispersive_in_words(DESIGN_AGAIN));
        Self { margin, if_dispersive, ..self }.joined()
    }

    fn joined(self) -> Self {
        let beside = [&self.washout, &self.margin, &self.walk, &self.if_dispersive].into_iter().flatten();
        let said: Vec<&str> = [&self.limit].into_iter().chain(beside).map(String::as_str).collect();
        Self { said: said.join(". "), ..self }
    }
}

impl Design {
    /// The answer, worked out where it is not yet.
    pub fn answer(&self) -> DesignAnswer {
        let specified = || design_answer(self, None).specified(self.specification.as_ref());
        self.answer.clone().unwrap_or_else(specified)
    }

    /// What the walk is worth beside a limit of practice that sets the answer, in short: a sentence.
    pub fn walk_beside_practice(&self) -> String {
        self.answer().walk.map_or_else(String::new, |said| format!("{said}."))
    }
}
