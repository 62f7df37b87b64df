//! What is on the screen after some keys: scenarios as data. Each is one dashboard on the three-mass rotor at R = 2.5.

use super::{dashboard, frame};
use crate::capture::KeyPresses;
use crate::options::Options;

/// Keys as `--press` has them, what the screen then shows, and what it does not.
type Then = (&'static str, &'static [&'static str], &'static [&'static str]);

const SCENARIOS: &[(&str, &[Then])] = &[
    (
        "what a command would do is shown while it is typed",
        &[
            ("3:kd=-0.2", &["then 0.", "│? "], &[]),
            ("<esc>", &[], &["then "]),
            (":set speed=9 kd=0", &["then -0.", "│? "], &[]),
            ("<esc>:off", &["then -0.", "│? "], &[]),
            ("<esc>:speed 9", &["then -0.", "│? "], &[]),
            ("<esc>:run-up 9 0.01", &[], &["then "]),
        ],
    ),
    (
        "the scale of a plot stands still until it is let go",
        &[
            ("z", &["no plot is chosen"], &["┏"]),
            (":choose orbits<enter>", &["┏ orbits  ±4.0 e_t  ◉"], &[]),
            ("z", &["┏ orbits  ±2.0 e_t fixed  ◉"], &[]),
            ("=", &["┏ orbits  ±4.0 e_t  ◉"], &[]),
            ("<esc>", &[], &["┏"]),
            (":scale orbits -8..8<enter>", &[" orbits  ±8.0 e_t fixed "], &[]),
            (":scale y -5..5<enter>", &["=±5"], &[]),
            (":scale nothing 1..2<enter>", &["no plot or strip 'nothing'"], &[]),
            (
                ":scale orbits 3..1<enter>",
                &["scale '3..1': expected auto, TIMES above 0 and other than 1, or LOW..HIGH"],
                &[],
            ),
        ],
    ),
    (
        "modes, frequencies and speeds are read where a plot has them",
        &[
            (":layout tuning<enter>:choose poles<enter>..", &["◈"], &[]),
            (":choose damping-over-speed<enter>:read 4<enter>", &["┆ R 4  0."], &[]),
            ("+", &["┆ R 4"], &[]),
            (":read off<enter>", &[], &["┆ R 4"]),
            (":layout whirl<enter>:choose spectrum<enter>", &["┏ full spectrum"], &[]),
            (":read 1.25<enter>", &["┆ 1.2", "1.5"], &[]),
            (":spectrum 2 -3..3<enter>", &["full spectrum  mass 2 fixed"], &[]),
            (":spectrum 9<enter>", &["spectrum 9: expected a mass from 1 to 3"], &[]),
            (":spectrum auto<enter>", &["full spectrum  mass 1  30.0 tau "], &[]),
            (":choose orbits<enter>,", &["the moment under the cursor"], &[]),
        ],
    ),
    (
        "strips show what was chosen",
        &[
            (
                "5:strips radius.2 y.1+z.1 damping speed<enter>",
                &["│radius.2", "│y.1 z.1 ", "│damping ", "│speed "],
                &[],
            ),
            // A strip may have the name of a panel.
            (":scale damping 0..0.08<enter>", &["=0 to 0.08│"], &[]),
            (":strips y.9<enter>", &["strips 'y.9': expected a mass from 1 to 3"], &[]),
            (":strips auto<enter>", &["│u"], &["│radius.2"]),
        ],
    ),
    (
        "what cannot be done is refused in words",
        &[
            (":fly<enter>", &["no command 'fly'"], &[]),
            (":run-up 0..6 0.01<enter>", &["it spins at R 2.5, not at 0"], &[]),
            (":run-up 6<enter>", &["expected where the speed goes and how fast"], &[]),
            (":run-up 6 0<enter>", &["expected a number above 0"], &[]),
            (":run-up 6 -1<enter>", &["expected a number above 0"], &[]),
            (":stay<enter>", &["the speed is not on its way"], &[]),
            ("V", &["it would jump: `:run-up 0 RATE`"], &[]),
            (":search stop<enter>", &["no search is under way"], &[]),
            (":search 6..1<enter>", &["expected a range of speeds"], &[]),
            ("b", &["hold the settings first"], &[]),
            (":go 5<enter>", &["only a recording can be played"], &[]),
        ],
    ),
    (
        "a filter holds for all lists, and the selected setting is never hidden",
        &[
            ("3/kc<enter>", &["▶ speed", "  kc ", "/kc 0 of 6"], &["  deadband "]),
            ("<down>", &["▶ kc"], &["  speed "]),
            ("<esc>", &["  speed "], &[]),
        ],
    ),
];

#[test]
fn the_screen_answers_keys() {
    for (name, steps) in SCENARIOS {
        let (mut app, _edits) = dashboard(&Options::default());
        for (keys, shown, hidden) in *steps {
            // Between two keys a person sees a frame.
            for key in keys.parse::<KeyPresses>().unwrap().keys() {
                app.press(key);
                frame(&mut app);
            }
            let screen = frame(&mut app);
            for words in *shown {
                assert!(screen.contains(words), "{name}: no '{words}' after {keys}:\n{screen}");
            }
            for words in *hidden {
                assert!(!screen.contains(words), "{name}: '{words}' after {keys}:\n{screen}");
            }
        }
    }
}
