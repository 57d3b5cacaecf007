//! Checks that a scene states all that it needs, and nothing that conflicts with the rest.

use super::keys::concentrations;
use super::{NetworkMadeOf, Scene, SceneError};
use voidwalk_core::network::ExitRule;
use voidwalk_core::schema::GivenSettings;
use voidwalk_core::walk::Engine;

impl Scene {
    /// Refuses a scene that leaves a question open, or answers one that is not asked.
    pub(super) fn check_what_is_missing(&self, s: &GivenSettings) -> Result<(), SceneError> {
        let filter = &self.filter;
        if filter.curve.is_none()
            && filter.library.is_none()
            && filter.estimate.is_none()
            && self.packing.is_none()
            && self.network.file.is_none()
            && self.network.packing.is_none()
        {
            return Err(s.clash(
                "the filter's constrictions are missing: filter.density = \"loose\" (or \"intermediate\", \
                 \"dense\") packs its grains; filter.library = \"loose\" takes them from the library of \
                 packings; filter.curve names a shipped curve, or a CSV file with \
                 percent_smaller,diameter_mm",
            ));
        }
        if filter.measured.is_some() && (self.packing.is_none() || filter.grains_per_void.is_none()) {
            return Err(s.clash(
                "filter.measured goes with filter.grains_per_void, and filter.density or filter.friction",
            ));
        }
        self.check_network(s)?;
        let base = &self.base;
        if base.cu.is_none() && base.sieve.is_none() && base.single_mm.is_none() {
            return Err(
                s.clash("the base is missing: give base.cu (with D85B), base.sieve or base.single_mm")
            );
        }
        if base.cu.is_some() && base.d85().is_none() {
            return Err(s.clash("base.cu needs one of base.d85_mm, base.d85_at_dc, base.d15f_over_d85b"));
        }
        if s.has("stop.most_replicates") && self.stop.is_unset() {
            return Err(s.clash(
                "stop.most_replicates says nothing without stop.target_error_pp or stop.decide_percent",
            ));
        }
        self.packing_spec().map(drop)
    }

    /// Refuses a network that is half a lattice and half a graph, and an exit rule that does not go with it.
    fn check_network(&self, s: &GivenSettings) -> Result<(), SceneError> {
        let graph = self.network.kind == Some(NetworkMadeOf::Graph);
        let wrong = |names: &[&str], problem: &str| match names.iter().find(|name| s.has(name)) {
            Some(name) => Err(s.clash(format!("{name} {problem}"))),
            None => Ok(()),
        };
        if graph {
            wrong(
                &["network.nx", "network.ny", "network.nz", "network.connectivity", "network.file"],
                "does not go with network.kind = \"graph\": a packing has its voids where they are",
            )?;
            wrong(&["walk.conductance_exponent"], "is for a lattice: a packing's voids conduct as they do")?;
            if self.network.packing.is_some() {
                let problem = "says what the constrictions are, but network.packing brings its own: keep one";
                wrong(&["filter.curve", "filter.library", "filter.estimate"], problem)?;
                // A run keeps the grains of the filter that it packed, and states both.
                if self.filter.measured.is_none() {
                    wrong(&["filter.density", "filter.friction"], problem)?;
                }
            }
            if self.network.packing.is_none() && self.packing.is_none() {
                return Err(s.clash(
                    "network.kind = \"graph\" needs grains: filter.density packs them, or network.packing \
                     names a file of them",
                ));
            }
        } else {
            wrong(&["network.packing", "network.copies"], "goes with network.kind = \"graph\"")?;
        }
        if self.network.file.is_some() {
            wrong(
                &["record.voids"],
                "needs to know where voids lie, which a network from a file does not say",
            )?;
        }
        let of_arrays = self.network.is_of_arrays();
        if self.network.packing.is_none() {
            wrong(&["network.cell"], "goes with network.packing")?;
            if !of_arrays {
                wrong(&["network.unit"], "goes with network.packing, or with an .npz as network.file")?;
            }
        }
        if of_arrays {
            wrong(
                &["walk.conductance_exponent"],
                "is for a lattice: arrays say what conducts, or the fourth power does",
            )?;
        }
        if self.network.file.is_some() || self.network.connectivity.is_some() {
            wrong(&["network.thickness_mm", "network.thickness_d50f"], "is for a lattice or a graph")?;
        }
        let rule = self.exit_rule();
        let allowed: &[ExitRule] = match (graph, &self.network.file, &self.network.connectivity) {
            (false, Some(_), _) if of_arrays => &[ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Area],
            (true, ..) => &[ExitRule::Flux, ExitRule::AreaAlongFlow, ExitRule::Height],
            (false, None, None) => &[ExitRule::Area, ExitRule::Flux, ExitRule::AreaAlongFlow],
            _ => &[ExitRule::Area],
        };
        if !allowed.contains(&rule) {
            let words: Vec<String> = allowed.iter().map(|rule| format!("\"{}\"", rule.name())).collect();
            return Err(s.refuse(
                "walk.exit",
                format!(
                    "{} on this network: {}",
                    words.join(", "),
                    match graph {
                        true =>
                            "the constrictions of a graph have no direction of their own, so that area alone \
                             leads nowhere",
                        false => "the rule needs to know which way is which",
                    }
                ),
            ));
        }
        if !rule.needs_flow() {
            wrong(
                &["walk.rho", "walk.flow_tolerance", "walk.conductance_exponent"],
                "says nothing where no water flows: walk.exit",
            )?;
        }
        if self.leaves_openings() {
            wrong(
                &["walk.rho", "walk.conductance_exponent"],
                "says nothing where walk.blocked is \"open\": what openings conduct follows from the fourth \
                 power of their size",
            )?;
            if matches!(self.walk.engine, Engine::Counts | Engine::Expected) {
                let problem = format!(
                    "\"particles\" or \"auto\": where walk.blocked is \"open\" any particle may be stopped, \
                     and \"{}\" counts those that cannot be",
                    self.walk.engine.name()
                );
                return Err(s.refuse("engine", problem));
            }
        }
        match self.law().filter(|law| law.of_concentration) {
            None => {
                wrong(&["walk.concentration"], "says nothing without a law of arching that depends on it")
            }
            Some(law) if self.exits.concentration.is_none() => Err(s.clash(format!(
                "walk.concentration is missing: \"{}\" depends on the solids fraction of the suspension that \
                 enters the filter (volume of particles by volume of suspension), {}",
                law.name,
                concentrations()
            ))),
            Some(_) => Ok(()),
        }
    }
}
