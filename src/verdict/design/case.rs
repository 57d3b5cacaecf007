//! Which of walk and practice sets the answer of a design: one case with its numbers.

use super::sizes::Sizes;
use crate::outcome::design::band::{open_retention, retaining, retention};
use crate::outcome::design::{Design, DesignRow};
use crate::outcome::record::AppliedRule;
use crate::outcome::rules::DESIGN;
use crate::verdict::rule_words::against;
use crate::verdict::washout::washout;

/// The finest base that practice allows with a filter, for the inverse.
#[derive(Clone, Debug, PartialEq)]
pub struct FinestBase {
    /// D15F/D85B up to which every rule of retention is known to be kept; `None` where that is so of no base
    /// that was searched.
    pub ratio: Option<f64>,
    /// The rule that a finer base breaks, or may break.
    pub rule: AppliedRule,
    /// Whether it may break it: of the limit only the most is known.
    pub is_open: bool,
    /// What is left of a filter that is not internally stable, where that breaks the rule: a sentence without
    /// its end. `None` where the filter as placed breaks it.
    pub washout: Option<String>,
}

impl FinestBase {
    /// Where a base breaks, or may break, a rule of retention of these, with the filter as placed or without
    /// the finer part that it may lose; `kept` is the ratio up to which every base kept all. `None` where it
    /// keeps all.
    pub fn at(rules: &[AppliedRule], kept: Option<f64>) -> Option<Self> {
        let broken = retaining(rules).find(|rule| rule.is_broken());
        let washout = washout(rules);
        let d15f = rules.iter().find(|rule| rule.id == DESIGN).and_then(|rule| rule.value).unwrap_or(1.0);
        let strictest = retention(rules, d15f).map(|(rule, _)| rule).filter(|_| washout.is_some());
        let rule = broken.or(strictest);
        let (rule, is_open) = match rule {
            Some(rule) => (rule, false),
            None => (open_retention(rules)?, true),
        };
        let washout = washout.map(|of| {
            let placed = rules.iter().find(|rule| rule.id == DESIGN);
            let placed = placed.map_or_else(String::new, |rule| {
                let [value, _] = against(rule, 3);
                value
            });
            format!(
                "The filter as given is not internally stable: its D15F is {placed}{}, and the limit of \
                 practice allows for that",
                of.as_placed()
            )
        });
        Some(Self { ratio: kept, rule: rule.clone(), is_open, washout })
    }
}

/// A limit of D15F/D85B, and the rule that sets it.
#[derive(Clone, Copy)]
pub(super) struct Limit<'a> {
    pub ratio: f64,
    pub rule: &'a AppliedRule,
    /// Whether it is only not known if practice allows more.
    pub may_be_more: bool,
}

/// Which of the cases holds, each with its numbers; ratios are D15F/D85B.
pub(super) enum Case<'a> {
    /// Practice allows no base that was searched.
    Forbidden(&'a AppliedRule),
    /// Of the limit of practice only the most is known, for want of this; the walk may hold a ratio.
    Open(Limit<'a>, &'a AppliedRule, Option<f64>),
    /// The same of every base that was searched, for the inverse.
    OpenBase(&'a AppliedRule, Option<f64>),
    /// Neither walk nor practice knows a ratio.
    Unknown,
    /// The walk has no answer: the finest tail of the base, this share of its mass, may be anything.
    TailOpen(Limit<'a>, f64),
    /// Practice allows less than the least ratio that was walked, at which networks erode.
    BelowSearch(Limit<'a>, f64),
    /// No ratio is known that nearly all networks hold, and practice alone allows one.
    NotHeld(Limit<'a>),
    /// Practice allows no more than nearly all networks hold.
    Practice(Limit<'a>),
    /// Nearly all networks of a row hold less than practice allows.
    Walk(&'a DesignRow, f64, Limit<'a>),
    /// Nearly all networks of a row hold this, and no limit of practice is known.
    ModelAlone(&'a DesignRow, f64),
}

/// The strictest rule of retention of a design, with its limit of D15F.
pub(super) fn strictest<'a>(design: &'a Design, sizes: &Sizes) -> Option<(&'a AppliedRule, f64)> {
    retention(&design.rules, design.rules_at * sizes.d85)
}

impl<'a> Case<'a> {
    pub fn of(design: &'a Design, sizes: &Sizes, finest: Option<&'a FinestBase>) -> Self {
        let none = finest.filter(|of| of.ratio.is_none());
        if let Some(of) = none.filter(|of| of.is_open) {
            return Self::OpenBase(&of.rule, design.least_held().map(|(_, held)| held));
        }
        if let Some(of) = none {
            return Self::Forbidden(&of.rule);
        }
        let limit = match design.inverse {
            true => finest
                .and_then(|of| Some(Limit { ratio: of.ratio?, rule: &of.rule, may_be_more: of.is_open })),
            // Sizes without a unit are taken as a sand without fines: no limit is known of the base itself.
            false if !sizes.has_unit => None,
            false => {
                let limit = |(rule, limit)| Limit { ratio: limit / sizes.d85, rule, may_be_more: false };
                strictest(design, sizes).map(limit)
            }
        };
        let open = open_retention(&design.rules).filter(|_| sizes.has_unit && !design.inverse);
        if let Some((limit, rule)) = limit.zip(open) {
            return Self::Open(limit, rule, design.least_held().map(|(_, held)| held));
        }
        let (tail, least) = (design.base.tail_mass_fraction, design.bracket[0]);
        let nothing_holds = design.boundaries.iter().all(|row| row.held().is_none());
        match (design.least_held(), limit) {
            (None, None) => Self::Unknown,
            // The walk says nothing against a base of which it does not know enough.
            (None, Some(limit)) if tail >= design.threshold && nothing_holds => Self::TailOpen(limit, tail),
            (None, Some(limit)) if limit.ratio < least => Self::BelowSearch(limit, least),
            (None, Some(limit)) => Self::NotHeld(limit),
            (Some((_, held)), Some(limit)) if limit.ratio <= held => Self::Practice(limit),
            (Some((row, held)), Some(limit)) => Self::Walk(row, held, limit),
            (Some((row, held)), None) => Self::ModelAlone(row, held),
        }
    }

    /// The ratio that is allowed; `None` where none is known.
    pub fn ratio(&self) -> Option<f64> {
        match self {
            Self::TailOpen(limit, _) | Self::Practice(limit) => Some(limit.ratio),
            Self::Walk(_, held, _) | Self::ModelAlone(_, held) => Some(*held),
            Self::Forbidden(_)
            | Self::Open(..)
            | Self::OpenBase(..)
            | Self::Unknown
            | Self::BelowSearch(..)
            | Self::NotHeld(_) => None,
        }
    }

    /// The ratio at which the case judges a filter of this shape: the one that is allowed, or what practice
    /// allows; `None` where neither is known.
    pub fn spoken_of(&self) -> Option<f64> {
        match self {
            Self::Open(limit, ..) | Self::BelowSearch(limit, _) | Self::NotHeld(limit) => Some(limit.ratio),
            _ => self.ratio(),
        }
    }

    /// The rule that set the answer; `None` where the walk did.
    pub fn rule(&self) -> Option<&'a AppliedRule> {
        match self {
            Self::Forbidden(rule) => Some(rule),
            Self::TailOpen(limit, _) | Self::Practice(limit) => Some(limit.rule),
            _ => None,
        }
    }
}
