//! Real receivers give no evidence against themselves: no second receiver, no halves of epochs, and
//! no satellite whose bands no ionosphere explains.

use std::fs::File;
use std::io::Read as _;

use adversary::attack::victim::Victim;
use flate2::read::MultiGzDecoder;
use raim_core::frame::Ecef;
use raim_firmware::input::{Event, Input, Rivalry};
use rig::shared;

/// Captures of real receivers, and streams made of recordings; the third and the last are of
/// receivers with small antennas.
const CAPTURES: [&str; 11] = [
    "ubx/esbc_4h.ubx.gz",
    "ubx/static1hz_base.ubx.gz",
    "ubx/static1hz_rover_f9p_noise.ubx.gz",
    "ubx/tlse_x20p_fnav.ubx.gz",
    "real/f9r_rtcm_ubx.log.gz",
    "real/gmsd7_2012.rtcm3.gz",
    "real/f9p_sfrbx.ubx",
    "sbf/mosaic_12s.sbf.gz",
    "sbf/static1hz_base.sbf.gz",
    "sbf/tlse_x20p_fnav.sbf.gz",
    "ubx/urban_m8t.ubx.gz",
];

#[test]
fn real_receivers_give_no_evidence_against_themselves() {
    for name in CAPTURES {
        let Some(path) = shared::path_or_skip(&format!("data/{name}")) else { return };
        let (mut file, mut bytes) = (File::open(&path).expect("a readable file"), Vec::new());
        if name.ends_with("gz") {
            MultiGzDecoder::new(file).read_to_end(&mut bytes).expect("a packed file");
        } else {
            file.read_to_end(&mut bytes).expect("a readable file");
        }
        let (mut epochs, mut told) = (0, Vec::<Rivalry>::new());
        let mut input = Input::new();
        let mut victim = Victim::new(&[], 0.1).expect("a module");
        for (index, chunk) in bytes.chunks(512).enumerate() {
            input.feed(chunk, 50 * index as u64, |event| match event {
                Event::Epoch(..) => epochs += 1,
                Event::Rivalry(rivalry) => told.push(rivalry),
                _ => {}
            });
            victim.receive(chunk, Ecef::CENTRE).expect("sentences");
        }
        println!(
            "{name}: {epochs} epochs, {told:?}, bands apart {}",
            victim.counter("bands_apart").expect("an answer")
        );
        assert_eq!(told, [], "{name}, {epochs} epochs");
        assert_eq!(victim.counter("bands_apart").expect("an answer"), 0, "{name}");
    }
}
