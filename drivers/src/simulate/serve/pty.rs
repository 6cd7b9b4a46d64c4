//! A pseudo-terminal.

use super::Line;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::{Errno, ioctl_fionbio, read, write};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{OptionalActions, ioctl_tiocnxcl, tcgetattr, tcsetattr};
use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::OwnedFd;
use std::os::unix::fs::{OpenOptionsExt, symlink};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// A line that programs open like a serial port.
///
/// It is raw from the beginning: a terminal as it comes echoes what the device sends, and mangles it. It stays there
/// when programs come and go, and lets the next one in where one was killed that had it exclusively.
#[derive(Debug)]
pub struct Pty {
    master: OwnedFd,
    /// Kept open, or the master would fail whenever nobody else has it.
    slave: File,
    name: String,
    link: Option<PathBuf>,
}

impl Pty {
    /// Opens one. With `link`, a symbolic link of that name points to it as long as it is there; such a link from before
    /// is replaced.
    ///
    /// # Errors
    /// What the operating system says; where there is something else than a link of that name.
    pub fn open(link: Option<&Path>) -> io::Result<Self> {
        let master = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY)?;
        grantpt(&master)?;
        unlockpt(&master)?;
        let name = ptsname(&master, Vec::new())?.into_string().map_err(io::Error::other)?;
        // O_NOCTTY: it must not become this process's own terminal.
        let no_controlling_terminal = rustix::fs::OFlags::NOCTTY.bits().cast_signed();
        let slave =
            OpenOptions::new().read(true).write(true).custom_flags(no_controlling_terminal).open(&name)?;
        let mut settings = tcgetattr(&slave)?;
        settings.make_raw();
        tcsetattr(&slave, OptionalActions::Now, &settings)?;
        ioctl_fionbio(&master, true)?;
        if let Some(link) = link {
            if link.symlink_metadata().is_ok_and(|found| found.file_type().is_symlink()) {
                std::fs::remove_file(link)?;
            }
            symlink(&name, link)?;
        }
        Ok(Self { master, slave, name, link: link.map(Path::to_owned) })
    }
}

impl Drop for Pty {
    fn drop(&mut self) {
        if let Some(link) = &self.link
            && std::fs::read_link(link).is_ok_and(|target| target == Path::new(&self.name))
        {
            // There is nobody to tell.
            let _ = std::fs::remove_file(link);
        }
    }
}

impl Line for Pty {
    fn name(&self) -> String {
        match &self.link {
            Some(link) => link.display().to_string(),
            None => self.name.clone(),
        }
    }

    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let timeout = Timespec::try_from(timeout).map_err(io::Error::other)?;
        let mut events = [PollFd::new(&self.master, PollFlags::IN)];
        match poll(&mut events, Some(&timeout)) {
            Ok(0) => {
                // A program that was killed leaves the terminal closed to all others, unless somebody opens it again.
                ioctl_tiocnxcl(&self.slave)?;
                return Ok(0);
            }
            Ok(_) => {}
            Err(Errno::INTR) => return Ok(0),
            Err(error) => return Err(error.into()),
        }
        match read(&self.master, buffer) {
            Ok(count) => Ok(count),
            Err(Errno::INTR | Errno::AGAIN) => Ok(0),
            Err(error) => Err(error.into()),
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        match write(&self.master, bytes) {
            // Where nobody reads, the terminal is full some day.
            Ok(_) | Err(Errno::AGAIN | Errno::INTR) => Ok(()),
            Err(error) => Err(error.into()),
        }
    }
}
