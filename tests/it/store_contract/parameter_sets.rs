use std::sync::Arc;

use elevon::store::records::{ActuatorUpdate, Id, Thresholds};
use elevon::store::{Page, Records};

use super::samples::{actuator, all, parameter_set};

pub async fn contract_a_parameter_set_comes_back_as_it_was_kept(records: Arc<dyn Records>) {
    let set = parameter_set("mine", "00ab");
    assert_eq!(records.newest_parameter_set("mine").await.unwrap(), None);
    assert_eq!(records.insert_parameter_set(&set).await.unwrap(), (set.clone(), true));
    assert_eq!(records.newest_parameter_set("mine").await.unwrap(), Some(set.clone()));
    assert_eq!(records.parameter_sets_by_hash("mine", "00ab").await.unwrap(), [set]);
    assert_eq!(records.newest_parameter_set("Mine").await.unwrap(), None, "names are case-sensitive");
}

pub async fn contract_a_name_has_versions_and_means_the_one_kept_last(records: Arc<dyn Records>) {
    let (first, second) = (parameter_set("mine", "ff00"), parameter_set("mine", "00ff"));
    for set in [&first, &second, &parameter_set("other", "aaaa")] {
        records.insert_parameter_set(set).await.unwrap();
    }
    assert_eq!(records.newest_parameter_set("mine").await.unwrap(), Some(second.clone()));
    for set in [first, second] {
        assert_eq!(records.parameter_sets_by_hash("mine", &set.hash).await.unwrap(), [set]);
    }
}

pub async fn contract_the_same_version_again_is_the_record_that_is_kept(records: Arc<dyn Records>) {
    let (first, second) = (parameter_set("mine", "00aa"), parameter_set("mine", "00bb"));
    records.insert_parameter_set(&first).await.unwrap();
    records.insert_parameter_set(&second).await.unwrap();
    assert_eq!(records.insert_parameter_set(&parameter_set("mine", "00aa")).await.unwrap(), (first.clone(), false));
    assert_eq!(records.newest_parameter_set("mine").await.unwrap(), Some(second.clone()), "it does not become newer");
    assert_eq!(records.parameter_sets(&all()).await.unwrap().items, [first, second]);
}

pub async fn contract_a_version_is_found_by_the_beginning_of_its_hash(records: Arc<dyn Records>) {
    for (name, hash) in [("mine", "00aa"), ("mine", "00ab"), ("mine", "0fff"), ("other", "0000")] {
        records.insert_parameter_set(&parameter_set(name, hash)).await.unwrap();
    }
    let found = async |prefix: &str| -> Vec<String> {
        let sets = records.parameter_sets_by_hash("mine", prefix).await.unwrap();
        sets.into_iter().map(|set| set.hash).collect()
    };
    assert_eq!(found("00ab").await, ["00ab"]);
    assert_eq!(found("0f").await, ["0fff"]);
    assert_eq!(found("00a").await, ["00aa", "00ab"]);
    assert_eq!(found("0").await.len(), 2, "two are enough to see that it is not unique");
    assert!(found("00abc").await.is_empty() && found("1").await.is_empty());
}

pub async fn contract_parameter_sets_are_listed_in_the_order_in_which_they_were_kept(records: Arc<dyn Records>) {
    let mut expected = Vec::new();
    for (name, hash) in [("b", "02"), ("a", "01"), ("b", "00")] {
        expected.push(records.insert_parameter_set(&parameter_set(name, hash)).await.unwrap().0);
    }
    let first = records.parameter_sets(&Page { after: None, limit: 2 }).await.unwrap();
    let second = records.parameter_sets(&Page { after: first.next_cursor, limit: 2 }).await.unwrap();
    assert_eq!((&first.items[..], &second.items[..]), expected.split_at(2));
    assert_eq!(second.next_cursor, None);
}

pub async fn contract_actuators_of_the_built_in_set_go_with_it_and_others_stay_pinned(records: Arc<dyn Records>) {
    let (mut follows, mut pinned) = (actuator("follows"), actuator("pinned"));
    (follows.parameter_set_hash, pinned.parameter_set) = ("0a".into(), "mine".into());
    for actuator in [&follows, &pinned] {
        records.insert_actuator(actuator).await.unwrap();
    }
    let hash = async |id| records.actuator(id).await.unwrap().unwrap().parameter_set_hash;
    let (older, newer) = (parameter_set("reference", "0b"), parameter_set("reference", "0c"));
    for set in [&older, &newer, &parameter_set("reference", "0b")] {
        records.keep_built_in_set(set).await.unwrap();
        assert_eq!((hash(follows.id).await, hash(pinned.id).await), (set.hash.clone(), "00".into()));
    }
    assert_eq!(records.parameter_sets(&all()).await.unwrap().items, [older, newer]);
    assert_eq!(records.actuator(follows.id).await.unwrap().unwrap().revision, 0, "its history did not change");
}

pub async fn contract_an_actuator_is_pinned_anew_and_keeps_the_rest(records: Arc<dyn Records>) {
    let (mut changed, other) = (actuator("changed"), actuator("other"));
    for actuator in [&changed, &other] {
        records.insert_actuator(actuator).await.unwrap();
    }
    (changed.parameter_set, changed.parameter_set_hash, changed.revision) = ("mine".into(), "0a".into(), 1);
    let update = ActuatorUpdate { parameter_set: Some(("mine".into(), "0a".into())), ..ActuatorUpdate::default() };
    assert_eq!(records.change_actuator(changed.id, &update).await.unwrap(), Some(changed.clone()));
    assert_eq!(records.actuators(&all()).await.unwrap().items, [changed, other]);
    assert_eq!(records.change_actuator(Id::now(), &update).await.unwrap(), None);
}

pub async fn contract_a_threshold_that_becomes_another_grows_the_revision_and_keeps_the_rest(
    records: Arc<dyn Records>,
) {
    let (mut changed, other) = (actuator("changed"), actuator("other"));
    for actuator in [&changed, &other] {
        records.insert_actuator(actuator).await.unwrap();
    }
    let steps = [
        (Some(0.3), None, 0.3, 1000.0, 1),
        (None, Some(900.0), 0.3, 900.0, 2),
        (Some(0.3), Some(900.0), 0.3, 900.0, 2),
        (None, None, 0.3, 900.0, 2),
        (Some(0.1 + 0.2), Some(210.0), 0.1 + 0.2, 210.0, 3),
    ];
    for (threshold_kgm, threshold_fdj_n, kgm, fdj_n, revision) in steps {
        (changed.thresholds, changed.revision) = (Thresholds { kgm, fdj_n }, revision);
        let update = ActuatorUpdate { threshold_kgm, threshold_fdj_n, ..ActuatorUpdate::default() };
        assert_eq!(records.change_actuator(changed.id, &update).await.unwrap(), Some(changed.clone()));
    }
    assert_eq!(records.actuators(&all()).await.unwrap().items, [changed.clone(), other.clone()]);
    assert_eq!(records.stale_forecasts(10).await.unwrap(), [changed.id, other.id]);
}
