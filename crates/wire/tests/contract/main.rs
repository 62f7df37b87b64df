//! What every carrier promises, checked on shared memory and on the carrier for tests alike.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

mod attached;
mod foreign;
mod names;
mod news;
mod processes;
mod requests;
mod roots;
mod states;
mod support;

/// Runs every promise on one carrier, each as its own test.
macro_rules! contract {
    ($carrier:ident: $make:expr; $($room:ident: $($promise:ident)+;)+) => {
        mod $carrier {
            $($(#[test]
            fn $promise() {
                let (_keep, carrier) = $make;
                crate::$room::$promise(&carrier);
            })+)+
        }
    };
}

macro_rules! on {
    ($carrier:ident: $make:expr) => {
        contract! { $carrier: $make;
            names:
                nobody_home
                one_simulation_a_name
                of_six_that_start_together_one_has_the_name_and_the_others_are_told_so
                in_a_full_house_who_looks_or_asks_still_gets_in;
            states:
                every_state_in_order
                states_that_are_sent_together_arrive_one_by_one
                a_sleeping_reader_loses_the_oldest_and_holds_nobody_up;
            news:
                the_last_bench_status_reaches_who_comes_later
                documents_that_are_named_reach_who_comes_late_or_sleeps
                snapshots_arrive_whole_and_the_last_one_for_who_comes_later
                every_event_in_order_and_the_last_ones_for_who_comes_later
                the_events_of_the_last_run_are_not_told_in_the_next;
            attached:
                one_recorder_a_bench_and_its_latest_status_for_all
                a_recorder_that_goes_without_a_word_has_died
                one_controller_a_bench_and_the_last_readings_for_who_comes_later;
            requests:
                requests_are_answered
                a_silent_simulation_does_not_hang_its_readers
                a_listener_hears_the_next_simulation_of_the_name;
        }
    };
}

on!(memory: ((), wire::Memory::default()));
on!(shared_memory: {
    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    (dir, carrier)
});
