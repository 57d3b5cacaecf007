//! The findings of a case in the order in which every face shows them.

use super::entry::Finding;
use super::finding::ALL;
use super::practice;
use crate::outcome::record::{AppliedRule, FindingRecord};

/// The place of a finding in the table.
pub fn rank(finding: &Finding) -> Option<usize> {
    ALL.iter().position(|entry| entry.id == finding.id())
}

/// The findings of a case and of its rules of practice, each once, in the order of the table.
pub fn ordered(rules: &[AppliedRule], findings: Vec<Finding>) -> Vec<FindingRecord> {
    let mut all: Vec<Finding> = Vec::new();
    for finding in practice::findings(rules).into_iter().chain(findings) {
        if !all.contains(&finding) {
            all.push(finding);
        }
    }
    all.sort_by_cached_key(rank);
    all.iter().map(Finding::record).collect()
}

#[cfg(test)]
mod tests {
    use super::super::finding;
    use super::*;

    #[test]
    fn findings_stand_in_the_order_of_the_table_whatever_the_order_in_which_they_came() {
        let mut all = vec![
            finding::pan_of_filter(2.0),
            finding::cohesive_fines(35.0),
            finding::replicates_leave_open(),
            finding::cohesive_fines(35.0),
        ];
        for _ in 0..all.len() {
            all.rotate_left(1);
            let ids: Vec<String> = ordered(&[], all.clone()).into_iter().map(|finding| finding.id).collect();
            assert_eq!(ids, ["replicates_leave_open", "cohesive_fines", "pan_of_filter"]);
        }
    }
}
