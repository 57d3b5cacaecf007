//! Page on this machine alone: it takes sheets and shows curves, rules, walks and their verdicts.
//!
//! Only the user can reach it. It listens on the loopback address and answers only clients that know the
//! secret in the address and use this machine's own name, but no page of another origin (`guard.rs`).
//! Requests are bounded (`http.rs`); the page fetches nothing from outside and runs only its own script.
//!
//! Every answer is a call of the library (`routes.rs`). Each walk is a folder of a run or batch in the
//! server's folder (`jobs.rs`), as made by the command line, so `voidwalk resume` continues a run, too.

mod batches;
mod guard;
mod http;
mod job;
mod jobs;
mod live;
mod routes;
mod sheets;

use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

pub(crate) use job::OnResults;

use crate::run::folder::{FolderKind, claim};
use crate::run::{PrepareOptions, RunError};
use guard::{Connections, Guard, Place};
use jobs::JobQueue;
use routes::Routes;
use sheets::Sheets;
use voidwalk_core::store::Folder;
use voidwalk_core::store::format;

/// Pause after a failed accept: the system may be short of file handles for a while.
const PAUSE: Duration = Duration::from_millis(100);

/// Options of a server.
pub struct ServeOptions {
    /// Port of the loopback address; 0 takes any free one.
    pub port: u16,
    /// Folder for sheets and results; by default the first new `voidwalk-serve`, `voidwalk-serve-2`, ...
    pub folder: Option<PathBuf>,
    /// Threads, memory and the folder of packings.
    pub prepare: PrepareOptions,
    /// Action on finished results, which writes their pages.
    pub on_results: OnResults,
    /// Command that started a run, for `manifest.json`.
    pub command: String,
}

/// Server of a page on this machine; it holds its folder and its port.
pub struct Server {
    listener: TcpListener,
    folder: Folder,
    routes: Arc<Routes>,
}

impl Server {
    /// Takes a folder and a port.
    ///
    /// # Errors
    /// A folder that is not the program's own, holds work of another kind, or is in use by another server; a
    /// port that is in use.
    pub fn open(options: ServeOptions) -> Result<Self, RunError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, options.port)).map_err(|error| {
            RunError::Refused(format!("port {}: {error}; name another by --port", options.port))
        })?;
        let folder = match &options.folder {
            Some(path) => claim(path, FolderKind::Serve, false),
            None => first_new("voidwalk-serve"),
        }?;
        let record = format::SERVE.json(&())?;
        folder.write(FolderKind::Serve.record(), record.as_bytes())?;
        let port = listener.local_addr().map_err(RunError::failed)?.port();
        let root = folder.path();
        let routes = Routes {
            guard: Guard::new(port).map_err(RunError::failed)?,
            sheets: Sheets::new(root),
            jobs: JobQueue::new(root, options.prepare.clone(), options.command, options.on_results),
            prepare: options.prepare,
            root: root.to_owned(),
        };
        Ok(Self { listener, routes: Arc::new(routes), folder })
    }

    /// Address of the page, with its secret.
    pub fn address(&self) -> String {
        self.routes.guard.address()
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    /// Answers requests and walks jobs, until `stop`; then saves the work under way.
    ///
    /// # Errors
    /// A job that was running or waiting is not done, and can be continued; or it failed.
    pub fn run(self, stop: &AtomicBool) -> Result<(), RunError> {
        let (routes, listener) = (Arc::clone(&self.routes), self.listener);
        // It ends only with the process, because its next connection may never come.
        let answering = std::thread::Builder::new().spawn(move || accept(&listener, &routes));
        answering.map_err(RunError::no_thread)?;
        std::thread::scope(|scope| {
            let worker =
                std::thread::Builder::new().spawn_scoped(scope, || self.routes.jobs.work_until(stop));
            let worker = worker.map_err(RunError::no_thread)?;
            while !stop.load(Ordering::Relaxed) && !worker.is_finished() {
                std::thread::sleep(Duration::from_millis(100));
            }
            let open = self.routes.jobs.stop_all();
            // The worker has saved its work when it ends.
            worker.join().map_err(|_| RunError::failed("a fault of the program, while a job was done"))?;
            self.routes.jobs.ended(&open)
        })
    }
}

fn first_new(name: &str) -> Result<Folder, RunError> {
    let mut names = std::iter::once(name.to_owned()).chain((2..).map(|n| format!("{name}-{n}")));
    let free = names.find(|name| Path::new(name).symlink_metadata().is_err());
    claim(Path::new(&free.expect("there is no last name")), FolderKind::Serve, false)
}

fn accept(listener: &TcpListener, routes: &Arc<Routes>) {
    let connections = Arc::new(Connections::default());
    for stream in listener.incoming() {
        let place = stream.and_then(|stream| Ok((connections.place(&stream)?, stream)));
        let Ok((place, stream)) = place else {
            std::thread::sleep(PAUSE);
            continue;
        };
        let routes = Arc::clone(routes);
        // If there is no thread for it, the connection ends and its place is free again.
        let _ = std::thread::Builder::new().name("answer".into()).spawn(move || {
            answer(stream, &place, &routes);
        });
    }
}

/// Answers one connection; a browser that has left is not an error of the server.
fn answer(mut stream: TcpStream, place: &Place, routes: &Routes) {
    let _ = http::read_head(&mut stream).and_then(|head| {
        let answer = match head {
            Ok(request) => {
                if routes.guard.path(&request).is_some() {
                    place.keep();
                }
                routes.answer(request, &mut stream)?
            }
            Err(refusal) => refusal,
        };
        http::send(&mut stream, answer)
    });
}
