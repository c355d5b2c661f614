//! Starts Chromium and talks to it over the DevTools protocol.

use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// How long the browser may take for one answer.
const PATIENCE: Duration = Duration::from_secs(120);

const FLAGS: [&str; 11] = [
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-gpu-sandbox",
    "--use-angle=swiftshader-webgl",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    // A camera that shows a moving pattern, and that is always allowed.
    "--use-fake-device-for-media-stream",
    "--use-fake-ui-for-media-stream",
    "--remote-debugging-port=0",
    "about:blank",
];

/// One browser at a time: each works on all cores.
static TURN: Mutex<()> = Mutex::new(());

/// A browser with a fresh profile, which ends with the test.
pub struct Browser {
    process: Child,
    _profile: TempDir,
    port: u16,
    session: Session,
    _turn: MutexGuard<'static, ()>,
}

impl Browser {
    /// Starts the browser when its turn comes, with few pixels: a processor draws them.
    pub fn start() -> Self {
        Self::with_pixels_per_point(0.5)
    }

    /// Starts the browser when its turn comes, with this many pixels per point, and at least one if screenshots are wanted.
    pub fn with_pixels_per_point(pixels_per_point: f64) -> Self {
        let least = if std::env::var_os("SCREENSHOTS").is_some() { 1.0 } else { 0.0 };
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let profile = tempfile::tempdir().expect("a folder for the profile");
        let is_installed = |name: &&str| Command::new(name).arg("--version").output().is_ok();
        let name = ["chromium", "google-chrome"].into_iter().find(is_installed);
        let mut command = Command::new(name.expect("chromium is installed (Debian: apt-get install chromium)"));
        command.args(FLAGS).arg(format!("--user-data-dir={}", profile.path().display()));
        command.arg(format!("--force-device-scale-factor={}", pixels_per_point.max(least)));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        let process = command.spawn().expect("chromium starts");
        let (port, path) = debugging_port(profile.path());
        let session = Session::connect(port, &path);
        Self { process, _profile: profile, port, session, _turn: turn }
    }

    /// Opens an empty tab.
    pub fn open_tab(&mut self) -> Session {
        let target = self.session.call("Target.createTarget", json!({ "url": "about:blank" }));
        let id = target["targetId"].as_str().expect("the id of a tab");
        Session::connect(self.port, &format!("/devtools/page/{id}"))
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Ended by itself it takes its processes along, and writes nothing into the profile any more.
        self.session.send("Browser.close", json!({}));
        let begun = Instant::now();
        while self.process.try_wait().is_ok_and(|status| status.is_none()) {
            if begun.elapsed() > Duration::from_secs(10) {
                self.process.kill().ok();
            }
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// The port on which a browser that was just started listens, and the path of its own connection.
fn debugging_port(profile: &Path) -> (u16, String) {
    let begun = Instant::now();
    loop {
        let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        if let Some((port, path)) = text.split_once('\n') {
            return (port.parse().expect("a port"), path.trim().to_owned());
        }
        assert!(begun.elapsed() < PATIENCE, "chromium does not start");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A connection to a tab, or to the browser.
pub struct Session {
    socket: WebSocket<TcpStream>,
    calls: u64,
    /// The events that were received and not yet taken.
    events: Vec<Value>,
}

impl Session {
    fn connect(port: u16, path: &str) -> Self {
        let stream = TcpStream::connect(("127.0.0.1", port)).expect("chromium listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit of time");
        let (socket, _) =
            tungstenite::client(format!("ws://127.0.0.1:{port}{path}"), stream).expect("chromium answers");
        Self { socket, calls: 0, events: Vec::new() }
    }

    fn send(&mut self, method: &str, params: Value) -> u64 {
        self.calls += 1;
        let message = json!({ "id": self.calls, "method": method, "params": params });
        // A browser that is gone is noticed when its answer is read.
        self.socket.send(Message::text(message.to_string())).ok();
        self.calls
    }

    /// Calls a method of the protocol.
    pub fn call(&mut self, method: &str, params: Value) -> Value {
        let id = self.send(method, params);
        loop {
            let message = self.socket.read().unwrap_or_else(|error| panic!("{method}: {error}"));
            let Message::Text(text) = message else { continue };
            let mut message: Value = serde_json::from_str(&text).expect("JSON");
            match message["id"].as_u64() {
                Some(answered) if answered == id => {
                    assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                    return message["result"].take();
                }
                Some(_) => {}
                None => self.events.push(message),
            }
        }
    }

    /// Takes the events that were received during calls.
    pub fn take_events(&mut self) -> Vec<Value> {
        std::mem::take(&mut self.events)
    }
}
