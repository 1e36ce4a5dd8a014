//! Whether clients should be sent here, from the newest figures of the bus.

use super::metrics::LoopMetrics;
use palpate_proto::messages::LoopState;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Figures come ten times a second: after this long without, the bus stands still.
const SILENCE: Duration = Duration::from_secs(2);

/// The newest figures. The bus thread writes them, anybody reads.
#[derive(Debug, Default)]
pub struct Health(Mutex<Option<Newest>>);

#[derive(Debug)]
struct Newest {
    at: Instant,
    figures: LoopMetrics,
    /// The figures as text, once someone has asked for it.
    text: Option<String>,
}

impl Health {
    /// Takes the newest figures.
    pub fn put(&self, figures: LoopMetrics) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Newest {
            at: Instant::now(),
            figures,
            text: None,
        });
    }

    /// The newest figures as [`LoopMetrics::text`], if any have come. However many ask, it is written once for each.
    pub fn text(&self) -> Option<String> {
        let mut newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let Newest { figures, text, .. } = newest.as_mut()?;
        Some(text.get_or_insert_with(|| figures.text()).clone())
    }

    /// Why no one should be sent here, if so: what `/readyz` answers.
    pub fn not_ready(&self) -> Option<&'static str> {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        match &*newest {
            None => Some("no status yet"),
            Some(Newest { at, .. }) if at.elapsed() > SILENCE => Some("no status for two seconds"),
            Some(Newest { figures, .. }) if figures.status.state == LoopState::Stopping => {
                Some("stopping")
            }
            Some(Newest { figures, .. }) if figures.rate_lost => {
                Some("the loop does not keep its rate: forces fade")
            }
            Some(_) => None,
        }
    }

    /// A client has moved a tool.
    pub fn moved(&self) -> bool {
        let newest = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        (newest.as_ref()).is_some_and(|newest| {
            newest
                .figures
                .status
                .tools
                .iter()
                .any(|tool| tool.received > 0)
        })
    }
}
