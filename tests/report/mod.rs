//! The HTML page: complete, self-contained, correct, and usable in a browser.

mod browser;
mod contents;
mod subject;
