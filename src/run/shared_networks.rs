//! Networks that several cases of a campaign walk, built once.
//!
//! Cases with one seed draw their networks from the same random numbers; where nothing that makes a network
//! differs, it is the same network, and one of them is enough. The bits are those of networks that each case
//! builds for itself. With a network stay the exits that its first runs begin with.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

use crate::case::Case;
use crate::network::{Network, NetworkError};
use crate::walk::UnblockedExits;

/// Networks that are kept take no more than this (bytes), and no more than one part in so many of what the
/// walks may take.
const MOST_BYTES: u64 = 1 << 27;
const PART: u64 = 16;

/// A network, and where nothing of it is blocked, which exits draws pick, as far as somebody keeps both.
pub struct NetworkToWalk {
    /// The network.
    pub network: Network,
    /// Its exits.
    pub open: Option<UnblockedExits>,
}

/// Networks by what makes them.
pub struct SharedNetworks {
    kept: Mutex<VecDeque<(u128, Arc<NetworkToWalk>)>>,
    most_bytes: u64,
}

impl SharedNetworks {
    /// What is kept, where walks and networks together may take so much memory (bytes).
    pub fn bytes(memory: u64) -> u64 {
        MOST_BYTES.min(memory / PART)
    }

    /// Keeps none yet, and never more than so many bytes; the network that was kept first goes first.
    pub fn new(most_bytes: u64) -> Self {
        Self { kept: Mutex::default(), most_bytes }
    }

    /// The network of the replicate of a case with this seed, as [`Case::network`] builds it.
    ///
    /// # Errors
    /// As [`Case::network`].
    pub fn get(&self, case: &Case, seed: u64) -> Result<Arc<NetworkToWalk>, NetworkError> {
        let Some(key) = case.network_key(seed) else {
            return Ok(Arc::new(NetworkToWalk { network: case.network(seed)?, open: None }));
        };
        if let Some(network) = self.find(key) {
            return Ok(network);
        }
        // Others are found meanwhile; two that build the same one build the same bits.
        let network = case.network(seed)?;
        let open = case.begins_with_plain_exits().then(|| UnblockedExits::new(&network));
        let found = Arc::new(NetworkToWalk { network, open });
        let most = (self.most_bytes / case.shared_network_bytes().max(1)) as usize;
        if let Ok(mut kept) = self.kept.lock() {
            if kept.iter().all(|(other, _)| *other != key) {
                kept.push_back((key, found.clone()));
            }
            while kept.len() > most {
                kept.pop_front();
            }
        }
        Ok(found)
    }

    fn find(&self, key: u128) -> Option<Arc<NetworkToWalk>> {
        let kept = self.kept.lock().ok()?;
        kept.iter().find(|(other, _)| *other == key).map(|(_, network)| network.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn case(settings: &[&str]) -> Case {
        let small = ["network.nx=6", "network.ny=6", "network.nz=8"];
        let settings: Vec<String> = small.iter().chain(settings).map(|s| s.to_string()).collect();
        Case::new(Scene::built_in(&settings).unwrap()).unwrap()
    }

    #[test]
    fn what_makes_no_network_shares_it_and_what_makes_one_does_not() {
        let shared = SharedNetworks::new(MOST_BYTES);
        let own = case(&[]);
        let network = shared.get(&own, 5).unwrap();
        assert_eq!(network.network.fingerprint(), own.network(5).unwrap().fingerprint());
        for same in [vec!["base.cu=3"], vec!["base.n_base=1000"], vec!["replicates=3"], vec!["engine=counts"]]
        {
            assert!(Arc::ptr_eq(&network, &shared.get(&case(&same), 5).unwrap()), "{same:?}");
        }
        for other in [
            vec!["network.nx=7"],
            vec!["filter.curve=shire2016-cu1.5-dense"],
            vec!["walk.exit=flux"],
            vec!["network.connectivity=table3"],
            vec!["filter.d0_mm=2"],
        ] {
            let (other, name) = (case(&other), other);
            let found = shared.get(&other, 5).unwrap();
            assert!(!Arc::ptr_eq(&network, &found), "{name:?}");
            assert_eq!(found.network.fingerprint(), other.network(5).unwrap().fingerprint(), "{name:?}");
        }
        assert!(!Arc::ptr_eq(&network, &shared.get(&own, 6).unwrap()));
    }

    /// Exits are worked out only where first runs begin with them.
    #[test]
    fn exits_stay_with_the_networks_whose_walks_take_them() {
        let shared = SharedNetworks::new(MOST_BYTES);
        let has_exits = |set: &[&str]| shared.get(&case(set), 5).unwrap().open.is_some();
        assert!(has_exits(&["engine=expected"]));
        for without in [
            vec!["engine=particles"],
            vec!["engine=expected", "network.connectivity=table3"],
            vec!["walk.exit=flux"],
        ] {
            let other = SharedNetworks::new(MOST_BYTES);
            assert!(other.get(&case(&without), 5).unwrap().open.is_none(), "{without:?}");
        }
    }

    #[test]
    fn no_more_are_kept_than_there_is_room_for() {
        let case = case(&[]);
        let shared = SharedNetworks::new(7 * case.shared_network_bytes());
        for seed in 0..9 {
            shared.get(&case, seed).unwrap();
        }
        assert_eq!(shared.kept.lock().unwrap().len(), 7);
        assert_eq!((SharedNetworks::bytes(1 << 40), SharedNetworks::bytes(160)), (MOST_BYTES, 10));
    }
}
