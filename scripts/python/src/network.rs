//! Networks: from columns, lattices, the voids of a packing, files.

use std::sync::Arc;

use bitvec::slice::BitSlice;
use bitvec::vec::BitVec;
use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use voidwalk::constrictions::VoidGraph;
use voidwalk::network::{
    self, CONDUCTANCE_EXPONENT, END, ExitRule, Flow, GraphShape, NO_EXIT, NO_LAYER, NetworkColumns, WIDE,
};
use voidwalk::run::RunError;
use voidwalk::run::machine::threads as pool;
use voidwalk::store::read_regular;

use crate::arrays::{Grains, column, of_rows, rows, voids};
use crate::problem::{failed, of_network, refused};
use crate::soil::Curve;
use crate::work::at_work;

/// A network of the library, and the exit of each throat.
#[pyclass(frozen, module = "voidwalk._voidwalk")]
pub struct Network {
    pub inner: Arc<network::Network>,
    exit: Vec<u32>,
}

fn rule(name: &str) -> PyResult<ExitRule> {
    let words = ExitRule::ALL.map(ExitRule::name).join(", ");
    let rule = ExitRule::ALL.into_iter().find(|rule| rule.name() == name);
    rule.ok_or_else(|| refused(format!("exit = {name} is not allowed; one of {words}")))
}

impl From<network::Network> for Network {
    /// Makes every constriction a throat, each once; entrances and exits that nothing can block are left out.
    fn from(inner: network::Network) -> Self {
        let is_throat = |c: &usize| inner.diameters()[*c] != WIDE && inner.counts(*c);
        let exit = (0..inner.constrictions()).filter(is_throat).map(|c| c as u32).collect();
        Self { inner: Arc::new(inner), exit }
    }
}

impl Network {
    /// Blocked throats.
    pub fn blocked(&self, exits: &BitSlice) -> impl Iterator<Item = bool> {
        self.exit.iter().map(|&exit| exit != NO_EXIT && exits[exit as usize])
    }

    pub fn throat_count(&self) -> usize {
        self.exit.len()
    }

    fn nothing_blocked(&self) -> BitVec {
        BitVec::repeat(false, self.inner.constrictions())
    }

    /// The network with the directions that water gives its constrictions, and the flow, if water flows.
    fn with_directions(&self) -> PyResult<(network::Network, Option<Flow>)> {
        let mut inner = (*self.inner).clone();
        if !inner.exit_rule().needs_flow() {
            return Ok((inner, None));
        }
        let open = self.nothing_blocked();
        let mut flow = Flow::new(&inner);
        flow.solve_closely(&inner, &open).map_err(failed)?;
        flow.direct(&mut inner);
        Ok((inner, Some(flow)))
    }

    /// Voids of the filter at one end of an exit which is not a constriction.
    fn wide_ends(&self, leads_in: bool) -> Vec<i64> {
        let (n, upstream) = (&self.inner, self.inner.upstream());
        let reservoir = n.reservoir();
        let wide = (0..n.constrictions()).filter(|&c| n.diameters()[c] == WIDE);
        let end = |c: usize| match (Some(upstream[c]) == reservoir, n.targets()[c]) {
            (true, to) => leads_in.then_some(i64::from(to)),
            (false, END) => (!leads_in).then_some(i64::from(upstream[c])),
            (false, _) => None,
        };
        wide.filter_map(end).collect()
    }
}

#[pymethods]
impl Network {
    #[staticmethod]
    fn from_columns(
        py: Python<'_>,
        pores: usize,
        conns: PyReadonlyArray2<'_, i64>,
        diameter: PyReadonlyArray1<'_, f64>,
        conductance: Option<PyReadonlyArray1<'_, f64>>,
        inlets: PyReadonlyArray1<'_, i64>,
        outlets: PyReadonlyArray1<'_, i64>,
        exit: &str,
        rho: f64,
        unit_mm: f64,
    ) -> PyResult<Self> {
        let inlets = voids("inlets", column("inlets", &inlets)?)?;
        let outlets = voids("outlets", column("outlets", &outlets)?)?;
        let columns = NetworkColumns {
            voids: pores,
            conns: rows("conns", &conns)?,
            diameter_mm: column("diameter", &diameter)?,
            conductance: conductance.as_ref().map(|array| column("conductance", array)).transpose()?,
            inlets: &inlets,
            outlets: &outlets,
            rule: rule(exit)?,
            rho,
            unit_mm,
        };
        let (inner, exit) =
            py.detach(|| network::Network::from_columns(&columns)).map_err(|error| of_network(&error))?;
        Ok(Self { inner: Arc::new(inner), exit })
    }

    #[staticmethod]
    fn cubic(
        py: Python<'_>,
        shape: [u32; 3],
        curve: &Curve,
        unit_mm: f64,
        seed: u64,
        exit: &str,
        rho: f64,
    ) -> PyResult<Self> {
        let (rule, curve) = (rule(exit)?, &curve.inner);
        network::Network::lattice_constrictions(shape).map_err(|error| of_network(&error))?;
        let lattice = at_work(py, None, |_| {
            pool(None)?.install(|| {
                let lattice = network::Network::cubic(shape, curve, unit_mm, seed);
                let turned = lattice.and_then(|lattice| match rule {
                    ExitRule::Area => Ok(lattice),
                    rule => lattice.undirected_lattice(rule, rho, CONDUCTANCE_EXPONENT),
                });
                turned.map_err(RunError::refused)
            })
        });
        Ok(lattice?.into())
    }

    #[staticmethod]
    fn of_packing(
        py: Python<'_>,
        grains: Grains<'_>,
        merge_overlap: f64,
        copies: u32,
        exit: &str,
        rho: f64,
    ) -> PyResult<Self> {
        let (grains, rule) = (grains.packing()?, rule(exit)?);
        if rule == ExitRule::Area {
            let problem =
                "the voids of a packing have no direction of their own, so that area alone leads nowhere";
            return Err(refused(format!("exit = area is not allowed: {problem}")));
        }
        let network = at_work(py, None, |_| {
            pool(None)?.install(|| {
                let (_, graph) = VoidGraph::measure(&grains, merge_overlap).map_err(RunError::refused)?;
                let shape = GraphShape { copies, rule, rho, unit_mm: graph.d0_mm };
                network::Network::of_graph(&graph, shape).map_err(RunError::refused)
            })
        });
        Ok(network?.into())
    }

    #[staticmethod]
    fn from_csv(py: Python<'_>, path: std::path::PathBuf, unit_mm: f64) -> PyResult<Self> {
        let name = path.display().to_string();
        // A pipe is not waited for.
        let bytes = read_regular(&path, u64::MAX).map_err(|error| refused(format!("{name}: {error}")))?;
        let bytes = bytes.ok_or_else(|| refused(format!("{name}: is not a regular file")))?;
        let read = py.detach(|| network::Network::from_csv(&bytes, &name, unit_mm));
        Ok(read.map_err(|error| of_network(&error))?.into())
    }

    /// The network as the CSV that a scene names as network.file.
    fn to_csv<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        if self.inner.reservoir().is_some() {
            let problem = "a network file holds constrictions with a direction, and this network has none";
            return Err(refused(problem));
        }
        let mut text = Vec::new();
        self.inner.write_csv(&mut text)?;
        Ok(PyBytes::new(py, &text))
    }

    #[getter]
    fn pores(&self) -> usize {
        self.inner.filter_voids()
    }

    #[getter]
    fn unit_mm(&self) -> f64 {
        self.inner.unit_mm()
    }

    #[getter]
    fn exit(&self) -> &'static str {
        self.inner.exit_rule().name()
    }

    #[getter]
    fn layers(&self) -> usize {
        self.inner.layers()
    }

    #[getter]
    fn fingerprint(&self) -> String {
        format!("{:016x}", self.inner.fingerprint())
    }

    /// Pores at both ends of each throat; -1 is the outside.
    fn conns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let (n, upstream) = (&self.inner, self.inner.upstream());
        let inside = |void: u32| match void == END || Some(void) == n.reservoir() {
            true => -1,
            false => i64::from(void),
        };
        let ends = |&exit: &u32| match exit {
            NO_EXIT => [-1, -1],
            exit => {
                let (from, to) = (upstream[exit as usize], n.targets()[exit as usize]);
                // Seen from inside, a way in leads to the reservoir.
                match Some(to) == n.reservoir() {
                    true => [-1, inside(from)],
                    false => [inside(from), inside(to)],
                }
            }
        };
        of_rows(py, self.exit.iter().map(ends).collect())
    }

    /// Diameter (mm) of each throat.
    fn diameter<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let n = &self.inner;
        let mm = |&exit: &u32| match exit {
            NO_EXIT => f64::NAN,
            exit => f64::from(n.diameters()[exit as usize]) * n.unit_mm(),
        };
        self.exit.iter().map(mm).collect::<Vec<f64>>().into_pyarray(py).into_any()
    }

    /// Conductance times viscosity of each throat, in the unit of the input; 0 if constrictions have a
    /// direction.
    fn conductance<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let value = |&exit: &u32| if exit == NO_EXIT { 0.0 } else { self.inner.conductance(exit as usize) };
        self.exit.iter().map(value).collect::<Vec<f64>>().into_pyarray(py).into_any()
    }

    /// Pores that particles come into by ways that nothing can block.
    fn inlets<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let inlets = match self.inner.reservoir() {
            Some(_) => self.wide_ends(true),
            None => self.inner.start().iter().map(|&void| i64::from(void)).collect(),
        };
        inlets.into_pyarray(py).into_any()
    }

    /// Pores that particles leave by ways that nothing can block.
    fn outlets<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.wide_ends(false).into_pyarray(py).into_any()
    }

    /// Layer of each pore; -1 if nothing leads to it.
    fn layer<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let layer = |&layer: &u32| if layer == NO_LAYER { -1 } else { i64::from(layer) };
        let layers: Vec<i64> = self.inner.layer_of().iter().take(self.pores()).map(layer).collect();
        layers.into_pyarray(py).into_any()
    }

    /// Probability that the first particle of a diameter leaves the filter, and its mean number of moves.
    fn first_passage(&self, py: Python<'_>, diameter_mm: f64) -> PyResult<(f64, f64)> {
        let size = (diameter_mm / self.inner.unit_mm()) as f32;
        if !(size.is_finite() && size > 0.0) {
            let allowed = "allowed: a size in mm above 0";
            return Err(refused(format!("diameter = {diameter_mm} is not allowed; {allowed}")));
        }
        py.detach(|| {
            let (inner, _) = self.with_directions()?;
            let passage = inner.first_passage(size, |_| false).map_err(|error| of_network(&error))?;
            Ok(passage.at_start(&inner))
        })
    }

    /// Pressure by pore (1 before the filter, 0 behind it) and flow times viscosity through each throat, from
    /// its first pore to its second, if water decides the exits of particles.
    fn flow<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let (pressure, flux) = py.detach(|| {
            let (inner, Some(flow)) = self.with_directions()? else {
                return Err(refused("no water flows where particles choose by area"));
            };
            let flux = |&exit: &u32| match exit {
                NO_EXIT => 0.0,
                exit => {
                    let flux = flow.flux(exit as usize);
                    // Seen from inside, a way in leads out.
                    if Some(inner.targets()[exit as usize]) == inner.reservoir() { -flux } else { flux }
                }
            };
            let flux: Vec<f64> = self.exit.iter().map(flux).collect();
            Ok((flow.pressure()[..self.pores()].to_vec(), flux))
        })?;
        Ok((pressure.into_pyarray(py).into_any(), flux.into_pyarray(py).into_any()))
    }
}
