//! Networks that several cases of a campaign share, built once.
//!
//! Cases with the same seed draw their networks from the same random numbers. If all inputs of a network
//! agree, each case would build the same bits, and one copy is enough. The exits with which first runs begin
//! are kept with a network, as far as there is room.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock};

use crate::case::Case;
use voidwalk_core::network::{Network, NetworkError};
use voidwalk_core::walk::PlainExits;

/// Maximum memory of the kept networks (bytes), and their maximum fraction of the memory for walks, as a
/// divisor.
const MOST_BYTES: u64 = 1 << 27;
const PART: u64 = 16;

/// Exits drawn on a network without blocked constrictions, once a case has computed them.
type KeptExits = Arc<OnceLock<PlainExits>>;

/// Network to walk, and its exits if they are kept.
#[derive(Clone)]
pub(crate) struct NetworkToWalk {
    pub(crate) network: Arc<Network>,
    exits: Option<KeptExits>,
}

impl NetworkToWalk {
    /// Network that is not shared.
    pub(crate) fn own(network: Network) -> Self {
        Self { network: Arc::new(network), exits: None }
    }

    /// Exits with which the first run of a case begins, computed by the first case that asks for them. `None`
    /// if they are not kept, or if the case begins with other exits.
    pub(crate) fn exits(&self, case: &Case) -> Option<&PlainExits> {
        let kept = self.exits.as_ref().filter(|_| case.begins_with_plain_exits())?;
        if kept.get().is_none() {
            // No case waits here: two cases that compute the exits get the same bits.
            let _ = kept.set(PlainExits::unblocked(&self.network));
        }
        kept.get()
    }
}

struct KeptNetwork {
    key: u128,
    to_walk: NetworkToWalk,
    /// Memory of the network and of its exits (bytes).
    bytes: [u64; 2],
}

impl KeptNetwork {
    fn bytes(&self) -> u64 {
        let [network, exits] = self.bytes;
        network.saturating_add(if self.to_walk.exits.is_some() { exits } else { 0 })
    }
}

/// Networks, each under the key of its inputs.
pub(crate) struct SharedNetworks {
    kept: Mutex<VecDeque<KeptNetwork>>,
    most_bytes: u64,
}

impl SharedNetworks {
    /// Memory for kept networks if walks and networks together may take this much (bytes).
    pub(crate) fn bytes(memory: u64) -> u64 {
        MOST_BYTES.min(memory / PART)
    }

    /// Creates an empty store of at most this many bytes. Exits are dropped before networks, the oldest
    /// first.
    pub(crate) fn new(most_bytes: u64) -> Self {
        Self { kept: Mutex::default(), most_bytes }
    }

    /// Network of the replicate of a case with this seed, as built by [`Case::network`].
    pub(crate) fn get(&self, case: &Case, seed: u64) -> Result<NetworkToWalk, NetworkError> {
        let Some(key) = case.network_key(seed) else {
            return Ok(NetworkToWalk::own(case.network(seed)?));
        };
        if let Some(network) = self.find(key) {
            return Ok(network);
        }
        // Others may look up networks meanwhile; two threads that build the same network build the same bits.
        let bytes = case.shared_network_bytes();
        let exits = (bytes[1] > 0).then(KeptExits::default);
        let to_walk = NetworkToWalk { network: Arc::new(case.network(seed)?), exits };
        self.keep(KeptNetwork { key, to_walk: to_walk.clone(), bytes });
        Ok(self.find(key).unwrap_or(NetworkToWalk { exits: None, ..to_walk }))
    }

    fn keep(&self, new: KeptNetwork) {
        let Ok(mut kept) = self.kept.lock() else { return };
        if kept.iter().any(|other| other.key == new.key) {
            return;
        }
        kept.push_back(new);
        let mut bytes = kept.iter().map(KeptNetwork::bytes).fold(0, u64::saturating_add);
        for entry in kept.iter_mut() {
            if bytes > self.most_bytes && entry.to_walk.exits.take().is_some() {
                bytes -= entry.bytes[1];
            }
        }
        while bytes > self.most_bytes
            && let Some(first) = kept.pop_front()
        {
            bytes -= first.bytes();
        }
    }

    fn find(&self, key: u128) -> Option<NetworkToWalk> {
        let kept = self.kept.lock().ok()?;
        Some(kept.iter().find(|other| other.key == key)?.to_walk.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::case_of;

    fn case(settings: &[&str]) -> Case {
        case_of(&[&["network.nx=6", "network.ny=6", "network.nz=8"], settings].concat())
    }

    #[test]
    fn what_makes_no_network_shares_it_and_what_makes_one_does_not() {
        let shared = SharedNetworks::new(MOST_BYTES);
        let case_itself = case(&[]);
        let network = shared.get(&case_itself, 5).unwrap().network;
        assert_eq!(network.fingerprint(), case_itself.network(5).unwrap().fingerprint());
        for same in ["base.cu=3", "base.n_base=1000", "replicates=3", "engine=counts"] {
            assert!(Arc::ptr_eq(&network, &shared.get(&case(&[same]), 5).unwrap().network), "{same}");
        }
        for name in [
            "network.nx=7",
            "filter.curve=shire2016-cu1.5-dense",
            "walk.exit=flux",
            "network.connectivity=table3",
            "filter.d0_mm=2",
        ] {
            let other = case(&[name]);
            let other_network = shared.get(&other, 5).unwrap().network;
            assert!(!Arc::ptr_eq(&network, &other_network), "{name}");
            assert_eq!(other_network.fingerprint(), other.network(5).unwrap().fingerprint(), "{name}");
        }
        assert!(!Arc::ptr_eq(&network, &shared.get(&case_itself, 6).unwrap().network));
    }

    /// Exits are computed only if first runs begin with them, whichever case built the network.
    #[test]
    fn exits_stay_with_the_networks_whose_walks_take_them() {
        let shared = SharedNetworks::new(MOST_BYTES);
        let exits_of = |set: &[&str]| {
            let (case, mut at) = (case(set), None);
            let shared_network = shared.get(&case, 5).unwrap();
            let has_some =
                shared_network.exits(&case).inspect(|exits| at = Some(std::ptr::from_ref(*exits) as usize));
            assert_eq!(has_some.is_some(), case.begins_with_plain_exits(), "{set:?}");
            at
        };
        for without in ["engine=particles", "network.connectivity=table3", "walk.exit=flux"] {
            assert_eq!(exits_of(&[without]), None, "{without}");
        }
        let first = exits_of(&["engine=expected"]);
        assert!(first.is_some() && exits_of(&["engine=counts", "base.cu=3"]) == first);
    }

    #[test]
    fn exits_go_before_networks_and_the_oldest_first() {
        let case = case(&["engine=expected"]);
        let [network, exits] = case.shared_network_bytes();
        assert!(exits > network && network > 0);
        let kept = |most: u64, seeds: u64| {
            let shared = SharedNetworks::new(most);
            for seed in 0..seeds {
                let has_room = network + exits <= most && most >= seeds * network + exits;
                let network = shared.get(&case, seed).unwrap();
                assert!(!has_room || network.exits(&case).is_some());
            }
            let kept = shared.kept.lock().unwrap();
            let bytes: u64 = kept.iter().map(KeptNetwork::bytes).sum();
            assert!(bytes <= most);
            let shown: String =
                kept.iter().map(|entry| if entry.to_walk.exits.is_some() { '+' } else { '-' }).collect();
            (shown, kept.iter().map(|entry| entry.key).collect::<Vec<_>>())
        };
        assert_eq!(kept(3 * (network + exits), 3).0, "+++");
        assert_eq!(kept(3 * (network + exits), 4).0, "--++");
        assert_eq!(kept(7 * network, 7).0, "-------");
        let (shown, keys) = kept(7 * network, 9);
        assert_eq!((shown.as_str(), keys[0]), ("-------", case.network_key(2).unwrap()));
        // If nothing fits, it keeps nothing and computes no exits.
        assert_eq!(kept(network - 1, 2).0, "");
        let none = SharedNetworks::new(0).get(&case, 1).unwrap();
        assert!(none.exits(&case).is_none());
        assert_eq!((SharedNetworks::bytes(1 << 40), SharedNetworks::bytes(160)), (MOST_BYTES, 10));
    }
}
