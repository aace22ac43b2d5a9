//! The page of the running module, in a real browser and by plain requests.

use oracle::browser::{self, Browser, Tab as _};
use raim::signal::sky::Site;
use rig::skip;
use serde_json::Value;

use super::*;

/// Epochs before the leap of the position.
const EPOCHS: usize = 30;

/// Returns the answer to a request: its head and its body.
fn answer(address: SocketAddr, request: &str) -> (String, String) {
    let mut stream = client(address);
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap_or_else(|| panic!("{request}: {text}"));
    (head.to_owned(), body.to_owned())
}

fn get(address: SocketAddr, path: &str) -> (String, String) {
    answer(address, &format!("GET {path} HTTP/1.1\r\nHost: {address}\r\n\r\n"))
}

/// Starts the service with a page; returns also the receiver's line.
fn with_page(folder: &Path) -> (Service, TcpStream, SocketAddr) {
    let ((receiver, input), page) = (receiver(), free_address());
    let output = vec!["udp://127.0.0.1:9".to_owned()];
    let arguments = Arguments { input, output, page: Some(page.to_string()), ..Arguments::default() };
    let service = Service::start(folder, arguments);
    let (line, _) = receiver.accept().unwrap();
    (service, line, page)
}

/// Returns the epochs of a receiver that is 5 km farther south: an alert.
fn leapt() -> Vec<Vec<u8>> {
    let mut stray = sky(2 * EPOCHS as u32);
    stray.site = Site::geodetic(34.125, 108.57, 400.0);
    pieces_of(&stray)[1 + EPOCHS..].to_vec()
}

#[test]
fn page_answers_to_reads_alone_and_says_what_the_module_says() {
    let folder = tempfile::tempdir().unwrap();
    let (mut service, mut line, page) = with_page(folder.path());
    let (head, body) = get(page, "/healthz");
    assert!(head.starts_with("HTTP/1.1 503") && body.starts_with("unavailable"), "{head} {body}");
    service.send(&mut line, &pieces(EPOCHS as u32));
    let (head, body) = get(page, "/state.json");
    assert!(head.starts_with("HTTP/1.1 200 OK"), "{head}");
    let state: Value = serde_json::from_str(&body).unwrap();
    assert_eq!(
        (&state["state"], &state["reason"], &state["pin"]),
        (&"protected".into(), &"OK".into(), &true.into())
    );
    let near = |field: &str, want: f64| (state[field].as_f64().unwrap() - want).abs() < 1e-3;
    assert!(near("latitude_deg", 34.17) && near("longitude_deg", 108.57), "{state}");
    let satellites = state["satellites"].as_array().unwrap();
    let used = satellites.iter().filter(|one| one["fate"] == "used").count();
    assert_eq!(Some(used as u64), state["used"].as_u64(), "{state}");
    let (head, body) = get(page, "/metrics");
    assert!(head.contains("text/plain; version=0.0.4"), "{head}");
    // The first epoch behind a new connection may count as incomplete.
    let verdicts = state["verdicts"].as_u64().unwrap();
    assert!((EPOCHS as u64 - 1..=EPOCHS as u64).contains(&verdicts), "{verdicts}");
    let counted = format!("\nrai_events_total{{name=\"epochs_protected\"}} {verdicts}\n");
    for want in ["\nrai_protected 1\n", "\nrai_pin_high 1\n", &counted] {
        assert!(format!("\n{body}").contains(want), "{want}: {body}");
    }
    // Each line is a comment, or a name with labels and a number.
    for metric in body.lines().filter(|line| !line.starts_with('#')) {
        let (name, value) = metric.rsplit_once(' ').unwrap();
        assert!(name.starts_with("rai_") && value.parse::<f64>().is_ok(), "{metric}");
    }
    assert_eq!(get(page, "/healthz").1, "protected OK\n");
    let (head, body) = get(page, "/");
    for want in ["default-src 'none'", "script-src 'sha256-", "style-src 'sha256-", "frame-ancestors 'none'"]
    {
        assert!(head.contains(want), "{want}: {head}");
    }
    for foreign in ["http://", "https://", "//cdn", "@import", "url(", "style=\"", "onclick"] {
        assert!(!body.replace("http://www.w3.org/2000/svg", "").contains(foreign), "{foreign}");
    }
    for (request, want) in [
        ("POST /state.json HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 2\r\n\r\n{}", "405"),
        ("GET /nothing HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n", "404"),
        ("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", "403"),
        ("nonsense\r\n\r\n", "400"),
    ] {
        assert!(answer(page, request).0.starts_with(&format!("HTTP/1.1 {want}")), "{request}");
    }
    assert!(is_high(folder.path()), "nothing of this reaches the module");
}

/// Clients that never ask, that ask by halves, that never read, and far too many of them.
#[test]
fn bad_clients_of_the_page_are_bounded_and_cost_no_epoch() {
    let folder = tempfile::tempdir().unwrap();
    let (mut service, mut line, page) = with_page(folder.path());
    service.send(&mut line, &pieces(EPOCHS as u32)[..10]);
    let silent: Vec<_> = (0..6).map(|_| client(page)).collect();
    let halves: Vec<_> = (0..6)
        .map(|_| {
            let mut half = client(page);
            half.write_all(b"GET / HTTP/1.1\r\nHost").unwrap();
            half
        })
        .collect();
    let deaf: Vec<_> = (0..30)
        .map(|_| {
            let mut deaf = client(page);
            // It may be refused already.
            let _ = deaf.write_all(b"GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
            deaf
        })
        .collect();
    service.send(&mut line, &pieces(EPOCHS as u32)[10..]);
    assert!(is_high(folder.path()), "all epochs are judged");
    // The silent ones are closed after five seconds, and others are served.
    thread::sleep(Duration::from_millis(5500));
    drop((deaf, halves));
    thread::sleep(Duration::from_millis(100));
    assert!(get(page, "/healthz").0.starts_with("HTTP/1.1 "), "a place is free");
    drop(silent);
}

#[test]
fn alert_is_on_the_screen_within_a_second_at_the_width_of_a_telephone_and_of_a_desk() {
    let Some(name) = browser::name() else { return skip::say("a browser (chromium)") };
    for (width, height) in [(390, 844), (1280, 900)] {
        let folder = tempfile::tempdir().unwrap();
        let (mut service, mut line, page) = with_page(folder.path());
        service.send(&mut line, &pieces(EPOCHS as u32));
        let mut browser = Browser::open(name, &format!("http://{page}/"), (width, height)).unwrap();
        let shows = |word: &str| format!("document.getElementById('state')?.textContent === '{word}'");
        browser.wait_for(&shows("protected"), Duration::from_secs(20)).unwrap();
        let wide = browser.value("document.documentElement.scrollWidth").unwrap();
        assert!(wide.as_u64() <= Some(width.into()), "{wide} px on a screen of {width}");
        let points = browser.value("document.querySelectorAll('#sky .used').length").unwrap();
        assert!(points.as_u64() > Some(8), "{points}");
        keep(&mut browser, &format!("page-protected-{width}"));
        let leap = leapt();
        line.write_all(&leap[0]).unwrap();
        let taken = browser.wait_for(&shows("alert"), Duration::from_secs(5)).unwrap();
        assert!(taken < Duration::from_secs(1), "{taken:?}");
        assert_eq!(browser.value("document.getElementById('banner').className").unwrap(), "alert");
        assert_eq!(browser.value("document.getElementById('pin').textContent").unwrap(), "integrity pin low");
        keep(&mut browser, &format!("page-alert-{width}"));
        assert_eq!(browser.complaints, [""; 0], "the policy allows all of the page");
        service.sent += leap[0].len() as u64;
        drop(line);
        // Without the module the last verdict must not stay.
        drop(service);
        browser.wait_for(&shows("no connection"), Duration::from_secs(10)).unwrap();
    }
}

/// Keeps a picture of the page for whoever asks for it by `RAI_PICTURES`.
fn keep(browser: &mut Browser, name: &str) {
    if let Ok(folder) = std::env::var("RAI_PICTURES") {
        fs::write(Path::new(&folder).join(format!("{name}.b64")), browser.picture().unwrap()).unwrap();
    }
}
