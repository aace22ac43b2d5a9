//! Work that many threads share, whose results come in the order of the work.
//!
//! A thread that is free takes the next piece, so that nobody waits for the others: all are busy
//! until no piece is left. A result that is early waits until those before it have been taken.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver};
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Returns the number of threads that this computer can run at once.
pub fn threads() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// Computes the pieces 0 to `count` − 1 on so many threads, and passes their results on in order.
///
/// # Errors
/// The first error of `take`; pieces that nobody has begun are then left.
pub fn compute<R: Send>(
    count: usize,
    threads: usize,
    work: &(dyn Fn(usize) -> R + Sync),
    take: &mut dyn FnMut(R) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let next = AtomicUsize::new(0);
    let (done, results) = mpsc::channel();
    let walk = |done: mpsc::Sender<(usize, R)>| {
        loop {
            let piece = next.fetch_add(1, Ordering::Relaxed);
            if piece >= count || done.send((piece, work(piece))).is_err() {
                return;
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..threads.clamp(1, count.max(1)) {
            let done = done.clone();
            scope.spawn(|| walk(done));
        }
        drop(done);
        pass_on(results, take)
    })
}

/// Passes results on in the order of their pieces.
fn pass_on<R>(
    results: Receiver<(usize, R)>,
    take: &mut dyn FnMut(R) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let (mut early, mut due) = (BTreeMap::new(), 0);
    for (piece, result) in results {
        early.insert(piece, result);
        while let Some(result) = early.remove(&due) {
            take(result)?;
            due += 1;
        }
    }
    Ok(())
}

/// Returns the results of the pieces 0 to `count` − 1, computed on all processors.
pub fn all<R: Send>(count: usize, work: &(dyn Fn(usize) -> R + Sync)) -> Vec<R> {
    (0..count).together(work).collect()
}

/// Work on items, on all processors.
pub trait Together: IntoIterator<Item: Send> + Sized {
    /// Returns the results in the order of the items.
    fn together<R: Send>(self, work: impl Fn(Self::Item) -> R + Sync) -> std::vec::IntoIter<R> {
        let slots: Vec<_> = self.into_iter().map(|item| Mutex::new(Slot::Item(item))).collect();
        let fill = |slot: &Mutex<Slot<Self::Item, R>>| {
            let item = std::mem::replace(&mut *held(slot.lock()), Slot::Empty);
            if let Slot::Item(item) = item {
                let result = work(item);
                *held(slot.lock()) = Slot::Result(result);
            }
        };
        each(slots.len(), &|piece| slots.get(piece).into_iter().for_each(&fill));
        let results = slots.into_iter().filter_map(|slot| match held(slot.into_inner()) {
            Slot::Result(result) => Some(result),
            _ => None,
        });
        results.collect::<Vec<_>>().into_iter()
    }

    /// Returns the sum of the results, added in the order of the items. They are computed in
    /// batches, because the results of a whole experiment may not fit the memory.
    ///
    /// # Errors
    /// The first error of a result.
    fn together_sum<R: Send>(
        self,
        work: impl Fn(Self::Item) -> anyhow::Result<R> + Sync,
        nothing: R,
        add: impl Fn(R, R) -> R,
    ) -> anyhow::Result<R> {
        let (mut items, mut sum) = (self.into_iter(), nothing);
        loop {
            let batch: Vec<_> = items.by_ref().take(BATCH).collect();
            if batch.is_empty() {
                return Ok(sum);
            }
            for result in batch.into_iter().together(&work) {
                sum = add(sum, result?);
            }
        }
    }
}

/// Number of results of [`Together::together_sum`] that are kept at once.
const BATCH: usize = 4096;

impl<I: IntoIterator<Item: Send>> Together for I {}

/// An item, and then its result.
enum Slot<T, R> {
    Item(T),
    Empty,
    Result(R),
}

/// Returns what a lock holds. A thread that panicked ends the whole work, so that nobody reads what
/// it left behind.
fn held<T>(lock: Result<T, PoisonError<T>>) -> T {
    lock.unwrap_or_else(PoisonError::into_inner)
}

/// Does the pieces 0 to `count` − 1 on all processors. It is not generic, so that it is compiled
/// once for all kinds of work.
fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    let walk = || {
        loop {
            let piece = next.fetch_add(1, Ordering::Relaxed);
            if piece >= count {
                return;
            }
            work(piece);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads().min(count) {
            scope.spawn(walk);
        }
        walk();
    });
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::thread::ThreadId;
    use std::time::{Duration, Instant};

    use anyhow::bail;

    use super::*;

    /// Returns the share of its time that each of the threads is busy, if a piece keeps one busy for
    /// so long. A thread that sleeps needs no processor, so that this counts any number of them.
    fn efficiency(threads: usize, pieces: &[Duration]) -> f64 {
        let start = Instant::now();
        let mut busy = Duration::ZERO;
        let work = |piece: usize| {
            let begin = Instant::now();
            thread::sleep(pieces[piece]);
            begin.elapsed()
        };
        let mut add = |one| {
            busy += one;
            Ok(())
        };
        compute(pieces.len(), threads, &work, &mut add).unwrap();
        busy.as_secs_f64() / (start.elapsed().as_secs_f64() * threads as f64)
    }

    /// The cells of `tests-host/campaigns/lpv200.toml` at four times what they cost: 1.75 ms under two
    /// systems (1.14 s for 648) and 4.6 ms under three (3.0 s). The few percent by which they differ
    /// here are assumed.
    fn cells() -> Vec<Duration> {
        let cost = |cell: u64| if cell < 648 { 1_600 + cell % 7 * 50 } else { 4_400 + cell % 5 * 100 };
        (0..1296).map(|cell| Duration::from_micros(4 * cost(cell))).collect()
    }

    /// Checks that the threads are busy nine tenths of their time in one of three runs, because other
    /// programs may take the processors in one.
    fn assert_busy(threads: usize, pieces: &[Duration]) {
        let have: Vec<f64> = (0..3).map(|_| efficiency(threads, pieces)).collect();
        assert!(have.iter().any(|have| *have >= 0.9), "{have:?}");
    }

    #[test]
    fn sixty_four_threads_are_busy_nine_tenths_of_their_time() {
        assert_busy(64, &cells());
    }

    #[test]
    fn one_long_piece_holds_nobody_up() {
        let mut pieces = vec![Duration::from_millis(2); 100];
        pieces[10] = Duration::from_millis(60);
        assert_busy(2, &pieces);
    }

    #[test]
    fn results_come_in_order_from_several_threads() {
        let threads = Mutex::new(BTreeSet::new());
        let name = |id: ThreadId| format!("{id:?}");
        let work = |piece: usize| {
            thread::sleep(Duration::from_millis(if piece.is_multiple_of(3) { 3 } else { 1 }));
            threads.lock().unwrap().insert(name(thread::current().id()));
            piece * piece
        };
        let mut have = Vec::new();
        let mut keep = |result| {
            have.push(result);
            Ok(())
        };
        compute(40, 4, &work, &mut keep).unwrap();
        assert!(have.into_iter().eq((0..40).map(|piece| piece * piece)));
        assert_eq!(threads.lock().unwrap().len(), 4);
    }

    #[test]
    fn items_become_results_and_sums_in_their_order() {
        let texts = ["a", "b", "c"].map(str::to_owned);
        assert!(texts.into_iter().together(|text| text + "!").eq(["a!", "b!", "c!"]));
        assert_eq!(all(3, &|piece| piece), [0, 1, 2]);
        assert!(all(0, &|piece| piece).is_empty());
        let count = BATCH * 2 + 3;
        let sum = (0..count).together_sum(|piece| Ok(vec![piece]), Vec::new(), |a, b| [a, b].concat());
        assert!(sum.unwrap().into_iter().eq(0..count));
        let fail = |piece| if piece < 2 { Ok(piece) } else { bail!("{piece}") };
        assert_eq!((0..9).together_sum(fail, 0, |a, b| a + b).unwrap_err().to_string(), "2");
    }

    #[test]
    fn an_error_ends_the_work() {
        let begun = AtomicUsize::new(0);
        let work = |piece: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            thread::sleep(Duration::from_millis(1));
            piece
        };
        let mut fail = |piece| if piece == 5 { bail!("full") } else { Ok(()) };
        assert_eq!(compute(1_000, 2, &work, &mut fail).unwrap_err().to_string(), "full");
        assert!(begun.load(Ordering::Relaxed) < 100);
    }
}
