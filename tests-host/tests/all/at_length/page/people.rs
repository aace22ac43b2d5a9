//! Everybody can read the page and reach its controls: widths, contrast, names, the keyboard.

use serde_json::{Value, json};

use super::*;

/// Roles of controls in the tree that a screen reader reads.
const CONTROLS: [&str; 7] =
    ["button", "textbox", "combobox", "link", "checkbox", "DisclosureTriangle", "progressbar"];

/// Least contrast of letters against their ground (WCAG 2.2, 1.4.3).
const LEAST_CONTRAST: f64 = 4.5;

/// Returns `contrast: words` of every text whose contrast is too small, by WCAG 2.2: (L₁ + 0.05) / (L₂ + 0.05).
const FAINT: &str = "
(() => {
  const parts = (text) => text.match(/[\\d.]+/g).map(Number);
  const light = (parts) => {
    const [red, green, blue] = parts.map((part) => (part /= 255) <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
  };
  const ground = (one) => {
    for (; one; one = one.parentElement) {
      const colour = parts(getComputedStyle(one).backgroundColor);
      if (colour.length < 4 || colour[3] > 0) return colour;
    }
    return [255, 255, 255];
  };
  const faint = [];
  for (const one of document.querySelectorAll('main *:not(svg *):not(canvas):not(option)')) {
    const words = [...one.childNodes].filter((node) => node.nodeType === 3).map((node) => node.textContent.trim()).join(' ').trim();
    if (!words || !one.checkVisibility() || one.disabled) continue;
    const [dark, bright] = [light(parts(getComputedStyle(one).color)), light(ground(one))].sort((a, b) => a - b);
    const contrast = (bright + 0.05) / (dark + 0.05);
    if (contrast < LEAST) faint.push(`${contrast.toFixed(2)}: ${words.slice(0, 60)}`);
  }
  return faint.join('; ');
})()";

fn keep(browser: &mut Browser, name: &str) {
    if let Ok(folder) = std::env::var("RAI_PICTURES") {
        std::fs::write(Path::new(&folder).join(format!("{name}.b64")), browser.picture().unwrap()).unwrap();
    }
}

/// Checks that nothing is wider than the screen, and no text too faint.
fn readable(browser: &mut Browser, width: u32, scheme: &str) {
    let wide = number(browser, "document.documentElement.scrollWidth");
    assert!(wide <= f64::from(width), "{wide} px on a screen of {width}");
    let faint = text(browser, &FAINT.replace("LEAST", &LEAST_CONTRAST.to_string()));
    assert_eq!(faint, "", "{width} {scheme}");
}

/// Opens the page and connects a receiver, which has sent some epochs.
fn live(built: &Built, size: (u32, u32), scheme: &str) -> Browser {
    let mut browser = built.open(size, scheme);
    port::plug(&mut browser, 0);
    for epoch in port::epochs(6) {
        port::feed(&mut browser, &epoch);
        std::thread::sleep(Duration::from_millis(300));
    }
    browser.wait_for("document.getElementById('state').textContent === 'protected'", PATIENCE).unwrap();
    browser
}

/// Opens everything that is folded.
const UNFOLD: &str = "for (const one of document.querySelectorAll('details')) one.open = true; 1";

#[test]
fn page_is_readable_at_the_width_of_a_telephone_and_of_a_desk_light_and_dark() {
    let Some(built) = Built::new() else { return };
    for (width, height) in [(390, 844), (1280, 900)] {
        for scheme in ["light", "dark"] {
            let mut browser = built.open((width, height), scheme);
            let end = number(&mut browser, "document.querySelector('#words').getBoundingClientRect().bottom");
            assert!(end <= f64::from(height), "the first view ends at {end} px of {height}");
            keep(&mut browser, &format!("rai-start-{width}-{scheme}"));
            for (button, view) in [("sample", "report"), ("faulty", "fault")] {
                browser
                    .value(&format!(
                        "document.body.dataset.state = ''; document.getElementById('{button}').click()"
                    ))
                    .unwrap();
                assert_eq!(finished(&mut browser), "done");
                keep(&mut browser, &format!("rai-{view}-{width}-{scheme}"));
            }
            browser.value(UNFOLD).unwrap();
            readable(&mut browser, width, scheme);
            let mut browser = live(&built, (width, height), scheme);
            keep(&mut browser, &format!("rai-live-{width}-{scheme}"));
            browser.value(UNFOLD).unwrap();
            readable(&mut browser, width, scheme);
        }
    }
}

#[test]
fn every_control_has_a_name_and_every_picture_a_sentence() {
    let Some(built) = Built::new() else { return };
    let mut browser = built.open(DESK, "light");
    browser.value("document.getElementById('faulty').click()").unwrap();
    assert_eq!(finished(&mut browser), "done");
    browser.value(UNFOLD).unwrap();
    browser.order("Accessibility.enable", &json!({})).unwrap();
    let tree = browser.order("Accessibility.getFullAXTree", &json!({})).unwrap();
    let mut controls = 0_u32;
    for node in tree["nodes"].as_array().unwrap() {
        let role = node["role"]["value"].as_str().unwrap_or_default();
        let is_ignored = node["ignored"] == Value::Bool(true);
        if is_ignored || !(CONTROLS.contains(&role) || role == "image") {
            continue;
        }
        let named = node["name"]["value"].as_str().unwrap_or_default();
        assert!(!named.trim().is_empty(), "a {role} without a name: {node}");
        controls += 1;
    }
    let settings = number(&mut browser, "document.querySelectorAll('#settings tbody tr').length");
    assert!(
        settings > 20.0 && f64::from(controls) > settings + 15.0,
        "{controls} controls, {settings} settings"
    );
}

/// Presses a key, and lets it go.
fn press(browser: &mut Browser, key: &str, code: u32, text: Option<&str>) {
    for kind in ["keyDown", "keyUp"] {
        let mut event = json!({"type": kind, "key": key, "code": key, "windowsVirtualKeyCode": code});
        if let Some(text) = text {
            event["text"] = json!(text);
        }
        browser.order("Input.dispatchKeyEvent", &event).unwrap();
    }
}

/// Numbers all controls that can be seen, in the order of reading; returns how many there are.
const NUMBER: &str = "
(() => {
  const all = [...document.querySelectorAll('input, select, button, summary, a[href]')];
  const seen = all.filter((one) => one.checkVisibility() && !one.disabled);
  seen.forEach((one, index) => { one.dataset.number = index; });
  document.activeElement.blur();
  getSelection().removeAllRanges();
  getSelection().collapse(document.querySelector('h1'), 0);
  return seen.length;
})()";

#[test]
fn keyboard_reaches_every_control_in_the_order_of_reading() {
    let Some(built) = Built::new() else { return };
    let mut browser = built.open(DESK, "light");
    // A button by its key, as by a click.
    browser.value("document.getElementById('faulty').focus(); 1").unwrap();
    press(&mut browser, "Enter", 13, Some("\r"));
    assert_eq!(finished(&mut browser), "done");
    assert_eq!(text(&mut browser, "document.activeElement.id"), "verdict", "the result is read out");
    browser.value(UNFOLD).unwrap();
    let all = number(&mut browser, NUMBER);
    assert!(all > 50.0, "{all} controls");
    let mut reached = Vec::new();
    // Tables that are wider than the screen are stops of their own.
    for _ in 0..all as usize + 20 {
        press(&mut browser, "Tab", 9, None);
        let stop = number(&mut browser, "document.activeElement.dataset.number ?? -1");
        if stop >= 0.0 && !reached.contains(&stop) {
            reached.push(stop);
        }
    }
    // It goes on where the focus was, at the result, and round.
    let start = reached.iter().position(|stop| *stop == 0.0).unwrap();
    reached.rotate_left(start);
    let want: Vec<f64> = (0..all as u32).map(f64::from).collect();
    assert_eq!(reached, want);
}
