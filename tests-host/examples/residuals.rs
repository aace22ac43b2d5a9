#![allow(missing_docs)]
use rai_core::{frame::*, satellite::*};
use rai_firmware::{correction::*, ephemeris::Store, rtcm::*};
use std::collections::BTreeMap;
use tests_host::{encode::*, recording::*, replay};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let rec = Recording::load(&[a[1].clone().into()], &[a[2].clone().into()]).unwrap();
    let Ok(replay::Truth::Fixed(truth)) = replay::Truth::parse(&a[3]) else { panic!() };
    let f = if a[5] == "single" { Frequency::Single } else { Frequency::Dual };
    let lumps = replay::encode(&rec, &Selection::new(&a[4], f).unwrap(), &[], &replay::Window::ALL).unwrap();
    let mut dec = Decoder::new();
    let mut store = Store::new();
    let mut tally = Tally::default();
    let mut out: BTreeMap<SatelliteId, Vec<(f64, f64, f64)>> = BTreeMap::new();
    let frame = LocalFrame::at(truth);
    for l in &lumps {
        for &b in &l.bytes {
            let mut ev = dec.push(b);
            while let Some(e) = ev {
                match e {
                    Event::Ephemeris(e) => {
                        store.insert(e, None);
                    }
                    Event::Epoch(raw) => {
                        let sky = locate(raw, &store, &mut tally);
                        let site = Site::new(truth, raw.time, 10f64.to_radians(), rec.klobuchar);
                        let epoch = site.correct(&sky, &mut tally.ranges);
                        for c in Constellation::ALL {
                            let mut v: Vec<(SatelliteId, f64, f64, f64)> = epoch
                                .observations()
                                .iter()
                                .filter(|o| o.satellite.constellation() == c)
                                .map(|o| {
                                    let w = 7.2921151467e-5 / 299792458.0;
                                    let r = o.position.distance_m(truth)
                                        + w * (o.position.x_m * truth.y_m - o.position.y_m * truth.x_m);
                                    (
                                        o.satellite,
                                        o.range_m - r,
                                        frame.sin_elevation(truth, o.position),
                                        o.sigma_m,
                                    )
                                })
                                .collect();
                            if v.is_empty() {
                                continue;
                            }
                            v.sort_by(|a, b| a.1.total_cmp(&b.1));
                            let wsum: f64 = v.iter().map(|o| 1.0 / o.3 / o.3).sum();
                            let _ = wsum;
                            let med = v[v.len() / 2].1;
                            for o in v {
                                out.entry(o.0).or_default().push((o.1 - med, o.2, o.3));
                            }
                        }
                    }
                    _ => {}
                }
                ev = dec.pending();
            }
        }
    }
    for (s, v) in out {
        let n = v.len() as f64;
        let m = v.iter().map(|x| x.0).sum::<f64>() / n;
        let sd = (v.iter().map(|x| (x.0 - m).powi(2)).sum::<f64>() / n).sqrt();
        let max = v.iter().fold(0.0f64, |a, x| a.max(x.0.abs()));
        let nr = (v.iter().map(|x| (x.0 / x.2).powi(2)).sum::<f64>() / n).sqrt();
        let sg = v.iter().map(|x| x.2).sum::<f64>() / n;
        println!("{s} n {n} mean {m:.2} sd {sd:.2} max {max:.2} sigma {sg:.2} norm rms {nr:.2}");
    }
    println!("{tally:?}");
}
