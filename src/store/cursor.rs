//! Cursors: the place in a list where the next page starts, as an opaque word that is safe in a URL.

use super::{Page, Paged, StoreError};

/// Part of a list's sort key, as text of a cursor and back.
pub(super) trait Key: Sized {
    /// The part's text; it holds no `.`.
    fn write(&self) -> String;
    /// The part that made `text`.
    fn read(text: &str) -> Option<Self>;
}

impl Key for super::records::Id {
    fn write(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }
}

impl Key for i64 {
    fn write(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }
}

impl Key for f64 {
    fn write(&self) -> String {
        format!("{:016x}", self.to_bits())
    }

    fn read(text: &str) -> Option<Self> {
        u64::from_str_radix(text, 16).ok().map(Self::from_bits)
    }
}

impl<A: Key, B: Key> Key for (A, B) {
    fn write(&self) -> String {
        format!("{}.{}", self.0.write(), self.1.write())
    }

    fn read(text: &str) -> Option<Self> {
        let (first, rest) = text.split_once('.')?;
        Some((A::read(first)?, B::read(rest)?))
    }
}

impl Page {
    /// The sort key of the last record already seen, or `None` on the first page.
    pub(super) fn start<K: Key>(&self) -> Result<Option<K>, StoreError> {
        let read = |text: &String| K::read(text).ok_or_else(|| StoreError::Cursor { found: text.clone() });
        self.after.as_ref().map(read).transpose()
    }

    /// How many rows to ask for: one more than the page holds, to know whether another page follows.
    pub(super) fn rows(&self) -> i64 {
        i64::from(self.limit) + 1
    }

    /// The page made of the rows that were found, `key` giving the sort key of one.
    pub(super) fn cut<T, K: Key>(&self, mut items: Vec<T>, key: impl Fn(&T) -> K) -> Paged<T> {
        let limit = self.limit as usize;
        let more = items.len() > limit;
        items.truncate(limit);
        let next_cursor = items.last().filter(|_| more).map(|last| key(last).write());
        Paged { items, next_cursor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::records::Id;

    #[test]
    fn a_key_survives_its_cursor_bit_for_bit() {
        let key = (-0.1f64, (f64::NEG_INFINITY, Id::now()));
        assert_eq!(Key::read(&key.write()), Some(key));
        assert_eq!(Key::read(&(i64::MIN, Id::now()).write()).map(|k: (i64, Id)| k.0), Some(i64::MIN));
    }

    #[test]
    fn a_malformed_cursor_is_named() {
        for found in ["", "x", "12", "12.", ".", "12.34", "é.é"] {
            let page = Page { after: Some(found.into()), limit: 1 };
            let error = page.start::<(i64, Id)>().unwrap_err();
            assert!(matches!(&error, StoreError::Cursor { found: f } if f == found), "{error}");
        }
    }
}
