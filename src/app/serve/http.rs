//! One HTTP/1.1 request per connection, read within limits, and its answer.
//!
//! Heads are parsed by `httparse`; input larger or slower than the limits below is refused before it is
//! stored. A body must state its length in advance. There are no chunks and no second request on a
//! connection, so nothing that two readers could split differently.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

use serde_json::Value;

use voidwalk_core::text::all_visible;

const HEAD: usize = 16 << 10;

const FIELDS: usize = 64;

/// Maximum body of a request (bytes): a workbook.
pub(crate) const BODY: u64 = 32 << 20;

/// Time limits for the head of a request, and for its body as a whole.
const ARRIVAL: (Duration, Duration) = (Duration::from_secs(10), Duration::from_secs(60));

/// Time limits for sending an answer: for each piece, and in all, plus one second for this many bytes.
const DEPARTURE: (Duration, Duration, u64) = (Duration::from_secs(20), Duration::from_secs(60), 1 << 20);

/// Limits on the time and bytes of input discarded after a refusal, so that the refusal is read.
const DRAIN: (Duration, u64) = (Duration::from_secs(1), 2 * BODY);

#[derive(Debug)]
pub(crate) struct Request {
    pub(crate) method: String,
    pub(crate) path: String,
    query: String,
    fields: Vec<(String, String)>,
    begun: Vec<u8>,
    length: u64,
}

impl Request {
    /// Value of a header field; `None` if it is missing or repeated.
    pub(crate) fn field(&self, name: &str) -> Option<&str> {
        let mut values = self.fields.iter().filter(|(field, _)| field.eq_ignore_ascii_case(name));
        match (values.next(), values.next()) {
            (Some((_, value)), None) => Some(value),
            _ => None,
        }
    }

    pub(crate) fn has(&self, name: &str) -> bool {
        self.fields.iter().any(|(field, _)| field.eq_ignore_ascii_case(name))
    }

    pub(crate) fn parameter(&self, name: &str) -> Option<String> {
        let pairs = self.query.split('&').filter_map(|pair| pair.split_once('='));
        pairs.into_iter().find(|(key, _)| *key == name).map(|(_, value)| decoded(value))
    }
}

/// Text with its `%41` decoded; bytes that are not UTF-8 are replaced.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [first, more @ ..] = rest {
        let digit = |at: usize| more.get(at).and_then(|b| char::from(*b).to_digit(16));
        let (byte, after) = match (first, digit(0), digit(1)) {
            (b'%', Some(high), Some(low)) => ((16 * high + low) as u8, &more[2..]),
            (b'+', ..) => (b' ', more),
            _ => (*first, more),
        };
        bytes.push(byte);
        rest = after;
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) kind: &'static str,
    pub(crate) body: Body,
    /// Content security policy; without one, nothing at all is allowed.
    pub(crate) policy: Option<String>,
    pub(crate) download: Option<String>,
}

pub(crate) enum Body {
    Bytes(Vec<u8>),
    /// Content of a file from its start, with its length.
    File(std::fs::File, u64),
}

impl Answer {
    pub(crate) fn new(status: u16, kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status, kind, body: Body::Bytes(body.into()), policy: None, download: None }
    }

    pub(crate) fn file(kind: &'static str, file: std::fs::File) -> io::Result<Self> {
        let length = file.metadata()?.len();
        Ok(Self { body: Body::File(file, length), ..Self::new(200, kind, "") })
    }

    /// Answer with a value as JSON for the page, without hidden characters.
    pub(crate) fn json(status: u16, mut value: Value) -> Self {
        show(&mut value);
        Self::new(status, "application/json; charset=utf-8", value.to_string())
    }

    pub(crate) fn problem(status: u16, words: &str) -> Self {
        Self::json(status, serde_json::json!({ "problem": words }))
    }
}

fn show(value: &mut Value) {
    match value {
        Value::String(text) => *text = all_visible(text),
        Value::Array(values) => values.iter_mut().for_each(show),
        Value::Object(fields) => fields.values_mut().for_each(show),
        _ => {}
    }
}

/// Connection with a deadline for all reading and writing, however small the pieces.
struct Until<'a> {
    stream: &'a mut TcpStream,
    end: Instant,
    piece: Duration,
}

impl<'a> Until<'a> {
    fn new(stream: &'a mut TcpStream, piece: Duration, all: Duration) -> Self {
        Self { stream, end: Instant::now() + all, piece }
    }

    fn left(&self) -> io::Result<Duration> {
        match self.end.saturating_duration_since(Instant::now()) {
            Duration::ZERO => Err(io::ErrorKind::TimedOut.into()),
            left => Ok(left.min(self.piece)),
        }
    }
}

impl Read for Until<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        self.stream.read(bytes)
    }
}

impl Write for Until<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

pub(crate) fn read_head(stream: &mut TcpStream) -> io::Result<Result<Request, Answer>> {
    let mut stream = Until::new(stream, ARRIVAL.0, ARRIVAL.0);
    let refused = |status, words| Ok(Err(Answer::problem(status, words)));
    let mut bytes = Vec::new();
    loop {
        let mut piece = [0; 4096];
        let count = stream.read(&mut piece)?;
        if count == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        bytes.extend_from_slice(&piece[..count]);
        let mut fields = [httparse::EMPTY_HEADER; FIELDS];
        let mut parsed = httparse::Request::new(&mut fields);
        match parsed.parse(&bytes) {
            Ok(httparse::Status::Complete(length)) => {
                return Ok(request(&parsed, bytes[length..].to_vec()));
            }
            Ok(httparse::Status::Partial) if bytes.len() < HEAD => {}
            Ok(httparse::Status::Partial) => return refused(431, "the head is too large"),
            Err(httparse::Error::TooManyHeaders) => return refused(431, "there are too many header fields"),
            Err(_) => return refused(400, "this is not an HTTP request"),
        }
    }
}

fn request(parsed: &httparse::Request, begun: Vec<u8>) -> Result<Request, Answer> {
    let target = parsed.path.unwrap_or_default();
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let text = |value: &[u8]| String::from_utf8_lossy(value).into_owned();
    let fields = parsed.headers.iter().map(|field| (field.name.to_owned(), text(field.value))).collect();
    let mut request = Request {
        method: parsed.method.unwrap_or_default().to_owned(),
        path: path.to_owned(),
        query: query.to_owned(),
        fields,
        begun,
        length: 0,
    };
    if request.has("transfer-encoding") {
        return Err(Answer::problem(411, "a body needs Content-Length"));
    }
    if request.has("content-length") {
        let length = request.field("content-length").filter(|text| text.bytes().all(|b| b.is_ascii_digit()));
        request.length = match length.map(str::parse) {
            Some(Ok(length)) => length,
            _ => return Err(Answer::problem(400, "Content-Length is not a number")),
        };
    } else if request.method == "POST" {
        return Err(Answer::problem(411, "a body needs Content-Length"));
    }
    Ok(request)
}

/// Reads the body of a request; a body that is too large is not read and gives its answer.
pub(crate) fn read_body(
    request: &mut Request,
    stream: &mut TcpStream,
) -> io::Result<Result<Vec<u8>, Answer>> {
    if request.length > BODY {
        let words = format!("too large: at most {} MB", BODY >> 20);
        return Ok(Err(Answer::problem(413, &words)));
    }
    let mut stream = Until::new(stream, ARRIVAL.0, ARRIVAL.1);
    if request.field("expect").is_some_and(|value| value.eq_ignore_ascii_case("100-continue")) {
        stream.write_all(b"HTTP/1.1 100 Continue\r\n\r\n")?;
    }
    let length = request.length as usize;
    let mut bytes = std::mem::take(&mut request.begun);
    bytes.truncate(length);
    stream.take((length - bytes.len()) as u64).read_to_end(&mut bytes)?;
    if bytes.len() < length {
        return Err(io::ErrorKind::UnexpectedEof.into());
    }
    Ok(Ok(bytes))
}

pub(crate) fn send(stream: &mut TcpStream, answer: Answer) -> io::Result<()> {
    let (length, refused) = match &answer.body {
        Body::Bytes(bytes) => (bytes.len() as u64, answer.status >= 400),
        Body::File(_, length) => (*length, false),
    };
    let policy = answer.policy.as_deref().unwrap_or("default-src 'none'; sandbox");
    let mut head = format!(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {length}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nX-Frame-Options: DENY\r\n\
         Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\nContent-Security-Policy: {policy}\r\n",
        answer.status,
        reason(answer.status),
        answer.kind
    );
    if let Some(name) = &answer.download {
        head += &format!("Content-Disposition: attachment; filename=\"{name}\"\r\n");
    }
    head += "\r\n";
    let all = DEPARTURE.1 + Duration::from_secs(length / DEPARTURE.2);
    let mut leaving = Until::new(stream, DEPARTURE.0, all);
    leaving.write_all(head.as_bytes())?;
    match answer.body {
        Body::Bytes(bytes) => leaving.write_all(&bytes)?,
        Body::File(file, length) => drop(io::copy(&mut file.take(length), &mut leaving)?),
    }
    leaving.flush()?;
    stream.shutdown(Shutdown::Write)?;
    if refused { drain(stream) } else { Ok(()) }
}

/// Discards further input: closing with unread bytes would lose the answer.
fn drain(stream: &mut TcpStream) -> io::Result<()> {
    let mut rest = Until::new(stream, DRAIN.0, DRAIN.0).take(DRAIN.1);
    io::copy(&mut rest, &mut io::sink()).map(drop)
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        409 => "Conflict",
        411 => "Length Required",
        413 => "Content Too Large",
        422 => "Unprocessable Content",
        429 => "Too Many Requests",
        431 => "Request Header Fields Too Large",
        _ => "Error",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_browser_encodes_is_decoded() {
        assert_eq!(decoded("a%20b+c%2F..%2fx%3C"), "a b c/../x<");
        assert_eq!(decoded("100%"), "100%");
        assert_eq!(decoded("%zz%4"), "%zz%4");
        assert_eq!(decoded("%E2%80%AE%FF"), "\u{202e}\u{fffd}");
    }

    /// Sends small pieces, each in time, which do not extend the total time.
    #[test]
    fn a_connection_ends_in_time_however_slowly_it_is_fed_or_read() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let mut other = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (mut stream, _) = listener.accept().unwrap();
        let (piece, all) = (Duration::from_secs(5), Duration::from_millis(300));
        let slow = std::thread::spawn(move || {
            // One byte at a time, first written, then read.
            for _ in 0..100 {
                let _ = other.write_all(b"x");
                std::thread::sleep(Duration::from_millis(10));
            }
            while other.read(&mut [0; 1000]).is_ok_and(|count| count > 0) {
                std::thread::sleep(Duration::from_millis(1));
            }
        });
        let begun = Instant::now();
        let mut bytes = Vec::new();
        assert!(Until::new(&mut stream, piece, all).read_to_end(&mut bytes).is_err());
        assert!(!bytes.is_empty() && begun.elapsed() < piece, "{:?}", begun.elapsed());
        let begun = Instant::now();
        assert!(Until::new(&mut stream, piece, all).write_all(&vec![0; 256 << 20]).is_err());
        assert!(begun.elapsed() < piece, "{:?}", begun.elapsed());
        drop(stream);
        slow.join().unwrap();
    }
}
