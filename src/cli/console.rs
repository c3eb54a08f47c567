//! Results go to standard output; progress and errors go to standard error.

use std::io::{ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime};

use indicatif::{ProgressBar, ProgressStyle};
use mmxrt::formats::folder;
use mmxrt::formats::report_json::{FORMAT_VERSION, Run, Stage, rfc3339};
use mmxrt::progress::Progress;
use mmxrt::{Error, Result};

/// Work that takes less than this shows no progress.
const PATIENCE: Duration = Duration::from_secs(1);
/// Without a terminal, progress is a line this often.
const LINE_EVERY: Duration = Duration::from_secs(10);
/// After Ctrl-C, a step that has not checked for this long whether to stop is killed, ...
const UNHEARD: Duration = Duration::from_millis(500);
/// ... and so is work that has not ended this long after it was asked to stop.
const UNENDED: Duration = Duration::from_secs(10);

pub(crate) struct Console {
    quiet: bool,
    verbose: bool,
    json: bool,
    terminal: bool,
    date: SystemTime,
    began: Instant,
    /// CPU time of this process then, s: a host may have been at work before.
    before_s: f64,
    interrupted: Arc<AtomicBool>,
    heard: Arc<AtomicBool>,
    stages: Mutex<Stages>,
}

/// The stages of a run, and what is displayed for the latest.
#[derive(Default)]
struct Stages {
    done: Vec<Stage>,
    /// Name, when it began, and the CPU time of this process then, s.
    current: Option<(&'static str, Instant, f64)>,
    /// Since when each is on its way, and how far it is: one that others interrupt goes on, and one that begins again does so.
    since: Vec<(&'static str, Instant, u64)>,
    bar: Option<ProgressBar>,
    line: Option<Instant>,
}

impl Stages {
    /// `cpu_s`: the CPU time of this process now.
    fn finish(&mut self, cpu_s: f64) {
        if let Some((name, began, before_s)) = self.current.take() {
            let (wall_s, cpu_s) = (began.elapsed().as_secs_f64(), cpu_s - before_s);
            // A stage that was interrupted by another continues.
            match self.done.iter_mut().find(|stage| stage.name == name) {
                Some(stage) => (stage.wall_s, stage.cpu_s) = (stage.wall_s + wall_s, stage.cpu_s + cpu_s),
                None => self.done.push(Stage { name: name.to_owned(), wall_s, cpu_s }),
            }
        }
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }

    /// For how long a stage has been on its way.
    fn elapsed(&mut self, Progress { stage, done, .. }: Progress) -> Duration {
        let place = self.since.iter().position(|(name, ..)| *name == stage).unwrap_or_else(|| {
            self.since.push((stage, Instant::now(), 0));
            self.since.len() - 1
        });
        let (_, since, before) = &mut self.since[place];
        if done == 0 && *before > 0 {
            *since = Instant::now();
        }
        *before = done;
        since.elapsed()
    }
}

impl Console {
    pub(crate) fn new(quiet: bool, verbose: bool, json: bool) -> Self {
        Console {
            quiet,
            verbose,
            json,
            terminal: std::io::stderr().is_terminal(),
            date: SystemTime::now(),
            began: Instant::now(),
            before_s: process_cpu_s().unwrap_or(0.0),
            interrupted: Arc::default(),
            heard: Arc::default(),
            stages: Mutex::default(),
        }
    }

    /// From now on Ctrl-C makes the next progress call stop the work, so that half-written files are removed. Work that makes no
    /// call for too long is killed.
    pub(crate) fn catch_interrupt(&self) -> std::result::Result<(), ctrlc::Error> {
        let (interrupted, heard, json) = (Arc::clone(&self.interrupted), Arc::clone(&self.heard), self.json);
        ctrlc::set_handler(move || {
            interrupted.store(true, Ordering::Relaxed);
            std::thread::sleep(UNHEARD);
            if heard.load(Ordering::Relaxed) {
                std::thread::sleep(UNENDED);
            }
            // Output that is already being moved into place is finished: otherwise "nothing was written" would be false.
            if folder::abandon() {
                say(&Error::Interrupted, json);
                std::process::exit(1);
            }
        })
    }

    /// The callback that the library calls between steps.
    pub(crate) fn watch(&self, progress: Progress) -> bool {
        // A panic elsewhere while this lock was held cannot have left it inconsistent.
        let mut stages = self.stages.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if stages.current.is_none_or(|(name, ..)| name != progress.stage) {
            let cpu_s = self.cpu_s();
            stages.finish(cpu_s);
            stages.current = Some((progress.stage, Instant::now(), cpu_s));
        }
        if !self.quiet && !self.json {
            self.show(&mut stages, progress);
        }
        let stops = self.interrupted.load(Ordering::Relaxed);
        self.heard.fetch_or(stops, Ordering::Relaxed);
        !stops
    }

    fn show(&self, stages: &mut Stages, progress: Progress) {
        let (name, elapsed) = (progress.stage, stages.elapsed(progress));
        if elapsed < PATIENCE || progress.done == 0 {
            return;
        }
        if self.terminal {
            let bar = stages.bar.get_or_insert_with(|| {
                let style = ProgressStyle::with_template("{msg:24} {bar:40} {percent:>3} %  {eta} left");
                ProgressBar::new(progress.total)
                    .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
                    .with_message(name)
                    .with_elapsed(elapsed)
            });
            bar.set_length(progress.total);
            bar.set_position(progress.done);
        } else if stages.line.is_none_or(|last| last.elapsed() > LINE_EVERY) {
            stages.line = Some(Instant::now());
            let share = progress.done as f64 / progress.total.max(1) as f64;
            let left = elapsed.as_secs_f64() * (1.0 / share - 1.0);
            self.note(&format!("{name}: {:.0} %, {left:.0} s left", 100.0 * share));
        }
    }

    /// Ends the current stage and removes its progress bar.
    pub(crate) fn finish_progress(&self) {
        self.stages.lock().unwrap_or_else(std::sync::PoisonError::into_inner).finish(self.cpu_s());
    }

    /// The contents of `run.json` so far.
    pub(crate) fn run(&self, command: &str) -> Run {
        self.finish_progress();
        let stages = self.stages.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        Run {
            format_version: FORMAT_VERSION,
            mmxrt: env!("CARGO_PKG_VERSION").to_owned(),
            command: command.to_owned(),
            date: rfc3339(self.date),
            threads: rayon::current_num_threads() as u64,
            host_cores: std::thread::available_parallelism().map_or(1, |n| n.get() as u64),
            wall_s: self.began.elapsed().as_secs_f64(),
            cpu_s: Some(self.cpu_s()),
            stages: stages.done.clone(),
            costs: vec![],
            files: std::collections::BTreeMap::new(),
        }
    }

    /// CPU time since this began, s, of all threads of this process; where the system does not tell it, wall time.
    pub(crate) fn cpu_s(&self) -> f64 {
        process_cpu_s().map_or_else(|| self.began.elapsed().as_secs_f64(), |now_s| now_s - self.before_s)
    }

    /// Whether results and errors are JSON.
    pub(crate) fn is_json(&self) -> bool {
        self.json
    }

    /// Whether to report everything.
    pub(crate) fn is_verbose(&self) -> bool {
        self.verbose
    }

    /// A remark for the user: on standard error, unless quiet.
    pub(crate) fn note(&self, text: &str) {
        if !self.quiet && !self.json {
            // There is nowhere left to report that standard error is gone.
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    }

    /// A result: as text unless quiet, or as JSON.
    pub(crate) fn result(&self, text: &str, json: &serde_json::Value) -> Result<()> {
        self.finish_progress();
        if self.json {
            self.print(&format!("{json:#}"))
        } else if self.quiet {
            Ok(())
        } else {
            self.print(text)
        }
    }

    /// The result of a command whose output is already written: a full standard output does not make that an error.
    pub(crate) fn done(&self, text: &str, json: &serde_json::Value) {
        if let Err(error) = self.result(text, json) {
            self.note(&format!("warning: {error}; the output is complete"));
        }
    }

    /// A result of many, as a line of JSON unless quiet.
    pub(crate) fn line(&self, json: &serde_json::Value) -> Result<()> {
        if self.quiet { Ok(()) } else { self.print(&json.to_string()) }
    }

    /// A line on standard output. A reader that closed it early, such as `head`, has what it wants.
    fn print(&self, text: &str) -> Result<()> {
        let mut out = std::io::stdout().lock();
        match writeln!(out, "{}", text.trim_end()).and_then(|()| out.flush()) {
            Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::io("standard output", "writing", e)),
            _ => Ok(()),
        }
    }

    /// An error, on standard error.
    pub(crate) fn error(&self, error: &Error) {
        self.finish_progress();
        say(error, self.json);
    }
}

/// CPU time of this process so far, s, where the system tells it.
fn process_cpu_s() -> Option<f64> {
    #[cfg(any(target_os = "linux", target_vendor = "apple"))]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
        Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
    }
    #[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
    None
}

fn say(error: &Error, json: bool) {
    let text = if json { super::error_json(error).to_string() } else { mmxrt::formats::picture(error) };
    // There is nowhere left to report that standard error is gone.
    let _ = writeln!(std::io::stderr(), "{text}");
}
