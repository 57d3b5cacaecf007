//! The rest of a system of conductances while its rows are eliminated.

/// A conductance between two rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub one: u32,
    pub other: u32,
    pub conductance: f64,
}

/// Places that meet one place, each once. Serves one place after another.
pub(super) struct Meeting {
    /// With their conductances, in the order in which they were found.
    pub neighbours: Vec<(u32, f64)>,
    /// By place: the place that it met last, and its position in `neighbours` then.
    met: Vec<(u32, u32)>,
}

impl Meeting {
    /// No meetings yet, among this many places.
    pub(super) fn new(places: usize) -> Self {
        Self { neighbours: Vec::new(), met: vec![(NONE, 0); places] }
    }

    /// Adds a conductance between a place and one that it meets.
    fn add(&mut self, place: u32, to: u32, conductance: f64) {
        let (met, at) = &mut self.met[to as usize];
        if *met == place {
            self.neighbours[*at as usize].1 += conductance;
        } else {
            (*met, *at) = (place, self.neighbours.len() as u32);
            self.neighbours.push((to, conductance));
        }
    }
}

/// No handful, and no place.
const NONE: u32 = u32::MAX;

/// Links in one handful.
const HANDFUL: usize = 6;

/// Links of one place: the last that it was given, and where those before them are. A cache line; single
/// precision is enough for an approximation, and a conductance that it cannot tell from 0 becomes the least
/// that it can.
#[derive(Clone, Copy)]
#[repr(align(64))]
struct Head {
    conductance: [f32; HANDFUL],
    to: [u32; HANDFUL],
    /// Conductance to pressures that are known.
    ground: f64,
    count: u32,
    before: u32,
}

/// Links of one place that precede others.
#[derive(Clone, Copy)]
struct Handful {
    conductance: [f32; HANDFUL],
    to: [u32; HANDFUL],
    before: u32,
}

/// The rest of the system while rows are eliminated, by place: a link is kept with the one of its two places
/// that is eliminated first.
pub(super) struct Rest {
    head: Vec<Head>,
    handfuls: Vec<Handful>,
    /// First handful of those that are free again.
    free: u32,
}

impl Rest {
    /// Builds the system with places in this order of rows.
    pub(super) fn new(order: &[u32], ground: &[f64], links: &[Link]) -> Self {
        let mut place_of: Vec<u32> = vec![0; order.len()];
        order.iter().zip(0u32..).for_each(|(&row, place)| place_of[row as usize] = place);
        let head = |&row: &u32| Head {
            conductance: [0.0; HANDFUL],
            to: [0; HANDFUL],
            ground: ground[row as usize],
            count: 0,
            before: NONE,
        };
        let mut rest = Self { head: order.iter().map(head).collect(), handfuls: Vec::new(), free: NONE };
        for &Link { one, other, conductance } in links {
            rest.join(place_of[one as usize], place_of[other as usize], conductance);
        }
        rest
    }

    /// Adds a conductance between two places to those that exist.
    #[inline]
    pub(super) fn join(&mut self, one: u32, other: u32, conductance: f64) {
        let (from, to) = (one.min(other), one.max(other));
        let head = &mut self.head[from as usize];
        if head.count as usize == HANDFUL {
            let full = Handful { conductance: head.conductance, to: head.to, before: head.before };
            head.count = 0;
            head.before = if self.free == NONE {
                self.handfuls.push(full);
                u32::try_from(self.handfuls.len() - 1).expect("fewer links than a factor has bits for")
            } else {
                let at = self.free;
                self.free = std::mem::replace(&mut self.handfuls[at as usize], full).before;
                at
            };
        }
        let at = head.count as usize;
        (head.to[at], head.conductance[at]) = (to, (conductance as f32).max(f32::MIN_POSITIVE));
        head.count += 1;
    }

    /// Removes a place: its neighbours go to `meeting`, and its conductance to known pressures is returned.
    pub(super) fn take(&mut self, place: u32, meeting: &mut Meeting) -> f64 {
        meeting.neighbours.clear();
        let Head { conductance, to, ground, count, before } = self.head[place as usize];
        (0..count as usize).for_each(|i| meeting.add(place, to[i], f64::from(conductance[i])));
        let mut next = before;
        while next != NONE {
            let handful = &mut self.handfuls[next as usize];
            (0..HANDFUL).for_each(|i| meeting.add(place, handful.to[i], f64::from(handful.conductance[i])));
            let after = std::mem::replace(&mut handful.before, self.free);
            self.free = std::mem::replace(&mut next, after);
        }
        ground
    }

    /// Adds to the conductance from a place to known pressures.
    pub(super) fn hold(&mut self, place: u32, conductance: f64) {
        self.head[place as usize].ground += conductance;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Thousands of links come and go in the room of the first.
    #[test]
    fn room_of_links_is_used_again() {
        let links: Vec<Link> =
            (1..200).map(|other| Link { one: 0, other, conductance: f64::from(other) }).collect();
        let order: Vec<u32> = (0..200).collect();
        let mut rest = Rest::new(&order, &[0.0; 200], &links);
        let room = rest.handfuls.len();
        for _ in 0..20 {
            let mut meeting = Meeting::new(200);
            rest.take(0, &mut meeting);
            assert_eq!(meeting.neighbours.iter().map(|&(to, _)| to).sum::<u32>(), 199 * 100);
            (rest.head[0].count, rest.head[0].before) = (0, NONE);
            links.iter().for_each(|link| rest.join(link.one, link.other, link.conductance));
            assert_eq!(rest.handfuls.len(), room);
        }
    }

    /// A place that is met again and again is one neighbour, with all that leads to it.
    #[test]
    fn links_between_two_places_are_one() {
        let joined = [(0, 1, 1.0), (2, 0, 2.0), (0, 1, 4.0), (1, 2, 8.0), (1, 0, 16.0), (2, 0, 32.0)];
        let links = joined.map(|(one, other, conductance)| Link { one, other, conductance });
        let mut rest = Rest::new(&[0, 1, 2], &[0.5, 0.0, 0.0], &links);
        let mut meeting = Meeting::new(3);
        rest.hold(0, 0.25);
        assert_eq!(rest.take(0, &mut meeting), 0.75);
        // The first links that it was given follow those that came last.
        meeting.neighbours.sort_by_key(|neighbour| neighbour.0);
        assert_eq!(meeting.neighbours, [(1, 21.0), (2, 34.0)]);
        rest.take(1, &mut meeting);
        assert_eq!(meeting.neighbours, [(2, 8.0)]);
    }
}
