//! Networks from columns with one entry per constriction, as other programs store them.

use super::file::{listed_twice, unlinked};
use super::undirected::{Link, LinkEnd, LinkedVoids, WIDE};
use super::{END, ExitRule, Network, NetworkError};

/// Default exponent of the diameter in the conductance of a constriction (Poiseuille).
pub const CONDUCTANCE_EXPONENT: f64 = 4.0;

/// Marks a constriction without an exit: its two ends are the same void.
pub const NO_EXIT: u32 = u32::MAX;

/// Network as columns; entry `c` of each belongs to constriction `c`.
#[derive(Clone, Copy, Debug)]
pub struct NetworkColumns<'a> {
    /// Number of voids.
    pub voids: usize,
    /// Two voids that each constriction joins; a negative number means outside: upstream of the filter if
    /// first, downstream if second.
    pub conns: &'a [[i64; 2]],
    /// Diameter (mm) by constriction; 0 means closed from the start.
    pub diameter_mm: &'a [f64],
    /// Conductance times viscosity by constriction, in any consistent unit; default: fourth power of the
    /// diameter.
    pub conductance: Option<&'a [f64]>,
    /// Voids that base particles enter, through unblockable ways in.
    pub inlets: &'a [u32],
    /// Voids from which particles leave the filter, through unblockable ways out.
    pub outlets: &'a [u32],
    /// Rule by which particles choose exits. With [`ExitRule::Area`] each constriction leads from its first
    /// void to its second; with the other rules it can be passed in both directions, and water decides which.
    pub rule: ExitRule,
    /// Fraction of its conductance that a blocked constriction keeps.
    pub rho: f64,
    /// Length of one unit of diameter (mm).
    pub unit_mm: f64,
}

impl Network {
    /// Builds the network of these columns, and lists the exit of each constriction from its first void
    /// ([`NO_EXIT`] if it has no exit).
    ///
    /// In an undirected network, ways in and out have the mean conductance of all constrictions.
    ///
    /// ```
    /// use voidwalk_core::network::{ExitRule, Network, NetworkColumns};
    /// let columns = NetworkColumns {
    ///     voids: 2, conns: &[[0, 1]], diameter_mm: &[0.5], conductance: None, inlets: &[0], outlets: &[1],
    ///     rule: ExitRule::Flux, rho: 0.0, unit_mm: 1.0,
    /// };
    /// let (network, exit) = Network::from_columns(&columns)?;
    /// assert_eq!((network.passages(), network.twin(exit[0] as usize).is_some()), (1, true));
    /// # Ok::<(), voidwalk_core::network::NetworkError>(())
    /// ```
    ///
    /// # Errors
    /// Columns of unequal length; a void that does not exist; an invalid diameter or conductance; no
    /// constriction, inlet, way out or open path; a rule by height, which the columns do not contain.
    pub fn from_columns(columns: &NetworkColumns) -> Result<(Self, Vec<u32>), NetworkError> {
        let diameter = columns.checked()?;
        match columns.rule {
            ExitRule::Area => columns.directed(diameter),
            ExitRule::Flux | ExitRule::AreaAlongFlow => columns.undirected(&diameter),
            ExitRule::Height => unlinked("by height: conns do not say which void is higher"),
        }
    }
}

impl NetworkColumns<'_> {
    /// Refuses columns that do not form a network; returns their diameters in units of `unit_mm`.
    fn checked(&self) -> Result<Vec<f32>, NetworkError> {
        let Self { voids, conns, unit_mm, rho, .. } = *self;
        let count = conns.len();
        let conductances = self.conductance.map_or(count, <[f64]>::len);
        for (name, rows) in [("diameter", self.diameter_mm.len()), ("conductance", conductances)] {
            if rows != count {
                return unlinked(format!("conns has {count} rows, but {name} has {rows}"));
            }
        }
        if !(unit_mm.is_finite() && unit_mm > 0.0) {
            return unlinked(format!("the unit of length is {unit_mm} mm; above 0 is allowed"));
        }
        if !(0.0..1.0).contains(&rho) {
            return unlinked(format!("rho = {rho}; a number from 0 to below 1 is allowed"));
        }
        if count == 0 {
            return unlinked("it has no constriction");
        }
        if voids >= END as usize || 2 * count + self.outlets.len() >= END as usize {
            return unlinked(format!("{voids} voids and {count} constrictions are too many"));
        }
        for (c, ends) in conns.iter().enumerate() {
            if let Some(end) = ends.iter().find(|&&end| end >= voids as i64) {
                let problem = format!("constriction {c} leads to void {end}, but there are {voids} voids");
                return unlinked(problem);
            }
            if ends.iter().all(|&end| end < 0) {
                return unlinked(format!("constriction {c} joins no void: both its ends lie outside"));
            }
        }
        let marked = |name: &str, ends: &[u32]| {
            let mut marked = vec![false; voids];
            for &void in ends {
                let Some(is_marked) = marked.get_mut(void as usize) else {
                    let problem = format!("void {void} is made an {name}, but there are {voids} voids");
                    return unlinked(problem);
                };
                if std::mem::replace(is_marked, true) {
                    return unlinked(format!("void {void} is made an {name} twice"));
                }
            }
            Ok(marked)
        };
        let is_inlet = marked("inlet", self.inlets)?;
        let is_outlet = marked("outlet", self.outlets)?;
        // Extracted networks have isolated voids at their faces; if numbers count from 1, void 0 looks
        // like one.
        let is_joined = conns.iter().flatten().any(|&end| end == 0);
        for (name, marked) in [("inlet", &is_inlet), ("outlet", &is_outlet)] {
            if !is_joined && marked.first() == Some(&true) {
                return unlinked(format!(
                    "void 0 is made an {name}, but no constriction joins it; leave it out, and number the \
                     voids of conns, inlets and outlets from 0"
                ));
            }
        }
        if let Some(void) = self.outlets.iter().find(|&&void| is_inlet[void as usize]) {
            return unlinked(format!(
                "void {void} is made an inlet and an outlet: particles would leave it without a constriction"
            ));
        }
        let (d, g) = (self.diameter_mm, self.conductance);
        let rows = (0..count).map(|c| (conns[c], [d[c], g.map_or(0.0, |g| g[c])]));
        if let Some([row, again]) = listed_twice(rows, false) {
            return unlinked(format!(
                "constrictions {row} and {again} (counted from 0) are one constriction listed twice (there \
                 and back, or repeated), and others are, too; keep one row of each"
            ));
        }
        let unit = |(constriction, &mm): (usize, &f64)| {
            let value = (mm / self.unit_mm) as f32;
            let is_size = mm == 0.0 || mm > 0.0 && (f32::MIN_POSITIVE..WIDE).contains(&value);
            if is_size { Ok(value) } else { Err(NetworkError::diameter(constriction, mm as f32)) }
        };
        self.diameter_mm.iter().enumerate().map(unit).collect()
    }

    /// Builds a network in which every constriction leads from its first void to its second.
    fn directed(&self, mut diameter: Vec<f32>) -> Result<(Network, Vec<u32>), NetworkError> {
        if self.conductance.is_some() {
            return unlinked("by area: conductance says nothing where no water flows");
        }
        if self.inlets.is_empty() {
            return unlinked("it has no inlet");
        }
        if let Some(c) = self.conns.iter().position(|&[from, _]| from < 0) {
            return unlinked(format!(
                "by area: constriction {c} leads from the outside; name the voids that particles come into \
                 as inlets"
            ));
        }
        let void = |end: i64| u32::try_from(end).unwrap_or(END);
        let mut from: Vec<u32> = self.conns.iter().map(|&[from, _]| void(from)).collect();
        let mut to: Vec<u32> = self.conns.iter().map(|&[_, to]| void(to)).collect();
        from.extend(self.outlets);
        to.resize(from.len(), END);
        diameter.resize(from.len(), WIDE);
        if !to.contains(&END) {
            return unlinked("it has no outlet: nothing leads out of the filter");
        }
        let start = self.inlets.to_vec();
        let (network, slot) = Network::of_rows(self.voids, &from, &to, &diameter, start, self.unit_mm);
        if !network.leads_out() {
            return unlinked(
                "no open way leads from an inlet to an outlet. By area each constriction is passed in one \
                 direction, from the first of its two voids to the second; by flux both ways",
            );
        }
        Ok((network, slot[..self.conns.len()].to_vec()))
    }

    /// Builds a network in which every constriction can be passed in both directions; one blocking closes
    /// both.
    fn undirected(&self, diameter: &[f32]) -> Result<(Network, Vec<u32>), NetworkError> {
        let poiseuille = |d: f32| libm::pow(f64::from(d), CONDUCTANCE_EXPONENT);
        let conductance = |c: usize| match self.conductance {
            Some(column) => column[c],
            None => poiseuille(diameter[c]),
        };
        let mean = (0..diameter.len()).map(conductance).sum::<f64>() / diameter.len() as f64;
        let end = |end: i64| u32::try_from(end).map_or(LinkEnd::Outside, LinkEnd::Void);
        let link = |(c, &[from, to]): (usize, &[i64; 2])| Link {
            from: end(from),
            to: end(to),
            diameter: diameter[c],
            conductance: conductance(c),
            rise: 0.0,
        };
        let open_link = |from, to| Link { from, to, diameter: WIDE, conductance: mean, rise: 0.0 };
        let mut links: Vec<Link> = self.conns.iter().enumerate().map(link).collect();
        links.extend(self.inlets.iter().map(|&void| open_link(LinkEnd::Outside, LinkEnd::Void(void))));
        links.extend(self.outlets.iter().map(|&void| open_link(LinkEnd::Void(void), LinkEnd::Outside)));
        let voids = LinkedVoids {
            layer: self.layers(),
            unit_mm: self.unit_mm,
            rule: self.rule,
            rho: self.rho,
            ..LinkedVoids::default()
        };
        let (network, mut exit) = Network::linked_numbered(voids, &links)?;
        exit.truncate(self.conns.len());
        let (upstream, reservoir) = (network.upstream(), self.voids as u32);
        for (exit, &[from, _]) in exit.iter_mut().zip(self.conns) {
            let from = u32::try_from(from).unwrap_or(reservoir);
            if *exit != NO_EXIT && upstream[*exit as usize] != from {
                *exit = network.twin(*exit as usize).map_or(*exit, |twin| twin as u32);
            }
        }
        Ok((network, exit))
    }

    /// Minimum number of constrictions between each void and the way in, in either direction.
    fn layers(&self) -> Vec<u32> {
        let inside = |end: i64| u32::try_from(end).ok();
        let ends = self.conns.iter().filter_map(|&[a, b]| Some((inside(a)?, inside(b)?)));
        let (from, to): (Vec<u32>, Vec<u32>) = ends.flat_map(|(a, b)| [(a, b), (b, a)]).unzip();
        let from_outside = self.conns.iter().filter(|ends| ends[0] < 0).map(|ends| ends[1] as u32);
        let start = self.inlets.iter().copied().chain(from_outside).collect();
        let both_ways = Network::of_rows(self.voids, &from, &to, &vec![0.0; to.len()], start, self.unit_mm);
        both_ways.0.layer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::vec::BitVec;

    const CHAIN: NetworkColumns = NetworkColumns {
        voids: 4,
        conns: &[[2, 1], [0, 1], [2, 3]],
        diameter_mm: &[0.3, 0.2, 0.4],
        conductance: None,
        inlets: &[0],
        outlets: &[3],
        rule: ExitRule::Flux,
        rho: 0.0,
        unit_mm: 0.1,
    };

    const CHAIN_DOWN: [[i64; 2]; 3] = [[0, 1], [1, 2], [2, 3]];

    #[test]
    fn constrictions_keep_their_numbers() {
        let (network, exit) = Network::from_columns(&CHAIN).unwrap();
        assert_eq!(network.layer_of()[..4], [0, 1, 2, 3]);
        assert_eq!((network.passages(), network.entries(), network.filter_voids()), (3, 1, 4));
        let mut blocked: BitVec = BitVec::repeat(false, network.constrictions());
        for (c, &exit) in exit.iter().enumerate() {
            let (from, to) = (network.upstream()[exit as usize], network.targets()[exit as usize]);
            assert_eq!([i64::from(from), i64::from(to)], CHAIN.conns[c]);
            let mm = f64::from(network.diameters()[exit as usize]) * 0.1;
            assert!((mm - CHAIN.diameter_mm[c]).abs() < 1e-8);
            network.set_blocked(&mut blocked, exit as usize, true);
            assert_eq!(network.blocked_count(&blocked), c as u64 + 1);
        }
    }

    #[test]
    fn a_directed_network_is_that_of_its_file() {
        let text = "from,to,diameter_mm\nstart,1,\n2,end,0.3\n1,0,0.2\n1,2,0.4\n0,2,0.5\n";
        let file = Network::from_csv(text.as_bytes(), "net.csv", 0.5).unwrap();
        let columns = NetworkColumns {
            voids: 3,
            conns: &[[2, -1], [1, 0], [1, 2], [0, 2]],
            diameter_mm: &[0.3, 0.2, 0.4, 0.5],
            inlets: &[1],
            outlets: &[],
            rule: ExitRule::Area,
            unit_mm: 0.5,
            ..CHAIN
        };
        let (network, exit) = Network::from_columns(&columns).unwrap();
        assert_eq!(network, file);
        assert_eq!(exit, [3, 1, 2, 0]);
        // An outlet is one more exit and cannot be blocked.
        let (network, _) = Network::from_columns(&NetworkColumns { outlets: &[0], ..columns }).unwrap();
        assert_eq!(network.constrictions(), 5);
        assert_eq!((network.targets()[1], network.diameters()[1]), (END, WIDE));
    }

    #[test]
    fn constrictions_that_are_listed_twice_are_refused() {
        let refused = |conns: &[[i64; 2]], diameter_mm: &[f64], rule: ExitRule| {
            let result = Network::from_columns(&NetworkColumns { conns, diameter_mm, rule, ..CHAIN });
            result.is_err_and(|error| error.to_string().contains("listed twice"))
        };
        let (there, back) = (CHAIN_DOWN, CHAIN_DOWN.map(|[a, b]| [b, a]));
        let (d, alike) = ([0.3, 0.2, 0.4], [0.3; 3]);
        for rule in [ExitRule::Flux, ExitRule::Area] {
            assert!(!refused(&there, &d, rule));
            assert!(refused(&[there, back].concat(), &[d, d].concat(), rule));
            assert!(refused(&[there, back].concat(), &[alike, alike].concat(), rule));
            assert!(refused(&[there, there].concat(), &[d, d].concat(), rule));
        }
        // Two constrictions side by side.
        assert!(!refused(&[there, there].concat(), &[alike, alike].concat(), ExitRule::Flux));
        // Rows there and back are one constriction, for any sizes.
        for factor in [1.0 + 1e-12, 1.001, 2.0] {
            let (sizes, rows) = ([d, d.map(|d| d * factor)].concat(), [there, back].concat());
            assert!(refused(&rows, &sizes, ExitRule::Flux) && refused(&rows, &sizes, ExitRule::Area));
        }
        assert!(refused(
            &[there, there].concat(),
            &[d, d.map(|d| d * (1.0 + 1e-12))].concat(),
            ExitRule::Flux
        ));
        // A fifth of the rows of a long chain.
        let long: Vec<[i64; 2]> = (0..40).map(|void| [void, void + 1]).collect();
        let part = |factor: f64| {
            let back = long.iter().take(10).map(|&[a, b]| [b, a]);
            let size = |at: usize| 0.1 + 0.01 * at as f64;
            let sizes: Vec<f64> = (0..40).map(size).chain((0..10).map(|at| factor * size(at))).collect();
            let conns: Vec<[i64; 2]> = long.iter().copied().chain(back).collect();
            let columns =
                NetworkColumns { voids: 41, conns: &conns, diameter_mm: &sizes, outlets: &[40], ..CHAIN };
            Network::from_columns(&columns).is_err()
        };
        assert_eq!([1.0, 1.001, 1.5].map(part), [true, true, false]);
        let few = [&there[..], &there, &back[..1]].concat();
        assert!(!refused(&few, &[0.3, 0.2, 0.4, 0.5, 0.6, 0.7, 0.3], ExitRule::Flux));
    }

    #[test]
    fn what_is_no_network_is_refused() {
        let area = NetworkColumns { rule: ExitRule::Area, ..CHAIN };
        for (columns, message) in [
            (NetworkColumns { diameter_mm: &[1.0], ..CHAIN }, "conns has 3 rows, but diameter has 1"),
            (NetworkColumns { conductance: Some(&[]), ..CHAIN }, "but conductance has 0"),
            (NetworkColumns { conns: &[], diameter_mm: &[], ..CHAIN }, "no constriction"),
            (NetworkColumns { voids: 3, ..CHAIN }, "leads to void 3, but there are 3 voids"),
            (NetworkColumns { conns: &[[-1, -1], [0, 1], [2, 3]], ..CHAIN }, "joins no void"),
            (
                NetworkColumns { diameter_mm: &[f64::NAN, 1.0, 1.0], ..CHAIN },
                "constriction 0 has diameter NaN",
            ),
            (NetworkColumns { diameter_mm: &[1.0, -1.0, 1.0], ..CHAIN }, "constriction 1 has diameter -1"),
            (NetworkColumns { diameter_mm: &[1.0, 1.0, 1e300], ..CHAIN }, "constriction 2 has diameter"),
            (NetworkColumns { conductance: Some(&[1.0, f64::NAN, 1.0]), ..CHAIN }, "conductance NaN"),
            (NetworkColumns { inlets: &[], ..CHAIN }, "no inlet"),
            (NetworkColumns { outlets: &[], ..CHAIN }, "no outlet"),
            (NetworkColumns { inlets: &[0, 0], ..CHAIN }, "void 0 is made an inlet twice"),
            (NetworkColumns { outlets: &[4], ..CHAIN }, "void 4 is made an outlet, but there are 4 voids"),
            (NetworkColumns { diameter_mm: &[0.0, 1.0, 1.0], ..CHAIN }, "no open way"),
            (NetworkColumns { rule: ExitRule::Height, ..CHAIN }, "by height"),
            (NetworkColumns { rho: 1.0, ..CHAIN }, "rho = 1"),
            (NetworkColumns { voids: 5, outlets: &[4], ..CHAIN }, "no open way"),
            (
                NetworkColumns {
                    voids: 5,
                    conns: &CHAIN.conns.iter().map(|c| c.map(|v| v + 1)).collect::<Vec<_>>(),
                    ..CHAIN
                },
                "void 0 is made an inlet, but no constriction",
            ),
            (NetworkColumns { outlets: &[3, 0], ..CHAIN }, "void 0 is made an inlet and an outlet"),
            (NetworkColumns { unit_mm: 0.0, ..CHAIN }, "the unit of length is 0 mm"),
            (NetworkColumns { inlets: &[], ..area }, "no inlet"),
            (NetworkColumns { outlets: &[], ..area }, "no outlet"),
            // Each leads away from the outlet; with water these constrictions could be passed in both
            // directions.
            (NetworkColumns { conns: &[[2, 1], [1, 0], [3, 2]], ..area }, "from the first of its two voids"),
            (NetworkColumns { diameter_mm: &[1.0, 1.0, 0.0], conns: &CHAIN_DOWN, ..area }, "no open way"),
            (NetworkColumns { conns: &[[-1, 1], [0, 1], [2, 3]], ..area }, "leads from the outside"),
            (NetworkColumns { conductance: Some(&[1.0; 3]), ..area }, "conductance says nothing"),
        ] {
            let error = Network::from_columns(&columns).unwrap_err().to_string();
            assert!(error.contains(message), "{error}, not {message}");
        }
    }
}
