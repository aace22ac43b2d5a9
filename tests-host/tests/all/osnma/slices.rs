//! Slices of the work give way to bytes and to epochs, as many as there are.

use super::*;

/// Pages until the root key is known, and all of its blocks.
const PAGES_S: u32 = 150;

/// Passes of the loop without which no slice is done on a busy line, and while an epoch is open.
const PATIENCE: u32 = 20;
const LONG: u32 = 200;

/// A module with a long queue: it has heard pages for minutes, and its loop has not passed.
struct Behind {
    module: Module,
    now_ms: u64,
}

impl Behind {
    fn new(pages: &[Page]) -> Self {
        let (mut module, mut now_ms) = (Module::new(&[KEY]), 0);
        let start_s = pages[0].begin_s;
        for page in pages {
            now_ms = u64::from(page.begin_s + 2 - start_s) * 1000;
            module.receiver.gnss(&page.message(), now_ms, &mut module.reported);
        }
        Self { module, now_ms }
    }

    /// Lets the loop pass each millisecond, with these bytes of the line before each pass; returns the
    /// slices.
    fn pass(&mut self, passes: u32, bytes: &[u8]) -> u32 {
        let before = self.module.receiver.slices();
        for _ in 0..passes {
            self.now_ms += 1;
            if !bytes.is_empty() {
                self.module.receiver.gnss(bytes, self.now_ms, &mut self.module.reported);
            }
            self.module.receiver.tick(self.now_ms, &mut self.module.reported);
        }
        self.module.receiver.slices() - before
    }
}

#[test]
fn no_slice_is_done_while_bytes_of_an_epoch_wait() {
    let Some(pages) = station() else { return };
    let end_s = pages[0].begin_s + PAGES_S;
    let some: Vec<Page> = pages.into_iter().take_while(|page| page.begin_s < end_s).collect();
    // The work has waited for long: as many as a caller gets who passes ten times a second.
    let mut behind = Behind::new(&some);
    assert_eq!(behind.pass(1, &[]), 4);
    // Bytes were read a millisecond ago. A silent line then has one in each pass.
    assert_eq!(behind.pass(1, &[]), 0);
    assert_eq!(behind.pass(200, &[]), 200);
    // A byte that begins nothing before each pass.
    assert_eq!(behind.pass(PATIENCE - 1, b"U"), 0);
    assert_eq!(behind.pass(10 * PATIENCE, b"U"), 10);
    // An epoch whose last message is missing, on a silent line.
    let recording = Simulation::above_xian(3600.0, 1, 1).record();
    let mut encoder =
        Encoder::new(&recording.ephemerides, Selection::new("GC", Frequency::Dual).expect("systems"));
    let epoch = encoder.epoch(&recording.epochs[0]).expect("an epoch");
    behind.pass(10, &[]);
    let whole = epoch.len() - 20;
    behind.module.receiver.gnss(&epoch[..whole], behind.now_ms, &mut behind.module.reported);
    assert_eq!(behind.pass(LONG - 1, &[]), 0);
    assert!((1..=4).contains(&behind.pass(1, &[])));
    // Its last bytes complete it: slices go on as before.
    behind.module.receiver.gnss(&epoch[whole..], behind.now_ms, &mut behind.module.reported);
    assert_eq!(behind.pass(2, &[]), 0);
    assert!(behind.pass(100, &[]) >= 100);
    assert!(behind.module.reported.windows(6).any(|part| part == b"$PRAIS"), "the epoch was judged");
}
