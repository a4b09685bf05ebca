//! The page for people who would rather look: whole, closed, true, and usable in a browser.

mod browser;
mod contents;
mod subject;
