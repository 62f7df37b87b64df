//! The book (`docs/book`), carried in the program: its pages by topic, and any of them as text for a terminal.
//!
//! A topic is a page's file name without its ending. [`parts`] lists them in the order of the book's summary, [`page`] finds one, and
//! [`Page::show`] lays it out: paragraphs and tables wrapped to a width, blocks of commands as they stand, links as the command that
//! shows where they lead. A picture is told by its words.
//!
//! ```
//! use manual::{Look, page};
//!
//! let console = page("console")?;
//! assert!(console.show(80, Look::Plain).starts_with("The console\n"));
//! assert_eq!(page("consol").unwrap_err().to_string(), "no page 'consol': did you mean 'console'?");
//! # Ok::<(), manual::NoPage>(())
//! ```
//!
//! Not its job: printing, and what the pages say. Their Markdown is what mdBook makes HTML of; of it this knows what the pages use, which
//! is headings, paragraphs, lists, tables, fenced blocks, links, pictures, code, bold and italics.

mod block;
mod inline;
mod layout;
mod pages;
mod table;

pub use layout::Look;
pub use pages::{BookPart, NoPage, Page, page, parts, topics};
