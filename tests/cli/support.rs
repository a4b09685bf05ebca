//! Running the program in a folder of its own, and small inputs for it.

use image::{GrayImage, Luma, Rgb, RgbImage};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

/// A folder with a small photograph `photo.png`, in which the program is run.
pub(crate) struct Folder(tempfile::TempDir);

/// The outcome of a run of the program.
pub(crate) struct Run {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

impl Folder {
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        std::fs::write(folder.path("photo.png"), photo()).unwrap();
        folder
    }

    /// A folder that also holds `photo.lib.json`.
    pub(crate) fn with_library() -> Self {
        let folder = Self::new();
        std::fs::write(folder.path("photo.lib.json"), library()).unwrap();
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).unwrap();
    }

    /// Names of all files, sorted.
    pub(crate) fn names(&self) -> Vec<String> {
        let all = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            all.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program, ready to run here with arguments as a shell splits them: at blanks, except within single quotes.
    pub(crate) fn command(&self, arguments: &str) -> Command {
        let mut command = vtex();
        command.args(words(arguments));
        command.current_dir(self.0.path());
        // Models of the user who runs the tests are not used.
        command.env("VTEX_MODELS", self.0.path().join("models"));
        command
    }

    pub(crate) fn run(&self, arguments: &str) -> Run {
        self.command(arguments).output().unwrap().into()
    }

    /// Runs the program with something on standard input.
    pub(crate) fn feed(&self, arguments: &str, input: &[u8]) -> Run {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let input = input.to_vec();
        let feeder = std::thread::spawn(move || {
            // The program may end before it has read all input.
            let _ = stdin.write_all(&input);
        });
        let output = child.wait_with_output().unwrap();
        feeder.join().unwrap();
        output.into()
    }
}

/// Runs a command with a terminal for standard input and stderr, on which an answer is typed: its code, and
/// what the terminal shows.
#[cfg(unix)]
pub(crate) fn on_terminal(mut command: Command, answer: &str) -> (Option<i32>, String) {
    use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
    use std::io::Read;
    let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&master).unwrap();
    unlockpt(&master).unwrap();
    let name = ptsname(&master, Vec::new()).unwrap();
    let terminal = std::fs::File::options().read(true).write(true).open(name.to_str().unwrap()).unwrap();
    command.stdin(terminal.try_clone().unwrap()).stdout(Stdio::null()).stderr(terminal);
    let mut child = command.spawn().unwrap();
    // The command holds the terminal open, so that reading would never end.
    drop(command);
    let mut keys = std::fs::File::from(master);
    let mut screen = keys.try_clone().unwrap();
    let reader = std::thread::spawn(move || {
        let mut shown = Vec::new();
        // Reading reports the end of a terminal as an error.
        let _ = screen.read_to_end(&mut shown);
        String::from_utf8_lossy(&shown).into_owned()
    });
    keys.write_all(answer.as_bytes()).unwrap();
    let code = child.wait().unwrap().code();
    (code, reader.join().unwrap())
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(!stderr.contains("panicked"), "{stderr}");
        Self { code: output.status.code(), stdout: output.stdout, stderr }
    }
}

impl Run {
    #[track_caller]
    pub(crate) fn succeeds(self) -> Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        self
    }

    /// Checks exit code and message.
    #[track_caller]
    pub(crate) fn fails(self, code: i32, message: &str) -> Self {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        assert!(self.stderr.starts_with("error: "), "{}", self.stderr);
        assert!(self.stderr.contains(message), "'{message}' is not in: {}", self.stderr);
        self
    }

    #[track_caller]
    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.stdout).unwrap()
    }

    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).unwrap()
    }
}

/// The program in an environment that is the same everywhere.
pub(crate) fn vtex() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_vtex"));
    for name in [
        "VTEX_THREADS",
        "VTEX_MODELS",
        "VTEX_ONNXRUNTIME",
        "ORT_DYLIB_PATH",
        "NO_COLOR",
        "CLICOLOR",
        "CLICOLOR_FORCE",
        "COLUMNS",
        "LINES",
    ] {
        command.env_remove(name);
    }
    command.env("TERM", "xterm-256color").stdin(Stdio::null());
    command
}

/// A photograph of discs in two colours on noisy ground, 96 × 80, as PNG.
pub(crate) fn photo() -> Vec<u8> {
    let image = RgbImage::from_fn(96, 80, |x, y| {
        let noise = (x.wrapping_mul(2_654_435_761) ^ y.wrapping_mul(40_503)) >> 7 & 7;
        let (cx, cy) = (x as i32 % 16 - 8, y as i32 % 16 - 8);
        let number = x / 16 + y / 16;
        let base: [u32; 3] = match (cx * cx + cy * cy < 26, number % 2) {
            (false, _) => [120, 110, 90],
            (true, 0) => [220, 210, 200],
            (true, _) => [60, 70, 140],
        };
        Rgb(base.map(|v| (v + noise) as u8))
    });
    encode(&image.into(), image::ImageFormat::Png)
}

/// The library of [`photo`], made once.
pub(crate) fn library() -> &'static [u8] {
    static LIBRARY: OnceLock<Vec<u8>> = OnceLock::new();
    LIBRARY.get_or_init(|| {
        let run = Folder::new().run("analyze photo.png --seed 7 -o -");
        run.succeeds().stdout
    })
}

pub(crate) fn encode(image: &image::DynamicImage, format: image::ImageFormat) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

/// Whether bytes are a document of vtex with a given format.
pub(crate) fn is_document(bytes: &[u8], format: &str) -> bool {
    serde_json::from_slice::<serde_json::Value>(bytes).is_ok_and(|v| v["format"] == format)
}

/// Unpacks gzip.
pub(crate) fn unpack(path: &Path) -> Vec<u8> {
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).unwrap();
    std::io::Read::read_to_end(&mut flate2::read::GzDecoder::new(file), &mut bytes).unwrap();
    bytes
}

/// Writes shapes and maps that steer: `shape.svg`, `cage.svg`, `bent-cage.svg`, `fade.png`, `ring.png` and
/// `flag.png`.
pub(crate) fn steering(folder: &Path) {
    let disc = r#"<svg xmlns="http://www.w3.org/2000/svg" width="90" height="90"><circle cx="45" cy="45" r="40"/></svg>"#;
    std::fs::write(folder.join("shape.svg"), disc).unwrap();
    let cage = |d: &str| {
        format!(r#"<svg xmlns="http://www.w3.org/2000/svg" width="800" height="400"><path d="{d}"/></svg>"#)
    };
    std::fs::write(folder.join("cage.svg"), cage("M0 0H800V300H0z")).unwrap();
    std::fs::write(
        folder.join("bent-cage.svg"),
        cage("M0 0C250 120 550 120 800 0V300C550 420 250 420 0 300z"),
    )
    .unwrap();
    let fade = GrayImage::from_fn(256, 2, |x, _| Luma([x as u8]));
    fade.save(folder.join("fade.png")).unwrap();
    let ring = GrayImage::from_fn(90, 90, |x, y| {
        let (x, y) = (f64::from(x) - 44.5, f64::from(y) - 44.5);
        Luma([if (400.0..1600.0).contains(&(x * x + y * y)) { 255 } else { 0 }])
    });
    ring.save(folder.join("ring.png")).unwrap();
    let colours = [[20, 30, 90], [200, 40, 30], [250, 240, 220]];
    let flag = RgbImage::from_fn(30, 15, |x, _| Rgb(colours[x as usize / 10]));
    flag.save(folder.join("flag.png")).unwrap();
}

/// The words of a line of a shell: split at blanks, except within single quotes; a backslash before a quote keeps it.
pub(crate) fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut is_quoted) = (Vec::new(), None::<String>, false);
    let mut characters = line.chars().peekable();
    while let Some(c) = characters.next() {
        match c {
            '\'' => {
                is_quoted = !is_quoted;
                word.get_or_insert_default();
            }
            '\\' if !is_quoted && characters.peek() == Some(&'\'') => {
                word.get_or_insert_default().extend(characters.next());
            }
            c if c.is_whitespace() && !is_quoted => words.extend(word.take()),
            c => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    words
}
