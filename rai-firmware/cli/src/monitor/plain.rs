//! Verdicts and exclusions as lines of text, for a pipe or a log.

use crate::sentence::{self, Sentence};
use crate::verdict::State;

/// Returns a line in words; `None` for other sentences, and for lines that are not a sentence.
pub fn words(line: &str) -> Option<String> {
    match sentence::parse(line) {
        Ok(Sentence::State(state)) => Some(state_words(&state)),
        Ok(Sentence::Excluded(excluded)) => {
            Some(format!("            left out: {}, {:.1} m off", excluded.satellite, excluded.bias_m))
        }
        Ok(_) => {
            let is_news =
                ["$PRAIV", "$PRAIA", "$PRAIQ", "$PRAIL"].iter().any(|start| line.starts_with(start));
            is_news.then(|| line.to_owned())
        }
        // The first line after a port was opened is cut; the raw view shows noise.
        Err(_) => None,
    }
}

fn state_words(state: &State) -> String {
    let verdict = match state.state {
        'P' => "protected",
        'A' => "ALERT",
        _ => "unavailable",
    };
    let number =
        |value: Option<f64>, unit: &str| value.map_or("–".to_owned(), |value| format!("{value:.1}{unit}"));
    format!(
        "{:>10} {verdict:<11} {:<10} {:>2}/{:<2} statistic {} of {}  HPL {}  VPL {}",
        state.time_s.map_or("–".to_owned(), clock),
        state.reason,
        state.used,
        state.tracked,
        number(state.statistic, ""),
        number(state.threshold, ""),
        number(state.hpl_m, " m"),
        number(state.vpl_m, " m"),
    )
}

/// Returns seconds of the day as `hh:mm:ss.s`, never rounded up.
fn clock(time_s: f64) -> String {
    let tenths = (time_s * 10.0 + 1e-6) as u64;
    format!("{:02}:{:02}:{:02}.{}", tenths / 36_000, tenths / 600 % 60, tenths / 10 % 60, tenths % 10)
}

#[cfg(test)]
mod tests {
    use super::words;
    use crate::signal::checksum::nmea_line;

    #[test]
    fn a_verdict_is_said_in_words_and_noise_is_not() {
        let have = words(nmea_line("PRAIS,120000.00,A,FAULT,10,9,5,3.912,1.764,,,40.0,35.0").trim_end())
            .expect("words");
        assert_eq!(have, "12:00:00.0 ALERT       FAULT       9/10 statistic 3.9 of 1.8  HPL –  VPL –");
        assert_eq!(words("$PRAIS,1*00"), None);
        assert_eq!(words(nmea_line("PRAIN,120000.00,0123ABCD,10,1,0").trim_end()), None);
    }
}
