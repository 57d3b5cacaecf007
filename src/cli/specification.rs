//! `voidwalk design --steps`: the specification of a filter by practice alone.

use std::fmt::Write;
use std::path::Path;

use super::args::DesignArgs;
use super::print::{as_it_is, json, plain, shown, to_stdout, wrapped};
use super::progress::followed;
use crate::outcome::design::specification::{ProductMargin, Specification};
use crate::outcome::quantity::{SizeUnit, length, significant};
use crate::run::RunError;
use crate::scene::Scene;
use crate::store::format;
use crate::study::design::{SpecifyOptions, specify};
use crate::words::products::{product as product_result, products, to_be_checked};
use crate::words::row_note;
use crate::words::specification::{
    DESIGN_AGAIN, beside_limits, if_dispersive, no_band, step_name, step_notes, step_value, still_to_set,
    without_margin,
};

/// The folder of the results, where nobody names one.
const FOLDER: &str = "voidwalk-specification";

/// Makes the specification for a base and writes it into a folder; of the settings those of the sheet count.
pub(super) fn specification(args: &DesignArgs, base: &Path, settings: &[String]) -> Result<(), RunError> {
    let options = asked(args, base, FOLDER, settings)?;
    let found = followed(args.quiet, |callbacks| specify(&options, callbacks))?;
    if args.json {
        as_it_is(&json(format::SPECIFICATION, &found)?);
    } else if !args.quiet {
        to_stdout(&format!("{}report: {}\n", words(&found), shown(&options.out.join("specification.html"))));
    }
    Ok(())
}

/// The options for this base, with this folder where none is named.
pub(super) fn asked(
    args: &DesignArgs,
    base: &Path,
    folder: &str,
    settings: &[String],
) -> Result<SpecifyOptions, RunError> {
    let about = Scene::built_in(settings)?.about;
    Ok(SpecifyOptions {
        base: base.to_owned(),
        dispersive: args.dispersive,
        finer: args.finer,
        sieves: args.sieves,
        cover: about.cover(),
        inches: about.shows_inches(),
        out: args.out.clone().unwrap_or_else(|| folder.into()),
        overwrite: args.overwrite,
    })
}

/// What to do where a base is found to be dispersive, with the option that does it.
pub(super) fn by_option(again: &str) -> String {
    format!("{again} (--dispersive)")
}

/// Steps, limits and products.
fn words(of: &Specification) -> String {
    let mut text = String::new();
    let unit = SizeUnit::of(false, of.inches);
    // Writing to a string cannot fail.
    let mut line = |said: &str| {
        let _ = writeln!(text, "{}", plain(said).trim_end());
    };
    line(&format!("Specification of a filter for {}, by the rules of practice alone", of.base));
    let mut source = "";
    for step in &of.steps {
        line(&format!("{:>2}  {}", step.step, step_name(step.does)));
        for value in &step.values {
            let number = step_value(value, unit).unwrap_or_else(|| "not known".into());
            line(&format!("      {}: {number}", value.name));
        }
        // What several steps in a row rest on is said once.
        let again = std::mem::replace(&mut source, step.source.as_str()) == step.source;
        let source = if again { "" } else { step.source.as_str() };
        let note = step_notes(step, unit);
        let more = [step.formula.as_str(), note.as_str(), source];
        more.into_iter()
            .filter(|text| !text.is_empty())
            .flat_map(|text| wrapped(text, 6))
            .for_each(|s| line(&s));
    }
    line("");
    if let Some(why) = &of.no_band {
        line(&format!("No band. {}", no_band(why, unit)));
    }
    if let Some(said) = still_to_set(of, unit) {
        wrapped(&said, 0).iter().for_each(|said| line(said));
    }
    let margin = without_margin(of, unit);
    let dispersive = if_dispersive(of, &by_option(DESIGN_AGAIN), unit);
    for said in margin.into_iter().chain(dispersive) {
        line(&format!("{said}."));
    }
    let notes = of.notes.iter().map(|row| row_note(row, unit));
    notes.flat_map(|note| wrapped(&note, 0)).for_each(|text| line(&text));
    if !of.limits.is_empty() {
        line("sieve        opening, mm   percent finer");
        for limit in &of.limits {
            line(&format!(
                "{:<12} {:>11}   {}",
                limit.sieve,
                significant(limit.opening_mm),
                match limit.max_percent_finer {
                    Some(most) => format!(
                        "{} to {}",
                        significant(limit.min_percent_finer).in_digits(4),
                        significant(most).in_digits(4)
                    ),
                    None => format!("{} or more", significant(limit.min_percent_finer).in_digits(4)),
                }
            ));
        }
        let beside = beside_limits(of, unit);
        beside.iter().flat_map(|text| wrapped(text, 0)).for_each(|text| line(&text));
        line("");
    }
    for product in &of.products {
        line(&format!(
            "{}, D15 {}: {}",
            product.product,
            length(product.d15_fine_mm, unit).to(length(product.d15_coarse_mm, unit)),
            product_result(of, product)
        ));
        line(&format!("    {}", margins(product)));
    }
    if let Some(said) = to_be_checked(&of.products) {
        line(&said);
    }
    if of.nearest_product().is_some() {
        line(&products(of));
    }
    text
}

/// How a product compares with both limits of D15F.
fn margins(of: &ProductMargin) -> String {
    let finest = match of.drains_by {
        Some(margin) => format!("its finest D15 is {} times the minimum D15F", significant(margin)),
        None => "the minimum D15F is not known".into(),
    };
    let coarsest = match of.holds_by {
        Some(margin) => format!("the maximum D15F is {} times its coarsest D15", significant(margin)),
        None => "the maximum D15F is not known".into(),
    };
    format!("{finest}; {coarsest}")
}
