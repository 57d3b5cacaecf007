//! Limit of connections that are answered at a time, and the choice of the one to end if there are too many:
//! a client that has not shown the secret keeps others waiting only briefly.

use std::io;
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Connections that are answered at the same time; others wait.
const MOST: usize = 64;

/// Time for which a connection that has not shown the secret is left alone, however many wait.
const GRACE: Duration = Duration::from_secs(1);

/// Interval between checks for connections past that time.
const LOOK: Duration = Duration::from_millis(50);

/// The connections that are answered now.
#[derive(Default)]
pub struct Connections {
    /// In the order in which they came.
    open: Mutex<Vec<Connection>>,
    /// Number of connections so far: each has a number of its own, even after the last was ended.
    came: AtomicU64,
    freed: Condvar,
}

struct Connection {
    id: u64,
    /// The stream by which to end it; `None` once it has shown the secret.
    shed: Option<TcpStream>,
    since: Instant,
}

/// The place of a connection, until it is dropped.
pub struct Place {
    connections: Arc<Connections>,
    id: u64,
}

impl Connections {
    fn locked(&self) -> MutexGuard<'_, Vec<Connection>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A place for a connection, as soon as there is one: if all are taken, the oldest connection without the
    /// secret is ended.
    ///
    /// # Errors
    /// There are no more file handles.
    pub fn place(self: &Arc<Self>, stream: &TcpStream) -> io::Result<Place> {
        let shed = Some(stream.try_clone()?);
        let mut open = self.locked();
        while open.len() >= MOST {
            let oldest = open.iter().position(|one| one.shed.is_some() && one.since.elapsed() >= GRACE);
            if let Some(at) = oldest {
                // Its thread finds the connection ended.
                let ended = open.remove(at).shed.map(|stream| stream.shutdown(Shutdown::Both));
                drop(ended);
                continue;
            }
            open = self.freed.wait_timeout(open, LOOK).unwrap_or_else(PoisonError::into_inner).0;
        }
        let id = self.came.fetch_add(1, Ordering::Relaxed);
        open.push(Connection { id, shed, since: Instant::now() });
        Ok(Place { connections: Arc::clone(self), id })
    }
}

impl Place {
    /// The connection has shown the secret: it is not ended for others.
    pub fn keep(&self) {
        if let Some(one) = self.connections.locked().iter_mut().find(|one| one.id == self.id) {
            one.shed = None;
        }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.connections.locked().retain(|one| one.id != self.id);
        self.connections.freed.notify_one();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::TcpListener;

    /// All but the last have shown the secret; the last makes room for another, and when its thread finds it
    /// ended, that other keeps its place.
    #[test]
    fn a_connection_that_is_ended_takes_no_other_out_of_the_list() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let connections = Arc::new(Connections::default());
        let (mut streams, mut places) = (Vec::new(), Vec::new());
        for number in 0..MOST {
            streams.push((TcpStream::connect(address).unwrap(), listener.accept().unwrap().0));
            let place = connections.place(&streams[number].1).unwrap();
            if number + 1 < MOST {
                place.keep();
            }
            places.push(place);
        }
        let _stays = connections.place(&TcpStream::connect(address).unwrap()).unwrap();
        assert_eq!(connections.locked().len(), MOST);
        drop(places.pop());
        assert_eq!(connections.locked().len(), MOST, "the place of one that was ended before is none");
        drop(places);
        assert_eq!(connections.locked().len(), 1);
    }
}
