//! Attacks on the server: nothing but the page comes in, nothing stops the server, and it answers the page
//! afterwards.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use vtex_studio::{App, Bounds, Content, EventHub, StudioAnswer, StudioCall, StudioServer, Verb};

/// Answers every call, and counts them.
#[derive(Default)]
struct Counting {
    calls: AtomicUsize,
    last: Mutex<Option<StudioCall>>,
    /// Calls whose caller has left before the answer.
    left: AtomicUsize,
}

impl App for Counting {
    fn answer(&self, call: StudioCall) -> StudioAnswer {
        self.calls.fetch_add(1, Ordering::SeqCst);
        let name = call.name.clone();
        *self.last.lock().unwrap() = Some(call);
        assert_ne!(name, "panic", "on purpose");
        if name == "work" {
            let caller = self.last.lock().unwrap().as_ref().unwrap().caller.clone();
            let began = Instant::now();
            while !caller.has_left() && began.elapsed() < Duration::from_secs(20) {
                std::thread::sleep(Duration::from_millis(5));
            }
            self.left.fetch_add(usize::from(caller.has_left()), Ordering::SeqCst);
        }
        match &name[..] {
            "file" => StudioAnswer::bytes(Content::Download, vec![7; 100_000]),
            _ => StudioAnswer::json(&name),
        }
    }
}

/// A server that runs until this is dropped.
struct Running {
    port: u16,
    token: String,
    ticket: String,
    app: Arc<Counting>,
    events: EventHub,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

const BOUNDS: Bounds = Bounds {
    file: 1 << 20,
    body: 10_000,
    head: Duration::from_secs(30),
    transfer: Duration::from_secs(30),
    connections: 24,
};

impl Running {
    fn new(idle: Option<Duration>) -> Self {
        Self::with(BOUNDS, idle)
    }

    fn with(bounds: Bounds, idle: Option<Duration>) -> Self {
        let server = StudioServer::bind(0, bounds).unwrap();
        let address = server.guard().address();
        let (app, events) = (Arc::new(Counting::default()), EventHub::default());
        let stop = Arc::new(AtomicBool::new(false));
        let mut parts = address.strip_prefix("http://127.0.0.1:").unwrap().split('/');
        let port = parts.next().unwrap().parse().unwrap();
        let token = parts.next().unwrap().to_owned();
        let ticket = server.guard().ticket_address();
        let ticket = ticket.rsplit_once('/').unwrap().1.to_owned();
        let (own, heard, asked) = (Arc::clone(&app), events.clone(), Arc::clone(&stop));
        let thread = std::thread::spawn(move || {
            server.run(own, heard, idle, || asked.load(Ordering::SeqCst)).unwrap();
        });
        Self { port, token, ticket, app, events, stop, thread: Some(thread) }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
        stream
    }

    /// Sends bytes and returns all that comes back until the connection ends; the status is 0 if nothing does.
    fn raw(&self, bytes: &[u8]) -> (u16, String) {
        let mut stream = self.connect();
        // The server may refuse before it has read everything.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let status = answer.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
        (status, answer)
    }

    fn request(&self, line: &str, headers: &[String], body: &str) -> (u16, String) {
        let headers: String = headers.iter().map(|header| format!("{header}\r\n")).collect();
        self.raw(format!("{line} HTTP/1.1\r\n{headers}connection: close\r\n\r\n{body}").as_bytes())
    }

    fn host(&self) -> String {
        format!("host: 127.0.0.1:{}", self.port)
    }

    fn origin(&self) -> String {
        format!("origin: http://127.0.0.1:{}", self.port)
    }

    /// A call as the page makes it.
    fn call(&self, verb: &str, name: &str, body: &str) -> (u16, String) {
        let line = format!("{verb} /{}/api/{name}", self.token);
        let length = format!("content-length: {}", body.len());
        self.request(&line, &[self.host(), self.origin(), length], body)
    }

    fn calls(&self) -> usize {
        self.app.calls.load(Ordering::SeqCst)
    }

    /// The page still gets its answers.
    #[track_caller]
    fn serves(&self) {
        let before = self.calls();
        assert_eq!(self.call("GET", "state", "").0, 200);
        assert_eq!(self.call("POST", "set", "{}").0, 200);
        assert_eq!(self.calls(), before + 2);
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        let ended = self.thread.take().unwrap().join();
        if !std::thread::panicking() {
            ended.unwrap();
        }
    }
}

#[test]
fn the_page_is_served_and_may_load_nothing_from_elsewhere() {
    let server = Running::new(None);
    let (status, page) = server.request(&format!("GET /{}/", server.token), &[server.host()], "");
    assert_eq!(status, 200);
    for header in [
        "content-security-policy: default-src 'none'; script-src 'self'; style-src 'self'; ",
        "frame-ancestors 'none'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
        "cross-origin-resource-policy: same-origin",
        "cache-control: no-store",
        "content-type: text/html; charset=utf-8",
    ] {
        assert!(page.contains(header), "{header}: {page}");
    }
    assert!(!page.contains("unsafe-inline") && !page.to_lowercase().contains("access-control-allow"));
    assert_eq!(server.call("GET", "file?a=b%20c", "").0, 200);
    let last = server.app.last.lock().unwrap().clone().unwrap();
    assert_eq!((last.verb, last.parameter("a"), &last.body[..]), (Verb::Get, Some("b c"), &b""[..]));
}

#[test]
fn the_address_for_the_browser_leads_to_the_page_once() {
    let server = Running::new(None);
    let open = format!("GET /open/{}", server.ticket);
    let (status, answer) = server.request(&open, &[server.host()], "");
    assert_eq!(status, 303);
    assert!(answer.contains(&format!("location: /{}/\r\n", server.token)), "{answer}");
    assert_eq!(server.request(&open, &[server.host()], "").0, 404);
    assert_eq!(server.calls(), 0);
}

/// Requests that must not come in, with the status of the refusal.
fn hostile(server: &Running) -> Vec<(String, Vec<String>, &'static str, u16)> {
    let token = &server.token;
    let (host, origin) = (server.host(), server.origin());
    let state = format!("GET /{token}/api/state");
    let set = format!("POST /{token}/api/set");
    let length = "content-length: 2".to_owned();
    let evil = "origin: http://evil.example".to_owned();
    let mut all = vec![
        // Another token, or none.
        (format!("GET /{}/api/state", "0".repeat(32)), vec![host.clone()], "", 404),
        (format!("GET /{}/api/state", &token[1..]), vec![host.clone()], "", 404),
        (format!("GET /{}x/api/state", token), vec![host.clone()], "", 404),
        ("GET /".into(), vec![host.clone()], "", 404),
        ("GET /api/state".into(), vec![host.clone()], "", 404),
        ("GET /favicon.ico".into(), vec![host.clone()], "", 404),
        // Another host: DNS that was bound anew.
        (state.clone(), vec!["host: evil.example".into()], "", 403),
        (state.clone(), vec![format!("host: evil.example:{}", server.port)], "", 403),
        (state.clone(), vec!["host: 127.0.0.1".into()], "", 403),
        (state.clone(), vec![], "", 403),
        (state.clone(), vec![host.clone(), "host: evil.example".into()], "", 403),
        (format!("GET http://evil.example/{token}/api/state"), vec![host.clone()], "", 403),
        // Another origin: another page in the same browser.
        (set.clone(), vec![host.clone(), evil.clone(), length.clone()], "{}", 403),
        (set.clone(), vec![host.clone(), "origin: null".into(), length.clone()], "{}", 403),
        (set.clone(), vec![host.clone(), length.clone()], "{}", 403),
        (set.clone(), vec![host.clone(), origin.clone(), evil.clone(), length.clone()], "{}", 403),
        (state.clone(), vec![host.clone(), evil], "", 403),
        (state.clone(), vec![host.clone(), "sec-fetch-site: cross-site".into()], "", 403),
        // Other methods.
        (format!("PUT /{token}/api/set"), vec![host.clone(), origin.clone(), length.clone()], "{}", 405),
        (format!("OPTIONS /{token}/api/set"), vec![host.clone(), origin.clone()], "", 405),
        (format!("DELETE /{token}/api/set"), vec![host.clone(), origin.clone()], "", 405),
        (format!("CONNECT 127.0.0.1:{}", server.port), vec![host.clone()], "", 405),
        // Too large.
        (set.clone(), vec![host.clone(), origin.clone(), "content-length: 10001".into()], "x", 413),
        (set, vec![host.clone(), origin, "content-length: 99999999999999".into()], "x", 413),
        (format!("GET /{token}/api/state?name=%ff"), vec![host.clone()], "", 400),
    ];
    // Paths out of the page's files.
    for path in [
        "../Cargo.toml",
        "..%2f..%2fetc/passwd",
        "%2e%2e/%2e%2e/etc/passwd",
        "/etc/passwd",
        "api",
        "page/main.js",
    ] {
        all.push((format!("GET /{token}/{path}"), vec![host.clone()], "", 404));
    }
    all
}

#[test]
fn strangers_are_refused() {
    let server = Running::new(None);
    // Some two thousand requests.
    for round in 0..65 {
        for (line, headers, body, status) in hostile(&server) {
            let (got, answer) = server.request(&line, &headers, body);
            assert_eq!(got, status, "{line} {headers:?}: {answer}");
            assert!(!answer.contains(&server.token), "{answer}");
        }
        assert_eq!(server.calls(), 2 * round);
        server.serves();
    }
}

#[test]
fn what_is_no_request_harms_nobody() {
    let server = Running::new(None);
    let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(100_000));
    let many = format!("GET / HTTP/1.1\r\n{}\r\n", "a: b\r\n".repeat(5000));
    let both = format!(
        "POST /{}/api/set HTTP/1.1\r\n{}\r\n{}\r\ncontent-length: 3\r\ntransfer-encoding: chunked\r\n\r\n0\r\n\r\nGET / HTTP/1.1\r\n\r\n",
        server.token,
        server.host(),
        server.origin()
    );
    let noise: Vec<u8> = (0..4096u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for bytes in [
        long.as_bytes(),
        many.as_bytes(),
        &noise,
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
        b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        b"GET",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\nhost: a\0b\r\n\r\n",
        b"\r\n\r\n\r\n",
    ] {
        let (status, answer) = server.raw(bytes);
        assert!(!(200..300).contains(&status), "{answer}");
    }
    assert_eq!(server.calls(), 0);
    // A length and chunks together are taken as chunks, or refused; what follows is no second request.
    let (status, answer) = server.raw(both.as_bytes());
    assert!(status == 400 || answer.matches("HTTP/1.1 200").count() == 1, "{answer}");
    server.serves();
}

#[test]
fn bodies_end_at_their_bounds() {
    let server = Running::new(None);
    assert_eq!(server.call("POST", "set", &"x".repeat(10_000)).0, 200);
    assert_eq!(server.call("POST", "set", &"x".repeat(10_001)).0, 413);
    assert_eq!(server.call("POST", "open?name=a", &"x".repeat(1 << 20)).0, 200);
    assert_eq!(server.call("POST", "open?name=a", &"x".repeat((1 << 20) + 1)).0, 413);
    // In chunks, whose sum nobody announces.
    let chunk = format!("3e8\r\n{}\r\n", "y".repeat(1000));
    let head = format!(
        "POST /{}/api/set HTTP/1.1\r\n{}\r\n{}\r\ntransfer-encoding: chunked\r\n\r\n",
        server.token,
        server.host(),
        server.origin()
    );
    assert_eq!(server.raw(format!("{head}{}0\r\n\r\n", chunk.repeat(11)).as_bytes()).0, 413);
    assert_eq!(server.calls(), 2);
    server.serves();
}

#[test]
fn slow_senders_are_cut_off() {
    let short = Duration::from_millis(700);
    let server = Running::with(Bounds { head: short, transfer: short, ..BOUNDS }, None);
    // A byte now and then.
    let mut slow = server.connect();
    let mut alive = 0;
    for byte in format!("GET /{}/api/state HTTP/1.1\r\n{}\r\n\r\n", server.token, server.host()).bytes() {
        if slow.write_all(&[byte]).is_err() {
            break;
        }
        alive += 1;
        std::thread::sleep(Duration::from_millis(40));
    }
    assert!(alive < 60, "{alive} bytes were read of it");
    // A body that never comes.
    let line = format!("POST /{}/api/set", server.token);
    let head = [server.host(), server.origin(), "content-length: 100".into()];
    assert_eq!(server.request(&line, &head, "{").0, 408);
    assert_eq!(server.calls(), 0);
}

#[test]
fn idle_connections_do_not_keep_the_page_out() {
    let server = Running::new(None);
    let mut kept = Vec::new();
    for round in 0..200 {
        let mut stream = server.connect();
        if round % 2 == 0 {
            let _ = stream.write_all(b"GET / HTTP/1.1\r\nhost:");
        }
        kept.push(stream);
        if round % 40 == 39 {
            server.serves();
        }
    }
    server.serves();
}

#[test]
fn a_defect_in_one_answer_is_told_and_ends_nothing() {
    let server = Running::new(None);
    let (status, answer) = server.call("GET", "panic", "");
    assert_eq!(status, 500);
    assert!(answer.contains("a defect"), "{answer}");
    server.serves();
}

#[test]
fn events_reach_the_page() {
    let server = Running::new(None);
    let mut stream = server.connect();
    let head = format!("GET /{}/api/events HTTP/1.1\r\n{}\r\n\r\n", server.token, server.host());
    stream.write_all(head.as_bytes()).unwrap();
    let mut heard = String::new();
    let mut buffer = [0; 4096];
    while !heard.contains("event: changed") {
        let n = stream.read(&mut buffer).unwrap();
        assert!(n > 0, "{heard}");
        heard.push_str(&String::from_utf8_lossy(&buffer[..n]));
        if heard.contains(":\n\n") {
            server.events.send("changed", "{\"a\":1}");
        }
    }
    assert!(heard.contains("text/event-stream") && heard.contains("data: {\"a\":1}\n\n"), "{heard}");
    server.serves();
}

#[test]
fn it_ends_when_nobody_is_there() {
    let mut server = Running::new(Some(Duration::from_secs(3)));
    let began = Instant::now();
    // A page that listens keeps it up.
    let mut page = server.connect();
    let head = format!("GET /{}/api/events HTTP/1.1\r\n{}\r\n\r\n", server.token, server.host());
    page.write_all(head.as_bytes()).unwrap();
    std::thread::sleep(Duration::from_millis(4000));
    server.serves();
    drop(page);
    // A closed connection is noticed when something is sent.
    while !server.thread.as_ref().unwrap().is_finished() {
        server.events.send("changed", "{}");
        std::thread::sleep(Duration::from_millis(50));
        assert!(began.elapsed() < Duration::from_secs(60));
    }
    server.thread.take().unwrap().join().unwrap();
    server.thread = Some(std::thread::spawn(|| {}));
    assert!(began.elapsed() > Duration::from_millis(6800), "{:?}", began.elapsed());
}

#[test]
fn work_hears_that_its_caller_has_left() {
    let running = Running::new(None);
    let Running { token, app, .. } = &running;
    let head = format!("GET /{token}/api/work HTTP/1.1\r\n{}\r\n\r\n", running.host());
    let mut stream = running.connect();
    stream.write_all(head.as_bytes()).unwrap();
    let wait = |done: &dyn Fn() -> bool| {
        let began = Instant::now();
        while !done() && began.elapsed() < Duration::from_secs(10) {
            std::thread::sleep(Duration::from_millis(5));
        }
        assert!(done());
    };
    wait(&|| running.calls() == 1);
    assert_eq!(app.left.load(Ordering::SeqCst), 0);
    drop(stream);
    wait(&|| app.left.load(Ordering::SeqCst) == 1);
    running.serves();
}
