//! Exits of a void in the form that a draw reads first: all that it needs if few are open, side by side, and
//! the place of the others.

/// Open exits of a void, if they are few; else the place of its exits.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub struct FewExits {
    /// Top sixteen bits of the threshold of each open exit but the last; the largest number after them.
    pub top: [u16; FEW_EXITS],
    /// Position of each open exit among all.
    pub position: [u8; FEW_EXITS],
    /// First exit of the void.
    pub begin: u32,
    /// Exits of a void whose open ones do not fit in here; 0 if they fit, all are closed, or there are more
    /// exits than this can say.
    pub exits: u16,
    /// True if it has an open exit, and no more than fit in here.
    pub is_few: bool,
}

/// Open exits that fit in a [`FewExits`].
pub const FEW_EXITS: usize = 8;

/// Most exits that are counted without a branch.
const COUNTED: usize = 64;

impl FewExits {
    pub const NONE: Self =
        Self { top: [u16::MAX; FEW_EXITS], position: [0; FEW_EXITS], begin: 0, exits: 0, is_few: false };

    /// Builds it for a void whose exits from `begin` on have these thresholds, which rise where an exit is
    /// open; `last` is the position of its last open one.
    pub fn new(begin: u32, thresholds: &[u64], last: usize) -> Self {
        // It cannot be foreseen which exits are open: one that is closed leaves its place to the next.
        let (mut top, mut position) = ([u16::MAX; FEW_EXITS + 1], [0; FEW_EXITS + 1]);
        let (mut before, mut open) = (0, 0);
        for (place, &threshold) in thresholds[..last].iter().enumerate() {
            (top[open], position[open]) = ((threshold >> 48) as u16, place as u8);
            open = (open + usize::from(threshold != before)).min(FEW_EXITS);
            before = threshold;
        }
        (top[open], position[open]) = (u16::MAX, last as u8);
        let is_few = open < FEW_EXITS && last <= usize::from(u8::MAX);
        Self {
            top: std::array::from_fn(|i| top[i]),
            position: std::array::from_fn(|i| position[i]),
            begin,
            exits: if is_few { 0 } else { u16::try_from(thresholds.len()).unwrap_or(0) },
            is_few,
        }
    }

    /// The exit that a draw picks by its top sixteen bits, unless they do not decide.
    #[inline(always)]
    pub fn chosen(&self, draw: u16) -> Option<usize> {
        let passed: u16 = self.top.iter().map(|&top| u16::from(top < draw)).sum();
        let is_tie = self.top.iter().fold(false, |tie, &top| tie | (top == draw));
        // Thresholds rise, and the last exit has no threshold.
        (!is_tie).then(|| self.begin as usize + usize::from(self.position[usize::from(passed)]))
    }

    /// Exit that a draw picks if more are open than fit in here, by the upper sixteen bits of all thresholds
    /// of the network.
    #[inline(always)]
    pub fn chosen_of(&self, tops: &[u16], draw: u16) -> Option<usize> {
        let tops = &tops[self.begin as usize..][..usize::from(self.exits)];
        let passed = if tops.len() <= COUNTED {
            tops.iter().map(|&top| u16::from(top < draw)).sum::<u16>().into()
        } else {
            // A reservoir has thousands.
            tops.partition_point(|&top| top < draw)
        };
        // Thresholds rise, so an equal one comes first of those that are not passed.
        tops.get(passed).filter(|&&top| top != draw).map(|_| self.begin as usize + passed)
    }
}
