//! What is being done, for whoever waits.

/// Receives what is being done.
pub trait Observer: Send + Sync {
    /// A step begins.
    fn step(&self, what: &str);

    /// Steps that were done before are passed over; they do not count for the rate.
    fn skip(&self, _steps: usize) {}

    /// One step more is done.
    fn advance(&self) {}
}

/// The progress of a long computation.
pub struct Progress {
    observer: Option<Box<dyn Observer>>,
}

impl std::fmt::Debug for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress").field("observed", &self.observer.is_some()).finish()
    }
}

impl Progress {
    /// Nobody watches.
    pub const fn silent() -> Self {
        Self { observer: None }
    }

    /// `observer` watches.
    pub fn observed(observer: impl Observer + 'static) -> Self {
        Self { observer: Some(Box::new(observer)) }
    }

    /// Says what begins.
    pub fn step(&self, what: impl Into<String>) {
        if let Some(observer) = &self.observer {
            observer.step(&what.into());
        }
    }

    /// Passes over steps that were done before; they do not count for the rate.
    pub fn skip(&self, steps: usize) {
        if let Some(observer) = &self.observer {
            observer.skip(steps);
        }
    }

    /// Notes that one step more is done.
    pub fn advance(&self) {
        if let Some(observer) = &self.observer {
            observer.advance();
        }
    }
}
