//! What rules of practice that are not kept say, in sentences.

use super::record::{AppliedRule, RuleRole};

/// A rule that is not kept, in a sentence.
pub fn said_of(rule: &AppliedRule) -> String {
    let [value, limit] = against(rule, 2);
    let (quantity, at_most) = (&rule.quantity, if rule.limit_at_most { " at most" } else { "" });
    match rule.id.as_str() {
        "sherard-dunnigan" => format!(
            "practice allows D15F {limit}{at_most}, this is {value} (Sherard and Dunnigan's limit of design)"
        ),
        "foster-fell-no-erosion" => {
            format!("tests found no erosion up to D15F {limit}{at_most}, this is {value} (Foster and Fell)")
        }
        "foster-fell-continuing" => format!(
            "tests found continuing erosion beyond D15F {limit}{at_most}, this is {value} (Foster and Fell)"
        ),
        _ => format!("practice allows {quantity} up to {limit}{at_most}, this is {value} ({})", whose(rule)),
    }
}

/// Rules of one role that are not kept, in one sentence: what several authors say alike is one reason.
pub fn said_of_all(role: RuleRole, rules: &[&AppliedRule]) -> Option<String> {
    if rules.is_empty() {
        return None;
    }
    let one = |rule: &&AppliedRule| {
        let ([value, limit], quantity) = (against(rule, 2), &rule.quantity);
        let allowed = if rule.at_least { "at least" } else { "up to" };
        match (role, rule.role) {
            (RuleRole::Stability, _) => format!("{} ({quantity} {value}, limit {limit})", whose(rule)),
            _ => format!("{quantity} is {value}, and practice asks for {allowed} {limit}"),
        }
    };
    let all = |rules: &[&AppliedRule]| listed(&rules.iter().map(one).collect::<Vec<_>>());
    Some(match role {
        RuleRole::Stability => format!(
            "the filter may lose its own fines, and with them the constrictions that were walked; so {} {}",
            if rules.len() == 1 { "says" } else { "say" },
            all(rules)
        ),
        RuleRole::Drainage => {
            let (permeability, fines): (Vec<_>, Vec<_>) =
                rules.iter().copied().partition(|rule| rule.quantity == "D15F");
            let mut said = Vec::new();
            if let Some(first) = permeability.first() {
                let [value, limit] = against(first, 2);
                let by_all = match permeability.get(1) {
                    Some(least) => format!(", and EM 1110-2-1901 for {} at the least", against(least, 2)[1]),
                    None => String::new(),
                };
                said.push(format!(
                    "the filter may be too fine to drain the base; D15F {value}, USBR and NRCS ask for \
                     {limit} or more{by_all}"
                ));
            }
            if !fines.is_empty() {
                said.push(format!("the filter has fines, and may not drain: {}", all(&fines)));
            }
            format!("{}; that says nothing of retention", said.join("; "))
        }
        _ => format!("the filter may segregate when it is placed: {}", all(rules)),
    })
}

/// That tests found no erosion where the walk does, for the ratio at which this network ends to hold.
pub fn besides(tests: &AppliedRule, ratio: &AppliedRule) -> String {
    format!(
        "the walk errs on the safe side for this pair; D15F/D85B is {}, tests found no erosion up to D15F {} \
         (Foster and Fell), and this network retains uniform sands up to a ratio near {}",
        ratio.value.map_or("unknown".into(), short),
        size(tests.limit, &tests.unit),
        ratio.limit.map_or("unknown".into(), short)
    )
}

/// `a`, `a and b`, `a, b and c`.
pub fn listed(items: &[String]) -> String {
    match items {
        [] => String::new(),
        [one] => one.clone(),
        [all @ .., last] => format!("{} and {last}", all.join(", ")),
    }
}

/// Whose rule it is.
pub fn whose(rule: &AppliedRule) -> &str {
    rule.name.split(':').next().unwrap_or_default()
}

/// A value and its limit, with as many digits as tell them apart, and this many at the least.
pub fn against(rule: &AppliedRule, digits: i32) -> [String; 2] {
    let (Some(value), Some(limit)) = (rule.value, rule.limit) else {
        return [size(rule.value, &rule.unit), size(rule.limit, &rule.unit)];
    };
    let pair = |digits| [value, limit].map(|number| digits_of(number, digits));
    let apart = (digits..9).map(pair).find(|[value, limit]| value != limit);
    apart.unwrap_or_else(|| pair(digits)).map(|number| with_unit(number, &rule.unit))
}

/// A value with its unit.
fn size(value: Option<f64>, unit: &str) -> String {
    with_unit(value.map_or("unknown".into(), short), unit)
}

fn with_unit(number: String, unit: &str) -> String {
    if unit.is_empty() { number } else { format!("{number} {unit}") }
}

/// Two digits that mean something, or three from 100 on.
fn short(value: f64) -> String {
    digits_of(value, 2)
}

fn digits_of(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let decimals = (digits - 1 - value.abs().log10().floor() as i32).clamp(0, digits + 4);
    format!("{value:.*}", decimals as usize)
}
