//! Guard of requests: it admits the browser of the user who was given the address, and no page of another
//! origin.
//!
//! - The address holds a secret of 128 bits.
//! - The name that was asked for is this machine's own, so that no foreign name that is made to point here
//!   (DNS rebinding) is answered.
//! - A request that a page of another origin has made is refused, whatever it knows.

use std::io;

use super::http::Request;

/// Conditions on a request.
#[derive(Clone, Debug)]
pub struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// A new secret for this port.
    ///
    /// # Errors
    /// The system gives no random bytes.
    pub fn new(port: u16) -> io::Result<Self> {
        // A secret must not follow from any seed, so it is not a number of `voidwalk_core::stream`.
        let mut bytes = [0u8; 16];
        getrandom::fill(&mut bytes)?;
        Ok(Self { token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(), port })
    }

    /// The address of the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// The path below the secret; `None` if the request is not allowed.
    pub fn path<'a>(&self, request: &'a Request) -> Option<&'a str> {
        if !request.field("host").is_some_and(|name| self.is_host(name)) {
            return None;
        }
        if request.has("origin") {
            let host = request.field("origin").and_then(|origin| origin.strip_prefix("http://"));
            host.filter(|host| self.is_host(host))?;
        }
        // Browsers state the origin of a request; `none` is an address that the user has typed.
        if request.has("sec-fetch-site") {
            request.field("sec-fetch-site").filter(|site| ["same-origin", "none"].contains(site))?;
        }
        let path = request.path.strip_prefix('/')?;
        let (token, rest) = path.split_once('/')?;
        self.is_token(token).then_some(rest)
    }

    /// True if this is the name of this machine and port; browsers leave out port 80.
    fn is_host(&self, name: &str) -> bool {
        ["127.0.0.1", "localhost"].iter().any(|host| match name.strip_prefix(host) {
            Some("") => self.port == 80,
            Some(port) => port == format!(":{}", self.port),
            None => false,
        })
    }

    /// Compares in constant time.
    fn is_token(&self, text: &str) -> bool {
        let differ = |(a, b): (u8, u8)| a ^ b;
        let differences = text.bytes().zip(self.token.bytes()).map(differ).fold(0, |all, one| all | one);
        text.len() == self.token.len() && differences == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
}
