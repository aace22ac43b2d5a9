//! A receiver at a serial port, which the test plays in the page itself.

use std::time::Instant;

use raim::replay::{Window, encode};
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use serde_json::json;

use super::*;

/// A port of the page's interface. At a wrong rate it gives other bytes.
const PORT: &str = "
class Port {
  constructor() { [this.readable, this.opened, this.sent] = [null, [], []]; }
  async open({ baudRate }) {
    this.opened.push(baudRate);
    this.readable = new ReadableStream({ start: (control) => { this.control = control; } });
    this.writable = new WritableStream({ write: (bytes) => { this.sent.push(...bytes); } });
  }
  async close() { this.readable = null; }
  feed(bytes) {
    const is_wrong = this.right && this.opened.at(-1) !== this.right;
    this.control.enqueue(Uint8Array.from(bytes, (byte) => (is_wrong ? (byte * 37 + 91) & 255 : byte)));
  }
  unplug() {
    const { control } = this;
    this.readable = null;
    control.error(new Error('the device has been lost'));
  }
}
window.port = new Port();
Object.defineProperty(navigator, 'serial', { value: { requestPort: async () => window.port, addEventListener() {} } });
1";

/// Returns the epochs of a simulated receiver, one a second.
pub(super) fn epochs(count: u32) -> Vec<Vec<u8>> {
    let recording = Simulation::above_xian(3600.0, count, 5).record();
    let selection = Selection::new("GC", Frequency::Dual).unwrap();
    encode(&recording, &selection, &[], &Window::ALL).unwrap().into_iter().map(|lump| lump.bytes).collect()
}

pub(super) fn feed(browser: &mut Browser, bytes: &[u8]) {
    browser.value(&format!("port.feed({})", json!(bytes))).unwrap();
}

/// Connects the page to a receiver at this rate, or at any.
pub(super) fn plug(browser: &mut Browser, right: u32) {
    browser.value(PORT).unwrap();
    browser.value(&format!("port.right = {right}; document.getElementById('connect').click()")).unwrap();
    browser.wait_for("port.readable !== null", PATIENCE).unwrap();
}

fn connect(built: &Built, right: u32) -> Browser {
    let mut browser = built.open(DESK, "light");
    plug(&mut browser, right);
    browser
}

#[test]
fn verdict_is_on_the_screen_a_tenth_of_a_second_after_an_epoch_and_stale_after_the_time_to_alert() {
    let Some(built) = Built::new() else { return };
    let mut browser = connect(&built, 0);
    browser.value("document.getElementById('record').click()").unwrap();
    let mut worst_ms = 0.0_f64;
    for epoch in epochs(12) {
        let due = Instant::now() + Duration::from_secs(1);
        browser.value("document.body.dataset.delay = ''").unwrap();
        feed(&mut browser, &epoch);
        browser.wait_for("document.body.dataset.delay !== ''", PATIENCE).unwrap();
        worst_ms = worst_ms.max(number(&mut browser, "document.body.dataset.delay"));
        std::thread::sleep(due.saturating_duration_since(Instant::now()));
    }
    println!("verdict on the screen {worst_ms:.1} ms after the bytes, at most");
    assert!(worst_ms < 100.0, "{worst_ms} ms");
    assert_eq!(text(&mut browser, "document.getElementById('state').textContent"), "protected");
    assert_eq!(text(&mut browser, "document.getElementById('pin').textContent"), "integrity pin high");
    assert!(number(&mut browser, "document.querySelectorAll('#live-view #sky .used').length") > 8.0);
    // The commands for the receiver are shown before they are sent, and sent as they are shown.
    browser.value("document.getElementById('configure').open = true").unwrap();
    browser.wait_for("document.getElementById('steps').textContent !== ''", PATIENCE).unwrap();
    let shown = text(&mut browser, "document.getElementById('steps').textContent");
    browser.value("document.getElementById('send').click()").unwrap();
    browser.wait_for("document.getElementById('port').textContent.endsWith('sent')", PATIENCE).unwrap();
    let sent = text(
        &mut browser,
        "port.sent.map((byte) => byte.toString(16).padStart(2, '0').toUpperCase()).join(' ')",
    );
    assert!(sent.starts_with("B5 62 06 8A"), "{sent}");
    let shown: String = shown
        .lines()
        .filter(|line| line.contains("B5 62"))
        .map(|line| line.trim().split("   ").next().unwrap().to_owned() + " ")
        .collect();
    assert_eq!(shown.trim(), sent);
    let start = Instant::now();
    browser.value("port.unplug()").unwrap();
    // TTA of NPA is 10 s after the last epoch.
    browser
        .wait_for("document.getElementById('why').textContent.startsWith('STALE')", Duration::from_secs(11))
        .unwrap();
    println!("STALE {:.1} s after the plug is out", start.elapsed().as_secs_f64());
    assert_eq!(text(&mut browser, "document.getElementById('pin').textContent"), "integrity pin low");
    assert_eq!(browser.complaints, [""; 0]);
}

/// Lets every clock and timer of the page and of its threads run so many times faster, from now on.
const FASTER: &str = "
{
  const [times, now, date, from, day] = [TIMES, performance.now.bind(performance), Date.now, performance.now(), Date.now()];
  performance.now = () => from + times * (now() - from);
  Date.now = () => day + times * (now() - from);
  for (const name of ['setInterval', 'setTimeout']) {
    const wait = globalThis[name].bind(globalThis);
    globalThis[name] = (act, ms, ...more) => wait(act, ms / times, ...more);
  }
}";

/// Most growth of what scripts keep in 20 minutes, bytes: less than a number per epoch.
const KEPT_BYTES: f64 = 64.0 * 1024.0;

/// Takes what the compilers of V8 add to a heap and remove again away from it.
const INTERPRETED: &str =
    "'--js-flags=--no-opt --no-maglev --no-sparkplug --no-flush-bytecode --no-lazy-feedback-allocation'";

/// How many times faster.
const TIMES: u32 = 40;

/// Feeds an epoch a second by the page's own clock. `ALL` are Base64.
const FEEDER: &str = "
window.fed = 0;
{
  const all = ALL.map((text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)));
  setInterval(() => fed < all.length && !window.paused && port.feed(all[window.fed++]), 1000);
}
1";

/// Half an hour, in which everything that knows a time sees forty times as much of it pass: the number of
/// epochs, of verdicts and of ticks is that of half an hour.
#[test]
fn memory_does_not_grow_in_half_an_hour() {
    let Some(built) = Built::new() else { return };
    let address = built.address();
    let mut browser =
        opened(Browser::open_in(built.browser, &address, DESK, "light", &[INTERPRETED]).unwrap());
    let faster = FASTER.replace("TIMES", &TIMES.to_string());
    browser.value(&format!("{faster}; 1")).unwrap();
    let thread = format!(
        "const text = {} + document.getElementById('thread').textContent; const Plain = Worker; \
         window.Worker = class extends Plain {{ constructor() {{ super(URL.createObjectURL(new Blob([text]))); }} }}; 1",
        json!(faster)
    );
    browser.value(&thread).unwrap();
    plug(&mut browser, 0);
    let all: Vec<String> = epochs(1801).iter().map(|bytes| base64_text(bytes)).collect();
    browser.value(&FEEDER.replace("ALL", &json!(all).to_string())).unwrap();
    let mut at = |epoch: u32| {
        let wanted =
            format!("fed >= {epoch} && document.getElementById('state').textContent === 'protected'");
        browser.wait_for(&wanted, 4 * PATIENCE).unwrap();
        (browser.kept_bytes().unwrap(), number(&mut browser, "document.body.dataset.memory"))
    };
    // A message on its way is no growth, so that the least of some readings counts.
    let mut least = |last: u32| {
        let readings = (last - 100..=last).step_by(10).map(&mut at);
        readings.reduce(|one, other| (one.0.min(other.0), one.1.min(other.1))).unwrap()
    };
    // The page keeps the verdicts of the last 600 epochs.
    let (early, late) = (least(710), least(1800));
    println!("script and memory of the program after 12 and 30 minutes: {early:?}, {late:?} bytes");
    assert!(late.0 - early.0 < KEPT_BYTES, "{early:?} {late:?}");
    assert!(early.1 > 0.0 && late.1 <= early.1, "{early:?} {late:?}");
    assert_eq!(browser.complaints, [""; 0]);
}

/// A port gives bytes as they come to hand: the end of an epoch and the beginning of the next together.
#[test]
fn satellites_are_shown_however_the_bytes_are_cut() {
    let Some(built) = Built::new() else { return };
    let mut browser = connect(&built, 0);
    let bytes = epochs(8).concat();
    for piece in bytes[..bytes.len() - 20].chunks(bytes.len() / 11) {
        feed(&mut browser, piece);
        std::thread::sleep(Duration::from_millis(200));
    }
    browser.wait_for("document.getElementById('state').textContent === 'protected'", PATIENCE).unwrap();
    assert!(number(&mut browser, "document.querySelectorAll('#live-view #sky .used').length") > 8.0);
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn a_wrong_rate_is_found_as_on_the_board() {
    let Some(built) = Built::new() else { return };
    let epochs = epochs(6);
    let mut browser = connect(&built, 38_400);
    let end = Instant::now() + Duration::from_secs(20);
    while number(&mut browser, "port.opened.at(-1)") > 38_400.0 {
        assert!(Instant::now() < end, "the rate is not found");
        feed(&mut browser, &epochs[0]);
        std::thread::sleep(Duration::from_millis(100));
    }
    assert_eq!(text(&mut browser, "port.opened.join()"), "115200,38400");
    browser.wait_for("port.readable !== null", PATIENCE).unwrap();
    for epoch in &epochs {
        feed(&mut browser, epoch);
        std::thread::sleep(Duration::from_secs(1));
    }
    browser.wait_for("document.getElementById('state').textContent === 'protected'", PATIENCE).unwrap();
}

#[test]
fn a_browser_without_serial_ports_says_so_and_offers_files() {
    let Some(built) = Built::new() else { return };
    let mut browser = opened(
        Browser::open_in(
            built.browser,
            &built.address(),
            DESK,
            "light",
            &["--disable-features=Serial", "--disable-blink-features=Serial"],
        )
        .unwrap(),
    );
    assert_eq!(browser.value("'serial' in navigator").unwrap(), false);
    assert_eq!(browser.value("document.getElementById('ports').hidden").unwrap(), true);
    let words = text(&mut browser, "document.getElementById('without').innerText");
    assert!(words.contains("drop the file here"), "{words}");
}
