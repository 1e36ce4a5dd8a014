//! Other libraries, each behind one small adapter.

#[cfg(feature = "peers")]
mod curvo;
#[cfg(feature = "occt")]
mod occt;
mod parry;
pub(super) mod python;
#[cfg(feature = "peers")]
pub(super) mod rapier;
#[cfg(feature = "sisl")]
mod sisl;

use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;

/// What we ask of another library.
pub(super) trait Peer {
    fn name(&self) -> &'static str;

    /// The nearest point it finds; `warm` lets it start from its last answer.
    fn closest(&mut self, query: &Point3, warm: bool) -> Option<Point3>;

    /// Takes over a net that moved.
    fn moved(&mut self, surface: &Surface);

    /// Points, and unit normals unless `normals` is empty, at all pairs of parameters, u-major;
    /// false if it cannot.
    fn grid(
        &mut self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Point3],
        normals: &mut [Vector3],
    ) -> bool;
}

/// Runs peers without the messages of panics that their adapters catch.
pub(super) fn quietly<T>(work: impl FnOnce() -> T) -> T {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let answer = work();
    std::panic::set_hook(hook);
    answer
}

/// Libraries that this build leaves out, and how to build with them; none if it has them all.
pub const LEFT_OUT: Option<&str> = if cfg!(feature = "peers") {
    None
} else {
    Some("curvo and rapier3d are not in this build; to compare with them, add --features peers")
};

/// All that this build has, with one surface.
pub(super) fn all(surface: &Surface) -> Vec<Box<dyn Peer>> {
    vec![
        Box::new(parry::Parry::new(surface)),
        #[cfg(feature = "peers")]
        Box::new(curvo::Curvo::new(surface)),
        #[cfg(feature = "sisl")]
        Box::new(sisl::Sisl::new(surface)),
        #[cfg(feature = "occt")]
        Box::new(occt::Occt::new(surface)),
    ]
}
