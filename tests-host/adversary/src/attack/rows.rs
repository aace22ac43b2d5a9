//! Rows of attacks, from which the list of a folder and the tests come.
//!
//! A row is `test: file::CONSTANT`. The test is called by what the module does about the attack, and
//! runs the quick form. The compiler names an attack that has no row.

/// Defines `ATTACKS` and a test for each row.
macro_rules! attacks {
    ($($test:ident: $file:ident::$attack:ident,)*) => {
        /// Attacks of the rows, in their order.
        pub(super) const ATTACKS: &[&crate::attack::Attack] = &[$(&$file::$attack),*];

        #[cfg(test)]
        mod tests {
            $(#[test]
            fn $test() {
                crate::attack::rows::hold(&super::$file::$attack);
            })*
        }
    };
}

/// Fails unless the module withstands the quick form of an attack with the figures of the record.
#[cfg(test)]
pub(super) fn hold(attack: &super::Attack) {
    use super::Effort::Quick;
    use super::record::{Entry, Record};

    let outcome = attack.attempt(Quick).expect("an attack that can be tried");
    println!("{}: {}", attack.name, outcome.words());
    assert!(outcome.is_held(), "{} is not held: {}", attack.name, outcome.words());
    // Without the recordings, some attacks measure less.
    if rig::shared::path("data").is_some() {
        let record = Record::committed().expect("a record");
        let want = record.entry(attack.name, Quick).map(|entry| &entry.figures);
        let have = Entry::of(&outcome, Quick, "").figures;
        let name = attack.name;
        assert_eq!(Some(&have), want, "`cargo xtask attack --record {name}` records the new figures");
    }
}
