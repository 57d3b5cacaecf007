//! Networks in `.npz` files, as OpenPNM and PoreSpy name their arrays.
//!
//! | array | content |
//! |---|---|
//! | `throat.conns` (`conns`) | two voids of each constriction, n x 2 integers from 0 |
//! | `throat.diameter` (`throat.inscribed_diameter`, `diameter`) | diameter of each constriction |
//! | `throat.hydraulic_conductance` (`throat.conductance`, `conductance`) | optional |
//! | `pore.inlets` (`inlets`, `pore.left`, `pore.xmin`) | voids that base particles enter |
//! | `pore.outlets` (`outlets`, `pore.right`, `pore.xmax`) | voids from which they leave the filter |
//! | `pore.coords` | used only for the number of voids |
//!
//! A negative number in `throat.conns` means outside: upstream of the filter if first, downstream if
//! second. Inlets and outlets are void numbers, or one truth value per void. Missing conductances are
//! taken as the fourth power of the diameter.

use super::{ExitRule, Network, NetworkColumns, NetworkError};
use crate::packing::LengthUnit;
use crate::store::{Array, Npz, Numbers};

const CONNS: &[&str] = &["throat.conns", "conns"];
const DIAMETER: &[&str] = &["throat.diameter", "throat.inscribed_diameter", "diameter"];
const CONDUCTANCE: &[&str] = &["throat.hydraulic_conductance", "throat.conductance", "conductance"];
const INLETS: &[&str] = &["pore.inlets", "inlets", "pore.left", "pore.xmin"];
const OUTLETS: &[&str] = &["pore.outlets", "outlets", "pore.right", "pore.xmax"];
const COORDS: &[&str] = &["pore.coords", "coords"];

/// Number of voids allowed in a file with few constrictions.
const MANY: usize = 1 << 16;

/// Options for reading the arrays of a file.
#[derive(Clone, Copy, Debug)]
pub struct ArrayOptions {
    /// Unit of the diameters, which the file does not state.
    pub unit: LengthUnit,
    /// Rule by which particles choose exits.
    pub rule: ExitRule,
    /// Fraction of its conductance that a blocked constriction keeps.
    pub rho: f64,
    /// Length of one unit of diameter in the network (mm).
    pub unit_mm: f64,
}

impl Network {
    /// Reads a network from an `.npz`; `file` names it in errors.
    ///
    /// # Errors
    /// Errors state the file, the array and the allowed values.
    pub fn from_npz(bytes: &[u8], file: &str, options: &ArrayOptions) -> Result<Self, NetworkError> {
        let whole = |problem: String| NetworkError::whole(file, problem);
        let mut npz = Npz::open(bytes).map_err(whole)?;
        let known = npz.names().join(", ");
        let mut needed = |names: &[&'static str]| {
            let array = npz.first(names).map_err(whole)?;
            array.ok_or_else(|| whole(format!("has no array {}; it has {known}", names.join(" or "))))
        };
        let conns = needed(CONNS)?;
        let (conns_name, conns) = (conns.0, pairs(file, conns)?);
        let diameter = floats(file, needed(DIAMETER)?)?;
        let [inlets, outlets] = [needed(INLETS)?, needed(OUTLETS)?];
        let mut others = |names| npz.first(names).map_err(whole);
        let conductance = match options.rule.needs_flow() {
            true => others(CONDUCTANCE)?.map(|array| floats(file, array)).transpose()?,
            false => None,
        };
        let coords = others(COORDS)?;
        let ends = [&inlets, &outlets];
        let by_void = ends.into_iter().filter(|(_, array)| matches!(array.numbers, Numbers::Truth(_)));
        let by_void = by_void.chain(&coords);
        let most = by_void.max_by_key(|(_, array)| array.rows).map(|(name, array)| (*name, array.rows));
        let voids = number_of_voids((file, conns_name), &conns, ends, most)?;
        let [inlets, outlets] = [inlets, outlets].map(|array| numbered(file, array, voids));
        let diameter_mm: Vec<f64> = diameter.iter().map(|d| d * options.unit.mm()).collect();
        let columns = NetworkColumns {
            voids,
            conns: &conns,
            diameter_mm: &diameter_mm,
            conductance: conductance.as_deref(),
            inlets: &inlets?,
            outlets: &outlets?,
            rule: options.rule,
            rho: options.rho,
            unit_mm: options.unit_mm,
        };
        let (network, _) = Network::from_columns(&columns).map_err(|error| whole(error.to_string()))?;
        Ok(network)
    }
}

type Named = (&'static str, Array);

/// Number of voids: the length of the longest array with one entry per void. Without such an array it is
/// the number named by the constrictions, limited by their count, as every void takes memory.
fn number_of_voids(
    (file, name): (&str, &str),
    conns: &[[i64; 2]],
    ends: [&Named; 2],
    longest: Option<(&str, usize)>,
) -> Result<usize, NetworkError> {
    let named = || conns.iter().flatten().copied().filter(|&void| void >= 0);
    let (first, last) = (named().min().unwrap_or(0), named().max().unwrap_or(0));
    let (allowed, known) = match longest {
        Some((array, entries)) => (entries, format!("{array} has {entries} entries")),
        None => {
            let known = format!("there are {} constrictions and no pore.coords", conns.len());
            (MANY.max(2 * conns.len()), known)
        }
    };
    let is_first = |(_, array): &Named| matches!(&array.numbers, Numbers::Whole(all) if all.contains(&0));
    let counts_from_1 = match longest {
        Some((_, entries)) => last == entries as i64,
        None => !ends.into_iter().any(is_first),
    };
    if first == 1 && counts_from_1 {
        let problem = "number voids from 0, in the inlets and outlets too";
        let problem = format!("its voids are numbered from 1 to {last}, and {known}; {problem}");
        return refused(file, name, problem);
    }
    if last >= allowed as i64 {
        let row = conns.iter().position(|pair| pair.contains(&last)).unwrap_or(0);
        let most = allowed.saturating_sub(1);
        let problem = format!("names void {last}, and {known}; 0 to {most} are allowed");
        return refused(file, name, format!("row {row} (counted from 0) {problem}"));
    }
    Ok(if longest.is_some() { allowed } else { last as usize + 1 })
}

fn refused<T>(file: &str, name: &str, problem: impl std::fmt::Display) -> Result<T, NetworkError> {
    Err(NetworkError::whole(file, format!("{name}: {problem}")))
}

fn pairs(file: &str, (name, array): Named) -> Result<Vec<[i64; 2]>, NetworkError> {
    match (array.columns, array.numbers) {
        (Some(2), Numbers::Whole(all)) => Ok(all.as_chunks::<2>().0.to_vec()),
        _ => refused(file, name, "n x 2 whole numbers are needed, the two voids of each constriction"),
    }
}

fn floats(file: &str, (name, array): Named) -> Result<Vec<f64>, NetworkError> {
    match (array.columns, array.numbers) {
        (None | Some(1), Numbers::Float(all)) => Ok(all),
        (None | Some(1), Numbers::Whole(all)) => Ok(all.into_iter().map(|n| n as f64).collect()),
        _ => refused(file, name, "one number for each constriction is needed"),
    }
}

/// Reads voids given by number, or by one truth value per void.
fn numbered(file: &str, (name, array): Named, voids: usize) -> Result<Vec<u32>, NetworkError> {
    let is_void = |&void: &i64| u32::try_from(void).is_ok_and(|void| (void as usize) < voids);
    match (array.columns, array.numbers) {
        (None | Some(1), Numbers::Truth(all)) if all.len() == voids => {
            Ok((0..).zip(all).filter_map(|(void, is)| is.then_some(void)).collect())
        }
        (None | Some(1), Numbers::Truth(all)) => {
            refused(file, name, format!("has {} truth values, but there are {voids} voids", all.len()))
        }
        (None | Some(1), Numbers::Whole(all)) => match all.iter().find(|void| !is_void(void)) {
            None => Ok(all.into_iter().map(|void| void as u32).collect()),
            Some(wrong) => {
                refused(file, name, format!("{wrong} is no void; there are {voids}, numbered from 0"))
            }
        },
        _ => refused(file, name, "numbers of voids are needed, or a truth value for each void"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::npz;

    fn whole(rows: usize, columns: Option<usize>, all: &[i64]) -> Array {
        Array { rows, columns, numbers: Numbers::Whole(all.to_vec()) }
    }

    fn truth(all: &[bool]) -> Array {
        Array { rows: all.len(), columns: None, numbers: Numbers::Truth(all.to_vec()) }
    }

    fn arrays() -> Vec<(&'static str, Array)> {
        vec![
            ("throat.conns", whole(4, Some(2), &[0, 1, 1, 2, 0, 3, 3, 2])),
            ("throat.diameter", Array::of_floats(vec![1e-3, 1e-3, 0.4e-3, 0.4e-3])),
            ("pore.inlets", truth(&[true, false, false, false])),
            ("pore.outlets", whole(1, None, &[2])),
        ]
    }

    fn read(arrays: &[(&str, Array)], rule: ExitRule) -> Result<Network, NetworkError> {
        let named: Vec<(String, Array)> = arrays.iter().map(|(n, a)| (n.to_string(), a.clone())).collect();
        let options = ArrayOptions { unit: LengthUnit::M, rule, rho: 0.0, unit_mm: 0.5 };
        Network::from_npz(&npz(&named).unwrap(), "net.npz", &options)
    }

    #[test]
    fn arrays_are_the_network_of_their_columns() {
        let columns = NetworkColumns {
            voids: 4,
            conns: &[[0, 1], [1, 2], [0, 3], [3, 2]],
            diameter_mm: &[1.0, 1.0, 0.4, 0.4],
            conductance: None,
            inlets: &[0],
            outlets: &[2],
            rule: ExitRule::Flux,
            rho: 0.0,
            unit_mm: 0.5,
        };
        for rule in [ExitRule::Flux, ExitRule::Area] {
            let expected = Network::from_columns(&NetworkColumns { rule, ..columns }).unwrap().0;
            assert_eq!(read(&arrays(), rule).unwrap(), expected);
        }
        // Other array names, and conductances, which a network without water does not use.
        let mut other = arrays();
        other[0].0 = "conns";
        other[1].0 = "throat.inscribed_diameter";
        other.push(("conductance", Array::of_floats(vec![1.0, 1.0, 2.0, 2.0])));
        let conductance = Some(&[1.0, 1.0, 2.0, 2.0][..]);
        let expected = Network::from_columns(&NetworkColumns { conductance, ..columns }).unwrap().0;
        assert_eq!(read(&other, ExitRule::Flux).unwrap(), expected);
        assert!(read(&other, ExitRule::Area).is_ok());
    }

    /// A void without constrictions is counted if an array with one entry per void lists it.
    #[test]
    fn the_number_of_a_void_is_explained_by_the_constrictions_or_an_array_of_the_voids() {
        let ring = |last: i64| whole(4, Some(2), &[0, 1, 1, 2, 0, last, last, 2]);
        let mut all = arrays();
        all[2].1 = whole(1, None, &[0]);
        all[0].1 = ring(65_535);
        assert_eq!(read(&all, ExitRule::Area).unwrap().voids(), 65_536);
        all[0].1 = ring(65_536);
        let error = read(&all, ExitRule::Area).unwrap_err().to_string();
        let problem = "row 2 (counted from 0) names void 65536, and there are 4 constrictions";
        assert!(error.contains(problem), "{error}");
        let coords = Array { rows: 70_000, columns: Some(3), numbers: Numbers::Float(vec![0.0; 210_000]) };
        all.push(("pore.coords", coords));
        assert_eq!(read(&all, ExitRule::Area).unwrap().voids(), 70_000);
    }

    #[test]
    fn voids_beyond_those_that_there_are_or_numbered_from_1_are_refused() {
        let (conns, ends) = ([0, 1, 1, 2, 0, 3, 3, 2], [0, 2]);
        let coords =
            |rows: usize| Array { rows, columns: Some(3), numbers: Numbers::Whole(vec![0; 3 * rows]) };
        let with = |add: i64, coords: Option<Array>| {
            let mut all = arrays();
            all[0].1 = whole(4, Some(2), &conns.map(|void| void + add));
            all[2].1 = whole(1, None, &[ends[0] + add]);
            all[3].1 = whole(1, None, &[ends[1] + add]);
            all.extend(coords.map(|array| ("pore.coords", array)));
            read(&all, ExitRule::Flux).map(|network| network.filter_voids()).map_err(|e| e.to_string())
        };
        let read = [with(0, None), with(0, Some(coords(4))), with(1, Some(coords(9)))];
        assert_eq!(read, [Ok(4), Ok(4), Ok(9)]);
        for (add, coords, words) in [
            (0, Some(coords(3)), "names void 3, and pore.coords has 3 entries"),
            (3, Some(coords(4)), "names void 6, and pore.coords has 4 entries"),
            (1, Some(coords(4)), "numbered from 1 to 4, and pore.coords has 4 entries"),
            (1, None, "numbered from 1 to 4"),
        ] {
            let error = with(add, coords).unwrap_err();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn what_is_no_network_is_named_with_its_array() {
        let with = |at: usize, array: Array| {
            let mut all = arrays();
            all[at].1 = array;
            read(&all, ExitRule::Flux).unwrap_err().to_string()
        };
        let without = |at: usize| {
            let mut all = arrays();
            all.remove(at);
            read(&all, ExitRule::Flux).unwrap_err().to_string()
        };
        for (error, message) in [
            (without(0), "has no array throat.conns or conns; it has throat.diameter, pore.inlets"),
            (without(1), "has no array throat.diameter or throat.inscribed_diameter or diameter"),
            (without(2), "has no array pore.inlets"),
            (with(0, whole(2, None, &[0, 1])), "throat.conns: n x 2 whole numbers"),
            (with(1, truth(&[true])), "throat.diameter: one number for each"),
            (with(1, Array::of_floats(vec![1e-3])), "conns has 4 rows, but diameter has 1"),
            (with(1, Array::of_floats(vec![1e-3, f64::NAN, 1e-3, 1e-3])), "diameter"),
            (with(2, truth(&[true, false])), "names void 3, and pore.inlets has 2 entries"),
            (with(2, Array::of_floats(vec![0.0])), "pore.inlets: numbers of voids are needed"),
            (with(3, whole(1, None, &[9])), "pore.outlets: 9 is no void; there are 4, numbered from 0"),
            (with(3, whole(1, None, &[-1])), "pore.outlets: -1 is no void"),
            (
                with(0, whole(4, Some(2), &[0, 1, 1, 2, 0, 4_000_000_000, 3, 2])),
                "throat.conns: row 2 (counted from 0) names void 4000000000, and pore.inlets has 4 entries; \
                 0 to 3 are allowed",
            ),
            (with(0, whole(4, Some(2), &[0, 1, 1, 2, 0, 3, i64::MAX, 2])), "throat.conns: row 3"),
            (with(3, whole(1, None, &[4_000_000_000])), "pore.outlets: 4000000000 is no void"),
        ] {
            assert!(error.starts_with("net.npz: ") && error.contains(message), "{message}: {error}");
        }
    }
}
