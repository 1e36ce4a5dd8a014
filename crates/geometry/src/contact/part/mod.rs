pub mod ball;
pub mod plane;
use crate::math::Pose;
use crate::part::{Part, PartSolver};
#[derive(Debug)]
pub struct PartSide<'a> {
    pub part: &'a Part,
    pub pose: &'a Pose,
    pub solver: &'a mut PartSolver,
}
#[derive(Debug)]
pub struct PartScratch;
impl PartScratch {
    pub fn new(_: &Part) -> Self {
        Self
    }
}
