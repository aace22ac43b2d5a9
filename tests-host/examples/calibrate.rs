#![allow(missing_docs)]
use tests_host::{encode::*, recording::*, replay};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let rec = Recording::load(&[a[1].clone().into()], &[a[2].clone().into()]).unwrap();
    let truth = replay::Truth::parse(&a[3]).unwrap();
    let f = if a[5] == "single" { Frequency::Single } else { Frequency::Dual };
    let lumps = replay::encode(&rec, &Selection::new(&a[4], f).unwrap(), &[], &replay::Window::ALL).unwrap();
    let mut setup = vec![];
    if let Some(k) = rec.klobuchar {
        setup.push(format!("IONO,{}", k.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join(",")));
    }
    let host = replay::on_host(&lumps, &setup, |_| {}).unwrap();
    let track = replay::track(&lumps, &host, Some(&truth)).unwrap();
    let s = replay::Summary::of(&track, &[]);
    println!("{}", serde_json::to_string(&s).unwrap());
    let r: Vec<f64> =
        track.iter().filter_map(|m| m.output.as_ref().and_then(|o| o.state.statistic)).collect();
    println!(
        "stat rms {:.3} max {:.3}",
        (r.iter().map(|x| x * x).sum::<f64>() / r.len() as f64).sqrt(),
        r.iter().fold(0.0f64, |a, b| a.max(*b))
    );
}
