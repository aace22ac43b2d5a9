//! The attacks on a signed sky, and the tables of the documents that say what is seen of each.
//!
//! `RAI_BLESS=1` writes the tables.

use adversary::attack::sky::{MEANS, markdown, rows, summary};
use rig::document;

#[test]
fn the_documents_say_what_is_seen_of_a_signed_sky() {
    let rows = rows(&MEANS).expect("modules that run");
    println!("{}\n{}", markdown(&rows), summary(&rows));
    document::must_have("results/adversary.md", "sky", &markdown(&rows));
    document::must_have("README.md", "sky", &summary(&rows));
    // With everything, proved Galileo goes on where GPS is forged, and never where its own ranges are.
    let of =
        |short| rows.iter().find(|row| row.short == short).and_then(|row| row.cells.last()).expect("a cell");
    let forged = of("GPS forged, without jamming");
    assert!(forged.decided_s.is_some_and(|decided_s| decided_s <= 10) && forged.beyond == 0, "{forged:?}");
    for own in ["Galileo's ranges forged, without jamming", "Galileo's ranges forged, GPS genuine"] {
        assert_eq!((of(own).decided_s, of(own).beyond), (None, 0), "{own}");
    }
}
