//! Guard of requests: it admits the browser of the user who was given the address, and no page of another
//! origin.
//!
//! - The address holds a secret of 128 bits.
//! - The requested name must be this machine's own, so that a foreign name that is made to point here
//!   (DNS rebinding) gets no answer.
//! - A request from a page of another origin is refused, whatever it knows.

use std::io;
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::http::Request;

#[derive(Clone, Debug)]
pub(crate) struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// Creates a secret for this port; fails if the system gives no random bytes.
    pub(crate) fn new(port: u16) -> io::Result<Self> {
        // A secret must not follow from any seed, so it is not a number of `voidwalk_core::stream`.
        let mut bytes = [0u8; 16];
        getrandom::fill(&mut bytes)?;
        Ok(Self { token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(), port })
    }

    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    pub(crate) fn path<'a>(&self, request: &'a Request) -> Option<&'a str> {
        if !request.field("host").is_some_and(|name| self.is_host(name)) {
            return None;
        }
        if request.has("origin") {
            let host = request.field("origin").and_then(|origin| origin.strip_prefix("http://"));
            host.filter(|host| self.is_host(host))?;
        }
        // Browsers state the origin of a request; `none` means an address typed by the user.
        if request.has("sec-fetch-site") {
            request.field("sec-fetch-site").filter(|site| ["same-origin", "none"].contains(site))?;
        }
        let path = request.path.strip_prefix('/')?;
        let (token, rest) = path.split_once('/')?;
        self.is_token(token).then_some(rest)
    }

    /// True if this names the machine and port; browsers leave out port 80.
    fn is_host(&self, name: &str) -> bool {
        ["127.0.0.1", "localhost"].iter().any(|host| match name.strip_prefix(host) {
            Some("") => self.port == 80,
            Some(port) => port == format!(":{}", self.port),
            None => false,
        })
    }

    /// Compares in constant time.
    fn is_token(&self, text: &str) -> bool {
        let differences = text.bytes().zip(self.token.bytes()).fold(0, |all, (a, b)| all | (a ^ b));
        text.len() == self.token.len() && differences == 0
    }
}

/// Maximum number of connections answered at a time; others wait.
const MOST: usize = 64;

/// Time for which a connection that has not shown the secret is spared, however many wait.
const GRACE: Duration = Duration::from_secs(1);

const LOOK: Duration = Duration::from_millis(50);

#[derive(Default)]
pub(crate) struct Connections {
    open: Mutex<Vec<Connection>>,
    /// Number of connections so far, which numbers each of them uniquely.
    came: AtomicU64,
    freed: Condvar,
}

struct Connection {
    id: u64,
    /// Stream by which to end it; `None` once it has shown the secret.
    shed: Option<TcpStream>,
    since: Instant,
}

pub(crate) struct Place {
    connections: Arc<Connections>,
    id: u64,
}

impl Connections {
    fn locked(&self) -> MutexGuard<'_, Vec<Connection>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a place for a connection: if all are taken, the oldest connection without the secret is
    /// ended. Fails if there are no more file handles.
    pub(crate) fn place(self: &Arc<Self>, stream: &TcpStream) -> io::Result<Place> {
        let shed = Some(stream.try_clone()?);
        let mut open = self.locked();
        while open.len() >= MOST {
            let oldest = open.iter().position(|one| one.shed.is_some() && one.since.elapsed() >= GRACE);
            if let Some(at) = oldest {
                // Its thread will find the connection ended.
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
    /// Protects a connection that has shown the secret from being ended for others.
    pub(crate) fn keep(&self) {
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

    #[test]
    fn only_port_80_goes_without_saying() {
        let names =
            ["localhost", "127.0.0.1", "localhost:80", "127.0.0.1:80", "localhost:8080", "localhost:"];
        for (port, allowed) in [(80, &names[..4]), (8080, &names[4..5]), (1, &[])] {
            let guard = Guard::new(port).unwrap();
            for name in names.iter().chain(&["evil.example", "localhost.evil.example", ""]) {
                assert_eq!(guard.is_host(name), allowed.contains(name), "{name} at {port}");
            }
        }
    }

    /// All but the last have shown the secret. The last makes room for another; when its thread finds it
    /// ended, the other must keep its place.
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
