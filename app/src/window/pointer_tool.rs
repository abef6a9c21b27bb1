//! The tool that has the pointer in the image.

/// What a drag of the pointer over the image does. One tool is in use at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum PointerTool {
    /// Moves the camera, and the handles in the image.
    #[default]
    Camera,
    /// Cuts hair along a line.
    Scissors,
    /// Brushes hair.
    Brush,
    /// Paints the mask of the selected layer.
    Mask,
    /// Paints where hair grows.
    Scalp,
}

impl PointerTool {
    /// Takes `tool` up, or puts it down if it is in use.
    pub(crate) fn toggle(&mut self, tool: Self) {
        self.set(tool, *self != tool);
    }

    /// Takes `tool` up or puts it down. Putting down a tool that is not in use changes nothing.
    pub(crate) fn set(&mut self, tool: Self, used: bool) {
        if used {
            *self = tool;
        } else if *self == tool {
            *self = Self::Camera;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::PointerTool::{self, Brush, Camera, Mask, Scissors};

    #[test]
    fn one_tool_is_in_use_at_a_time() {
        let mut tool = PointerTool::default();
        tool.toggle(Scissors);
        tool.toggle(Brush);
        assert_eq!(tool, Brush, "it takes the place of the scissors");
        tool.set(Mask, false);
        assert_eq!(tool, Brush, "another tool is put down");
        tool.toggle(Brush);
        assert_eq!(tool, Camera);
    }
}
