//! The server: connections, bounds of size and time, and the way of each request.

use crate::answer::StudioAnswer;
use crate::call::{Caller, StudioCall, Verb, parameters};
use crate::events::EventHub;
use crate::guard::{Guard, RequestHead, Verdict};
use crate::{App, page};
use http_body_util::combinators::BoxBody;
use http_body_util::{BodyExt, Full, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::header::{self, HeaderMap, HeaderName, HeaderValue};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::collections::VecDeque;
use std::convert::Infallible;
use std::io;
use std::net::{Ipv4Addr, TcpListener};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::task::AbortHandle;
use tokio::time::timeout;

/// Bounds of requests and connections.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    /// Most bytes of a file that the page sends.
    pub file: usize,
    /// Most bytes of any other request.
    pub body: usize,
    /// Time for the head of a request, and for which an idle connection is kept.
    pub head: Duration,
    /// Time for the body of a request.
    pub transfer: Duration,
    /// Most connections. One more takes the place of the oldest that the guard has not let in.
    pub connections: usize,
}

impl Default for Bounds {
    fn default() -> Self {
        let (head, transfer) = (Duration::from_secs(10), Duration::from_secs(60));
        Self { file: 256 << 20, body: 4 << 20, head, transfer, connections: 96 }
    }
}

/// Most calls that are answered at the same time; further ones wait.
const CALLS: usize = 8;
/// Most bytes of the head of a request.
const HEAD: usize = 16 << 10;
/// How often the server looks whether it is to stop.
const TICK: Duration = Duration::from_millis(200);
/// How often closed connections of pages are sought.
const BEAT: Duration = Duration::from_secs(15);

/// What a page may load and do: only what came from here, and no script in its text.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A server on the loopback interface.
pub struct StudioServer {
    listener: TcpListener,
    guard: Guard,
    bounds: Bounds,
}

impl StudioServer {
    /// Takes a port of the loopback interface; 0 for any that is free.
    ///
    /// # Errors
    /// A port that is taken, or a system without random numbers.
    pub fn bind(port: u16, bounds: Bounds) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let guard = Guard::new(listener.local_addr()?.port())?;
        Ok(Self { listener, guard, bounds })
    }

    /// Who comes in, and by which addresses.
    pub fn guard(&self) -> &Guard {
        &self.guard
    }

    /// Serves until `stop` says so, or until no page has been open and nothing was asked for the time `idle`.
    ///
    /// # Errors
    /// Those of the system's network.
    pub fn run(
        self,
        app: Arc<dyn App>,
        events: EventHub,
        idle: Option<Duration>,
        stop: impl Fn() -> bool,
    ) -> io::Result<()> {
        let Self { listener, guard, bounds } = self;
        let mut builder = tokio::runtime::Builder::new_current_thread();
        // Some calls draw pictures, which takes a stack as large as that of the main thread.
        let runtime = builder
            .enable_io()
            .enable_time()
            .max_blocking_threads(CALLS)
            .thread_stack_size(8 << 20)
            .build()?;
        let last = Mutex::new(Instant::now());
        let shared = Arc::new(Shared { app, events, guard, bounds, last });
        let served = runtime.block_on(accept(listener, &shared, idle, stop));
        runtime.shutdown_timeout(TICK);
        served
    }
}

/// What all connections share.
struct Shared {
    app: Arc<dyn App>,
    events: EventHub,
    guard: Guard,
    bounds: Bounds,
    /// The time of the last request that was let in.
    last: Mutex<Instant>,
}

/// An open connection, and whether the guard has let a request of it in.
struct Connection {
    task: AbortHandle,
    welcome: Arc<AtomicBool>,
}

async fn accept(
    listener: TcpListener,
    shared: &Arc<Shared>,
    idle: Option<Duration>,
    stop: impl Fn() -> bool,
) -> io::Result<()> {
    let listener = tokio::net::TcpListener::from_std(listener)?;
    let mut connections: VecDeque<Connection> = VecDeque::new();
    let mut beat = Instant::now();
    while !stop() {
        if beat.elapsed() >= BEAT {
            shared.events.beat();
            beat = Instant::now();
        }
        let quiet = || shared.last.lock().unwrap_or_else(PoisonError::into_inner).elapsed();
        if idle.is_some_and(|idle| shared.events.listeners() == 0 && quiet() >= idle) {
            break;
        }
        let Ok(accepted) = timeout(TICK, listener.accept()).await else { continue };
        // The other side may be gone already, or the system be out of files: others can still come.
        let Ok((stream, _)) = accepted else {
            tokio::time::sleep(TICK).await;
            continue;
        };
        connections.retain(|c| !c.task.is_finished());
        if connections.len() >= shared.bounds.connections {
            let strangers = |c: &Connection| !c.welcome.load(Ordering::Relaxed);
            let Some(oldest) = connections.iter().position(strangers) else { continue };
            if let Some(connection) = connections.remove(oldest) {
                connection.task.abort();
            }
        }
        let welcome = Arc::new(AtomicBool::new(false));
        let task = tokio::spawn(serve(TokioIo::new(stream), Arc::clone(shared), Arc::clone(&welcome)));
        connections.push_back(Connection { task: task.abort_handle(), welcome });
    }
    Ok(())
}

type Answered = Response<BoxBody<Bytes, Infallible>>;

async fn serve(stream: TokioIo<tokio::net::TcpStream>, shared: Arc<Shared>, welcome: Arc<AtomicBool>) {
    let bounds = shared.bounds;
    let service = service_fn(|request| {
        let (shared, welcome) = (Arc::clone(&shared), Arc::clone(&welcome));
        async move { Ok::<_, Infallible>(respond(request, &shared, &welcome).await) }
    });
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(bounds.head).max_buf_size(HEAD);
    // A connection that breaks off harms nobody else.
    let _ = builder.serve_connection(stream, service).await;
}

/// The way of one request.
async fn respond(request: Request<Incoming>, shared: &Arc<Shared>, welcome: &AtomicBool) -> Answered {
    let verb = match *request.method() {
        Method::GET => Verb::Get,
        Method::POST => Verb::Post,
        _ => return refused(405),
    };
    let head = RequestHead {
        path: request.uri().path(),
        changes: verb == Verb::Post,
        host: only(request.headers(), &header::HOST),
        origin: only(request.headers(), &header::ORIGIN),
        site: only(request.headers(), &HeaderName::from_static("sec-fetch-site")),
    };
    let below = match shared.guard.check(&head) {
        // An address with a host of its own is for proxies.
        _ if request.uri().authority().is_some() => return refused(403),
        Verdict::Refused(status) => return refused(status),
        Verdict::SentOn(path) => return sent_on(&path),
        Verdict::Welcome(below) => below,
    };
    welcome.store(true, Ordering::Relaxed);
    *shared.last.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    let Some(name) = below.strip_prefix("api/") else {
        return match (verb, page::file(&below)) {
            (Verb::Get, Some((media_type, content))) => {
                answer(StatusCode::OK, media_type, Full::new(Bytes::from_static(content.as_bytes())))
            }
            _ => refused(404),
        };
    };
    if (verb, name) == (Verb::Get, "events") {
        return answer(StatusCode::OK, "text/event-stream", shared.events.listen());
    }
    let name = name.to_owned();
    let Some(query) = parameters(request.uri().query().unwrap_or_default()) else { return refused(400) };
    let most =
        if matches!(&name[..], "open" | "side" | "paint") { shared.bounds.file } else { shared.bounds.body };
    // What is announced as too large is not waited for.
    if request.body().size_hint().lower() > most as u64 {
        return refused(413);
    }
    let body = Limited::new(request.into_body(), most).collect();
    let body = match timeout(shared.bounds.transfer, body).await {
        Ok(Ok(body)) => body.to_bytes().into(),
        Ok(Err(e)) if e.is::<http_body_util::LengthLimitError>() => return refused(413),
        Ok(Err(_)) => return refused(400),
        Err(_) => return refused(408),
    };
    let app = Arc::clone(&shared.app);
    let caller = Caller::default();
    // If the connection ends first, this is dropped with the rest of the request.
    let _waiting = caller.waiting();
    let call = StudioCall { verb, name, query, body, caller };
    let done = tokio::task::spawn_blocking(move || app.answer(call)).await;
    let done = done.unwrap_or_else(|_| StudioAnswer::fault(500, "a defect of this program", None));
    let status = StatusCode::from_u16(done.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
    answer(status, done.content.media_type(), Full::new(done.bytes.into()))
}

/// The value of a header that stands once; one that cannot be, if it stands several times.
fn only<'a>(headers: &'a HeaderMap, name: &HeaderName) -> Option<&'a str> {
    let mut all = headers.get_all(name).iter();
    let first = all.next()?;
    if all.next().is_some() {
        return Some("");
    }
    Some(first.to_str().unwrap_or_default())
}

fn answer<B>(status: StatusCode, media_type: &'static str, body: B) -> Answered
where
    B: Body<Data = Bytes, Error = Infallible> + Send + Sync + 'static,
{
    let mut response = Response::new(BoxBody::new(body));
    *response.status_mut() = status;
    let fixed = [
        (header::CONTENT_TYPE, media_type),
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
        (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ];
    for (name, value) in fixed {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

/// A refusal, after which the connection ends, so that nothing more is read of it.
fn refused(status: u16) -> Answered {
    let status = StatusCode::from_u16(status).unwrap_or(StatusCode::FORBIDDEN);
    let text = status.canonical_reason().unwrap_or_default();
    let mut response = answer(status, "text/plain; charset=utf-8", Full::new(Bytes::from(text)));
    response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    response
}

fn sent_on(path: &str) -> Answered {
    let mut response = refused(303);
    if let Ok(path) = HeaderValue::from_str(path) {
        response.headers_mut().insert(header::LOCATION, path);
    }
    response
}
