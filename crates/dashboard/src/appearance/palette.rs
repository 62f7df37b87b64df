//! The themes.

use ratatui::style::Color;

use crate::theme::ROLES;

/// Colours of one theme.
#[derive(Debug)]
pub(crate) struct Palette {
    /// Of each role, by its number in [`theme`](crate::theme).
    pub(crate) roles: [Color; ROLES],
    /// Of text without a role.
    pub(crate) text: Color,
    /// Of what lies behind; `Reset` is the terminal's own.
    pub(crate) background: Color,
}

/// A theme by name.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Theme {
    pub(crate) name: &'static str,
    pub(crate) meaning: &'static str,
    /// Of the sixteen colours that every terminal has and lets its owner choose.
    pub(crate) sixteen: &'static Palette,
    /// For terminals that have more, if it is any better there.
    pub(crate) full: Option<&'static Palette>,
}

/// Every theme, the default first.
pub(crate) const THEMES: [Theme; 4] = [
    Theme { name: "default", meaning: "the terminal's own sixteen colours", sixteen: &SIXTEEN, full: None },
    Theme {
        name: "full",
        meaning: "true colours, on light and dark alike, where the terminal has them",
        sixteen: &SIXTEEN,
        full: Some(&FULL),
    },
    Theme { name: "contrast", meaning: "bright on black, no greys", sixteen: &CONTRAST, full: Some(&CONTRAST_FULL) },
    Theme {
        name: "colour-blind",
        meaning: "blue, ochre and purple for stable, warning and alarm",
        sixteen: &BLIND,
        full: Some(&BLIND_FULL),
    },
];

/// A colour as it is written on the web.
const fn rgb(code: u32) -> Color {
    Color::Rgb((code >> 16) as u8, (code >> 8 & 0xff) as u8, (code & 0xff) as u8)
}

/// The colours of one theme as it is read: what stands, what whirls, what is drawn upon, masses, heat.
const fn palette(
    [good, warn, bad]: [Color; 3],
    [forward, backward]: [Color; 2],
    [grid, clearance, key, force, candidate, cursor]: [Color; 6],
    traces: [Color; 4],
    heat: [Color; 8],
    [text, background]: [Color; 2],
) -> Palette {
    let [a, b, c, d] = traces;
    let [h0, h1, h2, h3, h4, h5, h6, h7] = heat;
    Palette {
        roles: [
            good, warn, bad, forward, backward, grid, clearance, key, force, a, b, c, d, candidate, cursor, h0, h1, h2,
            h3, h4, h5, h6, h7,
        ],
        text,
        background,
    }
}

use Color::{
    Black, Blue, Cyan, DarkGray, Gray, Green, LightBlue, LightCyan, LightGreen, LightMagenta, LightRed, LightYellow,
    Magenta, Red, Reset, White, Yellow,
};

// Green, amber and red (of the colour-blind themes cyan or blue, yellow and purple) are the state's alone: whatever else has a colour
// has another hue, and what a person points with is the text's own colour.

static SIXTEEN: Palette = palette(
    [Green, Yellow, Red],
    [Cyan, Magenta],
    [DarkGray, Blue, Reset, LightBlue, LightMagenta, Reset],
    [Cyan, Magenta, LightBlue, LightCyan],
    [DarkGray, Blue, Blue, LightBlue, Cyan, LightCyan, Magenta, LightMagenta],
    [Reset, Reset],
);

static CONTRAST: Palette = palette(
    [LightGreen, LightYellow, LightRed],
    [LightCyan, LightMagenta],
    [Gray, LightBlue, White, LightBlue, LightMagenta, White],
    [LightCyan, LightMagenta, White, LightBlue],
    [Gray, Gray, LightBlue, LightBlue, LightCyan, LightCyan, LightMagenta, White],
    [White, Black],
);

static CONTRAST_FULL: Palette = palette(
    [rgb(0x55ff55), rgb(0xffff55), rgb(0xff9a9a)],
    [rgb(0x66ffff), rgb(0xff9eff)],
    [rgb(0xbdbdbd), rgb(0x9ecbff), rgb(0xffffff), rgb(0x9ecbff), rgb(0xc8b4ff), rgb(0xffffff)],
    [rgb(0x66ffff), rgb(0xff9eff), rgb(0xffffff), rgb(0x9ecbff)],
    [
        rgb(0xa8a8a8),
        rgb(0x9ecbff),
        rgb(0x9ecbff),
        rgb(0x66ffff),
        rgb(0xc8b4ff),
        rgb(0xff9eff),
        rgb(0xffd0ff),
        rgb(0xffffff),
    ],
    [rgb(0xffffff), rgb(0x000000)],
);

/// Every colour stands out at least 3 : 1 on white and on black, which WCAG 2.2 asks of graphics (1.4.11).
static FULL: Palette = palette(
    [rgb(0x1f9a3c), rgb(0xb88600), rgb(0xe0402a)],
    [rgb(0x1496a8), rgb(0xb85ac8)],
    [rgb(0x7a7a7a), rgb(0x6f7f99), Reset, rgb(0x8a6fe0), rgb(0xd0559c), Reset],
    [rgb(0x1496a8), rgb(0xb85ac8), rgb(0x4a7fd6), rgb(0xd0559c)],
    HEAT,
    [Reset, Reset],
);

static BLIND: Palette = palette(
    [Cyan, Yellow, Magenta],
    [LightBlue, Reset],
    [DarkGray, Blue, Reset, LightBlue, Blue, Reset],
    [LightBlue, Reset, Blue, Gray],
    [DarkGray, DarkGray, Blue, Blue, LightBlue, LightBlue, Gray, Reset],
    [Reset, Reset],
);

/// Also apart under protanopia, deuteranopia and tritanopia; a test simulates them.
static BLIND_FULL: Palette = palette(
    [rgb(0x3a86d8), rgb(0xc08a00), rgb(0xb01c66)],
    [rgb(0xc656fe), rgb(0x22636b)],
    [rgb(0x7a7a7a), rgb(0x7b8e91), Reset, rgb(0x8041bd), rgb(0x8041bd), Reset],
    [rgb(0xc656fe), rgb(0x22636b), rgb(0x7b8e91), rgb(0x8041bd)],
    BLIND_HEAT,
    [Reset, Reset],
);

/// From teal over blue and violet to pink: no green, no amber, no red.
const HEAT: [Color; 8] = [
    rgb(0x44808c),
    rgb(0x3f84a8),
    rgb(0x4a7fc8),
    rgb(0x6474d8),
    rgb(0x846ada),
    rgb(0xa45ed0),
    rgb(0xc050bc),
    rgb(0xd8489c),
];

/// From grey to violet, without the blue that is the state's.
const BLIND_HEAT: [Color; 8] = [
    rgb(0x647074),
    rgb(0x737088),
    rgb(0x816e9b),
    rgb(0x8f6caf),
    rgb(0x9d69c2),
    rgb(0xaa64d6),
    rgb(0xb85eea),
    rgb(0xc656fe),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::theme;

    fn linear(color: Color) -> [f64; 3] {
        let Color::Rgb(r, g, b) = color else { panic!("{color} is not a true colour") };
        [r, g, b].map(|part| {
            let part = f64::from(part) / 255.0;
            if part <= 0.040_45 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        })
    }

    /// WCAG's contrast ratio.
    fn contrast(a: Color, b: Color) -> f64 {
        let luminance = |color| {
            let [r, g, b] = linear(color);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        let (a, b) = (luminance(a), luminance(b));
        a.max(b) / a.min(b)
    }

    const WHITE: Color = rgb(0xffffff);
    const BLACK: Color = rgb(0);

    #[test]
    fn true_colours_stand_on_light_and_dark() {
        for palette in [&FULL, &BLIND_FULL] {
            // The text's own colour stands on whatever the text does.
            for (number, color) in palette.roles.into_iter().enumerate().filter(|(_, color)| *color != Reset) {
                let (light, dark) = (contrast(color, WHITE), contrast(color, BLACK));
                assert!(light >= 3.0 && dark >= 3.0, "role {number}: {light:.2} on white, {dark:.2} on black");
            }
        }
    }

    #[test]
    fn high_contrast_is_that() {
        assert_eq!(contrast(CONTRAST_FULL.text, CONTRAST_FULL.background), 21.0);
        for (number, color) in CONTRAST_FULL.roles.into_iter().enumerate() {
            let ratio = contrast(color, CONTRAST_FULL.background);
            assert!(ratio >= 7.0, "role {number}: {ratio:.2}, WCAG asks for 7 at its highest level");
        }
    }

    /// Machado, Oliveira and Fernandes 2009, severity 1: what people see who lack one of the three kinds of cones.
    const DEFICIENCIES: [(&str, [[f64; 3]; 3]); 3] = [
        (
            "protanopia",
            [
                [0.152_286, 1.052_583, -0.204_868],
                [0.114_503, 0.786_281, 0.099_216],
                [-0.003_882, -0.048_116, 1.051_998],
            ],
        ),
        (
            "deuteranopia",
            [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
        ),
        (
            "tritanopia",
            [
                [1.255_528, -0.076_749, -0.178_779],
                [-0.078_411, 0.930_809, 0.147_602],
                [0.004_733, 0.691_367, 0.303_900],
            ],
        ),
    ];

    /// Ottosson's Oklab: lightness, green to red, blue to yellow.
    fn lab([r, g, b]: [f64; 3]) -> [f64; 3] {
        let [l, m, s] = [
            0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b,
            0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b,
            0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b,
        ]
        .map(|cone: f64| cone.clamp(0.0, 1.0).cbrt());
        [
            0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
            1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
            0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
        ]
    }

    /// Distance in Oklab, in which 1 is from black to white.
    fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
        lab(a).iter().zip(lab(b)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    /// Least difference of hue from those of the state, in degrees; greys have none.
    const OTHER_HUE: f64 = 25.0;

    #[test]
    fn the_colours_of_the_state_mean_nothing_else_in_any_theme() {
        // Of a colour of the sixteen its name, of a true one its hue.
        let name = |color: Color| format!("{color}").replace("Light", "");
        let hue = |color: Color| {
            let [_, a, b] = lab(linear(color));
            (a.hypot(b) > 0.05).then(|| b.atan2(a).to_degrees())
        };
        let is_true = |color: Color| matches!(color, Color::Rgb(..));
        for theme in THEMES {
            for palette in [Some(theme.sixteen), theme.full].into_iter().flatten() {
                let (state, others) = palette.roles.split_at(3);
                for (other, of_state) in others.iter().flat_map(|other| state.iter().map(move |of| (*other, *of))) {
                    let is_apart = match (is_true(other) && is_true(of_state)).then(|| (hue(other), hue(of_state))) {
                        Some((Some(other), Some(of_state))) => {
                            let turn = (other - of_state).rem_euclid(360.0);
                            turn.min(360.0 - turn) >= OTHER_HUE
                        }
                        Some(_) => true,
                        None => name(other) != name(of_state),
                    };
                    assert!(is_apart, "{}: {other} is {of_state}", theme.name);
                }
            }
        }
    }

    #[test]
    fn the_colour_blind_theme_keeps_apart_what_means_different_things() {
        let of = |role: Color| {
            let Color::Indexed(number) = role else { panic!("roles are numbers") };
            BLIND_FULL.roles[usize::from(number)]
        };
        let groups: [&[Color]; 3] =
            [&[theme::GOOD, theme::WARN, theme::BAD], &[theme::FORWARD, theme::BACKWARD], &theme::TRACES];
        for group in groups {
            for (i, a) in group.iter().enumerate() {
                for b in &group[i + 1..] {
                    for (name, seen) in DEFICIENCIES {
                        let see = |color| {
                            let rgb = linear(of(color));
                            seen.map(|row| row.iter().zip(rgb).map(|(m, c)| m * c).sum::<f64>().clamp(0.0, 1.0))
                        };
                        let distance = apart(see(*a), see(*b));
                        assert!(distance > 0.1, "{a} and {b} under {name}: {distance:.3}");
                    }
                }
            }
        }
    }

    #[test]
    fn heat_rises_without_turning_back() {
        for heat in [HEAT, BLIND_HEAT] {
            let steps: Vec<f64> = heat.windows(2).map(|pair| apart(linear(pair[0]), linear(pair[1]))).collect();
            assert!(steps.iter().all(|step| *step > 0.02), "{steps:?}");
            let from_first: Vec<f64> = heat.iter().map(|color| apart(linear(heat[0]), linear(*color))).collect();
            assert!(from_first.is_sorted(), "{from_first:?}");
        }
    }

    #[test]
    fn themes_have_names_of_their_own() {
        for (i, theme) in THEMES.iter().enumerate() {
            assert!(THEMES[i + 1..].iter().all(|other| other.name != theme.name));
        }
    }
}
