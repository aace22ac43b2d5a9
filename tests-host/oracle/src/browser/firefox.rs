//! Firefox, headless: another engine than Chromium's, for what must be the same in both.
//!
//! It is told what to do on a port of this computer, by Mozilla's Marionette protocol 3: the length
//! of a message, a colon and JSON; orders are `[0, number, name, parameters]`, answers `[1, number,
//! error, result]`.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{Ipv4Addr, TcpStream};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tempfile::TempDir;

use super::Tab;
use crate::gpsd::Daemon;

/// Longest wait for the start, and for an answer.
const PATIENCE: Duration = Duration::from_mins(5);

/// Time between two looks for the port.
const PAUSE: Duration = Duration::from_millis(50);

/// Settings of a browser that opens pages alone and asks nobody for news.
const SETTINGS: &str = r#"user_pref("marionette.port", 0);
user_pref("datareporting.policy.dataSubmissionEnabled", false);
user_pref("app.normandy.enabled", false);
user_pref("network.captive-portal-service.enabled", false);
user_pref("network.connectivity-service.enabled", false);
"#;

/// A running Firefox with one page.
pub struct Firefox {
    line: BufReader<TcpStream>,
    number: u64,
    _daemon: Daemon,
    _folder: TempDir,
}

impl Firefox {
    /// Opens an address; returns `None` without Firefox.
    ///
    /// # Errors
    /// If the browser does not start or does not answer.
    pub fn open(address: &str) -> Result<Option<Self>> {
        let Some(name) = super::found(&["firefox-esr", "firefox"]) else { return Ok(None) };
        let folder = TempDir::new()?;
        std::fs::write(folder.path().join("user.js"), SETTINGS)?;
        let child = Command::new(name)
            .args(["--headless", "--no-remote", "--marionette", "--profile"])
            .arg(folder.path())
            // What a browser keeps of its own beside the profile goes with it.
            .env("HOME", folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .context("starting Firefox")?;
        let daemon = Daemon(child);
        let file = folder.path().join("MarionetteActivePort");
        let end = Instant::now() + PATIENCE;
        let port: u16 = loop {
            if let Some(port) = std::fs::read_to_string(&file).ok().and_then(|text| text.trim().parse().ok())
            {
                break port;
            }
            ensure!(Instant::now() < end, "Firefox does not start");
            thread::sleep(PAUSE);
        };
        let line = TcpStream::connect((Ipv4Addr::LOCALHOST, port))?;
        line.set_read_timeout(Some(PATIENCE))?;
        let mut firefox = Self { line: BufReader::new(line), number: 0, _daemon: daemon, _folder: folder };
        firefox.message().context("the greeting of Firefox")?;
        firefox.order("WebDriver:NewSession", &json!({}))?;
        firefox.order("WebDriver:SetTimeouts", &json!({"script": PATIENCE.as_millis() as u64}))?;
        firefox.order("WebDriver:Navigate", &json!({"url": address}))?;
        Ok(Some(firefox))
    }

    fn message(&mut self) -> Result<Value> {
        let mut length = Vec::new();
        self.line.read_until(b':', &mut length)?;
        length.pop();
        let mut bytes = vec![0; std::str::from_utf8(&length)?.parse().context("the length of a message")?];
        self.line.read_exact(&mut bytes)?;
        Ok(serde_json::from_slice(&bytes)?)
    }

    fn order(&mut self, name: &str, parameters: &Value) -> Result<Value> {
        self.number += 1;
        let text = json!([0, self.number, name, parameters]).to_string();
        write!(self.line.get_mut(), "{}:{text}", text.len())?;
        loop {
            let answer = self.message().with_context(|| format!("{name}: no answer"))?;
            if answer[0] == 1 && answer[1] == self.number {
                ensure!(answer[2].is_null(), "{name}: {}", answer[2]);
                return Ok(answer[3].clone());
            }
        }
    }
}

impl Tab for Firefox {
    fn value(&mut self, expression: &str) -> Result<Value> {
        // As an element of the page, a script would be against its policy.
        let script = format!(
            "const done = arguments[arguments.length - 1]; \
             Promise.resolve((() => ({expression}))()).then(done, (error) => done(String(error)));"
        );
        let answer = self.order("WebDriver:ExecuteAsyncScript", &json!({"script": script, "args": []}))?;
        Ok(answer["value"].clone())
    }

    fn choose(&mut self, selector: &str, files: &[PathBuf]) -> Result<()> {
        let found =
            self.order("WebDriver:FindElement", &json!({"using": "css selector", "value": selector}))?;
        let element = found["value"].as_object().and_then(|one| one.values().next()).context("an element")?;
        let files: Vec<_> = files.iter().map(std::fs::canonicalize).collect::<Result<_, _>>()?;
        let names: Vec<_> = files.iter().map(|file| file.display().to_string()).collect();
        let parameters = json!({"id": element, "text": names.join("\n")});
        self.order("WebDriver:ElementSendKeys", &parameters).map(drop)
    }
}
