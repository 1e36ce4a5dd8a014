//! Bodies: rigid, and lattices that deform.
