//! `voidwalk design`: the specification of a filter, by practice.

use super::args::DesignArgs;
use super::design_each::{by_option, design_each};
use super::print::{as_it_is, json, plain, shown, to_stdout};
use super::progress::followed;
use super::setting_options::{CommandSettings, OfSpecification};
use crate::run::RunError;
use crate::scene::{About, Scene};
use crate::study::specified::{SpecifyOptions, specify};
use crate::words::products::{products, to_be_checked};
use crate::words::row_note;
use crate::words::specification::{
    DESIGN_AGAIN, band, if_dispersive, limit, no_band, raised, still_to_set, without_margin,
};
use voidwalk_core::schema::setting_name;
use voidwalk_core::store::format;
use voidwalk_practice::design::Specification;
use voidwalk_practice::quantity::SizeUnit;

/// Default folder of the results.
const FOLDER: &str = "voidwalk-specification";

/// Default folder of designs for many samples.
const EACH_FOLDER: &str = "voidwalk-designs";

/// Makes the specification for a base, or for each of many samples, and writes it into a folder.
pub fn design(args: &DesignArgs) -> Result<(), RunError> {
    let takes = [About::texts(), OfSpecification::OPTIONS.iter().map(ToString::to_string).collect()].concat();
    let settings = &args.settings.assignments;
    let is_taken = |set: &str| takes.iter().any(|name| setting_name(set) == name);
    if let Some(other) = settings.iter().find(|set| !is_taken(set)) {
        let problem =
            format!("a specification walks nothing, and takes no other settings than {}", takes.join(", "));
        return Err(RunError::Refused(format!("--set {other}: {problem}")));
    }
    let scene = Scene::built_in(settings)?;
    let about = &scene.about;
    let folder = if args.each { EACH_FOLDER } else { FOLDER };
    let options = SpecifyOptions {
        bases: args.bases.clone(),
        dispersive: scene.base.dispersive == Some(true),
        finer: args.finer,
        sieves: args.sieves,
        cover: about.cover(),
        inches: about.shows_inches(),
        out: args.out.clone().unwrap_or_else(|| folder.into()),
        overwrite: args.overwrite,
    };
    if args.each {
        return design_each(args, &options);
    }
    let specification = followed(args.quiet, |callbacks| specify(&options, callbacks))?;
    if args.json {
        as_it_is(&json(format::SPECIFICATION, &specification)?);
    } else if !args.quiet {
        to_stdout(&format!(
            "{}report: {}\n",
            words(&specification),
            shown(&options.out.join("specification.html"))
        ));
    }
    Ok(())
}

/// The band and its limit, points to watch, and the products that fit; the page has steps and limits.
fn words(specification: &Specification) -> String {
    let unit = SizeUnit::of(false, specification.inches);
    let band = band(specification, unit).unwrap_or_else(|| match &specification.no_band {
        Some(why) => format!("no band. {}", no_band(why, unit).trim_end_matches('.')),
        None => "no band".into(),
    });
    let mut lines =
        vec![format!("Specification of a filter for {}, by the rules of practice alone", specification.base)];
    lines.extend([format!("Practice: {band}"), format!("Limit: {}", limit(specification, unit))]);
    lines.extend(raised(specification, unit).map(|raised| format!("  {raised}")));
    let dispersive = if_dispersive(specification, &by_option(DESIGN_AGAIN), unit);
    lines.extend(
        without_margin(specification, unit)
            .into_iter()
            .chain(dispersive)
            .map(|beside| format!("  {beside}.")),
    );
    lines.extend(specification.notes.iter().map(|row| format!("warning: {}", row_note(row, unit))));
    lines.extend(still_to_set(specification, unit));
    lines.push(products(specification));
    lines.extend(to_be_checked(&specification.products));
    lines.iter().map(|line| plain(line) + "\n").collect()
}
