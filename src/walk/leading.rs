//! From which voids open constrictions lead to given ones.

use crate::network::Network;

/// By void: whether it is one of those wanted, or open constrictions lead from it to one.
pub(super) fn leading_to(
    network: &Network,
    open: impl Fn(usize) -> bool,
    wanted: impl Fn(&u32) -> bool,
) -> Vec<bool> {
    let (begin, entrances) = network.entrances();
    let upstream = network.upstream();
    let mut stack: Vec<u32> = (0..network.voids() as u32).filter(wanted).collect();
    let mut leads = vec![false; network.voids()];
    stack.iter().for_each(|&void| leads[void as usize] = true);
    while let Some(void) = stack.pop() {
        for &entrance in &entrances[begin[void as usize] as usize..begin[void as usize + 1] as usize] {
            let above = upstream[entrance as usize];
            if open(entrance as usize) && !leads[above as usize] {
                leads[above as usize] = true;
                stack.push(above);
            }
        }
    }
    leads
}
