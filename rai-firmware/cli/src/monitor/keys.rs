//! Keys of the live view, and the commands that they send.
//!
//! A change of the phase or of a limit takes back the standing promise, and decides what the pin
//! means. It is therefore typed and confirmed, never done by one key.

use raim_firmware::settings::Setting;

use super::Dashboard;

/// Key as the view knows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// A character.
    Letter(char),
    /// The key that confirms.
    Enter,
    /// The key that cancels.
    Escape,
    /// The key that takes a character back.
    Back,
}

/// Consequence of a key beyond the picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// End the view.
    Quit,
    /// Send a command, without `$PRAIC,` and checksum.
    Send(String),
}

/// Longest value of a command.
const LONGEST: usize = 12;

impl Dashboard {
    /// Takes a key; returns its consequence.
    pub fn press(&mut self, key: Key) -> Option<Action> {
        if self.prompt.is_some() {
            return self.type_on(key);
        }
        match (key, &self.control) {
            (Key::Letter('q') | Key::Escape, _) => return Some(Action::Quit),
            (Key::Letter(' '), _) => self.is_paused = !self.is_paused,
            (Key::Letter('s'), _) => self.shows_satellites = !self.shows_satellites,
            (Key::Letter('+' | '='), Some(control)) => control.faster(),
            (Key::Letter('-'), Some(control)) => control.slower(),
            (Key::Letter('a'), Some(control)) => control.seek_alert(),
            (Key::Letter('c'), _) if self.takes_commands => return Some(Action::Send("STATS".to_owned())),
            (Key::Letter(letter @ ('p' | 'h' | 'v')), _) if self.takes_commands => {
                let setting = match letter {
                    'p' => "PHASE",
                    'h' => "HAL",
                    _ => "VAL",
                };
                self.answer = None;
                self.prompt = Some((setting, String::new()));
            }
            _ => {}
        }
        None
    }

    /// Goes on with the command that is typed.
    fn type_on(&mut self, key: Key) -> Option<Action> {
        let (setting, value) = self.prompt.as_mut()?;
        match key {
            Key::Letter(letter)
                if value.len() < LONGEST && (letter.is_ascii_alphanumeric() || letter == '.') =>
            {
                value.push(letter.to_ascii_uppercase());
            }
            Key::Letter(_) => {}
            Key::Back => {
                value.pop();
            }
            Key::Escape => self.prompt = None,
            Key::Enter if value.is_empty() => self.prompt = None,
            Key::Enter => {
                let command = format!("{setting},{value}");
                self.prompt = None;
                return Some(Action::Send(command));
            }
        }
        None
    }
}

/// Returns the values that a setting takes, in words.
pub(super) fn values(setting: &str) -> String {
    match setting {
        "PHASE" => {
            let words = Setting::named(setting).map_or(&[][..], |setting| setting.documentation().words);
            words.join(" ")
        }
        "VAL" => "metres, or OFF".to_owned(),
        _ => "metres".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed(dashboard: &mut Dashboard, keys: &str) -> Vec<Action> {
        let key = |letter| match letter {
            '\n' => Key::Enter,
            '<' => Key::Back,
            '!' => Key::Escape,
            _ => Key::Letter(letter),
        };
        keys.chars().filter_map(|letter| dashboard.press(key(letter))).collect()
    }

    #[test]
    fn a_limit_is_typed_and_confirmed() {
        let mut dashboard = Dashboard::of("a port");
        dashboard.takes_commands = true;
        let send = |command: &str| Action::Send(command.to_owned());
        assert_eq!(pressed(&mut dashboard, "h405<\n"), [send("HAL,40")]);
        assert_eq!(pressed(&mut dashboard, "plpv200\nvoff\n"), [send("PHASE,LPV200"), send("VAL,OFF")]);
        // What is typed is no key of the view, and nothing is sent without the confirmation.
        assert_eq!(pressed(&mut dashboard, "hq!"), []);
        assert_eq!(pressed(&mut dashboard, "h\n"), []);
        assert_eq!(pressed(&mut dashboard, "h$*,\nq"), [Action::Quit]);
    }

    #[test]
    fn a_source_without_commands_gets_none() {
        assert_eq!(pressed(&mut Dashboard::of("a file"), "ch40\np\n"), []);
    }
}
