//! Command `voidwalk soil`: the contents of a file of soils, as the program reads them.

use super::args::SoilArgs;
use super::init::Soils;
use super::print::{answer, labelled, shown, to_stdout};
use crate::case::CaseError;
use crate::report::soils_figure;
use crate::run::{RunError, write_new};
use voidwalk_core::gradation::Gradation;
use voidwalk_core::store::format;
use voidwalk_sheets::{SoilSummary, named_soils_in, soils_in_file};

#[cfg(feature = "xlsx")]
use std::path::Path;

#[cfg(feature = "xlsx")]
use crate::report::soil_template;

pub(crate) fn soil(args: &SoilArgs) -> Result<(), RunError> {
    #[cfg(feature = "xlsx")]
    if let Some(path) = &args.template {
        return template(path);
    }
    let Some(file) = &args.file else { return Err(RunError::refused("name a file of soils")) };
    if args.names {
        let soils = named_soils_in(file).map_err(RunError::refused)?;
        to_stdout(&soils.iter().map(|soil| format!("{}\n", shown(&soil.path))).collect::<String>());
        return Ok(());
    }
    let soils = soils_in_file(file, args.d0_mm).map_err(CaseError::from)?;
    if let Some(path) = &args.figure {
        let curves = soils.iter().map(|soil| (soil.name.as_str(), soil.points.as_slice()));
        write_new(path, soils_figure(curves, args.coarse_left).as_bytes())?;
    }
    let soils = Soils { soils };
    let drawn = args.figure.as_deref().map_or(String::new(), |path| format!("\n{}\n", shown(path)));
    answer((args.json, false), format::SOILS, &soils, || words(&soils.soils) + &drawn)
}

#[cfg(feature = "xlsx")]
fn template(path: &Path) -> Result<(), RunError> {
    if path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("xlsx")) {
        let problem = "a workbook to fill in ends in .xlsx";
        return Err(RunError::Refused(format!("--template {}: {problem}", shown(path))));
    }
    write_new(path, &soil_template().map_err(RunError::failed)?)?;
    to_stdout(&format!("{}\n", shown(path)));
    Ok(())
}

fn words(soils: &[SoilSummary]) -> String {
    let mut text = String::new();
    for (index, soil) in soils.iter().enumerate() {
        if index > 0 {
            text.push('\n');
        }
        let mut line = |name: &str, value: String| text += &labelled(name, &value);
        line("soil", soil.name.clone());
        line("opening, mm", "percent finer by mass".into());
        for point in soil.points.iter().rev() {
            line(&format!("  {}", digits(point.size)), digits(point.percent));
        }
        let sizes = [
            ("D5", soil.d5_mm),
            ("D10", soil.d10_mm),
            ("D15", soil.d15_mm),
            ("D30", soil.d30_mm),
            ("D50", soil.d50_mm),
            ("D60", soil.d60_mm),
            ("D85", soil.d85_mm),
            ("D90", soil.d90_mm),
            ("D95", soil.d95_mm),
            ("D100", soil.d100_mm),
        ];
        let known = sizes.iter().filter_map(|(name, size)| Some(format!("{name} {}", digits((*size)?))));
        line("sizes, mm", known.collect::<Vec<_>>().join(", "));
        let unknown: Vec<&str> = sizes.iter().filter(|size| size.1.is_none()).map(|size| size.0).collect();
        if !unknown.is_empty() {
            line("  not known", format!("{}: finer than the finest opening", unknown.join(", ")));
        }
        for [finer, coarser] in far_apart(soil) {
            let between = format!("between {finer} and {coarser} mm, where no sieve tells the sizes");
            line("  straight line", between);
        }
        let number = |value: Option<f64>| value.map_or("not known".to_owned(), digits);
        line("Cu, Cc", format!("{}, {}", number(soil.cu), number(soil.cc)));
        line("fines", percent(soil.fines_percent, "finer than 0.075 mm"));
        line("gravel", percent(soil.gravel_percent, "coarser than 4.75 mm"));
        if let Some(class) = &soil.class {
            line("class (ASTM D2487)", class.clone());
        }
        soil.notes.iter().for_each(|note| line("note", note.clone()));
    }
    text
}

/// Neighbouring sieves (mm) too far apart for a rule of practice to interpolate between them.
fn far_apart(soil: &SoilSummary) -> Vec<[String; 2]> {
    let points: Vec<(f64, f64)> = soil.points.iter().map(|point| (point.size, point.percent)).collect();
    let steps = Gradation::from_points(&points, None).map_or(Vec::new(), |curve| curve.open_steps());
    steps.iter().map(|step| [step.from_mm, step.to_mm].map(digits)).collect()
}

fn percent(value: Option<f64>, part: &str) -> String {
    value.map_or("not known".to_owned(), |value| format!("{value:.1} % {part}"))
}

fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let decimals = (3 - libm::floor(libm::log10(value.abs())) as i32).clamp(0, 12) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::{digits, percent};

    #[test]
    fn nothing_follows_a_percentage_that_is_not_known() {
        let words = [Some(1.5), None].map(|value| percent(value, "finer than 0.075 mm"));
        assert_eq!(words, ["1.5 % finer than 0.075 mm", "not known"]);
    }

    #[test]
    fn numbers_have_four_digits() {
        let all = [0.075, 4.75, 100.0, 12.3456, 0.000_123_456, 0.0, 318.4].map(digits);
        assert_eq!(all, ["0.075", "4.75", "100", "12.35", "0.0001235", "0", "318.4"]);
    }
}
