//! Calls from C give the bits of Rust: on the host in C99 and C++17, sanitised, and on both
//! emulated boards.
//!
//! The same session runs in Rust, without the C interface; its results are laid out by the header.

mod session;

use raim::signal::capture;
use rig::bench::workload::{self, Stream, Wrong};
use rig::board;
use rig::board::Machine;
use rig::capi::calls::Answer;
use rig::capi::program::{ARM, Language, SANITISED, classic_on_board, on_board, on_host};
use rig::capi::run;
use rig::shared;
use rig::skip;
use session::Session;

/// Largest stack of a call, bytes: as the library's documentation states it, and no more than a
/// task of 8 KiB has.
const STACK_BYTES: [(&str, u32); 10] = [
    ("rai_monitor_init", 4 * 1024),
    ("rai_monitor_forget", 128),
    ("rai_monitor_judge", 8 * 1024),
    ("rai_receiver_init", 8 * 1024),
    ("rai_receiver_gnss", 8 * 1024),
    ("rai_receiver_tick", 8 * 1024),
    ("rai_receiver_command", 5 * 1024),
    ("rai_receiver_set", 5 * 1024),
    ("rai_monitor_residuals", 1024),
    ("rai_receiver_residuals", 1024),
];

/// Phase, method, policy, clock aiding: every method, every policy.
const STRATEGIES: [[u8; 4]; 10] = [
    [2, 0, 0, 0],
    [2, 1, 0, 0],
    [2, 2, 0, 0],
    [2, 3, 0, 0],
    [2, 4, 0, 0],
    [2, 5, 0, 0],
    [2, 6, 0, 0],
    [3, 7, 0, 0],
    [0, 0, 1, 0],
    [1, 0, 2, 1],
];

/// Judges skies of every size and number of faults under every strategy.
fn monitored(session: &mut Session) {
    for strategy in STRATEGIES {
        session.prepare(strategy);
        for (count, constellations, faults) in
            [(4, 1, 0), (8, 1, 0), (20, 2, 1), (20, 2, 2), (20, 2, 0), (40, 2, 3), (40, 4, 0)]
        {
            session.judge_and_explain(&workload::epoch(count, constellations, faults).expect("a sky"));
        }
        session.forget();
    }
}

/// Sends a receiver's first epochs, commands between them, and a silence.
fn received(session: &mut Session) {
    let stream = Stream::with(8, 40, Wrong { faults: 3, scale: 1.0, from_s: 3.0 }).expect("a stream");
    session.start();
    let commands =
        ["CLOCKAID,ON", "METHOD,RANSAC", "METHOD,SEPARATION", "PHASE,LPV200", "METHOD,GROUPING", "STATS"];
    for (second, bytes) in (1_u64..).zip(&stream.epochs) {
        session.gnss(second * 1000, bytes);
        session.tick(second * 1000 + 100);
        if let Some(command) = commands.get(second as usize - 1) {
            session.command(command);
        }
        session.explain_receiver();
    }
    for (key, values) in
        [("PHASE", "NPA"), ("OUTPUT", "RMC,1"), ("MASK", ""), ("STATS", ""), ("METHOD", "AUTO")]
    {
        session.set(key, values);
    }
    for second in 9..25 {
        session.tick(second * 1000);
    }
    session.explain_receiver();
    session.command("SELFTEST");
}

fn whole() -> Session {
    let mut session = Session::new();
    monitored(&mut session);
    received(&mut session);
    session
}

fn assert_same(have: &[Answer], session: &Session) {
    assert_eq!(have.len(), session.want().len(), "an answer for each call");
    for (number, (have, want)) in have.iter().zip(session.want()).enumerate() {
        assert_eq!(have.status, 0, "call {number}, {}: refused", have.function());
        assert!(have.given == *want, "call {number}, {}: {:?}\nwant {want:?}", have.function(), have.given);
    }
}

fn has(programs: &[&str]) -> bool {
    let missing =
        programs.iter().find(|name| run(std::process::Command::new(name).arg("--version")).is_err());
    if let Some(name) = missing {
        skip::say(&format!("the program {name}"));
    }
    missing.is_none()
}

#[test]
fn calls_from_the_host_give_the_bits_of_rust() {
    if !has(&["gcc", "g++"]) {
        return;
    }
    let session = whole();
    let out = tempfile::tempdir().expect("a folder");
    for (language, flags) in
        [(Language::C, &[][..]), (Language::Cpp, &[]), (Language::C, &SANITISED), (Language::Cpp, &SANITISED)]
    {
        let have =
            on_host(session.calls(), language, flags, out.path()).expect("the program runs to its end");
        assert_same(&have, &session);
    }
}

#[test]
fn calls_of_a_recording_give_the_bits_of_rust() {
    let Some(path) = shared::path_or_skip("data/ubx/static1hz_base.ubx.gz") else { return };
    if !has(&["gcc"]) {
        return;
    }
    let bytes = capture::read(&path.display().to_string(), f64::INFINITY).expect("a capture");
    let mut session = Session::new();
    session.start();
    // A line of 115,200 baud carries 1,152 bytes in a tenth of a second.
    for (number, chunk) in (1_u64..).zip(bytes.chunks(1152)).take(1200) {
        session.gnss(number * 100, chunk);
        session.tick(number * 100);
    }
    assert!(session.protected() > 20, "the comparison is of something: {}", session.protected());
    let out = tempfile::tempdir().expect("a folder");
    let have = on_host(session.calls(), Language::C, &SANITISED, out.path()).expect("it runs to its end");
    assert_same(&have, &session);
    if !board::is_installed() || !has(&[ARM]) {
        return;
    }
    for machine in [Machine::Stm32f405, Machine::Mps2An500] {
        let have = on_board(session.calls(), machine, Language::C, out.path()).expect("it runs to its end");
        assert_same(&have, &session);
        println!("stack of the calls on {machine:?}, bytes: {:?}", deepest(&have));
    }
}

fn assert_same_on(machine: Machine) {
    if !board::is_installed() || !has(&[ARM]) {
        return;
    }
    let session = whole();
    let out = tempfile::tempdir().expect("a folder");
    for language in [Language::C, Language::Cpp] {
        let have = on_board(session.calls(), machine, language, out.path()).expect("it runs to its end");
        assert_same(&have, &session);
        println!("stack of the calls on {machine:?}, bytes:");
        let deepest = deepest(&have);
        for (function, most) in STACK_BYTES {
            let bytes = deepest.get(function).copied().unwrap_or(u32::MAX);
            println!("{bytes:>8} of {most:>8} {function}");
            assert!(bytes <= most, "{function} takes {bytes} bytes of the stack, above its {most}");
        }
    }
}

/// Classic RAIM alone: largest stack of a judgement, bytes, by the capacity in satellites.
const CLASSIC_STACK_BYTES: [(u8, u32); 3] = [(16, 5 * 1024), (32, 6 * 1024), (48, 7 * 1024)];

#[test]
fn the_smallest_library_gives_the_bits_of_rust() {
    if !board::is_installed() || !has(&[ARM]) {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    for (satellites, most) in CLASSIC_STACK_BYTES {
        let mut session = Session::new();
        for strategy in [[2, 0, 0, 0], [2, 1, 0, 0], [0, 0, 1, 0], [1, 0, 2, 1]] {
            session.prepare(strategy);
            for (count, faults) in
                [(6, 0), (8, 0), (8, 1), (12, 1), (16, 3), (16, 0), (satellites.min(40), 3)]
            {
                session.judge(&workload::epoch(count.into(), 2, faults).expect("a sky"));
            }
        }
        let have = classic_on_board(session.calls(), satellites, out.path()).expect("it runs to its end");
        assert_same(&have, &session);
        let deepest = deepest(&have);
        println!("room for {satellites} satellites, stack in bytes: {deepest:?}");
        assert!(
            deepest["rai_monitor_judge"] <= most && deepest["rai_monitor_init"] <= 4 * 1024,
            "{deepest:?}"
        );
    }
}

/// Returns the deepest stack of each function.
fn deepest(answers: &[Answer]) -> std::collections::BTreeMap<&'static str, u32> {
    let mut deepest = std::collections::BTreeMap::new();
    for answer in answers {
        let most = deepest.entry(answer.function()).or_insert(0);
        *most = answer.stack_bytes.max(*most);
    }
    deepest
}

#[test]
fn calls_on_the_board_give_the_bits_of_rust() {
    assert_same_on(Machine::Stm32f405);
}

#[test]
fn calls_on_the_second_board_give_the_bits_of_rust() {
    assert_same_on(Machine::Mps2An500);
}
