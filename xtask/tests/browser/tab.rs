//! A tab with the page: what a person does there, and what the page shows.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use base64::Engine as _;
use serde_json::{Value, json};

use crate::chromium::{Browser, Session};

/// How long something may take to be shown.
const PATIENCE: Duration = Duration::from_secs(90);

/// A tab with the page. Every error in its console is a fault of the test.
pub struct Tab {
    session: Session,
    faults: Vec<String>,
}

impl Tab {
    /// Opens a tab of the size of a small laptop.
    pub fn new(browser: &mut Browser) -> Self {
        let mut session = browser.open_tab();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            session.call(&format!("{domain}.enable"), json!({}));
        }
        let mut tab = Self { session, faults: Vec::new() };
        tab.resize([1280, 720], false);
        tab
    }

    /// Has the page run this script before its own, whenever it is loaded.
    pub fn prepare(&mut self, script: &str) {
        self.call("Page.addScriptToEvaluateOnNewDocument", json!({ "source": script }));
    }

    /// Opens an address and waits until something is shown.
    pub fn open(&mut self, address: &str) {
        self.call("Page.navigate", json!({ "url": address }));
        self.wait("something to be shown", |_| true);
    }

    /// Loads the page anew and waits until something is shown.
    pub fn reload(&mut self) {
        self.evaluate("delete document.getElementById('motionscope').dataset.shown");
        self.call("Page.reload", json!({}));
        self.wait("something to be shown after a reload", |_| true);
    }

    /// Gives the page another size in points, as on a phone with a touch screen.
    pub fn resize(&mut self, [width, height]: [u32; 2], is_phone: bool) {
        // The browser's own pixels per point.
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 0, "mobile": is_phone });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
        self.call("Emulation.setTouchEmulationEnabled", json!({ "enabled": is_phone }));
    }

    /// Presses a key by its name in the browser, such as `ArrowRight` or `c`; a capital letter with Shift.
    pub fn press(&mut self, key: &str) {
        self.press_with(0, key);
    }

    /// Presses Ctrl and a key.
    pub fn press_ctrl(&mut self, key: &str) {
        self.press_with(2, key);
    }

    fn press_with(&mut self, modifiers: u32, key: &str) {
        let number = match key {
            "Enter" => 13,
            "Escape" => 27,
            "End" => 35,
            "Home" => 36,
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            other => other.to_uppercase().bytes().next().map_or(0, u32::from),
        };
        const SHIFT: u32 = 8;
        let is_letter = key.len() == 1;
        let is_capital = is_letter && key.bytes().all(|byte| byte.is_ascii_uppercase());
        let modifiers = modifiers | if is_capital { SHIFT } else { 0 };
        let code = if is_letter { format!("Key{}", key.to_uppercase()) } else { key.to_owned() };
        for kind in ["rawKeyDown", "keyUp"] {
            let event = json!({
                "type": kind, "modifiers": modifiers, "key": key, "code": code, "windowsVirtualKeyCode": number
            });
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// Gives files or a folder to the input with this id, as the browser's dialog does.
    pub fn choose(&mut self, id: &str, paths: &[&Path]) {
        let input = self.call("Runtime.evaluate", json!({ "expression": format!("document.getElementById({id:?})") }));
        let params = json!({ "files": paths, "objectId": input["result"]["objectId"] });
        self.call("DOM.setFileInputFiles", params);
    }

    /// Taps with a finger, which rests for as long as a person's does.
    pub fn tap(&mut self, [x, y]: [f64; 2]) {
        self.call("Input.dispatchTouchEvent", json!({ "type": "touchStart", "touchPoints": [{ "x": x, "y": y }] }));
        std::thread::sleep(Duration::from_millis(250));
        self.call("Input.dispatchTouchEvent", json!({ "type": "touchEnd", "touchPoints": [] }));
    }

    /// Clicks with a mouse.
    pub fn click(&mut self, [x, y]: [f64; 2]) {
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event);
            std::thread::sleep(Duration::from_millis(100));
        }
    }

    /// Waits until what is shown satisfies a condition, and returns it.
    pub fn wait(&mut self, what: &str, is_met: impl Fn(&Shown) -> bool) -> Shown {
        let begun = Instant::now();
        loop {
            let shown = self.shown();
            if let Some(shown) = shown.as_ref().filter(|shown| is_met(shown)) {
                return Shown(shown.0.clone());
            }
            if begun.elapsed() > PATIENCE || self.is_stopped() {
                self.screenshot("failure");
                let page = self.evaluate("document.body.innerText");
                panic!("waited for {what}; {shown:?} is shown, the page says {page}, faults: {:?}", self.take_faults());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits until nothing is worked on, and returns what is shown.
    pub fn settle(&mut self) -> Shown {
        self.wait("the work to end", |shown| !shown.is_busy())
    }

    /// The summary of the window, once the program has begun.
    pub fn shown(&mut self) -> Option<Shown> {
        let text = self.evaluate("document.getElementById('motionscope')?.dataset.shown ?? null");
        let shown = serde_json::from_str(text.as_str()?).expect("what is shown is JSON");
        Some(Shown(shown))
    }

    /// Waits until the page says that the program has stopped, and returns what it says.
    pub fn wait_for_stop(&mut self) -> String {
        let begun = Instant::now();
        while !self.is_stopped() {
            assert!(begun.elapsed() < PATIENCE, "the page does not say that the program has stopped");
            std::thread::sleep(Duration::from_millis(10));
        }
        self.evaluate("document.getElementById('stopped').innerText").as_str().unwrap_or_default().to_owned()
    }

    /// Whether the page says that the program has stopped.
    fn is_stopped(&mut self) -> bool {
        self.evaluate("document.getElementById('stopped')?.hidden === false") == json!(true)
    }

    /// The value of an expression in JavaScript; promises are waited for.
    pub fn evaluate(&mut self, expression: &str) -> Value {
        let params = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut answer = self.call("Runtime.evaluate", params);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].take()
    }

    /// Bytes of the program's memory and of the page's objects.
    pub fn memory(&mut self) -> (u64, u64) {
        let prototype = self.call("Runtime.evaluate", json!({ "expression": "WebAssembly.Memory.prototype" }));
        let objects = json!({ "prototypeObjectId": prototype["result"]["objectId"] });
        let memories = self.call("Runtime.queryObjects", objects)["objects"]["objectId"].take();
        let sum = "function() { return this.reduce((sum, memory) => sum + memory.buffer.byteLength, 0) }";
        let params = json!({ "objectId": memories, "functionDeclaration": sum, "returnByValue": true });
        let program = self.call("Runtime.callFunctionOn", params)["result"]["value"].as_u64();
        self.call("HeapProfiler.collectGarbage", json!({}));
        let page = self.call("Runtime.getHeapUsage", json!({}))["usedSize"].as_f64();
        (program.expect("a size"), page.expect("a size") as u64)
    }

    /// Writes a picture of the page into the folder that `SCREENSHOTS` names, if it names one.
    pub fn screenshot(&mut self, name: &str) {
        let Some(folder) = std::env::var_os("SCREENSHOTS").map(PathBuf::from) else { return };
        let picture = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let picture = base64::engine::general_purpose::STANDARD.decode(picture["data"].as_str().unwrap_or_default());
        std::fs::create_dir_all(&folder).expect("the folder of the pictures");
        std::fs::write(folder.join(format!("{name}.png")), picture.expect("a picture"))
            .expect("the picture is written");
    }

    /// Calls a method of the DevTools protocol.
    pub fn call(&mut self, method: &str, params: Value) -> Value {
        let answer = self.session.call(method, params);
        self.faults.extend(self.session.take_events().iter().filter_map(fault));
        answer
    }

    /// The errors of the console so far, which are then forgotten.
    pub fn take_faults(&mut self) -> Vec<String> {
        std::mem::take(&mut self.faults)
    }
}

impl Drop for Tab {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.faults.is_empty(), "errors in the console: {:#?}", self.faults);
        }
    }
}

/// The error that an event reports, if it reports one.
fn fault(event: &Value) -> Option<String> {
    let params = &event["params"];
    match event["method"].as_str()? {
        "Runtime.exceptionThrown" => Some(params["exceptionDetails"].to_string()),
        "Runtime.consoleAPICalled" if params["type"] == "error" => Some(params["args"].to_string()),
        "Log.entryAdded" if params["entry"]["level"] == "error" => Some(params["entry"].to_string()),
        _ => None,
    }
}

/// A summary of the window, as the page has it.
#[derive(Debug)]
pub struct Shown(Value);

impl Shown {
    /// A field with text: `lesson`, `clip`, `estimator`, `step`, `sentence`, `error` or `message`; empty where there is none.
    pub fn text(&self, field: &str) -> &str {
        self.0[field].as_str().unwrap_or_default()
    }

    /// The live picture of the camera: `frame`, `estimator`, `offered` and `error`; null where there is none.
    pub fn live(&self, field: &str) -> &Value {
        &self.0["live"][field]
    }

    /// Whether this is the start page.
    pub fn is_start(&self) -> bool {
        self.0["start"] == true
    }

    /// Whether something is being worked on.
    pub fn is_busy(&self) -> bool {
        self.0["busy"] == true
    }
}
