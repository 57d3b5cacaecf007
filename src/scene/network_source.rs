//! Where a scene's network comes from.

use std::path::PathBuf;

use super::settings::{SceneError, Settings, Value};
use crate::network::{Connectivity, NetworkError};

/// The network to walk.
#[derive(Clone, Debug, PartialEq)]
pub enum NetworkSource {
    /// The directed cubic lattice with this many voids along x, y, z.
    Cubic([u32; 3]),
    /// The lattice changed until its voids have this distribution of connectivity.
    Connected([u32; 3], Connectivity),
    /// A CSV file.
    File(PathBuf),
}

const NAME: &str = "network.connectivity";
const ALLOWED: &str = "\"table3\", or a table of percent of the voids by connectivity, as { 4 = 10, 5 = 20, 6 = 40, 7 = 20, 8 = 10 }";

impl NetworkSource {
    pub(super) fn of(s: &Settings) -> Result<Self, SceneError> {
        let file = s.path("network.file")?;
        let length = |name| s.whole(name, 1..=u64::from(u32::MAX));
        let shape = [length("network.nx")?, length("network.ny")?, length("network.nz")?];
        let connectivity = connectivity(s)?;
        if let Some(path) = file {
            if shape.iter().any(Option::is_some) || connectivity.is_some() {
                return Err(s.clash(
                    "network.file gives the network, and so do network.nx, ny, nz and network.connectivity: keep one",
                ));
            }
            return Ok(Self::File(path));
        }
        let [nx, ny, nz] = shape;
        let shape = [nx.unwrap_or(40) as u32, ny.unwrap_or(40) as u32, nz.unwrap_or(60) as u32];
        Ok(match connectivity {
            Some(connectivity) => Self::Connected(shape, connectivity),
            None => Self::Cubic(shape),
        })
    }

    /// Voids along x, y, z, where the network is a lattice.
    pub fn shape(&self) -> Option<[u32; 3]> {
        match self {
            Self::Cubic(shape) | Self::Connected(shape, _) => Some(*shape),
            Self::File(_) => None,
        }
    }
}

fn connectivity(s: &Settings) -> Result<Option<Connectivity>, SceneError> {
    let percent = match s.value(NAME) {
        None => return Ok(None),
        Some(Value::Text(text)) if text == "table3" => return Ok(Some(Connectivity::table_3())),
        Some(Value::Table(items)) => {
            let one = |(k, share): &(String, Value)| Some((k.parse::<u32>().ok()?, share.number()?));
            items.iter().map(one).collect::<Option<Vec<_>>>()
        }
        Some(_) => None,
    };
    let Some(percent) = percent else { return Err(s.refuse(NAME, ALLOWED)) };
    match Connectivity::new(&percent) {
        Ok(connectivity) => Ok(Some(connectivity)),
        Err(NetworkError::Connectivity { allowed, .. }) => Err(s.refuse(NAME, allowed)),
        Err(other) => Err(s.refuse(NAME, other.to_string())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn a_distribution_is_given_by_name_or_as_a_table() {
        let of = |network: &str| {
            let text = format!("[filter]\ncurve = \"a.csv\"\n[base]\nsingle_mm = 1\n{network}");
            Scene::parse(text.as_bytes(), "s.toml", &[]).map(|scene| scene.network)
        };
        let table_3 = NetworkSource::Connected([40, 40, 60], Connectivity::table_3());
        assert_eq!(of("[network]\nconnectivity = \"table3\"").unwrap(), table_3);
        for text in [
            "[network]\nnx = 5\nconnectivity = { 5 = 50, 7 = 50.0 }",
            "[network]\nnx = 5\n[network.connectivity]\n7 = 50\n5 = 50",
        ] {
            let expected = Connectivity::new(&[(5, 50.0), (7, 50.0)]).unwrap();
            assert_eq!(of(text).unwrap(), NetworkSource::Connected([5, 40, 60], expected));
        }
        for (text, message) in [
            (
                "connectivity = \"table4\"",
                "s.toml, line 6, network.connectivity: `table4` is not allowed; \"table3\"",
            ),
            ("connectivity = { 6 = 90 }", "`{ 6 = 90 }` is not allowed; percentages that sum to 100"),
            ("connectivity = { six = 100 }", "`{ six = 100 }` is not allowed; \"table3\", or a table"),
            ("connectivity = { 6 = \"all\" }", "is not allowed; \"table3\", or a table"),
            ("connectivity = { 1 = 100 }", "from 2"),
            ("connectivity = [6, 100]", "is not allowed"),
            ("connectivity = \"table3\"\nfile = \"n.csv\"", "keep one"),
        ] {
            let error = of(&format!("[network]\n{text}")).unwrap_err().to_string();
            assert!(error.starts_with("s.toml") && error.contains(message), "{text}: {error}");
        }
    }

    #[test]
    fn the_command_line_replaces_a_file_by_a_distribution_and_back() {
        let set = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(ToString::to_string).collect();
            Scene::built_in(&names).unwrap().network
        };
        let table_3 = NetworkSource::Connected([8, 40, 60], Connectivity::table_3());
        assert_eq!(set(&["network.file=n.csv", "network.connectivity=table3", "network.nx=8"]), table_3);
        assert_eq!(
            set(&["network.connectivity={6=100}", "network.file=n.csv"]),
            NetworkSource::File("n.csv".into())
        );
    }
}
