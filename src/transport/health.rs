//! Whether clients should be sent here, from the newest figures of the bus.

use super::metrics::LoopMetrics;
use palpate_proto::messages::LoopState;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Figures come ten times a second: after this long without, the bus stands still.
const SILENCE: Duration = Duration::from_secs(2);

/// The newest figures, and when they came. The bus thread writes them, anybody reads.
#[derive(Debug, Default)]
pub struct Health(Mutex<Option<(Instant, LoopMetrics)>>);

impl Health {
    /// Takes the newest figures.
    pub fn put(&self, figures: LoopMetrics) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some((Instant::now(), figures));
    }

    /// The newest figures, if any have come.
    pub fn figures(&self) -> Option<LoopMetrics> {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        newest.as_ref().map(|(_, figures)| figures.clone())
    }

    /// Why nobody should be sent here, if so: what `/readyz` answers.
    pub fn not_ready(&self) -> Option<&'static str> {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*newest {
            None => Some("no status yet"),
            Some((at, _)) if at.elapsed() > SILENCE => Some("no status for two seconds"),
            Some((_, figures)) if figures.status.state == LoopState::Stopping => Some("stopping"),
            Some((_, figures)) if figures.rate_lost => {
                Some("the loop does not keep its rate: forces fade")
            }
            Some(_) => None,
        }
    }

    /// A client has moved a tool.
    pub fn moved(&self) -> bool {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let figures = newest.as_ref().map(|(_, figures)| figures);
        figures.is_some_and(|figures| figures.status.tools.iter().any(|tool| tool.received > 0))
    }
}
