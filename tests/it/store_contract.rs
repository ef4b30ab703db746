//! What every store must do, whatever its engine: one body for each promise, run on each engine.

pub mod alerts;
mod cohorts;
mod fleet;
mod history;
mod parameter_sets;
mod queue;
pub mod samples;
mod traces;
mod trend;
pub mod webhooks;

use std::sync::Arc;

use elevon::store::local::LocalTraces;
use elevon::store::sqlite::SqliteRecords;
use elevon::store::{Records, Traces};
use tempfile::TempDir;

/// Runs contracts on one engine; `open` gives what must live as long as the store, and the store.
macro_rules! engine {
    ($engine:ident, $open:path, [$($module:ident::{$($contract:ident),+ $(,)?}),+ $(,)?]) => {
        mod $engine {
            $($(
                #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
                async fn $contract() {
                    let (_keep, store) = $open().await;
                    super::$module::$contract(store).await;
                }
            )+)+
        }
    };
}

/// Every contract of the records, on one engine.
macro_rules! records_engine {
    ($engine:ident, $open:path) => {
        engine!($engine, $open, [
            queue::{
                contract_an_upload_is_kept_with_its_job_or_not_at_all,
                contract_a_full_queue_takes_a_job_again_once_one_left_it,
                contract_a_job_is_claimed_once_whoever_asks_at_the_same_time,
                contract_only_the_running_attempt_reports_and_finishes,
                contract_a_cancelled_job_is_not_claimed_and_not_finished,
                contract_a_released_attempt_does_not_count,
                contract_recovery_queues_what_ran_and_fails_what_used_its_attempts,
                contract_jobs_are_listed_newest_first_and_counted_by_state,
            },
            history::{
                contract_a_late_upload_is_sorted_in_and_pages_follow_on,
                contract_from_is_inclusive_and_to_is_not,
                contract_a_trace_has_one_row_its_newest_estimate,
                contract_the_newest_estimate_is_that_of_the_job_asked_for_last,
                contract_the_other_faults_of_the_newest_estimate_stand_in_the_history,
                contract_an_excluded_trace_leaves_the_history_and_stays,
                contract_a_trace_excluded_before_its_estimate_does_not_enter_the_history,
                contract_an_inconclusive_estimate_is_listed_without_figures,
                contract_an_estimate_of_no_actuator_enters_no_history,
                contract_a_simulation_adds_its_trace_when_it_finishes,
                contract_maintenance_starts_a_life_unless_it_is_an_inspection,
                contract_maintenance_is_listed_by_its_time,
            },
            cohorts::{
                contract_the_shares_of_a_cohort_add_up_without_ones_own,
                contract_a_share_takes_the_place_of_the_earlier_one_of_its_fault,
                contract_shares_are_kept_with_their_forecast_or_not_at_all,
            },
            parameter_sets::{
                contract_a_parameter_set_comes_back_as_it_was_kept,
                contract_a_name_has_versions_and_means_the_one_kept_last,
                contract_the_same_version_again_is_the_record_that_is_kept,
                contract_a_version_is_found_by_the_beginning_of_its_hash,
                contract_parameter_sets_are_listed_in_the_order_in_which_they_were_kept,
                contract_an_actuator_is_pinned_anew_and_keeps_the_rest,
                contract_a_threshold_that_becomes_another_grows_the_revision_and_keeps_the_rest,
                contract_actuators_of_the_built_in_set_go_with_it_and_others_stay_pinned,
            },
            fleet::{
                contract_a_serial_number_is_taken_once,
                contract_actuators_are_listed_in_the_order_of_registration,
                contract_a_malformed_cursor_is_refused_by_every_list,
                contract_a_cursor_of_another_list_is_refused,
                contract_a_forecast_of_an_older_revision_is_refused,
                contract_what_changes_a_history_makes_its_forecast_stale,
                contract_the_fleet_is_listed_riskiest_first_page_by_page,
                contract_the_fleet_shows_the_newest_health_of_this_life,
            },
            trend::{
                contract_a_forecast_is_kept_with_its_step_of_the_trend_or_not_at_all,
                contract_a_step_of_the_same_life_and_trace_is_replaced_and_others_stay,
                contract_a_step_fills_a_gap_and_replaces_none,
                contract_the_trend_is_sorted_by_life_and_usage_page_by_page,
                contract_the_trend_is_cut_by_the_time_of_recording,
                contract_the_steps_of_an_excluded_trace_are_left_out_until_it_is_taken_back,
            },
            alerts::{
                contract_an_alert_comes_back_as_it_was_raised,
                contract_an_alert_that_is_open_is_not_raised_again,
                contract_a_forecast_of_an_older_revision_changes_no_alert,
                contract_an_alert_is_acknowledged_once_and_cleared_once_and_keeps_its_times,
                contract_a_new_life_clears_the_alerts_of_the_former_one,
                contract_alerts_are_listed_newest_first_by_state_and_by_actuator,
                contract_the_fleet_counts_the_alerts_that_are_not_cleared,
                contract_an_alert_and_what_is_told_of_it_are_one_change,
            },
            webhooks::{
                contract_a_webhook_comes_back_as_it_was_kept_and_as_it_was_changed,
                contract_webhooks_are_listed_as_they_were_made_and_have_a_limit,
                contract_only_enabled_webhooks_of_its_kind_are_told_of_an_alert,
                contract_a_delivery_is_due_until_its_end_is_kept,
                contract_each_enabled_webhook_has_the_delivery_due_that_waited_longest,
                contract_a_webhook_whose_receiver_is_gone_is_disabled_and_what_waits_is_given_up,
                contract_one_ping_waits_at_a_time,
                contract_a_webhook_that_is_deleted_takes_its_deliveries_along,
                contract_old_deliveries_that_are_over_are_forgotten,
            },
        ]);
    };
}

/// Every contract of the traces, on one engine.
macro_rules! traces_engine {
    ($engine:ident, $open:path) => {
        engine!($engine, $open, [
            traces::{
                contract_bytes_come_back_as_they_were_put,
                contract_bytes_that_are_deleted_or_set_aside_are_gone,
                contract_ids_are_listed_by_their_end,
            },
        ]);
    };
}

records_engine!(sqlite, super::open_sqlite);
traces_engine!(local, super::open_local);

async fn open_sqlite() -> (TempDir, Arc<dyn Records>) {
    let dir = tempfile::tempdir().unwrap();
    let records = SqliteRecords::open(dir.path()).await.unwrap();
    (dir, Arc::new(records))
}

async fn open_local() -> (TempDir, Arc<dyn Traces>) {
    let dir = tempfile::tempdir().unwrap();
    let traces = LocalTraces::open(dir.path()).unwrap();
    (dir, Arc::new(traces))
}
