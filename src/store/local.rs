//! Traces in files of this machine: one file each, in folders by the end of its id so that none grows large.
//!
//! A trace is written under `incoming/`, made durable and then renamed, so that a file under its final name is whole.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use async_trait::async_trait;
use tokio::task::spawn_blocking;

use super::records::Id;
use super::{StoreError, Traces};

/// The folder of files that are being written.
const INCOMING: &str = "incoming";
/// The folder of files that were set aside.
const ASIDE: &str = "unrecorded";

/// Traces under one folder.
#[derive(Debug, Clone)]
pub struct LocalTraces {
    dir: PathBuf,
}

impl LocalTraces {
    /// Opens the traces in `dir`, creates the folder when it is missing, and removes what a killed process left half
    /// written. One process at a time may have it open.
    ///
    /// # Errors
    /// A folder that cannot be created, read or written.
    pub fn open(dir: &Path) -> Result<Self, StoreError> {
        prepare(dir).map_err(|source| StoreError::File { path: dir.display().to_string(), source })?;
        Ok(Self { dir: dir.into() })
    }

    /// Runs file work for one trace where it may block.
    async fn run<T: Send + 'static>(
        &self,
        id: Id,
        work: impl FnOnce(&Path, &Path) -> io::Result<T> + Send + 'static,
    ) -> Result<T, StoreError> {
        let name = id.to_string();
        let path = Path::new(&name[name.len() - 2..]).join(&name);
        let (incoming, target) = (self.dir.join(INCOMING).join(&name), self.dir.join(&path));
        let done = spawn_blocking(move || work(&incoming, &target)).await;
        let done = done.unwrap_or_else(|ended| Err(io::Error::other(ended)));
        done.map_err(|source| StoreError::File { path: path.display().to_string(), source })
    }
}

/// Makes every folder that a trace may need, and removes what was half written.
fn prepare(dir: &Path) -> io::Result<()> {
    create_durably(dir)?;
    let incoming = dir.join(INCOMING);
    fs::create_dir_all(&incoming)?;
    fs::create_dir_all(dir.join(ASIDE))?;
    fs::read_dir(&incoming)?.try_for_each(|entry| fs::remove_file(entry?.path()))?;
    (0..=u8::MAX).try_for_each(|end| fs::create_dir_all(dir.join(format!("{end:02x}"))))?;
    sync_folder(dir)
}

/// Makes a folder and those above it where they are missing; the names of new ones are durable when this returns.
///
/// # Errors
/// A folder that cannot be created or made durable.
pub fn create_durably(folder: &Path) -> io::Result<()> {
    let folder = std::path::absolute(folder)?;
    let missing: Vec<_> = folder.ancestors().take_while(|folder| !folder.exists()).collect();
    fs::create_dir_all(&folder)?;
    missing.iter().filter_map(|folder| folder.parent()).try_for_each(sync_folder)
}

/// Writes a file so that it is there whole, or not at all, whatever happens meanwhile.
fn write_durably(incoming: &Path, target: &Path, bytes: &[u8]) -> io::Result<()> {
    let write = || -> io::Result<()> {
        let mut file = File::create(incoming)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(incoming, target)
    };
    write().inspect_err(|_| drop(fs::remove_file(incoming)))?;
    sync_folder(target.parent().expect("a trace's file is in a folder"))
}

/// The ids that files in a folder are named by.
fn ids_in(folder: &Path) -> io::Result<Vec<Id>> {
    let names = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name().to_str().and_then(|name| name.parse().ok())));
    names.filter_map(Result::transpose).collect()
}

/// Makes the names in a folder durable.
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// What was done, or `None` when there was no such file.
fn if_found<T>(done: io::Result<T>) -> io::Result<Option<T>> {
    match done {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        other => other.map(Some),
    }
}

#[async_trait]
impl Traces for LocalTraces {
    async fn put(&self, id: Id, bytes: Vec<u8>) -> Result<(), StoreError> {
        self.run(id, move |incoming, target| write_durably(incoming, target, &bytes)).await
    }

    async fn get(&self, id: Id) -> Result<Option<Vec<u8>>, StoreError> {
        self.run(id, |_, target| if_found(fs::read(target))).await
    }

    async fn ids_ending_in(&self, end: u8) -> Result<Vec<Id>, StoreError> {
        let folder = self.dir.join(format!("{end:02x}"));
        let path = folder.display().to_string();
        let listed = spawn_blocking(move || ids_in(&folder)).await;
        let listed = listed.unwrap_or_else(|ended| Err(io::Error::other(ended)));
        listed.map_err(|source| StoreError::File { path, source })
    }

    async fn set_aside(&self, id: Id) -> Result<(), StoreError> {
        let aside = self.dir.join(ASIDE).join(id.to_string());
        self.run(id, move |_, target| if_found(fs::rename(target, aside)).map(drop)).await
    }

    async fn delete(&self, id: Id) -> Result<(), StoreError> {
        self.run(id, |_, target| if_found(fs::remove_file(target)).map(drop)).await
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_half_written_trace_is_invisible_and_swept_at_the_next_start() {
        let dir = tempfile::tempdir().unwrap();
        let id = Id::now();
        LocalTraces::open(dir.path()).unwrap();
        let leftover = dir.path().join(INCOMING).join(id.to_string());
        fs::write(&leftover, b"time_s,posi").unwrap();
        let traces = LocalTraces::open(dir.path()).unwrap();
        assert_eq!(traces.get(id).await.unwrap(), None);
        assert!(!leftover.exists());
    }

    #[test]
    fn a_folder_is_made_with_those_above_it_and_may_be_there_already() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("a/b/c");
        for _ in 0..2 {
            create_durably(&folder).unwrap();
            assert!(folder.is_dir());
        }
        fs::write(dir.path().join("file"), b"").unwrap();
        create_durably(&dir.path().join("file/a")).unwrap_err();
    }

    #[tokio::test]
    async fn a_trace_that_could_not_be_kept_takes_no_room() {
        let dir = tempfile::tempdir().unwrap();
        let traces = LocalTraces::open(dir.path()).unwrap();
        (0..=u8::MAX).for_each(|end| fs::remove_dir(dir.path().join(format!("{end:02x}"))).unwrap());
        traces.put(Id::now(), vec![1]).await.unwrap_err();
        assert_eq!(fs::read_dir(dir.path().join(INCOMING)).unwrap().count(), 0);
    }

    #[tokio::test]
    async fn an_error_names_the_file_within_the_store() {
        let dir = tempfile::tempdir().unwrap();
        let traces = LocalTraces::open(dir.path()).unwrap();
        let id = Id::now();
        fs::remove_dir(dir.path().join(INCOMING)).unwrap();
        let error = traces.put(id, vec![1]).await.unwrap_err();
        assert!(error.to_string().contains(&id.to_string()), "{error}");
    }
}
