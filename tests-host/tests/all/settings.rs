//! Every setting of the module, through what takes settings.

use raim::replay::{self, Lump, Pace, Window};
use raim::sentence::epochs;
use raim::signal::encode::{Frequency, Selection};
use raim::signal::sky::raw::Simulation;
use rig::board::is_installed;
use rig::{image, lockstep};

/// Epochs of each replay.
const EPOCHS: u32 = 5;

fn lumps() -> Vec<Lump> {
    let recording = Simulation::above_xian(3600.0, EPOCHS, 11).record();
    let selection = Selection::new("GC", Frequency::Dual).expect("systems");
    replay::encode(&recording, &selection, &[], &Window::ALL).expect("a recording")
}

#[test]
fn every_setting_and_every_word_is_replayed() {
    let (lumps, every) = (lumps(), replay::every());
    assert!(every.len() > 60, "{every:?}");
    for setting in every {
        let command = replay::command_for(&setting).expect("a setting");
        let run = replay::on_host(&lumps, &[command], Pace::Recorded, |_| ());
        let run = run.unwrap_or_else(|error| panic!("{setting}: {error:#}"));
        let judged = epochs(&run.sentences()).expect("sentences").len();
        assert_eq!(judged, EPOCHS as usize, "{setting}");
    }
}

/// The board's frames of `MAVLink` stand between its sentences and spoil none of them.
#[test]
fn board_that_sends_mavlink_is_replayed() {
    if !is_installed() {
        return;
    }
    let messages = ["HEARTBEAT", "GPS_INPUT", "GNSS_INTEGRITY"];
    let (lumps, commands) = (lumps(), messages.map(|message| format!("OUTPUT,{message},1")));
    let image = image::build().expect("the image builds");
    let (mut host, mut board) = (String::new(), String::new());
    let run = lockstep::on_board(&image, lumps.into_iter().map(Ok), &commands, |heard| {
        host.push_str(&heard.host);
        board.push_str(&heard.board);
    });
    assert_eq!(run.expect("the board judges").difference, None);
    assert_eq!(board, host);
    assert_eq!(epochs(&board).expect("sentences").len(), EPOCHS as usize);
}
