//! The server behind `vtex studio`: a page that is served to this machine alone.
//!
//! [`StudioServer`] listens on the loopback interface, lets only its own page in ([`guard`]), bounds every
//! request in size and time, and hands calls to an [`App`]. It knows nothing of textures. [`elements`] mends
//! the masks of a photograph, and [`work`] is the document in which work is kept.

mod answer;
mod browser;
mod call;
pub mod elements;
mod events;
pub mod guard;
mod page;
mod server;
pub mod work;

pub use answer::{Content, StudioAnswer};
pub use browser::open_address;
pub use call::{Caller, StudioCall, Verb};
pub use events::EventHub;
pub use server::{Bounds, StudioServer};

/// What answers the calls of the page.
pub trait App: Send + Sync + 'static {
    /// Answers a call that the guard has let in. It may take its time: other calls are answered meanwhile.
    fn answer(&self, call: StudioCall) -> StudioAnswer;
}
