//! Events for the pages that are open, by server-sent events.

use hyper::body::{Body, Bytes, Frame};
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::task::{Context, Poll};
use tokio::sync::mpsc::{Receiver, Sender, channel};

/// Events that a page may lag behind; one that lags further is cut off and connects again.
const LAG: usize = 64;
/// Most pages that listen at once.
const PAGES: usize = 16;

/// Sends events to all pages that listen. Its copies send to the same pages.
#[derive(Clone, Debug, Default)]
pub struct EventHub(Arc<Mutex<Vec<Sender<Bytes>>>>);

impl EventHub {
    /// Sends an event. `data` must be one line, such as JSON.
    pub fn send(&self, name: &str, data: &str) {
        debug_assert!(!data.contains('\n') && !name.contains('\n'));
        self.send_bytes(&Bytes::from(format!("event: {name}\ndata: {data}\n\n")));
    }

    /// Sends what pages ignore, by which closed connections are noticed.
    pub(crate) fn beat(&self) {
        self.send_bytes(&Bytes::from_static(b":\n\n"));
    }

    /// Number of pages that listen.
    pub(crate) fn listeners(&self) -> usize {
        let mut pages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pages.retain(|page| !page.is_closed());
        pages.len()
    }

    fn send_bytes(&self, bytes: &Bytes) {
        let mut pages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pages.retain(|page| page.try_send(bytes.clone()).is_ok());
    }

    /// The events from now on; the page that has listened longest makes room for one too many.
    pub(crate) fn listen(&self) -> EventStream {
        let (sender, receiver) = channel(LAG);
        // The page is ready once it hears something.
        let _ = sender.try_send(Bytes::from_static(b":\n\n"));
        let mut pages = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        pages.retain(|page| !page.is_closed());
        if pages.len() == PAGES {
            pages.remove(0);
        }
        pages.push(sender);
        EventStream(receiver)
    }
}

/// The body of an answer that ends only when the page goes.
pub(crate) struct EventStream(Receiver<Bytes>);

impl Body for EventStream {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.0.poll_recv(context).map(|bytes| bytes.map(|bytes| Ok(Frame::data(bytes))))
    }
}
