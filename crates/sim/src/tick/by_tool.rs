//! Values by tool, as many as a scene has tools.

use super::record::ToolOutput;
use crate::haptics::DevicePose;
use std::ops::{Index, IndexMut};
use std::sync::LazyLock;

/// Values by tool index. Tools beyond its length have the default, so that an empty one fits any
/// scene; writing to one of them makes room, which allocates.
#[derive(Debug, Default)]
pub struct ByTool<T>(Vec<T>);

/// A type whose default stands for a tool about which nothing is known.
pub trait Absent: Clone + Default + PartialEq + 'static {
    /// The default, as a static.
    fn absent() -> &'static Self;
}

impl Absent for Option<DevicePose> {
    fn absent() -> &'static Self {
        &None
    }
}

impl Absent for ToolOutput {
    fn absent() -> &'static Self {
        static ABSENT: LazyLock<ToolOutput> = LazyLock::new(ToolOutput::default);
        &ABSENT
    }
}

impl<T: Absent> ByTool<T> {
    /// Defaults for `tool_count` tools.
    pub fn for_tools(tool_count: usize) -> Self {
        Self(vec![T::default(); tool_count])
    }

    /// Back to defaults for `tool_count` tools. Allocates nothing where there is room.
    pub fn reset(&mut self, tool_count: usize) {
        self.0.clear();
        self.0.resize(tool_count, T::default());
    }

    /// Replaces all; tools beyond the end of `values` have the default.
    pub fn set(&mut self, values: &[T]) {
        self.0.clear();
        self.0.extend_from_slice(values);
    }

    /// The values of the first `tool_count` tools.
    pub fn first(&self, tool_count: usize) -> impl Iterator<Item = &T> {
        (0..tool_count).map(|tool| &self[tool])
    }

    /// The stored values: as many as there is room for.
    pub fn as_slice(&self) -> &[T] {
        &self.0
    }

    /// The stored values, mutable.
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.0
    }
}

impl<T: Clone> Clone for ByTool<T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }

    /// Allocates nothing where there is room for as many tools.
    fn clone_from(&mut self, from: &Self) {
        self.0.clone_from(&from.0);
    }
}

/// Equal values; room does not count.
impl<T: Absent> PartialEq for ByTool<T> {
    fn eq(&self, other: &Self) -> bool {
        let tools = self.0.len().max(other.0.len());
        self.first(tools).eq(other.first(tools))
    }
}

impl<T: Absent> Index<usize> for ByTool<T> {
    type Output = T;

    fn index(&self, tool: usize) -> &T {
        self.0.get(tool).unwrap_or_else(|| T::absent())
    }
}

impl<T: Absent> IndexMut<usize> for ByTool<T> {
    fn index_mut(&mut self, tool: usize) -> &mut T {
        if tool >= self.0.len() {
            self.0.resize(tool + 1, T::default());
        }
        &mut self.0[tool]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tools_beyond_the_end_have_the_default_until_somebody_writes() {
        let mut outputs = ByTool::<ToolOutput>::default();
        assert_eq!(outputs, ByTool::for_tools(64));
        assert_eq!(outputs[63], ToolOutput::default());
        outputs[5].flags = 1;
        assert_ne!(outputs, ByTool::for_tools(64));
        assert_eq!(outputs.as_slice().len(), 6);
        assert_eq!(
            outputs.first(8).filter(|output| output.flags == 1).count(),
            1
        );
        outputs.reset(3);
        assert_eq!(outputs, ByTool::default());
        assert_eq!(ByTool::<Option<DevicePose>>::default()[7], None);
    }
}
