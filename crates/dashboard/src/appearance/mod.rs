//! How a finished frame looks: which colours stand for the roles of [`theme`](crate::theme), and whether glyphs beyond
//! ASCII are shown. One pass over the cells does both, so no panel knows of either.
//!
//! What a person asks for wins; else the environment decides: `NO_COLOR`, `COLORTERM`, and the locale.

mod ascii;
mod palette;

use std::fmt;
use std::str::FromStr;

use ratatui::buffer::Buffer;
use ratatui::style::Color;

use palette::{Palette, THEMES, Theme};

/// What a person asks of the looks of the dashboard; what is left open, the environment decides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AppearanceOptions {
    /// The theme.
    pub theme: ThemeName,
    /// Nothing but ASCII on the screen, whatever the locale says.
    pub ascii: bool,
}

/// A theme by its name: `default`, `full`, `contrast` or `colour-blind`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ThemeName(usize);

impl ThemeName {
    /// Every theme, the default first, with what it is for.
    pub fn all() -> impl ExactSizeIterator<Item = (Self, &'static str)> {
        THEMES.iter().enumerate().map(|(at, theme)| (Self(at), theme.meaning))
    }

    fn theme(self) -> &'static Theme {
        &THEMES[self.0]
    }
}

impl fmt::Display for ThemeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.theme().name)
    }
}

impl FromStr for ThemeName {
    type Err = UnknownTheme;

    fn from_str(name: &str) -> Result<Self, UnknownTheme> {
        let at = THEMES.iter().position(|theme| theme.name == name);
        at.map(Self).ok_or_else(|| UnknownTheme(name.to_owned()))
    }
}

/// There is no theme of that name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no theme '{0}': {meant}there are {names}", meant = text::meant(.0, &THEMES.map(|theme| theme.name)), names = THEMES.map(|theme| theme.name).join(", "))]
pub struct UnknownTheme(String);

/// Colours and glyphs of a finished frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Look {
    /// `None` shows no colour at all.
    palette: Option<&'static Palette>,
    ascii: bool,
}

impl Look {
    /// The look for `appearance` in an environment.
    pub(crate) fn choose(appearance: AppearanceOptions, variable: impl Fn(&str) -> Option<String>) -> Self {
        let set = |name: &str| variable(name).filter(|value| !value.is_empty());
        let theme = appearance.theme.theme();
        let full = set("COLORTERM").is_some_and(|value| matches!(&*value, "truecolor" | "24bit"));
        let palette = if full { theme.full.unwrap_or(theme.sixteen) } else { theme.sixteen };
        // no-color.org: any value but the empty one. The console of the Linux kernel has no braille.
        let simple = set("TERM").is_some_and(|terminal| matches!(&*terminal, "linux" | "dumb"));
        // The first of these that is set says what the terminal can show; none set says nothing.
        let locale = ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(set).map(|value| value.to_lowercase());
        let foreign = locale.is_some_and(|locale| !(locale.contains("utf-8") || locale.contains("utf8")));
        Self { palette: set("NO_COLOR").is_none().then_some(palette), ascii: appearance.ascii || simple || foreign }
    }

    /// The look of a screenshot, which can have all colours and glyphs.
    pub(crate) fn of_screenshot(appearance: AppearanceOptions) -> Self {
        Self::choose(appearance, |name| (name == "COLORTERM").then(|| "truecolor".to_owned()))
    }

    /// The look of this process's environment.
    pub(crate) fn of_environment(appearance: AppearanceOptions) -> Self {
        Self::choose(appearance, |name| std::env::var(name).ok())
    }

    /// Turns roles into colours, and glyphs into their ASCII twins if need be.
    pub(crate) fn finish(&self, buffer: &mut Buffer) {
        if self.ascii {
            spell_out(buffer);
        }
        for cell in &mut buffer.content {
            cell.fg = self.color(cell.fg, |palette| palette.text);
            cell.bg = self.color(cell.bg, |palette| palette.background);
            if self.ascii
                && let Some(twin) = ascii::twin(cell.symbol())
            {
                cell.set_char(twin);
            }
        }
    }

    fn color(&self, color: Color, plain: impl Fn(&Palette) -> Color) -> Color {
        match (self.palette, color) {
            (None, _) => Color::Reset,
            (Some(palette), Color::Reset) => plain(palette),
            (Some(palette), Color::Indexed(role)) => palette.roles[usize::from(role)],
            (Some(_), color) => color,
        }
    }
}

/// Writes plus-minus as two signs where there is a blank before it: one sign alone would be read as another.
fn spell_out(buffer: &mut Buffer) {
    let width = usize::from(buffer.area.width);
    for at in 1..buffer.content.len() {
        if buffer.content[at].symbol() == "±" && at % width != 0 && buffer.content[at - 1].symbol() == " " {
            let style = buffer.content[at].style();
            buffer.content[at - 1].set_symbol("+").set_style(style);
            buffer.content[at].set_symbol("-");
        }
    }
}

#[cfg(test)]
mod tests {
    use ratatui::layout::Rect;
    use ratatui::style::Style;

    use super::*;
    use crate::theme;

    fn look(appearance: AppearanceOptions, environment: &[(&str, &str)]) -> Look {
        let find = |name: &str| environment.iter().find(|(n, _)| *n == name).map(|(_, value)| (*value).to_owned());
        Look::choose(appearance, find)
    }

    /// The one cell of a finished frame.
    fn finished(look: Look, symbol: &str, style: Style) -> (String, Color, Color) {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 1, 1));
        buffer.set_string(0, 0, symbol, style);
        look.finish(&mut buffer);
        let cell = &buffer[(0, 0)];
        (cell.symbol().to_owned(), cell.fg, cell.bg)
    }

    #[test]
    fn roles_become_the_sixteen_colours_unless_told_otherwise() {
        let appearance = AppearanceOptions::default();
        for environment in [&[][..], &[("COLORTERM", "truecolor")], &[("NO_COLOR", "")]] {
            let cell = finished(look(appearance, environment), "⠿", Style::new().fg(theme::BAD));
            assert_eq!(cell, ("⠿".into(), Color::Red, Color::Reset), "{environment:?}");
        }
        let full = AppearanceOptions { theme: "full".parse().unwrap(), ..appearance };
        let fg = |environment| finished(look(full, environment), "x", Style::new().fg(theme::BAD)).1;
        assert!(matches!(fg(&[("COLORTERM", "truecolor")]), Color::Rgb(..)));
        assert_eq!(fg(&[("COLORTERM", "no")]), Color::Red, "a terminal that does not say so gets no true colours");
    }

    #[test]
    fn no_color_leaves_none() {
        for (theme, _) in ThemeName::all() {
            let appearance = AppearanceOptions { theme, ascii: false };
            let look = look(appearance, &[("NO_COLOR", "1"), ("COLORTERM", "truecolor")]);
            let style = Style::new().fg(theme::GOOD).bg(theme::FORCE);
            assert_eq!(finished(look, "x", style), ("x".into(), Color::Reset, Color::Reset));
        }
    }

    #[test]
    fn the_locale_and_the_terminal_decide_on_ascii() {
        let is_ascii = |environment: &[(&str, &str)]| look(AppearanceOptions::default(), environment).ascii;
        assert!(!is_ascii(&[]));
        assert!(!is_ascii(&[("LANG", "en_GB.UTF-8")]));
        assert!(!is_ascii(&[("LC_ALL", ""), ("LANG", "C.utf8")]));
        assert!(is_ascii(&[("LANG", "C")]));
        assert!(is_ascii(&[("LC_ALL", "POSIX"), ("LANG", "en_GB.UTF-8")]));
        assert!(is_ascii(&[("LC_CTYPE", "de_DE.ISO-8859-1"), ("LANG", "en_GB.UTF-8")]));
        assert!(is_ascii(&[("TERM", "linux"), ("LANG", "en_GB.UTF-8")]));
        assert!(
            look(AppearanceOptions { ascii: true, ..AppearanceOptions::default() }, &[("LANG", "en_GB.UTF-8")]).ascii
        );
    }

    #[test]
    fn themes_go_by_their_names() {
        for (theme, _) in ThemeName::all() {
            assert_eq!(theme.to_string().parse(), Ok(theme));
        }
        let unknown = "dark".parse::<ThemeName>().unwrap_err();
        assert_eq!(unknown.to_string(), "no theme 'dark': there are default, full, contrast, colour-blind");
        assert!(UnknownTheme("contast".into()).to_string().contains("did you mean 'contrast'?"));
    }

    #[test]
    fn ascii_means_ascii() {
        let look = look(AppearanceOptions { ascii: true, ..AppearanceOptions::default() }, &[]);
        for (symbol, twin) in [("◆", "*"), ("│", "|"), ("⠤", "-"), ("x", "x"), ("²", "2")] {
            assert_eq!(finished(look, symbol, Style::new()).0, twin);
        }
    }

    #[test]
    fn plus_minus_is_two_signs_where_it_has_room() {
        let area = Rect::new(0, 0, 12, 2);
        let mut buffer = Buffer::empty(area);
        buffer.set_string(0, 0, "Im ±3 kd±0.1", Style::new());
        buffer.set_string(0, 1, "±4", Style::new());
        look(AppearanceOptions { ascii: true, ..AppearanceOptions::default() }, &[]).finish(&mut buffer);
        let row = |y| (0..12).map(|x| buffer[(x, y)].symbol().to_owned()).collect::<String>();
        assert_eq!([row(0), row(1).trim_end().to_owned()], ["Im+-3 kd~0.1", "~4"]);
    }
}
