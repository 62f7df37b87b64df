//! ASCII twins of the glyphs on the screen. Braille and blocks are translated by shape, the rest from a table.

/// Glyphs and their twins.
const TWINS: &[(&str, &str)] = &[
    ("│┃║┆┊╎", "||||||"),
    ("─━═┄┈╌▬", "-------"),
    ("┌┐└┘├┤┬┴┼╭╮╰╯", "+++++++++++++"),
    ("┏┓┗┛", "####"),
    ("▲▼◀▶◆◇●◉•○⊕△▽◈", "^v<>*o@O.o+^v%"),
    ("±·…×²³⁰¹τ≤≥–—→←↑↓↕↔Δζωμ√°", "~..x2301t<>--><^v|-Dzwuv'"),
    ("✓✗⚠■□▪", "+x!#o*"),
];

/// The twin of a glyph that is not ASCII. Whatever has none is a question mark: a test sees to it that no panel needs one.
pub(super) fn twin(symbol: &str) -> Option<char> {
    let mut characters = symbol.chars();
    let (Some(glyph), None) = (characters.next(), characters.next()) else { return None };
    if glyph.is_ascii() {
        return None;
    }
    Some(match glyph {
        '\u{2800}'..='\u{28ff}' => braille((glyph as u32 & 0xff) as u8),
        '\u{2580}'..='\u{259f}' => block(glyph),
        _ => from_table(glyph).unwrap_or('?'),
    })
}

fn from_table(glyph: char) -> Option<char> {
    TWINS.iter().find_map(|(glyphs, twins)| {
        let at = glyphs.chars().position(|candidate| candidate == glyph)?;
        twins.chars().nth(at)
    })
}

/// A sign whose ink is about where the dots are.
fn braille(bits: u8) -> char {
    // Rows from the top, each of two dots.
    let rows = [0x09, 0x12, 0x24, 0xc0].map(|row| (bits & row).count_ones());
    let (left, right) = ((bits & 0x47).count_ones(), (bits & 0xb8).count_ones());
    let filled = rows.iter().filter(|dots| **dots > 0).count();
    match (bits.count_ones(), filled) {
        (0, _) => ' ',
        (7.., _) => '#',
        // In one column from top to bottom, or nearly.
        (3.., 3..) if left == 0 || right == 0 => '|',
        (3.., 3..) if rising(bits) => '/',
        (3.., 3..) if falling(bits) => '\\',
        (5.., _) => '%',
        (_, 3..) => ':',
        _ if rows[0] > 0 && rows[2] + rows[3] == 0 => '\'',
        _ if rows[0] + rows[1] == 0 && rows[3] > 0 => '.',
        _ if rows[0] + rows[3] == 0 => '-',
        _ => ':',
    }
}

/// Dots in the upper right and the lower left alone.
fn rising(bits: u8) -> bool {
    bits & (0x01 | 0x80) == 0 && bits & (0x08 | 0x40) != 0
}

/// Dots in the upper left and the lower right alone.
fn falling(bits: u8) -> bool {
    bits & (0x08 | 0x40) == 0 && bits & (0x01 | 0x80) != 0
}

/// Blocks: the large digits, bars and shades.
fn block(glyph: char) -> char {
    match glyph {
        '▀' | '▘' | '▝' | '▔' => '\'',
        '▄' | '▖' | '▗' | '▁' | '▂' | '▃' => '.',
        '▌' | '▍' | '▎' | '▏' | '▐' | '▕' => '|',
        '▞' => '/',
        '▚' => '\\',
        '░' => '.',
        '▒' => ':',
        '▓' => '*',
        _ => '#',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_table_has_a_twin_for_each_glyph() {
        for (glyphs, twins) in TWINS {
            assert_eq!(glyphs.chars().count(), twins.len(), "{glyphs}");
            assert!(twins.is_ascii() && !glyphs.chars().any(|glyph| glyph.is_ascii()), "{glyphs}");
        }
        let all: String = TWINS.iter().map(|(glyphs, _)| *glyphs).collect();
        for glyph in all.chars() {
            assert_eq!(all.matches(glyph).count(), 1, "{glyph} has two twins");
        }
    }

    #[test]
    fn braille_and_blocks_keep_their_shape() {
        for bits in 0..=255_u8 {
            let twin = braille(bits);
            assert_eq!(twin == ' ', bits == 0, "{bits:#x}");
            assert!(twin.is_ascii_graphic() || twin == ' ');
        }
        for (glyph, sign) in
            [("⠁", '\''), ("⢀", '.'), ("⠒", '-'), ("⡇", '|'), ("⢸", '|'), ("⣿", '#'), ("⡠", '.'), ("⠉", '\'')]
        {
            assert_eq!(twin(glyph), Some(sign), "{glyph}");
        }
        assert_eq!((twin("⡰"), twin("⢆")), (Some('/'), Some('\\')));
        for glyph in '\u{2580}'..='\u{259f}' {
            assert_ne!(block(glyph), ' ');
        }
    }

    #[test]
    fn ascii_stays_and_what_is_unknown_is_a_question_mark() {
        assert_eq!((twin("a"), twin(" "), twin("")), (None, None, None));
        assert_eq!(twin("漢"), Some('?'));
    }
}
