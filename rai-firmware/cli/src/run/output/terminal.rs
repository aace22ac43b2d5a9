//! A pseudo-terminal among the outputs. Sentences without a reader are lost.

#[cfg(unix)]
use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
#[cfg(unix)]
use std::thread;

#[cfg(unix)]
use anyhow::Context as _;
use anyhow::{Result, bail};

#[cfg(unix)]
use super::{Kind, spawn};
use crate::run::inbox::Inbox;
use crate::run::outbox::Outbox;

#[cfg(unix)]
pub(super) fn terminal(path: &Path, outbox: &mut Outbox, inbox: &Arc<Inbox>) -> Result<()> {
    use std::fs::File;
    use std::io::Read as _;
    use std::os::fd::AsFd as _;

    use nix::fcntl::{FcntlArg, OFlag, fcntl};
    use nix::poll::{PollFd, PollFlags, PollTimeout, poll};
    use nix::pty::openpty;
    use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};

    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    let pair = openpty(None, None)?;
    let mut settings = tcgetattr(&pair.slave)?;
    cfmakeraw(&mut settings);
    tcsetattr(&pair.slave, SetArg::TCSANOW, &settings)?;
    admit_the_group(&pair.slave);
    let name = nix::unistd::ttyname(&pair.slave)?;
    match std::fs::symlink_metadata(path) {
        Ok(there) if there.file_type().is_symlink() => std::fs::remove_file(path)?,
        Ok(_) => bail!("{} exists and is no link: remove it, or name another path", path.display()),
        Err(_) => {}
    }
    std::os::unix::fs::symlink(&name, path)
        .with_context(|| format!("cannot make the link {}", path.display()))?;
    fcntl(pair.master.as_fd(), FcntlArg::F_SETFL(OFlag::O_NONBLOCK))?;
    let master = File::from(pair.master);
    spawn(outbox, Kind::Nmea, Terminal(master.try_clone()?));
    let (inbox, mut commands, slave) = (Arc::clone(inbox), master, pair.slave);
    thread::spawn(move || {
        // While this end is open, the terminal exists without a reader.
        let _slave = slave;
        let mut bytes = [0; 256];
        loop {
            let mut ready = [PollFd::new(commands.as_fd(), PollFlags::POLLIN)];
            // An error returns at once, and the read then has it too.
            let _ = poll(&mut ready, PollTimeout::NONE);
            match commands.read(&mut bytes) {
                Ok(count) => inbox.push_commands(bytes.get(..count).unwrap_or_default()),
                Err(error)
                    if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {}
                Err(_) => return,
            }
        }
    });
    Ok(())
}

/// Lets the group of serial ports read and write the terminal, if there is one and this user may say
/// so; otherwise the group that the system gives it.
#[cfg(unix)]
fn admit_the_group(slave: &std::os::fd::OwnedFd) {
    use nix::sys::stat::{Mode, fchmod};
    use nix::unistd::{Group, fchown};

    if let Ok(Some(group)) = Group::from_name("dialout") {
        let _ = fchown(slave, None, Some(group.gid));
    }
    // A terminal that stays closed to others is still one for this user.
    let _ = fchmod(slave, Mode::from_bits_truncate(0o660));
}

#[cfg(not(unix))]
pub(super) fn terminal(_: &Path, _: &mut Outbox, _: &Arc<Inbox>) -> Result<()> {
    bail!("pseudo-terminals exist on Unix only: use tcp:// or udp://")
}

/// The side of a pseudo-terminal to which the service writes. Sentences without a reader are lost.
#[cfg(unix)]
struct Terminal(std::fs::File);

#[cfg(unix)]
impl Write for Terminal {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.0.write(bytes) {
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(bytes.len()),
            other => other,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn terminal_is_open_to_its_group() {
        use std::os::unix::fs::MetadataExt as _;

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nmea");
        let inbox = Arc::new(Inbox::new(crate::run::clock::Clock::of_the_computer(), false));
        terminal(&path, &mut Outbox::new(None), &inbox).unwrap();
        assert_eq!(std::fs::metadata(&path).unwrap().mode() & 0o777, 0o660);
    }
}
