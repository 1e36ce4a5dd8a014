//! Parts: rigid bodies of trimmed faces, which have no net.

use super::rigid;
use crate::scene::door::At;
use crate::scene::spec::BodySpec;
use palpate_geometry::part::Part;

/// Refuses what only a net can do.
pub(super) fn check(spec: &BodySpec, at: &At<'_>, part: &Part) -> Option<()> {
    let before = at.problem_count();
    let faces = part.faces().len();
    if spec.model().model().deforms() {
        at.key("model").refuse(format!(
            "model = {:?} deforms a net of control points, and the file holds a part of {faces} trimmed faces; use model = \
             \"rigid\", or fit a surface to it: palpate surface tessellate, then palpate surface fit",
            spec.model().name()
        ));
    }
    rigid::check(spec, at);
    let given = [
        ("fixed", !spec.fixed.is_empty()),
        ("region", !spec.regions.is_empty()),
    ];
    for (key, given) in given {
        if given {
            at.key(key)
                .refuse("a part is rigid and has no nodes to hold or to change; drop it");
        }
    }
    (at.problem_count() == before).then_some(())
}
