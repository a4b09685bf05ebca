//! The end of the program: on request at any time, or when its output is closed.
#![cfg(unix)]

use super::support::{Folder, Run};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Runs the program and asks it to stop after `after`. Returns its outcome and the seconds until its end.
fn stopped(folder: &Folder, arguments: &str, after: Duration) -> (Run, f64) {
    let mut child = folder.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(after);
    assert!(child.try_wait().unwrap().is_none(), "'{arguments}' had ended");
    let asked = Instant::now();
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let run = Run::from(child.wait_with_output().unwrap());
    (run, asked.elapsed().as_secs_f64())
}

#[test]
fn what_another_library_draws_is_ended_too() {
    let folder = Folder::new();
    // Drawing these octaves of noise takes some ten seconds, in one call of the renderer.
    folder.write(
        "noise.svg",
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="300" height="300"><filter id="f" x="0" y="0" width="1" height="1"><feTurbulence baseFrequency=".1" numOctaves="4"/></filter><rect width="300" height="300" filter="url(#f)"/></svg>"#,
    );
    let names = folder.names();
    let line = "render noise.svg --scale 11 -o noise.png";
    let (run, seconds) = stopped(&folder, line, Duration::from_millis(700));
    assert_eq!(run.code, Some(130), "{}", run.stderr);
    assert!(run.stderr.contains("error: interrupted"), "{}", run.stderr);
    // The bound allows for a busy machine, and is shorter than the uninterrupted run.
    assert!(seconds < 3.0, "{seconds}");
    assert_eq!(folder.names(), names);
}

#[test]
fn a_job_of_a_batch_that_is_stopped_is_not_taken_for_one_that_died() {
    let folder = Folder::with_library();
    std::fs::create_dir(folder.path("out")).unwrap();
    let line = "batch photo.lib.json --out-dir out --size 6000 --seed 1";
    let (run, _) = stopped(&folder, line, Duration::from_millis(1500));
    assert_eq!(run.code, Some(130), "{}", run.stderr);
    let left: Vec<_> = std::fs::read_dir(folder.path("out")).unwrap().collect();
    assert!(left.is_empty(), "{left:?}");
}

/// Runs a line of the shell in which `$VTEX` is the program.
fn shell(folder: &Folder, line: &str) -> Run {
    let program = folder.command("");
    let mut shell = Command::new("sh");
    shell.args(["-c", line]).env("VTEX", program.get_program()).current_dir(folder.path("."));
    shell.stdin(Stdio::null()).output().unwrap().into()
}

#[test]
fn what_nobody_can_read_is_an_error() {
    let folder = Folder::with_library();
    for closed in [">&-", "1<>/dev/null"] {
        let run = shell(&folder, &format!("\"$VTEX\" synth photo.lib.json --size 40 -o - {closed}"));
        run.fails(1, "cannot write '-': it is closed, or leads nowhere");
    }
    shell(&folder, "\"$VTEX\" synth photo.lib.json --size 40 -o - >/dev/null").succeeds();
    if std::path::Path::new("/dev/full").exists() {
        for line in ["--help", "--version", "synth -h"] {
            shell(&folder, &format!("\"$VTEX\" {line} >/dev/full")).fails(1, "cannot write '-'");
        }
    }
    // A reader that closes the pipe early causes no failure.
    shell(&folder, "\"$VTEX\" --help | head -1").succeeds();
}
