//! How a command line can go on.

use alarms::Watch;
use rotor::PARAMETERS;

use telemetry::drill::Fault;

use crate::actions::ACTIONS;
use crate::panels::registry::plots;
use crate::series;

/// Every way to go on with a command line: whole lines.
pub(crate) fn completions(line: &str, layouts: &[String], presets: &[String]) -> Vec<String> {
    let (before, word) = line.rsplit_once(' ').map_or(("", line), |(before, word)| (before, word));
    let settings = || PARAMETERS.iter().map(|parameter| format!("{}=", parameter.name));
    let first = before.split_whitespace().next();
    let candidates: Vec<String> = match first {
        None => {
            let named = ACTIONS.iter().map(|row| {
                let space = if row.argument.is_empty() { "" } else { " " };
                format!("{}{space}", row.name)
            });
            named.chain(settings()).collect()
        }
        Some("layout") => layouts.to_vec(),
        Some("load" | "save" | "delete") => presets.to_vec(),
        Some("set") => settings().collect(),
        Some("alarm") if before.split_whitespace().count() == 1 => {
            Watch::ALL.into_iter().filter(|watch| watch.has_limits()).map(|watch| format!("{watch} ")).collect()
        }
        Some("alarm") => ["off", "machine"].map(str::to_owned).to_vec(),
        Some("drill") if before.split_whitespace().count() == 1 => {
            Fault::ALL.into_iter().map(|fault| format!("{fault} ")).chain(["off".to_owned()]).collect()
        }
        Some("drill") => ["at=", "size="].map(str::to_owned).to_vec(),
        Some("search") => ["robust", "full", "stop"].map(str::to_owned).to_vec(),
        Some("choose") => plots().map(str::to_owned).collect(),
        Some("scale") => plots().chain(["auto"]).map(str::to_owned).collect(),
        Some("strips") => series::names().chain(["auto"]).map(str::to_owned).collect(),
        Some("spectrum") => vec!["auto".to_owned()],
        Some("copy") => vec!["settings".to_owned()],
        Some("peak") => vec!["reset".to_owned()],
        Some("read") => ["left", "right", "off"].map(str::to_owned).to_vec(),
        Some(_) => Vec::new(),
    };
    let whole = |candidate: String| if before.is_empty() { candidate } else { format!("{before} {candidate}") };
    candidates.into_iter().filter(|candidate| candidate.starts_with(word)).map(whole).collect()
}

/// What the last word of a line that can follow means there: what a command does, what a setting is. Empty for anything else.
pub(crate) fn meaning(line: &str) -> String {
    let line = line.trim_end();
    let (before, word) = line.rsplit_once(' ').map_or(("", line), |(before, word)| (before, word));
    match (before.split_whitespace().next(), word) {
        (Some("drill"), "off") => return "the fault put back".to_owned(),
        (Some("alarm"), "off") => return "no limit".to_owned(),
        (Some("alarm"), "machine") => return "limits that follow the machine".to_owned(),
        _ => {}
    }
    // Only the first word is a command.
    if before.is_empty()
        && let Some(row) = ACTIONS.iter().find(|row| row.name == word)
    {
        return format!("{} {}", row.argument, row.meaning).trim_start().to_owned();
    }
    if let Ok(fault) = Fault::named(word) {
        return fault.meaning().to_owned();
    }
    let setting = word.strip_suffix('=').and_then(|name| PARAMETERS.iter().find(|parameter| parameter.name == name));
    setting.map_or_else(String::new, |parameter| parameter.meaning.to_owned())
}

/// What all of some lines begin with.
pub(crate) fn common(lines: &[String]) -> String {
    let Some((first, rest)) = lines.split_first() else { return String::new() };
    let alike = |at: usize, c: char| rest.iter().all(|line| line[at.min(line.len())..].starts_with(c));
    let end = first.char_indices().find(|(at, c)| !alike(*at, *c)).map_or(first.len(), |(at, _)| at);
    first[..end].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_means_what_it_does_where_it_stands() {
        assert_eq!(meaning("drill off"), "the fault put back");
        assert_eq!(meaning("alarm force off"), "no limit");
        assert!(meaning("off").contains("control off"), "{}", meaning("off"));
        assert!(!meaning("set kd=").is_empty() && !meaning("drill sensor-lost ").is_empty());
    }

    #[test]
    fn completion_offers_names_settings_and_what_commands_take() {
        let layouts = ["operator".to_owned(), "overview".to_owned()];
        let complete = |line: &str| completions(line, &layouts, &["good".to_owned()]);
        assert_eq!(
            complete("se"),
            ["select ", "set ", "search ", "seek ", "sensor_lag=", "seed=", "sensor_gain=", "sensor_at="]
        );
        assert_eq!(complete("layout o"), ["layout operator", "layout overview"]);
        assert_eq!(complete("load "), ["load good"]);
        assert_eq!(complete("drill sensor-l"), ["drill sensor-lost "]);
        assert_eq!(complete("drill sensor-lost a"), ["drill sensor-lost at="]);
        assert_eq!(complete("strips y.1 rad"), ["strips y.1 radius"]);
        assert_eq!(complete("scale pole"), ["scale poles"]);
        assert!(complete("choose ").contains(&"choose spectrum".to_owned()));
        assert_eq!(complete("set kd=1 sp"), ["set kd=1 speed="]);
        assert!(complete("").len() > 20 && complete("").contains(&"speed=".to_owned()));
        assert_eq!(common(&complete("se")), "se");
        assert_eq!(common(&complete("layout ")), "layout o");
        assert_eq!(common(&["ä".to_owned(), "ö".to_owned()]), "");
        assert_eq!(common(&[]), "");
    }
}
