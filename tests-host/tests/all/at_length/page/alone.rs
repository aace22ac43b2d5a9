//! The page asks nobody for anything and keeps nothing.

use std::sync::atomic::Ordering;

use super::server::serve;
use super::*;

/// A proxy that refuses everything: its port is closed.
const PROXY: &str = "--proxy-server=127.0.0.1:9";

#[test]
fn after_it_is_loaded_the_page_asks_for_nothing_and_stores_nothing() {
    let Some(built) = Built::new() else { return };
    let (address, count) = serve(std::fs::read(&built.path).unwrap());
    // The first is served, the second has no network at all.
    for (address, more) in [(address, &[][..]), (built.address(), &[PROXY])] {
        let mut browser = opened(Browser::open_in(built.browser, &address, DESK, "light", more).unwrap());
        let loaded = count.load(Ordering::SeqCst);
        browser.value("document.getElementById('faulty').click()").unwrap();
        assert_eq!(finished(&mut browser), "done");
        let photo = built.file("photo.jpg", b"\xFF\xD8\xFF\xE0\0\x10JFIF");
        assert_eq!(judged(&mut browser, &[photo]), "failed");
        let foreign: Vec<_> = browser.requests.iter().filter(|one| !one.starts_with("blob:")).collect();
        assert_eq!(foreign, [&address], "the page itself, and nothing else");
        assert_eq!(count.load(Ordering::SeqCst), loaded);
        let kept = "Promise.all([indexedDB.databases(), globalThis.caches?.keys() ?? []]).then(([bases, caches]) => \
                    [localStorage.length, sessionStorage.length, bases.length, caches.length].join())";
        assert_eq!(text(&mut browser, kept), "0,0,0,0");
        assert_eq!(text(&mut browser, "document.cookie"), "");
        assert_eq!(browser.complaints, [""; 0]);
        // The policy holds: a request is refused before it leaves.
        let refused = "fetch('http://127.0.0.1:9/').then(() => 'sent', () => 'refused')";
        assert_eq!(text(&mut browser, refused), "refused");
        assert!(browser.complaints.iter().any(|words| words.contains("Content Security Policy")));
    }
    assert_eq!(count.load(Ordering::SeqCst), 1, "one page, and no icon");
}
