//! The C header is that of these messages, and a C and a C++ compiler lay them out as we do.

#![allow(clippy::unwrap_used, reason = "a test that cannot set up has failed")]
#![allow(clippy::print_stderr, reason = "what was not tested is to be seen")]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use wire::header;
use wire::{CHANNELS, Scope, StepLayout};

const HEADER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/whirl.h");

#[test]
fn the_header_is_that_of_these_messages() {
    let kept = std::fs::read_to_string(HEADER).unwrap();
    assert!(kept == header::text(), "make it again: cargo run -p wire --example header -- crates/wire/whirl.h");
}

/// A program that prints every size and offset and every place of a word, and what it has to print.
fn program() -> (String, String) {
    let mut code = "#include <stddef.h>\n#include <stdio.h>\n#include \"whirl.h\"\nint main(void) {\n".to_owned();
    let mut expected = String::new();
    let mut tell = |value: &str, told: usize| {
        let _ = writeln!(code, "    printf(\"%zu\\n\", (size_t)({value}));");
        let _ = writeln!(expected, "{told}");
    };
    for message in header::messages() {
        tell(&format!("sizeof(struct {})", message.c_name), message.size);
        for field in &message.fields {
            tell(&format!("offsetof(struct {}, {})", message.c_name, field.name), field.offset);
        }
    }
    for masses in [1, 3, 16] {
        let layout = StepLayout::new(masses).with_bearings(3);
        tell(&format!("WHIRL_WIDTH({masses}, {masses}, 2)"), layout.width());
        for row in CHANNELS {
            let index = layout.count(row.scope) - 1;
            let arguments = match row.scope {
                Scope::Once => String::new(),
                Scope::Mass => format!("({index})"),
                Scope::Sensor => format!("({masses}, {index})"),
                Scope::Further => format!("({masses}, {masses}, {index})"),
            };
            let name = row.name.to_ascii_uppercase();
            tell(&format!("WHIRL_{name}{arguments}"), layout.place(row.channel, index));
        }
    }
    code.push_str("    uint64_t row[5] = {0, 0, 0, 0, UINT64_C(0x0203000300020005)};\n");
    code.push_str("    printf(\"%u %u %u\\n\", WHIRL_MASSES(row), WHIRL_SENSORS(row), WHIRL_FURTHER(row));\n");
    code.push_str("    printf(\"%g\\n\", whirl_number(UINT64_C(0x4004000000000000)));\n    return 0;\n}\n");
    expected.push_str("3 3 2\n2.5\n");
    (code, expected)
}

fn laid_out_by(compiler: &str, file: &str, flags: &[&str]) {
    if Command::new(compiler).arg("--version").output().is_err() {
        eprintln!("NOT TESTED: there is no compiler '{compiler}' here, so whirl.h was not compiled with it");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (code, expected) = program();
    let (source, made) = (folder.path().join(file), folder.path().join("layout"));
    std::fs::write(&source, code).unwrap();
    let compiled = Command::new(compiler)
        .args(["-Wall", "-Wextra", "-Werror", "-pedantic"])
        .args(flags)
        .arg("-I")
        .arg(Path::new(HEADER).parent().unwrap())
        .args([&source])
        .arg("-o")
        .arg(&made)
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let told = Command::new(&made).output().unwrap();
    assert_eq!(String::from_utf8_lossy(&told.stdout), expected);
}

#[test]
fn val_a_c_compiler_lays_them_out_as_we_do() {
    laid_out_by("cc", "layout.c", &["-std=c99"]);
}

#[test]
fn val_a_cpp_compiler_lays_them_out_as_we_do() {
    laid_out_by("c++", "layout.cpp", &["-std=c++11"]);
}

/// What a reader that sleeps, a late one, and every event costs.
#[test]
fn messages_are_narrow() {
    let size = |name: &str| header::messages().into_iter().find(|message| message.name == name).unwrap().size;
    assert!(StepLayout::new(3).width() * 8 <= 256);
    assert!(
        size("whirl.Event") <= 600 && size("whirl.Request") <= 600,
        "{} {}",
        size("whirl.Event"),
        size("whirl.Request")
    );
    assert!(
        size("whirl.BenchStatus") <= 1024 && size("whirl.Answer") <= 320,
        "{} {}",
        size("whirl.BenchStatus"),
        size("whirl.Answer")
    );
}
