//! What stands on the report's page.

use std::collections::BTreeMap;

use rotor::{FIELDS, builtin};

use super::compare::{Comparison, Verdict};
use super::corrections::CORRECTIONS;
use super::{Figure, Report, criteria};
use crate::page::{self, Block, Caption, Page, TableRow};

const TITLE: &str = "The NASA report again";

impl Report {
    /// The page as Markdown. With `pictures`, each figure shows its file in the folder `figures` beside the page and links
    /// to its data; without, captions stand alone.
    #[must_use]
    pub fn markdown(&self, pictures: bool) -> String {
        let made = if pictures { "whirl report --out DIR" } else { "whirl report --page FILE" };
        format!(
            "<!-- Made by `{made}`: do not edit. -->

{}",
            self.page().markdown(pictures)
        )
    }

    /// The page as one HTML file, its figures in it.
    #[must_use]
    pub fn html(&self) -> String {
        self.page().html()
    }

    fn page(&self) -> Page<'_> {
        Page { title: TITLE, blocks: blocks(self) }
    }
}

fn blocks(report: &Report) -> Vec<Block<'_>> {
    let mut blocks = vec![
        Block::Heading(1, TITLE.into()),
        Block::Paragraph(
            "\"Eigenvalue Assignment Strategies in Rotor Systems\", final report of NASA grant NAG8034, computed anew with \
             Whirl: every number that it prints beside ours, and every figure that its gains allow. Lengths are in e_t, \
             times in τ = ω₀t, speeds R = ω/ω₀, frequencies in radians per unit of τ, control forces |u| in ω₀² e_t. Of ours \
             those digits are shown that are sure: rounding and steps are below them, and of motion that beats, what one long \
             stretch of time and the next agree on. What a search for gains found is the best found, not proven best."
                .into(),
        ),
        Block::Paragraph(summary(&report.comparisons)),
        Block::Paragraph(criteria::words()),
    ];
    for (chapter, heading) in [(3, "Numbers of chapter III: one mass"), (4, "Numbers of chapter IV: three masses")] {
        blocks.push(Block::Heading(2, heading.into()));
        blocks.push(numbers(report.comparisons.iter().filter(|c| c.chapter == chapter)));
    }
    blocks.push(Block::Heading(2, "Where the report is silent, damaged or wrong".into()));
    let header = vec!["The report is", "Where", "What", "Here"];
    let rows = CORRECTIONS
        .iter()
        .map(|c| TableRow::plain([c.fault.word(), c.place, c.matter, c.here].map(str::to_owned).to_vec()));
    blocks.push(Block::Table(header, rows.collect()));
    blocks.push(Block::Heading(2, "What was put in".into()));
    blocks.push(Block::Paragraph(
        "The parameters of Tables 3.2 and 4.2, as printed, per mass from one end to the other.".into(),
    ));
    blocks.push(parameters());
    blocks.push(Block::Heading(2, "Figures".into()));
    blocks.push(Block::Paragraph(
        "Forward whirl (with the spin) is drawn solid and blue, backward whirl dashed and red. Figs. 3.1 to 3.3, 4.1 and \
         4.6 are sketches, not results."
            .into(),
    ));
    blocks.extend(report.figures.iter().map(figure));
    blocks
}

fn figure(figure: &Figure) -> Block<'_> {
    let label = format!("Fig. {}", figure.number);
    let caption = Caption { label, words: figure.caption, remark: ("Agreement", figure.agreement) };
    Block::Figure(page::Figure { id: figure.stem(), title: figure.title, chart: &figure.chart, caption: Some(caption) })
}

/// How many rows agree, and how.
fn summary(comparisons: &[Comparison]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for comparison in comparisons {
        *counts.entry(comparison.verdict().words()).or_default() += 1;
    }
    let count = |verdict: Verdict| counts.get(verdict.words()).copied().unwrap_or(0);
    let near = count(Verdict::Reconstructed);
    let numbers = count(Verdict::EveryDigit) + count(Verdict::LastDigit) + near + count(Verdict::Differs);
    let claims = count(Verdict::Holds) + count(Verdict::DoesNotHold);
    format!(
        "Of {numbers} printed numbers, {} agree to every printed digit, {} are one off in the last, {near} are \
         reconstructions within 0.5 %, {} differ; of {claims} \
         statements put to the test, {} hold and {} do not. Each exception has its reason beside it.",
        count(Verdict::EveryDigit),
        count(Verdict::LastDigit),
        count(Verdict::Differs),
        count(Verdict::Holds),
        count(Verdict::DoesNotHold),
    )
}

fn numbers<'a>(comparisons: impl Iterator<Item = &'a Comparison>) -> Block<'static> {
    let header = vec!["Quantity", "Where", "Report", "Ours", "Difference", "Relative", "Agreement", "Note"];
    let rows = comparisons.map(|c| {
        let (absolute, relative) = c.difference_words();
        let agreement = c.verdict().words().to_owned();
        let [quantity, place, printed, note] = [c.quantity, c.place, c.printed_words(), c.note].map(str::to_owned);
        TableRow::plain(vec![quantity, place, printed, c.our_words(), absolute, relative, agreement, note])
    });
    Block::Table(header, rows.collect())
}

fn parameters() -> Block<'static> {
    // The two of the report; a third that is built in is not its.
    let rotors = ["jeffcott", "three-mass"].map(|name| builtin::rotor(name).expect("a built-in rotor"));
    // The clearance is what the figures vary.
    let fields = FIELDS.iter().enumerate().filter(|(_, field)| field.name != "deadband");
    let mut rows: Vec<TableRow> = fields
        .map(|(i, field)| {
            let values = rotors.iter().map(|rotor| {
                let each: Vec<String> = rotor.masses().iter().map(|m| m.values()[i].to_string()).collect();
                each.join(", ")
            });
            TableRow::plain(std::iter::once(field.name.replace('_', " ")).chain(values).collect())
        })
        .collect();
    let shafts = rotors.iter().map(|rotor| {
        let each: Vec<String> = rotor.shafts().iter().map(f64::to_string).collect();
        each.join(", ")
    });
    rows.push(TableRow::plain(std::iter::once("shaft stiffness".to_owned()).chain(shafts).collect()));
    Block::Table(vec!["Parameter", "One mass (Table 3.2)", "Three masses (Table 4.2)"], rows)
}
