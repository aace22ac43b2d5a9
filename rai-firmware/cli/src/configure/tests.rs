//! A simulated receiver at a TCP port; frames of another program.

use std::io::{Read as _, Write as _};
use std::net::TcpListener;
use std::thread::JoinHandle;

use super::*;
use crate::configure::ubx::{self, ACK_ACK, ACK_NAK, CFG_MSG, CFG_VALSET, MON_VER};

/// A GNSS receiver that refuses some commands, and talks between its answers.
fn receiver(
    hardware: &'static str,
    module: &'static str,
    refused: &'static [&'static [u8]],
) -> (String, JoinHandle<usize>) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let name = format!("tcp://{}", listener.local_addr().unwrap());
    let handle = std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().unwrap();
        let (mut bytes, mut chunk, mut commands) = (Vec::new(), [0; 256], 0);
        while let Ok(count @ 1..) = stream.read(&mut chunk) {
            bytes.extend(&chunk[..count]);
            while let Some((identity, payload)) = ubx::take(&mut bytes) {
                // A sentence, the start of a frame, and an acknowledgement of something else.
                stream.write_all(b"$GNGLL,,,,,,V,N*7A\r\n\xB5").unwrap();
                stream.write_all(&ubx::frame(ACK_ACK, &[0x06, 0x24])).unwrap();
                if identity == MON_VER {
                    stream.write_all(&ubx::frame(MON_VER, &version(hardware, module))).unwrap();
                    continue;
                }
                commands += 1;
                let is_refused = refused.iter().any(|part| payload.windows(part.len()).any(|at| at == *part));
                let answer = if is_refused { ACK_NAK } else { ACK_ACK };
                stream.write_all(&ubx::frame(answer, &[identity.0, identity.1])).unwrap();
            }
        }
        commands
    });
    (name, handle)
}

fn version(hardware: &str, module: &str) -> Vec<u8> {
    let mut payload = Vec::new();
    for (text, length) in [("EXT CORE 1.00", 30), (hardware, 10), ("PROTVER=27.50", 30), (module, 30)] {
        let mut bytes = text.as_bytes().to_vec();
        bytes.resize(length, 0);
        payload.extend(bytes);
    }
    payload
}

fn arguments(port: &str, receiver: Option<Receiver>) -> Arguments {
    Arguments { port: Some(port.into()), receiver, wire: None, keep: false, dry_run: false }
}

/// Key of the rate of RXM-RAWX on UART1, and that of SEC-SIG, on the wire.
const RAWX: &[u8] = &[0xA5, 0x02, 0x91, 0x20];
const SEC_SIG: &[u8] = &[0x35, 0x06, 0x91, 0x20];

#[test]
fn frames_are_those_of_another_program() {
    // By pyubx2 1.4.0: config_set of one key in the layers RAM, or RAM, BBR and flash; CFG-MSG.
    let of = |receiver: Receiver, wire: &str, keep: bool| {
        receiver.steps(wire, keep).unwrap().iter().map(|step| hexadecimal(&step.bytes())).collect::<Vec<_>>()
    };
    assert_eq!(of(Receiver::Ublox9, "UART1", false)[1], "b562068a090000010000a502912001f366");
    assert_eq!(of(Receiver::X20, "USB", false)[1], "b562068a090000010000a702912001f570");
    assert_eq!(
        of(Receiver::Ublox9, "UART1", true)[0],
        "b562068a0900000700000100741001 26e3".replace(' ', "")
    );
    assert_eq!(of(Receiver::Ublox8, "UART1", false)[0], "b56206010300021501 2270".replace(' ', ""));
    assert_eq!(
        of(Receiver::Ublox8, "UART1", true)[3],
        "b56206090c0000000000030000000000000 01ea7".replace(' ', "")
    );
    assert_eq!(hexadecimal(&ubx::frame(MON_VER, &[])), "b5620a0400000e34");
}

fn hexadecimal(bytes: &[u8]) -> String {
    let digits: Vec<_> = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
    digits.concat()
}

#[test]
fn every_key_is_that_of_the_table_of_another_program() {
    // By pyubx2 1.4.0, UBX_CONFIG_DATABASE.
    let want: [(&str, [u32; 5]); 3] = [
        ("UART1", [0x1074_0001, 0x2091_02A5, 0x2091_0232, 0x2091_001B, 0x2091_0635]),
        ("UART2", [0x1076_0001, 0x2091_02A6, 0x2091_0233, 0x2091_001C, 0x2091_0636]),
        ("USB", [0x1078_0001, 0x2091_02A7, 0x2091_0234, 0x2091_001D, 0x2091_0637]),
    ];
    for (wire, keys) in want {
        let steps = Receiver::X20.steps(wire, false).unwrap();
        let have: Vec<_> = steps.iter().map(|step| step.bytes()[10..14].to_vec()).collect();
        assert_eq!(have, keys.map(|key| key.to_le_bytes().to_vec()), "{wire}");
    }
}

#[test]
fn receiver_is_asked_for_its_generation_and_takes_every_command() {
    for (hardware, module, commands) in
        [("00190000", "MOD=ZED-F9P", 5), ("00080000", "MOD=NEO-M8T", 3), ("00190000", "MOD=ZED-X20P", 5)]
    {
        let (port, simulated) = receiver(hardware, module, &[]);
        run(&arguments(&port, None)).unwrap();
        assert_eq!(simulated.join().unwrap(), commands, "{module}");
    }
}

#[test]
fn receiver_without_raw_ranges_is_refused_with_its_reason() {
    for (hardware, module) in [("00190000", "MOD=NEO-M9N"), ("000A0000", "MOD=MAX-M10S")] {
        let (port, simulated) = receiver(hardware, module, &[RAWX]);
        let error = run(&arguments(&port, None)).unwrap_err().to_string();
        assert!(error.contains("M9 and M10 have no RXM-RAWX"), "{error}");
        // The other commands are sent all the same.
        assert_eq!(simulated.join().unwrap(), 5);
    }
}

#[test]
fn older_firmware_without_a_message_that_the_module_can_miss_is_enough() {
    let (port, simulated) = receiver("00190000", "MOD=ZED-F9P", &[SEC_SIG]);
    run(&arguments(&port, Some(Receiver::Ublox9))).unwrap();
    assert_eq!(simulated.join().unwrap(), 5);
}

#[test]
fn unknown_receiver_must_be_named() {
    let (port, simulated) = receiver("000C0000", "MOD=NEW-1", &[]);
    let error = run(&arguments(&port, None)).unwrap_err().to_string();
    assert!(error.contains("--receiver") && error.contains("MOD=NEW-1"), "{error}");
    assert_eq!(simulated.join().unwrap(), 0);
}

/// A mosaic with a command line that knows one port.
#[test]
fn mosaic_replies_to_lines() {
    for (wire, is_known) in [("COM1", true), ("COM3", false)] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut arguments =
            arguments(&format!("tcp://{}", listener.local_addr().unwrap()), Some(Receiver::Mosaic));
        arguments.wire = Some(wire.to_lowercase());
        let simulated = std::thread::spawn(move || {
            let (mut stream, _) = listener.accept().unwrap();
            let (mut text, mut chunk) = (String::new(), [0; 256]);
            while let Ok(count @ 1..) = stream.read(&mut chunk) {
                text += std::str::from_utf8(&chunk[..count]).unwrap();
                if text.ends_with("\r\n") {
                    let line = text.lines().next_back().unwrap();
                    let is_good = !line.contains("COM3");
                    let reply = if is_good {
                        format!("$R: {line}\r\n")
                    } else {
                        "$R? Argument 'Cd' is invalid!\r\n".into()
                    };
                    stream.write_all(reply.as_bytes()).unwrap();
                }
            }
            text
        });
        assert_eq!(run(&arguments).is_ok(), is_known, "{wire}");
        let text = simulated.join().unwrap();
        assert!(text.starts_with(&format!("setDataInOut, {wire}, , +RTCMv3\r\n")), "{text}");
        assert_eq!(text.lines().count(), 4);
    }
}

#[test]
fn silent_port_and_a_port_that_the_receiver_lacks_are_named() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp://{}", listener.local_addr().unwrap());
    let error = run(&arguments(&port, None)).unwrap_err().to_string();
    assert!(error.contains("does not answer UBX-MON-VER"), "{error}");
    let mut wrong = arguments(&port, Some(Receiver::Ublox9));
    wrong.wire = Some("com1".into());
    assert!(run(&wrong).unwrap_err().to_string().contains("one of UART1, UART2, USB"));
}

#[test]
fn dry_run_prints_what_a_person_types() {
    let steps = Receiver::Ublox9.steps("UART1", false).unwrap();
    let text = typed(Receiver::Ublox9, &steps);
    assert!(text.contains("CFG-MSGOUT-UBX_RXM_RAWX_UART1 = 1\n    B5 62 06 8A 09 00"), "{text}");
    let text = typed(Receiver::Mosaic, &Receiver::Mosaic.steps("USB1", true).unwrap());
    let line = "setRTCMv3Output, USB1, MSM7+RTCM1019+RTCM1020+RTCM1042+RTCM1044+RTCM1045+RTCM1046";
    assert!(text.contains(line) && text.contains("exeCopyConfigFile, Current, Boot"), "{text}");
}

/// A refused block refuses its line alone, and the module works without the reports.
#[test]
fn mosaic_by_sbf_needs_its_ranges_and_bits_alone() {
    let steps = Receiver::MosaicSbf.steps("COM2", true).unwrap();
    let text = typed(Receiver::MosaicSbf, &steps);
    for line in [
        "setDataInOut, COM2, , +SBF",
        "setSBFOutput, Stream1, COM2, MeasEpoch, sec1",
        "setSBFOutput, Stream2, COM2, GPSRawCA+GLORawCA+GALRawINAV+GALRawFNAV+BDSRaw+QZSRawL1CA, OnChange",
        "setSBFOutput, Stream4, COM2, RFStatus, sec1",
        "exeCopyConfigFile, Current, Boot",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let refusing = |refused: &str| {
        let answer =
            |step: &Step| if step.name.contains(refused) { Answer::Refused } else { Answer::Accepted };
        let answers: Vec<_> = steps.iter().map(answer).collect();
        report(Receiver::MosaicSbf, &steps, &answers).1
    };
    assert!(refusing("GALAuthStatus") && refusing("RFStatus") && refusing("DOP"));
    assert!(!refusing("MeasEpoch") && !refusing("GPSRawCA"));
}

#[test]
fn frame_is_found_among_noise_and_a_cut_one_waits() {
    let frame = ubx::frame(CFG_MSG, &[1, 2, 3]);
    let mut damaged = frame.clone();
    damaged[7] ^= 1;
    let mut bytes = [&b"\xB5\xB5\x62"[..], &damaged, &frame, &frame[..5]].concat();
    assert_eq!(ubx::take(&mut bytes), Some((CFG_MSG, vec![1, 2, 3])));
    assert_eq!(ubx::take(&mut bytes), None);
    bytes.extend(&frame[5..]);
    assert_eq!(ubx::take(&mut bytes), Some((CFG_MSG, vec![1, 2, 3])));
    assert!(bytes.is_empty());
    let mut lengths = ubx::frame(CFG_VALSET, &[7; 300]);
    assert_eq!(ubx::take(&mut lengths), Some((CFG_VALSET, vec![7; 300])));
}
