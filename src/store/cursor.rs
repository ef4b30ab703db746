//! Cursors: the place in a list where the next page starts, as an opaque word that is safe in a URL.

use super::{Page, Paged, StoreError};
use crate::numeric::digest::sha256_hex;

/// Characters of a list's tag.
const TAG_CHARS: usize = 8;

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
        u64::from_str_radix(text, 16).ok().map(Self::from_bits).filter(|value| value.is_finite())
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
    /// The sort key of the last record already seen, or `None` on the first page. `list` names the list and whatever
    /// chooses its records: a cursor of another list is refused.
    pub(super) fn start<K: Key>(&self, list: &[&str]) -> Result<Option<K>, StoreError> {
        let tag = tag(list);
        let key = |text: &String| text.strip_prefix(&tag)?.strip_prefix('.').and_then(K::read);
        let read = |text| key(text).ok_or_else(|| StoreError::Cursor { found: text.clone() });
        self.after.as_ref().map(read).transpose()
    }

    /// How many rows to ask for: one more than the page holds, to know whether another page follows.
    pub(super) fn rows(&self) -> i64 {
        i64::from(self.limit) + 1
    }

    /// The page made of the rows that were found in `list`, `key` giving the sort key of one.
    pub(super) fn cut<T, K: Key>(&self, list: &[&str], mut items: Vec<T>, key: impl Fn(&T) -> K) -> Paged<T> {
        let limit = self.limit as usize;
        let more = items.len() > limit;
        items.truncate(limit);
        let next_cursor = items.last().filter(|_| more).map(|last| format!("{}.{}", tag(list), key(last).write()));
        Paged { items, next_cursor }
    }
}

/// What tells the cursors of one list from those of another.
fn tag(list: &[&str]) -> String {
    let mut tag = sha256_hex(list.join("\0").as_bytes());
    tag.truncate(TAG_CHARS);
    tag
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::records::Id;

    #[test]
    fn a_key_survives_its_cursor_bit_for_bit() {
        let key = (-0.1f64, (1e308, Id::now()));
        assert_eq!(Key::read(&key.write()), Some(key));
        assert_eq!(Key::read(&(i64::MIN, Id::now()).write()).map(|k: (i64, Id)| k.0), Some(i64::MIN));
    }

    #[test]
    fn a_number_that_is_not_finite_is_no_key() {
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!(f64::read(&number.write()), None);
        }
    }

    #[test]
    fn a_malformed_cursor_is_named() {
        let tag = tag(&["list"]);
        let keys = ["", "x", "12", "12.", ".", "12.34", "é.é"].map(|key| format!("{tag}.{key}"));
        for found in keys.into_iter().chain([String::new(), tag.clone(), format!("{tag}12.{}", Id::now())]) {
            let page = Page { after: Some(found.clone()), limit: 1 };
            let error = page.start::<(i64, Id)>(&["list"]).unwrap_err();
            assert!(matches!(&error, StoreError::Cursor { found: f } if *f == found), "{error}");
        }
    }

    #[test]
    fn a_cursor_belongs_to_its_list() {
        let page = Page { after: None, limit: 1 };
        let after = page.cut(&["jobs", "queued"], vec![7_i64, 8], |item| *item).next_cursor;
        let next = Page { after, limit: 1 };
        assert_eq!(next.start::<i64>(&["jobs", "queued"]).unwrap(), Some(7));
        for other in [&["jobs", "failed"][..], &["jobs"], &["traces", "queued"], &["jobsqueued"]] {
            next.start::<i64>(other).unwrap_err();
        }
    }
}
