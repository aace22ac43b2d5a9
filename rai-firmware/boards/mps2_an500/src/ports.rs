//! The three serial ports, driven by interrupts through the rings of `raim_board_arm::rings`.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use cortex_m_rt::exception;
use raim_firmware::board::reset::Fault;
use raim_firmware::outlet::Outlet;
use raim_firmware::ring::Ring;

use crate::board::{CORE_HZ, Mps2An500};
use crate::registers::{GNSS, HOST, LOG, Uart};
use raim_board_arm::fault::give_up;
use raim_board_arm::rings::{GNSS_IN, HOST_IN, HOST_OUT, HostPort, LOG_OUT, note_host_overrun};
use raim_board_arm::time;

/// Rate of all ports at start, bit/s.
const BAUD: u32 = 115_200;

/// Largest number of bytes that one interrupt receives.
const BYTES_PER_INTERRUPT: usize = 64;

/// An interrupt by its number.
#[derive(Clone, Copy)]
struct Line(u16);

// SAFETY: the number is that of a line of this board.
#[allow(unsafe_code)]
unsafe impl InterruptNumber for Line {
    fn number(self) -> u16 {
        self.0
    }
}

/// Interrupts of receiver and transmitter of UART 0, 1, 2.
const HOST_LINES: [Line; 2] = [Line(0), Line(1)];
const GNSS_LINES: [Line; 2] = [Line(2), Line(3)];
const LOG_LINES: [Line; 2] = [Line(4), Line(5)];

/// Starts the ports and their interrupts; returns the writer to the host.
#[allow(unsafe_code)]
pub fn start() -> HostPort {
    for port in [HOST, GNSS, LOG] {
        port.start(CORE_HZ / BAUD);
    }
    for line in [HOST_LINES, GNSS_LINES, LOG_LINES].into_iter().flatten() {
        // SAFETY: the handler below touches only the rings and registers of the ports, which are
        // ready.
        unsafe { NVIC::unmask(line) };
    }
    Outlet::new(&HOST_OUT, || NVIC::pend(HOST_LINES[1]))
}

/// Sets the rate of the GNSS port, bit/s.
pub fn set_gnss_rate(baud: u32) {
    GNSS.set_divider(CORE_HZ / baud.max(1));
}

/// Queues one frame of the log, whole or not at all. Call it with interrupts held back.
pub fn send_log(frame: &[u8]) {
    LOG_OUT.push_whole(frame);
    NVIC::pend(LOG_LINES[1]);
}

fn receive(port: Uart, mut push: impl FnMut(u8), mut overrun: impl FnMut()) {
    for _ in 0..BYTES_PER_INTERRUPT {
        if port.take_overrun() {
            overrun();
        }
        let Some(byte) = port.take() else { return };
        push(byte);
    }
}

/// Sends while the port takes bytes; its interrupt continues when it takes the next.
fn transmit<const N: usize>(port: Uart, ring: &Ring<N>) {
    for _ in 0..N {
        if !port.is_ready() {
            return;
        }
        let Some(byte) = ring.pop() else { return };
        port.send(byte);
    }
}

/// Serves all interrupts, because this board's are used by number.
#[exception]
#[allow(unsafe_code)]
unsafe fn DefaultHandler(number: i16) {
    match number {
        0 | 1 => {
            HOST.clear_interrupts();
            receive(HOST, |byte| _ = HOST_IN.push(byte), note_host_overrun);
            transmit(HOST, &HOST_OUT);
        }
        2 | 3 => {
            GNSS.clear_interrupts();
            let now_ms = time::now_ms_low();
            receive(GNSS, |byte| GNSS_IN.push(byte, now_ms), || GNSS_IN.lose());
        }
        4 | 5 => {
            LOG.clear_interrupts();
            receive(LOG, |_| (), || ());
            transmit(LOG, &LOG_OUT);
        }
        _ => give_up::<Mps2An500>(Fault::Hard { address: 0 }),
    }
}
