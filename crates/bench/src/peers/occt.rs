//! OpenCASCADE: GeomAPI_ProjectPointOnSurf, from the last parameters
//! ShapeAnalysis_Surface::NextValueOfUV, grids point by point. Feature `bench-occt`; compiles
//! `occt.cpp` against Debian's libocct-*-dev.
#![allow(unsafe_code)]

use super::Peer;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;
use std::ffi::{c_double, c_int, c_void};
use std::ptr::NonNull;

unsafe extern "C" {
    fn occt_new(
        rows: c_int,
        columns: c_int,
        p: c_int,
        q: c_int,
        nu: c_int,
        u: *const c_double,
        mu: *const c_int,
        nv: c_int,
        v: *const c_double,
        mv: *const c_int,
        points: *const c_double,
        size: c_double,
    ) -> *mut c_void;
    fn occt_free(it: *mut c_void);
    fn occt_closest(
        it: *mut c_void,
        query: *const c_double,
        warm: c_int,
        out: *mut c_double,
    ) -> c_int;
    fn occt_grid(
        it: *mut c_void,
        m: c_int,
        us: *const c_double,
        n: c_int,
        vs: *const c_double,
        points: *mut c_double,
        normals: *mut c_double,
    );
}

pub(super) struct Occt {
    it: NonNull<c_void>,
    has_last: bool,
    points: Vec<f64>,
    normals: Vec<f64>,
}

fn convert(surface: &Surface) -> NonNull<c_void> {
    let clamped = surface.clamped();
    let knots = |knots: &KnotVector| -> (Vec<f64>, Vec<c_int>) {
        knots
            .knots()
            .chunk_by(|a, b| a == b)
            .map(|equal| (equal[0], equal.len() as c_int))
            .unzip()
    };
    let ((u, mu), (v, mv)) = (knots(clamped.knots_u()), knots(clamped.knots_v()));
    let points: Vec<f64> = clamped
        .net()
        .points()
        .iter()
        .flat_map(|p| [p.x, p.y, p.z])
        .collect();
    // SAFETY: the arrays have the lengths given and are copied.
    let it = unsafe {
        occt_new(
            clamped.net().rows() as c_int,
            clamped.net().columns() as c_int,
            clamped.knots_u().degree() as c_int,
            clamped.knots_v().degree() as c_int,
            u.len() as c_int,
            u.as_ptr(),
            mu.as_ptr(),
            v.len() as c_int,
            v.as_ptr(),
            mv.as_ptr(),
            points.as_ptr(),
            clamped.size(),
        )
    };
    NonNull::new(it).expect("OpenCASCADE takes every clamped surface")
}

impl Occt {
    pub fn new(surface: &Surface) -> Self {
        Self {
            it: convert(surface),
            has_last: false,
            points: Vec::new(),
            normals: Vec::new(),
        }
    }
}

impl Drop for Occt {
    fn drop(&mut self) {
        // SAFETY: made by occt_new and freed once.
        unsafe { occt_free(self.it.as_ptr()) }
    }
}

impl Peer for Occt {
    fn name(&self) -> &'static str {
        "OpenCASCADE"
    }

    fn closest(&mut self, q: &Point3, warm: bool) -> Option<Point3> {
        let (query, mut out) = ([q.x, q.y, q.z], [0.0; 3]);
        let warm = c_int::from(warm && self.has_last);
        // SAFETY: three coordinates in, three out.
        let found =
            unsafe { occt_closest(self.it.as_ptr(), query.as_ptr(), warm, out.as_mut_ptr()) };
        self.has_last = found == 1;
        self.has_last.then(|| Point3::from(out))
    }

    fn moved(&mut self, surface: &Surface) {
        *self = Self::new(surface);
    }

    fn grid(
        &mut self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Point3],
        normals: &mut [Vector3],
    ) -> bool {
        let (count, wanted) = (us.len() * vs.len(), !normals.is_empty());
        self.points.resize(3 * count, 0.0);
        self.normals.resize(3 * count, 0.0);
        let (m, n) = (us.len() as c_int, vs.len() as c_int);
        let room = if wanted {
            self.normals.as_mut_ptr()
        } else {
            std::ptr::null_mut()
        };
        // SAFETY: three values a pair in each array; none in a null one.
        unsafe {
            occt_grid(
                self.it.as_ptr(),
                m,
                us.as_ptr(),
                n,
                vs.as_ptr(),
                self.points.as_mut_ptr(),
                room,
            )
        };
        for (point, x) in points.iter_mut().zip(self.points.chunks(3)) {
            *point = Point3::from_slice(x);
        }
        for (normal, x) in normals.iter_mut().zip(self.normals.chunks(3)) {
            *normal = Vector3::from_column_slice(x);
        }
        true
    }
}
