//! The notes of a case in the order in which every face shows them.

use crate::Note;

/// The notes of a case, each once, in the order of their table.
pub fn ordered(notes: impl IntoIterator<Item = Note>) -> Vec<Note> {
    let mut all: Vec<Note> = Vec::new();
    for note in notes {
        if !all.contains(&note) {
            all.push(note);
        }
    }
    all.sort_by_key(Note::place);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_stand_in_the_order_of_the_table_whatever_the_order_in_which_they_came() {
        let table = [
            Note::ReplicatesLeaveOpen {},
            Note::CohesiveFines { fines_percent: 35.0 },
            Note::PanOfFilter { finest_percent: 2.0 },
        ];
        let mut all = vec![table[2].clone(), table[1].clone(), table[0].clone(), table[1].clone()];
        for _ in 0..all.len() {
            all.rotate_left(1);
            assert_eq!(ordered(all.clone()), table);
        }
    }
}
