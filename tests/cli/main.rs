//! The program as a user meets it at the shell.
#![cfg(feature = "cli")]

mod config;
mod damaged;
mod files;
mod help;
mod messages;
mod models;
mod output;
mod page;
mod stages;
mod support;
mod tune;
