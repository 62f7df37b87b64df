//! Of shared memory alone: programs that are not ours, in another version or another language.

use wire::{Carrier, Host, StateSender, Step, StepRow, Topic};

use crate::support::{LAYOUT, bench, number};

/// The number of the first step of a message.
fn first_seq(words: &[u64]) -> u64 {
    StepRow::all(words).next().unwrap().seq()
}

/// iceoryx2 as a program in another language would set it up: it knows the folder and the prefix, and has no lease.
fn foreign(root: &wire::Root) -> iceoryx2::config::Config {
    use iceoryx2::prelude::*;

    let mut config = Config::default();
    let path = root.iceoryx2();
    config.global.set_root_path(&iceoryx2::prelude::Path::new(path.as_os_str().as_encoded_bytes()).unwrap());
    config.global.prefix = FileName::new(root.prefix().as_bytes()).unwrap();
    config
}

/// A bench as another version of whirl would make it: the same services, another schema.
#[test]
fn a_bench_of_another_version_is_told_so_in_words() {
    use iceoryx2::prelude::*;

    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let config = foreign(&root);
    let node = NodeBuilder::new().name(&"sim".try_into().unwrap()).config(&config).create::<ipc::Service>().unwrap();
    let _other = node
        .service_builder(&"whirl/other/state".try_into().unwrap())
        .publish_subscribe::<[u64]>()
        .create_with_attributes(
            &AttributeSpecifier::new().define(&"whirl.schema".try_into().unwrap(), &"0".try_into().unwrap()).unwrap(),
        )
        .unwrap();
    for refusal in [carrier.listen(&bench("other")).err(), carrier.host(&bench("other")).err()] {
        let words = refusal.unwrap().to_string();
        assert!(words.starts_with("bench 'other' was started by another version of whirl"), "{words}");
    }
}

/// Every service that a bench makes is one of the list, and every one of the list is made.
#[test]
fn the_services_of_a_bench_are_those_of_the_list() {
    use iceoryx2::prelude::*;

    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let host = carrier.host(&bench("all")).unwrap();
    let _ports = (host.states(LAYOUT).unwrap(), host.news().unwrap(), host.inbox().unwrap());
    let _recorder = carrier.recorder(&bench("all")).unwrap();
    let mut found = Vec::new();
    ipc::Service::list(&foreign(&root), |service| {
        found.push(service.static_details.name().as_str().to_owned());
        CallbackProgression::Continue
    })
    .unwrap();
    found.sort();
    let mut listed = Topic::ALL.map(|topic| format!("whirl/all/{topic}"));
    listed.sort();
    assert_eq!(found, listed);
}

#[test]
fn a_reader_that_holds_no_lease_keeps_its_services_when_the_last_of_ours_goes() {
    use iceoryx2::prelude::*;

    let dir = tempfile::tempdir().unwrap();
    let root = wire::Root::at(dir.path()).unwrap();
    let config = foreign(&root);
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    let name = bench("shared");
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    let node = NodeBuilder::new().config(&config).create::<ipc::Service>().unwrap();
    let service = node.service_builder(&"whirl/shared/state".try_into().unwrap());
    let subscriber = service.publish_subscribe::<[u64]>().open().unwrap().subscriber_builder().create().unwrap();
    states.send(1, number(1)).unwrap();
    drop((states, host, carrier, root));

    let root = wire::Root::at(dir.path()).unwrap();
    let carrier = wire::SharedMemory::new(&root, "test").unwrap();
    // Asked to clean up, we leave it alone too.
    assert_eq!(wire::clean(&carrier).unwrap(), 0);
    let host = carrier.host(&name).unwrap();
    let mut states = host.states(LAYOUT).unwrap();
    assert_eq!(host.listeners(), 1);
    states.send(1, number(2)).unwrap();
    let heard: Vec<u64> =
        std::iter::from_fn(|| subscriber.receive().unwrap()).map(|s| first_seq(s.payload())).collect();
    assert_eq!(heard, [1, 2], "it hears the next simulation of the name");
    drop((states, host, carrier, subscriber, node));
    drop(root);
    let files: Vec<_> = std::fs::read_dir(dir.path()).unwrap().flatten().map(|e| e.file_name()).collect();
    assert_eq!(files, ["lease"]);
}
