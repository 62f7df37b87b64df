//! The file under rerun's encoder. Rerun's own sink stops silently when the disk is full; this one says so at once, and
//! leaves nothing half-written behind: a message that does not fit is taken back.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::fs::MetadataExt;
use std::path::Path;

/// A file that is whole after every write, or as it was before it. Nothing is buffered: what has been written survives a
/// kill of this process.
#[derive(Debug)]
pub(super) struct Ledger {
    file: File,
    len: u64,
}

impl Ledger {
    /// Makes the file, which must not be there yet.
    pub(super) fn create(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().write(true).create_new(true).open(path)?;
        Ok(Self { file, len: 0 })
    }

    /// Bytes written.
    pub(super) fn len(&self) -> u64 {
        self.len
    }

    /// Takes back all that was written after the first `len` bytes.
    fn cut(&mut self, len: u64) -> io::Result<()> {
        self.file.set_len(len)?;
        self.file.seek(SeekFrom::Start(len))?;
        self.len = len;
        Ok(())
    }

    /// Makes sure that it is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_all()
    }
}

impl Write for Ledger {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.file.metadata()?.nlink() == 0 {
            return Err(io::Error::new(io::ErrorKind::NotFound, "the file has been deleted"));
        }
        match self.file.write_all(bytes) {
            Ok(()) => {
                self.len += bytes.len() as u64;
                Ok(bytes.len())
            }
            Err(error) => {
                // A reader must not find half a message; if even that fails, it will pass over it.
                let _ = self.cut(self.len);
                Err(error)
            }
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_there_is_left_alone_and_one_that_was_deleted_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        let mut ledger = Ledger::create(&path).unwrap();
        ledger.write_all(b"whole").unwrap();
        assert_eq!(Ledger::create(&path).unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        ledger.write_all(b" and more").unwrap();
        ledger.cut(5).unwrap();
        assert_eq!((std::fs::read(&path).unwrap(), ledger.len()), (b"whole".to_vec(), 5));
        std::fs::remove_file(&path).unwrap();
        assert!(ledger.write_all(b"x").unwrap_err().to_string().contains("deleted"));
    }

    #[test]
    fn a_full_disk_is_an_error_at_once() {
        // The device that is always full.
        let mut ledger = Ledger { file: OpenOptions::new().write(true).open("/dev/full").unwrap(), len: 0 };
        assert_eq!(ledger.write_all(b"x").unwrap_err().kind(), io::ErrorKind::StorageFull);
    }
}
