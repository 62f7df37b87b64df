//! A file of ROSS, TOML or JSON, as a list of elements with names and numbers.

use std::collections::BTreeMap;
use std::ops::Range as Span;

use text::{Fault, Faults, Reader};
use toml::de::DeValue;

/// A value of the file, as far as elements need it.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Bool(bool),
    Text(String),
    List(Vec<Value>),
    Table(BTreeMap<String, Value>),
    /// JSON has it for what is not given.
    Absent,
}

/// One element of the rotor.
#[derive(Debug, Default)]
pub(super) struct Element {
    /// `ClassName_tag`, as the file has it.
    pub(super) name: String,
    /// Where that name stands.
    pub(super) span: Span<usize>,
    keys: BTreeMap<String, Value>,
}

/// The file.
pub(super) struct Document<'t> {
    pub(super) text: &'t str,
    /// The version of ROSS that wrote it.
    pub(super) version: Option<String>,
    /// What is said of the rotor as a whole.
    pub(super) parameters: Element,
    /// From left to right.
    pub(super) elements: Vec<Element>,
    /// All that is wrong so far.
    pub(super) faults: Vec<Fault>,
}

impl Element {
    /// The class of the element.
    pub(super) fn class(&self) -> &str {
        self.name.split('_').next().unwrap_or_default()
    }

    /// What stands after the class.
    pub(super) fn tag(&self) -> &str {
        self.name.split_once('_').map_or("", |(_, tag)| tag)
    }

    /// The value under `key`, if it is given.
    pub(super) fn get(&self, key: &str) -> Option<&Value> {
        self.keys.get(key).filter(|value| **value != Value::Absent)
    }

    /// All keys that are given.
    pub(super) fn keys(&self) -> impl Iterator<Item = &str> {
        self.keys.iter().filter(|(_, value)| **value != Value::Absent).map(|(key, _)| key.as_str())
    }

    /// The table under `key` as an element of the same name.
    pub(super) fn table(&self, key: &str) -> Option<Self> {
        match self.get(key)? {
            Value::Table(keys) => Some(Self { name: self.name.clone(), span: self.span.clone(), keys: keys.clone() }),
            _ => None,
        }
    }
}

impl<'t> Document<'t> {
    /// Parses `text`: JSON where it begins with a brace, otherwise TOML.
    pub(super) fn parse(text: &'t str) -> Result<Self, Faults> {
        let table = if text.trim_start().starts_with('{') { json(text)? } else { toml(text)? };
        let mut document =
            Self { text, version: None, parameters: Element::default(), elements: Vec::new(), faults: Vec::new() };
        for (name, value) in table {
            match (name.as_str(), value) {
                ("ross_version", Value::Text(version)) => document.version = Some(version),
                ("parameters", Value::Table(keys)) => {
                    document.parameters = Element { span: place(text, &name), name, keys };
                }
                (_, _) if name.starts_with('_') => {}
                (_, Value::Table(keys)) => {
                    document.elements.push(Element { span: place(text, &name), name, keys });
                }
                _ => {
                    let at = place(text, &name);
                    document.fault(&at, name, "a file that ROSS has saved: a table for every element");
                }
            }
        }
        // From left to right, and in the order of the file within a node.
        let node = |element: &Element| match element.get("n") {
            Some(Value::Number(n)) => *n,
            _ => f64::INFINITY,
        };
        document.elements.sort_by(|a, b| node(a).total_cmp(&node(b)).then(a.span.start.cmp(&b.span.start)));
        Ok(document)
    }

    /// Notes a fault.
    pub(super) fn fault(&mut self, at: &Span<usize>, found: impl Into<String>, expected: impl Into<String>) {
        self.faults.push(Fault::at(self.text, at.clone(), found, expected));
    }

    /// The number under `key` of an element; `otherwise` where it is not given.
    pub(super) fn number(&mut self, element: &Element, key: &str, otherwise: Option<f64>) -> f64 {
        let found = match (element.get(key), otherwise) {
            (Some(Value::Number(number)), _) if number.is_finite() => return *number,
            (Some(Value::List(list)), _) => match list.as_slice() {
                [Value::Number(number)] if number.is_finite() => return *number,
                _ => format!("a list of {} for {key}", list.len()),
            },
            (None, Some(otherwise)) => return otherwise,
            (None, None) => format!("no {key}"),
            (Some(_), _) => format!("{key} that is no finite number"),
        };
        self.fault(&element.span, format!("{}: {found}", element.name), format!("{key} = a finite number"));
        f64::NAN
    }

    /// The numbers under `key` of an element, one or a list of them; none where it is not given.
    pub(super) fn numbers(&mut self, element: &Element, key: &str) -> Vec<f64> {
        let list = match element.get(key) {
            None => return vec![],
            Some(Value::List(list)) => list.as_slice(),
            Some(one) => std::slice::from_ref(one),
        };
        let numbers: Option<Vec<f64>> = list
            .iter()
            .map(|value| match value {
                Value::Number(number) if number.is_finite() => Some(*number),
                _ => None,
            })
            .collect();
        numbers.unwrap_or_else(|| {
            let found = format!("{}: {key} that is not all finite numbers", element.name);
            self.fault(&element.span, found, "a number or a list of them");
            vec![]
        })
    }

    /// The truth under `key` of an element.
    pub(super) fn boolean(&mut self, element: &Element, key: &str, otherwise: bool) -> bool {
        match element.get(key) {
            None => otherwise,
            Some(Value::Bool(value)) => *value,
            Some(_) => {
                self.fault(&element.span, format!("{}: {key}", element.name), "true or false");
                otherwise
            }
        }
    }

    /// The node under `key` of an element, which has to be one of the shaft's `nodes`.
    pub(super) fn node(&mut self, element: &Element, nodes: usize) -> usize {
        let n = self.number(element, "n", None);
        if n >= 0.0 && n < nodes as f64 && n.fract() == 0.0 {
            return n as usize;
        }
        if n.is_finite() {
            let found = format!("{}: n = {n}", element.name);
            self.fault(&element.span, found, format!("a node of the shaft, 0 to {}", nodes.saturating_sub(1)));
        }
        0
    }
}

/// Where the name of an element stands: as a key of JSON, or as a header of TOML.
fn place(text: &str, name: &str) -> Span<usize> {
    let quoted = format!("\"{name}\"");
    let header = format!("[{name}]");
    let at = text.find(&quoted).map(|at| (at, quoted.len()));
    let (at, length) = at.or_else(|| text.find(&header).map(|at| (at, header.len()))).unwrap_or((0, 0));
    at..at + length
}

fn json(text: &str) -> Result<BTreeMap<String, Value>, Faults> {
    fn value(of: serde_json::Value) -> Value {
        use serde_json::Value as Json;
        match of {
            Json::Null => Value::Absent,
            Json::Bool(truth) => Value::Bool(truth),
            Json::Number(number) => Value::Number(number.as_f64().unwrap_or(f64::NAN)),
            Json::String(text) => Value::Text(text),
            Json::Array(list) => Value::List(list.into_iter().map(value).collect()),
            Json::Object(table) => Value::Table(table.into_iter().map(|(key, of)| (key, value(of))).collect()),
        }
    }
    let parsed: serde_json::Map<String, serde_json::Value> = serde_json::from_str(text).map_err(|error| {
        let before: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
        let line = text.get(before..).unwrap_or_default();
        let column: usize = line.chars().take(error.column().saturating_sub(1)).map(char::len_utf8).sum();
        let told = error.to_string();
        let found = told.split(" at line ").next().unwrap_or_default().to_owned();
        Faults::from(Fault::at(text, before + column..before + column, found, "JSON that ROSS has saved"))
    })?;
    Ok(parsed.into_iter().map(|(key, of)| (key, value(of))).collect())
}

fn toml(text: &str) -> Result<BTreeMap<String, Value>, Faults> {
    fn table(of: &text::Table<'_>) -> BTreeMap<String, Value> {
        of.iter().map(|(key, of)| (key.get_ref().to_string(), value(of))).collect()
    }
    fn value(of: &text::Value<'_>) -> Value {
        match of.get_ref() {
            DeValue::Boolean(truth) => Value::Bool(*truth),
            DeValue::String(text) => Value::Text(text.to_string()),
            DeValue::Array(list) => Value::List(list.iter().map(value).collect()),
            DeValue::Table(of) => Value::Table(table(of)),
            _ => text::as_number(of).map_or(Value::Absent, Value::Number),
        }
    }
    let (_, parsed) = Reader::parse(text)?;
    Ok(table(&parsed))
}
