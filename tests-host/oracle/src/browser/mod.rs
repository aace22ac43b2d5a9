//! Real browsers, headless, that open pages of this computer: Chromium, and [Firefox](firefox) for what
//! must be the same in both.
//!
//! Chromium is told what to do through a pair of pipes, by the Chrome `DevTools` Protocol: one JSON
//! object after another, each followed by a zero byte.

pub mod firefox;

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::PathBuf;
use std::process::{ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::gpsd::Daemon;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// A running browser with one page.
pub struct Browser {
    orders: ChildStdin,
    answers: Receiver<Value>,
    number: u64,
    session: Option<String>,
    /// Sessions of the page's threads, once they are asked for.
    threads: Vec<String>,
    /// Messages of the page's console.
    pub complaints: Vec<String>,
    /// Addresses that the page has asked for.
    pub requests: Vec<String>,
    _daemon: Daemon,
    _folder: TempDir,
}

/// What a test does with a page, in whichever browser.
pub trait Tab {
    /// Returns the value of an expression in the page, or of what it promises.
    ///
    /// # Errors
    /// If the browser does not answer.
    fn value(&mut self, expression: &str) -> Result<Value>;

    /// Gives files to the element of a selector, as a person chooses them.
    ///
    /// # Errors
    /// If there is no such element, or the browser does not answer.
    fn choose(&mut self, selector: &str, files: &[PathBuf]) -> Result<()>;

    /// Waits until an expression in the page is true; returns the time that it took.
    ///
    /// # Errors
    /// If it does not become true in time.
    fn wait_for(&mut self, expression: &str, within: Duration) -> Result<Duration> {
        let start = Instant::now();
        while self.value(expression)? != true {
            if start.elapsed() > within {
                bail!("{expression} is not true after {within:?}");
            }
            thread::sleep(Duration::from_millis(10));
        }
        Ok(start.elapsed())
    }
}

/// Returns the name of the browser, if there is one.
pub fn name() -> Option<&'static str> {
    found(&["chromium", "chromium-browser", "google-chrome"])
}

/// Returns the first of these programs that there is.
fn found(names: &[&'static str]) -> Option<&'static str> {
    let answers = |name: &&&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    names.iter().find(answers).copied()
}

impl Browser {
    /// Opens an address in a window of this size, in pixels.
    ///
    /// # Errors
    /// If the browser does not start or does not answer.
    pub fn open(name: &str, address: &str, size: (u32, u32)) -> Result<Self> {
        Self::open_in(name, address, size, "light", &[])
    }

    /// Opens an address in a window of this size, in pixels, and in a colour scheme, `light` or
    /// `dark`, with further arguments of the browser.
    ///
    /// # Errors
    /// As for [`Browser::open`].
    pub fn open_in(
        name: &str,
        address: &str,
        (width, height): (u32, u32),
        scheme: &str,
        more: &[&str],
    ) -> Result<Self> {
        let folder = TempDir::new()?;
        // The shell puts the pipes where the browser expects them: orders on 3, answers on 4.
        let script = format!(
            "exec {name} --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
             --disable-background-networking --disable-component-update --disable-sync \
             --remote-debugging-pipe --user-data-dir={} {} about:blank 3<&0 4>&1 </dev/null >/dev/null 2>&1",
            folder.path().display(),
            more.join(" ")
        );
        let mut command = Command::new("sh");
        command.args(["-c", &script]).stdin(Stdio::piped()).stdout(Stdio::piped());
        let mut child = command.spawn().context("starting the browser")?;
        let (orders, reported) =
            (child.stdin.take().context("a pipe")?, child.stdout.take().context("a pipe")?);
        let (sender, answers) = channel();
        thread::spawn(move || {
            for part in BufReader::new(reported).split(0).map_while(Result::ok) {
                let Ok(value) = serde_json::from_slice(&part) else { return };
                if sender.send(value).is_err() {
                    return;
                }
            }
        });
        let mut browser = Self {
            orders,
            answers,
            number: 0,
            session: None,
            threads: Vec::new(),
            complaints: Vec::new(),
            requests: Vec::new(),
            _daemon: Daemon(child),
            _folder: folder,
        };
        let target = browser.order("Target.createTarget", &json!({"url": "about:blank"}))?;
        let session = browser
            .order("Target.attachToTarget", &json!({"targetId": target["targetId"], "flatten": true}))?;
        browser.session = session["sessionId"].as_str().map(str::to_owned);
        browser.order("Log.enable", &json!({}))?;
        browser.order("Runtime.enable", &json!({}))?;
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600});
        browser.order("Emulation.setDeviceMetricsOverride", &size)?;
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        browser.order("Emulation.setEmulatedMedia", &features)?;
        browser.order("Network.enable", &json!({}))?;
        browser.order("Page.navigate", &json!({"url": address}))?;
        Ok(browser)
    }

    /// Gives an order, and returns its result.
    ///
    /// # Errors
    /// If the browser does not answer, or refuses.
    pub fn order(&mut self, method: &str, parameters: &Value) -> Result<Value> {
        let session = self.session.clone();
        self.order_to(session.as_deref(), method, parameters)
    }

    /// Returns the time that the processors have worked for the threads that pages have started, s; what
    /// else the computer does is not in it. Linux counts it, in nanoseconds.
    ///
    /// # Errors
    /// If the browser does not answer, or nobody counts.
    pub fn threads_worked_s(&mut self) -> Result<f64> {
        let answer = self.order_to(None, "SystemInfo.getProcessInfo", &json!({}))?;
        let processes = answer["processInfo"].as_array().context("processes")?;
        let mut sum_ns = 0.0;
        for process in processes.iter().filter_map(|one| one["id"].as_u64()) {
            for thread in std::fs::read_dir(format!("/proc/{process}/task"))? {
                let thread = thread?.path();
                let name = std::fs::read_to_string(thread.join("comm")).unwrap_or_default();
                let count = std::fs::read_to_string(thread.join("schedstat")).unwrap_or_default();
                if name.starts_with("DedicatedWorker") {
                    sum_ns += count.split(' ').next().unwrap_or("").parse::<f64>().context("a time")?;
                }
            }
        }
        Ok(sum_ns * 1e-9)
    }

    /// Returns the bytes that the page and its threads keep after everything is cleared away that they do
    /// not need any more, beside the memory of WebAssembly.
    ///
    /// # Errors
    /// If the browser does not answer.
    pub fn kept_bytes(&mut self) -> Result<f64> {
        let attach = json!({"autoAttach": true, "waitForDebuggerOnStart": false, "flatten": true});
        self.order("Target.setAutoAttach", &attach)?;
        let sessions: Vec<_> = self.session.iter().chain(&self.threads).cloned().collect();
        let mut sum = 0.0;
        for session in sessions {
            self.order_to(Some(&session), "HeapProfiler.collectGarbage", &json!({}))?;
            let answer = self.order_to(Some(&session), "Runtime.getHeapUsage", &json!({}))?;
            sum += answer["usedSize"].as_f64().context("a heap")?;
        }
        Ok(sum)
    }

    /// Gives an order to a page, or to the browser itself.
    fn order_to(&mut self, session: Option<&str>, method: &str, parameters: &Value) -> Result<Value> {
        self.number += 1;
        let mut order = json!({"id": self.number, "method": method, "params": parameters});
        if let Some(session) = session {
            order["sessionId"] = json!(session);
        }
        self.orders.write_all(order.to_string().as_bytes())?;
        self.orders.write_all(&[0])?;
        let end = Instant::now() + PATIENCE;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let answer = self.answers.recv_timeout(left).with_context(|| format!("{method}: no answer"))?;
            if answer["id"] == self.number {
                if let Some(error) = answer.get("error") {
                    bail!("{method}: {error}");
                }
                return Ok(answer["result"].clone());
            }
            if ["Log.entryAdded", "Runtime.exceptionThrown"].iter().any(|name| answer["method"] == *name) {
                self.complaints.push(answer["params"].to_string());
            }
            if answer["method"] == "Target.attachedToTarget" {
                self.threads.extend(answer["params"]["sessionId"].as_str().map(str::to_owned));
            }
            if answer["method"] == "Target.detachedFromTarget" {
                self.threads.retain(|one| answer["params"]["sessionId"] != **one);
            }
            if answer["method"] == "Network.requestWillBeSent" {
                self.requests.push(answer["params"]["request"]["url"].as_str().unwrap_or("").to_owned());
            }
        }
    }

    /// Returns a picture of the page, as a PNG in Base64.
    ///
    /// # Errors
    /// If the browser does not answer.
    pub fn picture(&mut self) -> Result<String> {
        let parameters = json!({"captureBeyondViewport": true});
        let picture = self.order("Page.captureScreenshot", &parameters)?;
        Ok(picture["data"].as_str().context("a picture")?.to_owned())
    }
}

impl Tab for Browser {
    fn value(&mut self, expression: &str) -> Result<Value> {
        let parameters = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        Ok(self.order("Runtime.evaluate", &parameters)?["result"]["value"].clone())
    }

    fn choose(&mut self, selector: &str, files: &[PathBuf]) -> Result<()> {
        let expression = format!("document.querySelector({})", json!(selector));
        let element = self.order("Runtime.evaluate", &json!({"expression": expression}))?;
        // A browser reads no path with `..` in it.
        let files: Vec<_> = files.iter().map(std::fs::canonicalize).collect::<Result<_, _>>()?;
        let parameters = json!({"files": files, "objectId": element["result"]["objectId"]});
        self.order("DOM.setFileInputFiles", &parameters).map(drop)
    }
}
