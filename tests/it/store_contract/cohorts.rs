use std::sync::Arc;

use elevon::store::records::{FleetShare, FleetTally, Id};
use elevon::store::{Records, StoreError, WithForecast};

use super::samples::{forecast, measured, registered};

fn share(fault: &str, cohort: &str, tally: &[i32]) -> FleetShare {
    FleetShare { fault: fault.into(), cohort: cohort.into(), tally: tally.to_vec(), prior: vec![0.5, 0.1 + 0.2] }
}

/// Keeps shares with a forecast of the actuator's newest revision.
async fn kept(records: &dyn Records, actuator: Id, shares: &[FleetShare]) -> Result<bool, StoreError> {
    let revision = records.actuator(actuator).await.unwrap().unwrap().revision;
    let with = WithForecast { shares, ..WithForecast::default() };
    records.store_forecast_with(&forecast(actuator, revision, None, None), &with).await
}

async fn others(records: &dyn Records, cohort: &str, without: Id) -> (u64, Vec<i64>) {
    let FleetTally { actuators, tally } = records.fleet_tally(cohort, without).await.unwrap();
    (actuators, tally)
}

pub async fn contract_the_shares_of_a_cohort_add_up_without_ones_own(records: Arc<dyn Records>) {
    let [a, b, c] =
        [registered(&*records, "A").await, registered(&*records, "B").await, registered(&*records, "C").await]
            .map(|actuator| actuator.id);
    assert_eq!(others(&*records, "x", a).await, (0, vec![]));
    for (id, tally) in [(a, [i32::MIN, 0]), (b, [-7, -1]), (c, [i32::MIN, -100])] {
        assert!(kept(&*records, id, &[share("kgm", "x", &tally), share("fdj_n", "y", &[0])]).await.unwrap());
    }
    let least = i64::from(i32::MIN);
    assert_eq!(others(&*records, "x", Id::now()).await, (3, vec![2 * least - 7, -101]));
    assert_eq!(others(&*records, "x", a).await, (2, vec![least - 7, -101]));
    assert_eq!(others(&*records, "x", b).await, (2, vec![2 * least, -100]));
    assert_eq!(others(&*records, "y", b).await, (2, vec![0]));
}

pub async fn contract_a_share_takes_the_place_of_the_earlier_one_of_its_fault(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    for id in [a, b] {
        kept(&*records, id, &[share("kgm", "x", &[-1, -2])]).await.unwrap();
    }
    kept(&*records, a, &[share("kgm", "x", &[-10, -20])]).await.unwrap();
    assert_eq!(others(&*records, "x", b).await, (1, vec![-10, -20]));
    kept(&*records, a, &[share("kgm", "another", &[-5])]).await.unwrap();
    assert_eq!(others(&*records, "x", Id::now()).await, (1, vec![-1, -2]), "it left its cohort");
    assert_eq!(others(&*records, "another", b).await, (1, vec![-5]));
    assert_eq!(records.forecast_prior(a, 0, "kgm").await.unwrap(), [0.5, 0.1 + 0.2]);
    for (revision, fault) in [(1, "kgm"), (0, "fdj_n")] {
        assert!(records.forecast_prior(a, revision, fault).await.unwrap().is_empty(), "{fault} of {revision}");
    }
    kept(&*records, a, &[]).await.unwrap();
    assert_eq!(others(&*records, "another", b).await, (1, vec![-5]), "a forecast without shares changes none");
    kept(&*records, a, &[share("kgm", "another", &[])]).await.unwrap();
    assert_eq!(others(&*records, "another", b).await, (0, vec![]), "what is not known any more is taken back");
    kept(&*records, a, &[share("kgm", "another", &[-1, -2, -3])]).await.unwrap();
    assert_eq!(others(&*records, "another", b).await, (1, vec![-1, -2, -3]));
}

pub async fn contract_shares_are_kept_with_their_forecast_or_not_at_all(records: Arc<dyn Records>) {
    let (a, b) = (registered(&*records, "A").await.id, registered(&*records, "B").await.id);
    let shares = [share("kgm", "x", &[-1])];
    let with = WithForecast { shares: &shares, ..WithForecast::default() };
    measured(&*records, a, 10, Some(0.1)).await;
    assert!(!records.store_forecast_with(&forecast(a, 0, None, None), &with).await.unwrap());
    assert_eq!(others(&*records, "x", b).await, (0, vec![]), "the history had moved on");
    assert!(kept(&*records, a, &shares).await.unwrap());
    let error = kept(&*records, b, &[share("kgm", "x", &[-1, -2])]).await.unwrap_err();
    assert!(matches!(error, StoreError::Corrupt { .. }), "shares of one cohort have as many numbers: {error:?}");
    assert_eq!(records.forecast(b).await.unwrap(), None);
    assert_eq!(others(&*records, "x", b).await, (1, vec![-1]));
}
