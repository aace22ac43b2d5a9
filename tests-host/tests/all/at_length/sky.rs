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
}
