//! Faults with the lines of the file that they are about.

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};

use crate::{Fault, Faults};

impl Faults {
    /// As [`Faults::in_file`], and under each fault the line of `text` that it is about, with what is wrong underlined:
    ///
    /// ```text
    /// bad.toml:7:8: mass = -0.25: expected a finite number greater than 0
    ///   |
    /// 7 | mass = -0.25
    ///   |        ^^^^^
    /// ```
    ///
    /// `text` is what was read. What is missing altogether has no line. Wide characters and tabs are annotate-snippets' business.
    #[must_use]
    pub fn drawn(&self, file: &str, text: &str) -> String {
        let one = |fault: &Fault| format!("{file}:{fault}{}", line_of(fault, text).unwrap_or_default());
        self.list().iter().map(one).collect::<Vec<_>>().join("\n")
    }
}

/// The line of `text` that holds the beginning of a fault, underlined; `None` where nothing is there to underline.
fn line_of(fault: &Fault, text: &str) -> Option<String> {
    let written = text.get(fault.span.clone())?;
    // What spans several lines is told by its first.
    let first = written.lines().next()?.trim_end();
    if first.is_empty() {
        return None;
    }
    let span = fault.span.start..fault.span.start + first.len();
    let snippet = Snippet::source(text).annotation(AnnotationKind::Primary.span(span));
    let drawn = Renderer::plain().render(&[Group::with_level(Level::ERROR).element(snippet)]);
    // It shows control characters as pictures of them, but for those beyond ASCII, which some terminals obey too.
    let harmless = drawn.chars().map(|c| if c.is_control() && c != '\n' { char::REPLACEMENT_CHARACTER } else { c });
    Some(std::iter::once('\n').chain(harmless).collect())
}

#[cfg(test)]
mod tests {
    use crate::{Domain, Faults, Reader};

    /// All that is wrong with a file that holds `mass`, at least 0.
    fn faults(text: &str) -> Faults {
        let read = Reader::parse(text).and_then(|(mut reader, table)| {
            reader.only(&table, &["mass", "name"]);
            reader.required(&table, ("the file", 0..0), "mass", Domain::NotNegative);
            reader.string(&table, "name", "a text");
            reader.finish(())
        });
        read.expect_err("something is wrong")
    }

    #[test]
    fn the_line_stands_under_its_fault() {
        let text = "# a rotor\nmass = -0.25  # kg\n\tnane = 1  # gr\u{f6}\u{df}e\n";
        assert_eq!(
            faults(text).drawn("bad.toml", text),
            "bad.toml:2:8: mass = -0.25: expected a finite number, not negative\n  \
             |\n2 | mass = -0.25  # kg\n  |        ^^^^^\n\
             bad.toml:3:2: unknown key 'nane': expected one of mass, name; did you mean 'name'?\n  \
             |\n3 |     nane = 1  # größe\n  |     ^^^^"
        );
    }

    #[test]
    fn what_is_missing_has_no_line_and_long_values_are_told_by_their_first() {
        let text = "";
        assert_eq!(faults(text).drawn("a", text), faults(text).in_file("a"));
        let text = "mass = [\n  1,\n  2,\n]\n";
        assert!(
            faults(text).drawn("a", text).ends_with("1 | mass = [\n  |        ^"),
            "{}",
            faults(text).drawn("a", text)
        );
    }

    #[test]
    fn nothing_in_a_file_moves_the_cursor() {
        let text = "mass = \"\u{1b}[2J\u{7}\u{9b}\"\n";
        let drawn = faults(text).drawn("a", text);
        assert!(drawn.chars().all(|c| c == '\n' || !c.is_control()), "{drawn:?}");
        let long = format!("mass = \"{}\"", "x".repeat(10_000));
        assert!(
            faults(&long).drawn("a", &long).lines().all(|line| line.chars().count() < 200),
            "a line fits a terminal"
        );
    }
}
