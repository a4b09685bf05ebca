//! Exit codes.

/// How the program ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Exit {
    /// Success.
    Success,
    /// Something failed: a file, a format, the disk.
    Failed,
    /// The command line or the configuration is wrong.
    Usage,
    /// Stopped by Ctrl-C or a signal to end.
    Interrupted,
}

impl Exit {
    /// The number handed to the shell.
    pub(crate) fn code(self) -> u8 {
        match self {
            Self::Success => 0,
            Self::Failed => 1,
            Self::Usage => 2,
            Self::Interrupted => 130,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_that_shells_expect() {
        let all = [Exit::Success, Exit::Failed, Exit::Usage, Exit::Interrupted];
        assert_eq!(all.map(Exit::code), [0, 1, 2, 130]);
    }
}
