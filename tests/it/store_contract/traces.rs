use std::sync::Arc;

use elevon::store::Traces;
use elevon::store::records::Id;

pub async fn contract_bytes_come_back_as_they_were_put(traces: Arc<dyn Traces>) {
    let kept = [(Id::now(), vec![]), (Id::now(), (0..=255).cycle().take(1_000_000).collect::<Vec<u8>>())];
    for (id, bytes) in kept.clone() {
        traces.put(id, bytes).await.unwrap();
    }
    for (id, bytes) in kept {
        assert!(traces.get(id).await.unwrap() == Some(bytes));
    }
    assert_eq!(traces.get(Id::now()).await.unwrap(), None);
}

pub async fn contract_bytes_that_are_deleted_or_set_aside_are_gone(traces: Arc<dyn Traces>) {
    let (gone, aside, kept) = (Id::now(), Id::now(), Id::now());
    for id in [gone, aside, kept] {
        traces.put(id, vec![1, 2, 3]).await.unwrap();
    }
    for _ in 0..2 {
        traces.delete(gone).await.unwrap();
        assert_eq!(traces.get(gone).await.unwrap(), None);
    }
    for _ in 0..2 {
        traces.set_aside(aside).await.unwrap();
        assert_eq!(traces.get(aside).await.unwrap(), None);
    }
    assert_eq!(traces.get(kept).await.unwrap(), Some(vec![1, 2, 3]));
}

pub async fn contract_ids_are_listed_by_their_end(traces: Arc<dyn Traces>) {
    let mut kept: Vec<_> = (0..50).map(|_| Id::now()).collect();
    for id in &kept {
        traces.put(*id, vec![1]).await.unwrap();
    }
    let mut listed = Vec::new();
    for end in 0..=u8::MAX {
        let ids = traces.ids_ending_in(end).await.unwrap();
        assert!(ids.iter().all(|id| id.to_string().ends_with(&format!("{end:02x}"))), "{ids:?}");
        listed.extend(ids);
    }
    listed.sort_unstable();
    kept.sort_unstable();
    assert_eq!(listed, kept);
}
