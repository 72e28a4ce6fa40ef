//! The functions that a page calls. A page puts a request into the memory that [`opm_request`] gives, calls
//! [`opm_answer`], and reads the reply at the places that [`opm_reply`] gives.
#![allow(
    unsafe_code,
    reason = "an exported name is an unsafe attribute; there is no unsafe code behind it"
)]

use crate::session::{Reply, Session};
use std::cell::RefCell;

/// What the page holds in this memory.
#[derive(Default)]
struct Page {
    session: Session,
    request: Vec<u8>,
    reply: Reply,
    /// Where text and bytes of the reply are, and how long they are.
    places: [u32; 4],
}

thread_local! {
    static PAGE: RefCell<Page> = RefCell::default();
}

/// Makes room for a request of this many bytes, and returns its place.
#[unsafe(no_mangle)]
pub extern "C" fn opm_request(length: u32) -> *mut u8 {
    PAGE.with_borrow_mut(|page| {
        page.request.clear();
        page.request.resize(length as usize, 0);
        page.request.as_mut_ptr()
    })
}

/// Answers the request.
#[unsafe(no_mangle)]
pub extern "C" fn opm_answer() {
    PAGE.with_borrow_mut(|page| {
        let request = String::from_utf8_lossy(&page.request);
        page.reply = page.session.answer(&request);
        let Reply { text, bytes } = &page.reply;
        let place = |bytes: &[u8]| [bytes.as_ptr() as u32, bytes.len() as u32];
        let ([text, long], [bytes, many]) = (place(text.as_bytes()), place(bytes));
        page.places = [text, long, bytes, many];
    });
}

/// The place of four 32-bit numbers: place and length of the reply's text, and of its bytes.
#[unsafe(no_mangle)]
pub extern "C" fn opm_reply() -> *const u32 {
    PAGE.with_borrow(|page| page.places.as_ptr())
}
