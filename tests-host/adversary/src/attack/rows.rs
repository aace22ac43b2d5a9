//! Rows of attacks, from which the list of a folder and the tests come.
//!
//! A row is `test: file::CONSTANT`. The test is called by what the module does about the attack, and
//! runs the quick form. `at_length` before its name says that it takes seconds: it then stands in a
//! module of that name, which `cargo xtask check` runs. The compiler names an attack that has no row.

/// Defines `ATTACKS` and a test for each row.
macro_rules! attacks {
    (@short at_length $test:ident $file:ident $attack:ident) => {};
    (@short $test:ident $file:ident $attack:ident) => {
        #[test]
        fn $test() {
            crate::attack::rows::hold(&super::$file::$attack);
        }
    };
    (@long at_length $test:ident $file:ident $attack:ident) => {
        #[test]
        fn $test() {
            crate::attack::rows::hold(&super::super::$file::$attack);
        }
    };
    (@long $test:ident $file:ident $attack:ident) => {};
    ($($($test:ident)+: $file:ident::$attack:ident,)*) => {
        /// Attacks of the rows, in their order.
        pub(super) const ATTACKS: &[&crate::attack::Attack] = &[$(&$file::$attack),*];

        #[cfg(test)]
        mod tests {
            $(attacks!(@short $($test)+ $file $attack);)*

            mod at_length {
                $(attacks!(@long $($test)+ $file $attack);)*
            }
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
