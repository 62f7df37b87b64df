//! The page of the protocol is that of these tables.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]

use std::mem::{align_of, size_of};

use wire::protocol::{SERVICES, page};
use wire::{header, message};

#[test]
fn the_page_is_that_of_these_tables() {
    let kept =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/book/src/protocol.md")).unwrap();
    assert!(kept == page(), "make it again: cargo run -p wire --example protocol -- docs/book/src/protocol.md");
}

#[test]
fn the_messages_for_python_are_those_of_these_tables() {
    let kept = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/python/whirl/messages.py")).unwrap();
    assert!(
        kept == wire::python::text(),
        "make them again: cargo run -p wire --example python -- crates/wire/python/whirl/messages.py"
    );
}

/// Every link within the page has a heading, and no mark of rustdoc is left.
#[test]
fn the_page_leads_where_it_says() {
    let page = page();
    let headings: Vec<String> = page
        .lines()
        .filter(|line| line.starts_with('#'))
        .map(|line| line.trim_start_matches('#').trim().to_lowercase().replace(' ', "-").replace(['.', '`'], ""))
        .collect();
    for link in page.split("](#").skip(1) {
        let target = link.split(')').next().unwrap();
        assert!(headings.iter().any(|heading| heading == target), "#{target} of {headings:?}");
    }
    assert!(!page.contains("crate::") && !page.contains("`] ") && !page.contains("{schema}"));
    for service in SERVICES {
        assert!(page.contains(&format!("`whirl/NAME/{}`", service.topic)));
    }
}

/// Element, shape, offset and size of the fields agree with each other: a client may lay a message out by any of them.
#[test]
fn fields_fill_their_messages() {
    let messages = header::messages();
    let size_of_element = |element: &str| match element {
        "u16" => 2,
        "u32" => 4,
        "u64" | "f64" => 8,
        "text" => 1,
        name => messages.iter().find(|message| message.name == name).unwrap().size,
    };
    for message in &messages {
        let mut end = 0;
        for field in &message.fields {
            assert_eq!(field.offset, end, "{}.{}: no gaps that a client could not see", message.name, field.name);
            end = field.offset + size_of_element(field.element) * field.shape.iter().product::<usize>();
        }
        assert_eq!(end, message.size, "{}", message.name);
    }
    assert_eq!(align_of::<message::Answer>(), 8);
    assert_eq!(size_of::<message::Health>(), messages.iter().find(|m| m.name == "whirl.Health").unwrap().size);
}
