//! `vtex studio`, by the calls of its page: what is saved is what the command lines that it shows make.

use super::support::{Folder, photo, steering};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// The program with its page, which ends with this.
struct Page {
    child: Child,
    port: u16,
    token: String,
}

impl Page {
    fn open(folder: &Folder, arguments: &str) -> Self {
        let mut command = folder.command(&format!("studio --no-open {arguments}"));
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stderr.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().rsplit_once("http://127.0.0.1:").unwrap_or_else(|| panic!("{line}")).1;
        let (port, token) = address.trim_end_matches('/').split_once('/').unwrap();
        Self { port: port.parse().unwrap(), token: token.to_owned(), child }
    }

    /// A call: its status and content.
    fn call(&self, verb: &str, name: &str, body: &[u8]) -> (u16, Vec<u8>) {
        let Self { port, token, .. } = self;
        let mut stream = TcpStream::connect(("127.0.0.1", *port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let head = format!(
            "{verb} /{token}/api/{name} HTTP/1.1\r\nhost: 127.0.0.1:{port}\r\norigin: http://127.0.0.1:{port}\r\n\
             content-length: {}\r\nconnection: close\r\n\r\n",
            body.len()
        );
        stream.write_all(&[head.as_bytes(), body].concat()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap();
        let status = String::from_utf8_lossy(&answer[9..12]).parse().unwrap();
        (status, answer.split_off(end + 4))
    }

    fn ask(&self, name: &str) -> Value {
        let (status, content) = self.call("GET", name, b"");
        assert_eq!(status, 200, "{name}: {}", String::from_utf8_lossy(&content));
        serde_json::from_slice(&content).unwrap()
    }

    #[track_caller]
    fn tell(&self, name: &str, content: &Value) {
        let (status, answer) = self.call("POST", name, content.to_string().as_bytes());
        assert_eq!(status, 200, "{name}: {}", String::from_utf8_lossy(&answer));
    }

    #[track_caller]
    fn refuses(&self, name: &str, content: &[u8], message: &str) {
        let (status, answer) = self.call("POST", name, content);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        assert!((400..500).contains(&status) && answer.contains(message), "{name}: {status} {answer}");
    }

    /// The state once nothing is left to do.
    #[track_caller]
    fn made(&self) -> Value {
        let began = Instant::now();
        loop {
            let state = self.ask("state");
            if state["busy"] == false {
                assert_eq!(state["fault"], Value::Null, "{state}");
                return state["work"].clone();
            }
            assert!(began.elapsed() < Duration::from_secs(60), "{state}");
            std::thread::sleep(Duration::from_millis(15));
        }
    }

    /// Saves in a format and runs the commands that are shown, in the same folder: both are the same.
    #[track_caller]
    fn same(&self, folder: &Folder, format: &str) -> Vec<String> {
        self.made();
        let (status, saved) = self.call("GET", &format!("save?format={format}"), b"");
        assert_eq!(status, 200, "{}", String::from_utf8_lossy(&saved));
        let commands = self.ask(&format!("commands?format={format}"));
        let lines: Vec<String> = commands["lines"]
            .as_array()
            .unwrap()
            .iter()
            .map(|line| line.as_str().unwrap().to_owned())
            .collect();
        for line in &lines {
            folder.run(line.strip_prefix("vtex ").unwrap()).succeeds();
        }
        let made = folder.read(commands["file"].as_str().unwrap());
        assert!(made == saved, "{format}: {} bytes, not {}: {lines:?}", saved.len(), made.len());
        lines
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn what_is_saved_is_what_the_commands_make_and_work_goes_on() {
    let folder = Folder::new();
    let page = Page::open(&folder, "photo.png --seed 3");
    page.made();
    page.tell("set", &json!({ "name": "size", "value": "90x70" }));
    page.tell("set", &json!({ "name": "tile", "value": "both" }));
    page.tell("set", &json!({ "name": "lattice", "value": "off" }));
    page.tell("set", &json!({ "name": "segmenter", "value": "regions" }));
    page.same(&folder, "svg");
    page.tell("seed", &json!({ "seed": "18446744073709551615" }));
    page.same(&folder, "pdf");
    // Mended.
    let work = page.made();
    let count = work["elements"]["count"].as_u64().unwrap();
    let version = &work["elements"]["version"];
    assert!(count > 4, "{work}");
    page.tell("mend", &json!({ "version": version, "mending": { "do": "delete", "elements": [0] } }));
    let lines = page.same(&folder, "library");
    assert!(lines[0].contains("--masks photo.masks.json"), "{lines:?}");
    assert_eq!(page.made()["elements"]["count"], count - 1);
    page.refuses(
        "mend",
        json!({ "version": version, "mending": { "do": "delete", "elements": [0] } }).to_string().as_bytes(),
        "changed meanwhile",
    );
    // Changed.
    let operations = ["recolor --from #404040 --to #ff0000 --where category=1", "thin 0.8 --layer primary"];
    page.tell("operations", &json!({ "operations": operations, "what": "" }));
    for format in ["svg", "png", "scene"] {
        assert_eq!(page.same(&folder, format).len(), 3);
    }
    page.tell("undo", &json!({}));
    assert_eq!(page.made()["operations"], json!([]));
    page.tell("redo", &json!({}));
    let work = page.made();
    // Killed, and started again.
    drop(page);
    let page = Page::open(&folder, "photo.png.vtex-studio.json");
    let again = page.made();
    for what in ["options", "seed", "operations", "mended", "elements"] {
        let same =
            again[what] == work[what] || what == "elements" && again[what]["count"] == work[what]["count"];
        assert!(same, "{what}: {again}");
    }
    assert_eq!(again["restored"], true);
    page.same(&folder, "svg");
    // A seed of the command line is newer, and undo brings the other back.
    drop(page);
    let page = Page::open(&folder, "photo.png --seed 9");
    assert_eq!(page.made()["seed"], "9");
    let lines = page.same(&folder, "svg");
    assert!(lines[..2].iter().all(|line| line.contains("--seed 9")), "{lines:?}");
    page.tell("undo", &json!({}));
    assert_eq!(page.made()["seed"], work["seed"]);
}

#[test]
fn categories_are_renamed_merged_filled_and_left_out() {
    let folder = Folder::new();
    let page = Page::open(&folder, "photo.png --seed 3");
    page.made();
    page.tell("set", &json!({ "name": "size", "value": "90x70" }));
    page.tell("set", &json!({ "name": "categories", "value": "3" }));
    page.tell("operations", &json!({ "operations": ["tint red --where category=3"], "what": "" }));
    let known = || {
        page.made();
        let known = page.ask("elements");
        let names: Vec<String> = serde_json::from_value(known["names"].clone()).unwrap();
        let of: Vec<usize> = serde_json::from_value(known["categories"].clone()).unwrap();
        (names, of, known["version"].clone())
    };
    let put = |elements: &[usize], name: Option<&str>| {
        let (_, _, version) = known();
        page.tell("categorize", &json!({ "version": version, "elements": elements, "name": name }));
    };
    let within = |category: usize| -> Vec<usize> {
        let (_, of, _) = known();
        (0..of.len()).filter(|&element| of[element] == category).collect()
    };
    let (found, of, _) = known();
    assert_eq!(found.len(), 3);
    put(&within(1), Some("R\u{e4}nder"));
    assert_eq!(known().0, [found[0].clone(), "R\u{e4}nder".into(), found[2].clone()]);
    assert_eq!(known().1, of);
    let lines = page.same(&folder, "library");
    assert!(lines[0].contains("--masks photo.masks.json") && !lines[0].contains("--categories"), "{lines:?}");
    // The second goes into the first; what was done to the third is done to it under its new number.
    let both = [within(0), within(1)].concat();
    put(&both, Some(&found[0]));
    assert_eq!(known().0, [found[0].clone(), found[2].clone()]);
    assert_eq!(page.made()["operations"], json!(["tint red --where category=2"]));
    page.tell("undo", &json!({}));
    assert_eq!(page.made()["operations"], json!(["tint red --where category=3"]));
    page.tell("redo", &json!({}));
    put(&[0], Some("the one"));
    let (names, of, _) = known();
    assert_eq!((names.len(), of[0]), (3, 2));
    let library = |page: &Page| {
        page.same(&folder, "library");
        let library: Value = serde_json::from_slice(&folder.read("photo.lib.json")).unwrap();
        library["categories"].as_array().unwrap().iter().map(|c| c["name"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(json!(library(&page)), json!(names));
    let written = String::from_utf8(folder.read("photo.lib.json")).unwrap();
    for (name, message) in [(&names[0][..], "is taken"), ("a,b", "blanks and hyphens")] {
        folder.write("bad.lib.json", written.replace("\"the one\"", &format!("\"{name}\"")));
        folder.run("inspect bad.lib.json").fails(1, message);
    }
    page.same(&folder, "svg");
    let svg = String::from_utf8(folder.read("photo.edited.svg")).unwrap();
    assert!(svg.contains(&names[0]), "{names:?}");
    page.tell("set", &json!({ "name": "exclude", "value": names[0] }));
    put(&within(0), Some("Kies"));
    let lines = page.same(&folder, "scene");
    assert!(lines[1].contains("--exclude=Kies"), "{lines:?}");
    let texture = &page.made()["texture"]["categories"];
    assert!(texture.as_array().unwrap().iter().all(|c| c["name"] != "Kies"), "{texture}");
    for (name, message) in [("a,b", "hyphens"), ("", "hyphens"), (&"x".repeat(101), "hyphens")] {
        let (_, _, version) = known();
        let wrong = json!({ "version": version, "elements": [0], "name": name }).to_string();
        page.refuses("categorize", wrong.as_bytes(), message);
    }
    let names = known().0;
    drop(page);
    let page = Page::open(&folder, "photo.png");
    page.made();
    assert_eq!(page.ask("elements")["names"], json!(names));
    assert_eq!(json!(library(&page)), json!(names));
    // Found anew, they are those of the analysis.
    let version = page.made()["elements"]["version"].clone();
    page.tell("categorize", &json!({ "version": version, "elements": [], "name": null }));
    page.made();
    assert_eq!(page.ask("elements")["names"], json!(found));
    page.same(&folder, "svg");
}

#[test]
fn what_is_drawn_is_kept_in_files_that_the_commands_name() {
    let folder = Folder::new();
    steering(&folder.path("."));
    let page = Page::open(&folder, "photo.png --seed 3");
    page.made();
    page.tell("set", &json!({ "name": "size", "value": "120x90" }));
    // A line that crosses itself encloses something all the same.
    let star = [[60, 5], [85, 85], [10, 35], [110, 35], [35, 85]];
    page.tell("draw", &json!({ "size": [120, 90], "path": star }));
    let lines = page.same(&folder, "svg");
    assert!(lines[1].contains("--domain photo.domain.svg"), "{lines:?}");
    let first = folder.read("photo.domain.svg");
    page.tell("draw", &json!({ "size": [120, 90], "path": [[10, 10], [100, 10], [100, 80], [10, 80]] }));
    assert!(folder.read("photo.domain.svg") != first && !folder.path("photo.domain-2.svg").exists());
    page.tell("undo", &json!({}));
    assert!(folder.read("photo.domain.svg") == first);
    for (size, path) in [([0, 9], json!([[1, 1], [9, 1], [9, 9]])), ([9, 9], json!([[1, 1], [9, 9]]))] {
        page.refuses("draw", json!({ "size": size, "path": path }).to_string().as_bytes(), "");
    }
    // A map that somebody else has put there is not replaced.
    folder.write("photo.density.png", folder.read("ring.png"));
    page.refuses("paint?option=density", b"no picture", "no PNG");
    assert_eq!(page.call("POST", "paint", &folder.read("ring.png")).0, 200);
    let lines = page.same(&folder, "svg");
    assert!(lines[1].contains("--density photo.density-2.png"), "{lines:?}");
    assert_eq!(page.call("GET", "picture?of=density", b"").1, folder.read("photo.density-2.png"));
    // Colours of a palette.
    assert_eq!(page.call("POST", "side?option=palette&name=my%20colours.txt", b"#102030\n#d0c0b0\n").0, 200);
    let lines = page.same(&folder, "svg");
    assert!(lines[2].contains("my colours.txt"), "{lines:?}");
    page.refuses("side?option=palette&name=x.txt", b"nothing", "");
    let work = page.made();
    drop(page);
    let page = Page::open(&folder, "photo.png");
    let again = page.made();
    assert_eq!([&again["files"], &again["operations"]], [&work["files"], &work["operations"]]);
    page.same(&folder, "svg");
    assert_eq!(page.call("POST", "side?option=palette", b"").0, 200);
    assert_eq!(page.made()["operations"], json!([]));
}

#[test]
fn files_of_the_page_steer_and_nothing_is_taken_from_paths() {
    let folder = Folder::new();
    steering(&folder.path("."));
    folder.write("secret.png", photo());
    let names = folder.names();
    let page = Page::open(&folder, "");
    // Nothing is open yet.
    page.refuses("set", br#"{"name":"size","value":"9"}"#, "nothing is open");
    page.refuses("open?name=..%2F..%2F", b"x", "name");
    page.refuses("open?name=a.png", b"no picture", "a.png");
    let heic = b"\0\0\0\x18ftypheic\0\0\0\0mif1heic\0\0\0\0meta";
    page.refuses("open?name=photo.heic", heic, "a HEIC picture");
    page.refuses("open?name=photo.heic", heic, "export it as JPEG or PNG");
    assert_eq!(folder.names(), names);
    assert_eq!(page.call("POST", "open?name=..%2F..%2Fdropped.png", &photo()).0, 200);
    assert!(folder.path("dropped.png").exists());
    page.tell("set", &json!({ "name": "size", "value": "80" }));
    assert_eq!(
        page.call("POST", "side?option=domain&name=%2Ftmp%2Fx%2Fmine.svg", &folder.read("shape.svg")).0,
        200
    );
    let lines = page.same(&folder, "svg");
    assert!(lines[1].contains("--domain mine.svg"), "{lines:?}");
    // Values out of range, options that name files, and operations that read them.
    let set = |name: &str, value: &str| json!({ "name": name, "value": value }).to_string().into_bytes();
    page.refuses("set", &set("rotate", "181"), "0 to 180 degrees");
    page.refuses("set", &set("size", "0"), "1 to 100000");
    for name in ["masks", "weights", "onnxruntime", "encoder", "config", "debug-dir", "o", "size=9 --config"]
    {
        page.refuses("set", &set(name, "secret.png"), "no option");
    }
    for operation in ["density secret.png", "palette secret.png", "mask secret.png", "tint secret.png"] {
        let body = json!({ "operations": [operation], "what": "" }).to_string();
        let (status, _) = page.call("POST", "operations", body.as_bytes());
        if status == 200 {
            // It is refused when it is done, at the latest.
            let state = loop {
                let state = page.ask("state");
                if state["busy"] == false {
                    break state;
                }
                std::thread::sleep(std::time::Duration::from_millis(20));
            };
            assert!(state["fault"]["error"].as_str().is_some_and(|e| e.contains("no files")), "{state}");
            page.tell("undo", &json!({}));
        }
    }
    page.made();
    for broken in [
        &b""[..],
        b"{",
        b"[]",
        b"{\"name\":1}",
        b"{\"name\":\"size\",\"value\":\"9\",\"more\":1}",
        &[0xff; 99],
    ] {
        page.refuses("set", broken, "cannot be read");
    }
    page.refuses("choose", b"7", "not open");
    assert_eq!(page.call("GET", "save?format=exe", b"").0, 422);
    assert_eq!(page.call("GET", "nothing", b"").0, 404);
    page.same(&folder, "svg");
}

#[test]
fn a_png_beyond_the_memory_of_a_page_is_refused_with_a_scale_that_does() {
    let folder = Folder::new();
    let page = Page::open(&folder, "photo.png --seed 3");
    page.tell("set", &json!({ "name": "size", "value": "260x260" }));
    page.made();
    let (status, answer) = page.call("GET", "save?format=png&scale=100", b"");
    let answer = String::from_utf8(answer).unwrap();
    assert!(status == 422 && answer.contains("26000 x 26000 px is too large"), "{status} {answer}");
    assert!(answer.contains("at most 38.4"), "{answer}");
    let (status, saved) = page.call("GET", "save?format=png&scale=2", b"");
    assert_eq!(status, 200);
    // What is told before is what is saved; a large picture is not drawn for it.
    let weighed = page.ask("weigh?format=png&scale=2");
    assert_eq!(weighed, json!({ "bytes": saved.len(), "size": [520.0, 520.0] }));
    assert_eq!(page.ask("weigh?format=png&scale=30")["bytes"], Value::Null);
    let saved = page.call("GET", "save?format=svg", b"").1;
    assert_eq!(page.ask("weigh?format=svg")["bytes"], saved.len());
}
