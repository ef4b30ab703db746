//! What every dispatch must do.

use std::sync::Arc;

use elevon::jobs::dispatch::{Dispatch, InProcess};
use elevon::store::records::Id;
use tokio::task::JoinSet;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn contract_every_id_reaches_exactly_one_of_several_consumers() {
    every_id_reaches_exactly_one_of_several_consumers(Arc::new(InProcess::default())).await;
}

#[tokio::test]
async fn contract_ids_are_delivered_in_the_order_of_their_publication() {
    ids_are_delivered_in_the_order_of_their_publication(Arc::new(InProcess::default())).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn contract_closing_ends_every_wait_and_every_later_one() {
    closing_ends_every_wait_and_every_later_one(Arc::new(InProcess::default())).await;
}

async fn every_id_reaches_exactly_one_of_several_consumers(dispatch: Arc<dyn Dispatch>) {
    let mut published: Vec<_> = (0..200).map(|_| Id::now()).collect();
    let mut consumers = JoinSet::new();
    for _ in 0..4 {
        let dispatch = dispatch.clone();
        consumers.spawn(async move {
            let mut taken = Vec::new();
            for _ in 0..50 {
                taken.push(dispatch.next().await.unwrap());
            }
            taken
        });
    }
    for id in &published {
        dispatch.publish(*id).await;
    }
    let mut taken = consumers.join_all().await.concat();
    taken.sort_unstable();
    published.sort_unstable();
    assert_eq!(taken, published);
}

async fn ids_are_delivered_in_the_order_of_their_publication(dispatch: Arc<dyn Dispatch>) {
    let published: Vec<_> = (0..10).map(|_| Id::now()).collect();
    for id in &published {
        dispatch.publish(*id).await;
    }
    for id in published {
        assert_eq!(dispatch.next().await, Some(id));
    }
}

async fn closing_ends_every_wait_and_every_later_one(dispatch: Arc<dyn Dispatch>) {
    let mut waiting = JoinSet::new();
    for _ in 0..3 {
        let dispatch = dispatch.clone();
        waiting.spawn(async move { dispatch.next().await });
    }
    dispatch.close();
    assert_eq!(waiting.join_all().await, [None; 3]);
    dispatch.publish(Id::now()).await;
    assert_eq!(dispatch.next().await, None);
}
