use super::*;
use crate::contact::*;
use crate::math::*;
pub fn contacts(
    _: PartSide<'_>,
    _: &Point3,
    _: &Vector3,
    _: &Reach,
    _: &mut PartScratch,
    _: &mut ContactSet,
) {
}
