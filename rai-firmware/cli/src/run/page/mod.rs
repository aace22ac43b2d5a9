//! The page of the running module: `--page 127.0.0.1:8080`.
//!
//! ```text
//! verdicts ─► Page ─► state ─► server ─► /  /events  /state.json  /metrics  /healthz
//! ```
//!
//! | path | content |
//! |---|---|
//! | `/` | the page, which shows the events |
//! | `/events` | server-sent events: `past` once, then `state` with each verdict and each second |
//! | `/state.json` | the state, as in an event |
//! | `/metrics` | metrics for Prometheus |
//! | `/healthz` | 200 while the receiver is heard and the loop comes round, else 503 |
//!
//! Nothing can be changed through it. A port without an address is one of this computer alone. The
//! requests are parsed by `httparse`; the connections are polled by `mio`, as the TCP clients are.
//! `tiny_http` was not taken: it bounds neither the time of a request nor the number of connections,
//! and has had no release since 2022.

mod digest;
mod request;
mod server;
mod text;

use std::sync::{Arc, Mutex, PoisonError};

use anyhow::Result;
use mio::Waker;

use super::share::Back;
use super::{Module, Plan};
use crate::page::live::State;
use crate::run::words::say;
use crate::satellites::Seen;

/// The epoch loop's side of the page.
#[derive(Debug)]
pub(super) struct Page {
    state: Arc<Mutex<State>>,
    waker: Arc<Waker>,
}

impl Page {
    /// Starts the server of the page.
    ///
    /// # Errors
    /// If the address cannot be used.
    pub(super) fn serve(address: &str, plan: &Plan, back: Option<Arc<Back>>) -> Result<Self> {
        let settings = plan.settings.iter().map(|(key, value)| format!("{key}={value}")).collect();
        let state = Arc::new(Mutex::new(State::new(plan.named.clone(), settings)));
        let (own, waker) = server::start(&with_host(address), plan.clients, Arc::clone(&state), back)?;
        say!("page: http://{own}/");
        Ok(Self { state, waker })
    }

    /// Notes whether the receiver sends ranges, or other messages alone.
    pub(super) fn note_ranges(&mut self, has_ranges: bool) {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).lacks_ranges = !has_ranges;
    }

    /// Takes the verdicts of a pass of the epoch loop.
    pub(super) fn note(&mut self, seen: &[Seen], receiver: &Module) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.live(receiver.pin().is_high());
        if seen.is_empty() {
            return;
        }
        state.counters = receiver.statistics().filter(|(name, _)| *name != "sigma_check_pct").collect();
        for Seen { output, view, .. } in seen {
            state.take(output.clone(), view.as_ref().map(|view| view.satellites.clone()));
        }
        drop(state);
        // A waker fails only if its thread has ended.
        let _ = self.waker.wake();
    }
}

impl Drop for Page {
    /// Closes every page, which then says that the module does not answer.
    fn drop(&mut self) {
        self.state.lock().unwrap_or_else(PoisonError::into_inner).has_ended = true;
        let _ = self.waker.wake();
    }
}

/// Returns the address; a port alone is one of this computer.
fn with_host(address: &str) -> String {
    let port = address.strip_prefix(':').unwrap_or(address);
    if port.parse::<u16>().is_ok() { format!("127.0.0.1:{port}") } else { address.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::with_host;

    #[test]
    fn port_without_an_address_is_of_this_computer() {
        assert_eq!(with_host("8080"), "127.0.0.1:8080");
        assert_eq!(with_host(":8080"), "127.0.0.1:8080");
        assert_eq!(with_host("0.0.0.0:8080"), "0.0.0.0:8080");
        assert_eq!(with_host("[::1]:80"), "[::1]:80");
    }
}
