//! The line of a GPIO chip that is the pin.

use std::io;
use std::path::Path;

use anyhow::{Context as _, Result};

/// Lines of a GPIO chip that a process has requested.
pub(super) trait Lines {
    /// Sets one line.
    ///
    /// # Errors
    /// As the system reports them.
    fn set(&self, line: u32, high: bool) -> io::Result<()>;
}

impl Lines for gpiocdev::Request {
    fn set(&self, line: u32, high: bool) -> io::Result<()> {
        use gpiocdev::line::Value;
        let value = if high { Value::Active } else { Value::Inactive };
        self.set_value(line, value).map(drop).map_err(io::Error::other)
    }
}

/// One requested line.
#[derive(Debug)]
pub(super) struct Line<L> {
    lines: L,
    number: u32,
}

impl<L: Lines> Line<L> {
    pub(super) fn drive(&self, high: bool) -> io::Result<()> {
        self.lines.set(self.number, high)
    }
}

/// Requests a line, which is low from then on.
///
/// # Errors
/// As the system reports them.
pub(super) fn open(chip: &Path, number: u32) -> Result<Line<gpiocdev::Request>> {
    let lines =
        request(chip, number).request().with_context(|| format!("line {number} of {}", chip.display()))?;
    Ok(Line { lines, number })
}

/// Returns the request for a line: an output, low from the beginning.
fn request(chip: &Path, line: u32) -> gpiocdev::request::Builder {
    use gpiocdev::line::Value;
    let mut request = gpiocdev::Request::builder();
    request.on_chip(chip).with_consumer("rai").with_line(line).as_output(Value::Inactive);
    request
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use gpiocdev::line::{Direction, Value};

    use super::super::Wire;
    use super::*;

    /// A chip that remembers what was set.
    #[derive(Default)]
    struct Chip(RefCell<Vec<(u32, bool)>>);

    impl Lines for Chip {
        fn set(&self, line: u32, high: bool) -> io::Result<()> {
            self.0.borrow_mut().push((line, high));
            Ok(())
        }
    }

    #[test]
    fn request_asks_for_one_output_that_is_low_and_not_inverted() {
        let request = request(Path::new("/dev/gpiochip7"), 17);
        let config = request.config();
        let line = config.line_config(17).unwrap();
        assert_eq!((line.direction, line.value), (Some(Direction::Output), Some(Value::Inactive)));
        assert!(!line.active_low && config.num_lines() == 1);
        assert_eq!(config.chip(), Path::new("/dev/gpiochip7"));
    }

    #[test]
    fn level_goes_to_the_line_that_was_named() {
        let line = Line { lines: Chip::default(), number: 17 };
        line.drive(true).unwrap();
        line.drive(false).unwrap();
        assert_eq!(*line.lines.0.borrow(), [(17, true), (17, false)]);
    }

    #[test]
    fn chip_that_is_not_there_is_named() {
        let place = "gpio:/dev/gpiochip-of-nobody:3".parse().unwrap();
        let error = format!("{:#}", Wire::open(&place).unwrap_err());
        assert!(error.contains("line 3 of /dev/gpiochip-of-nobody"), "{error}");
    }
}
