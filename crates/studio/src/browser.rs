//! Opening of the browser.

/// Opens an address in the user's browser, without waiting for it.
///
/// # Errors
/// No browser that could be started.
pub fn open_address(address: &str) -> std::io::Result<()> {
    open::that_detached(address)
}
