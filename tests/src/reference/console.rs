//! Keys, typed commands, layouts and panels of the console.

use super::{begin, code, table};

/// Keys and what can be typed.
pub(super) fn keys() -> String {
    let mut out = begin(
        "Keys and typed commands",
        "Of [the console](console.md), as `?` shows them there. `[keys]` in the configuration file binds others: `whirl config defaults` prints it.",
    );
    out += "\n## Keys\n";
    let rows = dashboard::manual_keys().into_iter().map(|(keys, meaning)| [keys, meaning.to_owned()]);
    table(&mut out, ["keys", "what they do"], rows);
    out += "\n## Typed commands\n\nTyped after a colon; tab completes them. Settings can be typed alone: `:speed 3`, `:kd=0.1`.\n";
    let rows = dashboard::manual_commands().into_iter().map(|(name, meaning)| [code(&name), meaning.to_owned()]);
    table(&mut out, ["command", "what it does"], rows);
    out
}

/// Layouts and panels.
pub(super) fn layouts() -> String {
    let mut out = begin(
        "Layouts and panels",
        "The screens of [the console](console.md#layouts), by the digit that shows each, and what a screen of your own can be made of. `whirl layout show NAME` prints one as a \
         file to start from, `whirl layout check FILE` looks for mistakes.",
    );
    out += "\n## Layouts\n";
    let size = |(width, height): (u16, u16)| format!("{width} x {height}");
    let rows = dashboard::built_in_layouts().into_iter().enumerate().map(|(at, layout)| {
        let sizes: Vec<String> = layout.sizes().into_iter().map(size).collect();
        [code(&(at + 1).to_string()), code(layout.name()), layout.about().to_owned(), sizes.join(", ")]
    });
    table(&mut out, ["key", "layout", "what it is for", "screens from"], rows);
    out += "\n## Panels\n";
    let rows = dashboard::panels().map(|(name, meaning, least)| [code(name), meaning.to_owned(), size(least)]);
    table(&mut out, ["panel", "what it shows", "smallest"], rows);
    out
}
