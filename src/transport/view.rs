//! What a viewer is shown.

use super::metrics::LoopMetrics;
use palpate_proto::messages::{ContactSet, ControlNet, LoopStatus, ToolForce};

/// Takes what a viewer shows. Called by the bus thread; must not wait.
pub trait ViewSink: Send {
    /// A tool's newest force.
    fn force(&mut self, tool: usize, force: &ToolForce);
    /// A body's newest net.
    fn net(&mut self, net: &ControlNet);
    /// All contacts, some sixty times a second while there are any, and when they begin and end.
    fn contacts(&mut self, contacts: &ContactSet);
    /// Other bodies than before; nets follow. `gaps`: by body, the rows and columns of its net
    /// after which no line goes on.
    fn bodies(&mut self, ids: &[&str], gaps: Vec<(String, [Vec<usize>; 2])>);
    /// Health.
    fn status(&mut self, status: &LoopStatus);
    /// Everything that is counted, ten times a second.
    fn figures(&mut self, figures: &LoopMetrics);
}

/// The viewer, if there is one.
pub(super) struct View(pub(super) Option<Box<dyn ViewSink>>);

impl View {
    /// Calls `show` if there is a viewer.
    pub(super) fn show(&mut self, show: impl FnOnce(&mut dyn ViewSink)) {
        if let Some(sink) = &mut self.0 {
            show(sink.as_mut());
        }
    }
}
