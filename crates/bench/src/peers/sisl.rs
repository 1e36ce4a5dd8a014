//! SISL (SINTEF): global closest points by s1954, from the last parameters by s1775, grids by
//! s1506. Feature `bench-sisl`; links Debian's libsisl-dev.
#![allow(unsafe_code)]

use super::Peer;
use palpate_geometry::basis::KnotVector;
use palpate_geometry::math::{Point3, Vector3};
use palpate_geometry::surface::Surface;
use std::ffi::{c_double, c_int};
use std::ptr::NonNull;

#[repr(C)]
struct SislSurf {
    _opaque: [u8; 0],
}

#[allow(non_snake_case)]
unsafe extern "C" {
    fn newSurf(
        n1: c_int,
        n2: c_int,
        order1: c_int,
        order2: c_int,
        t1: *const c_double,
        t2: *const c_double,
        coefficients: *const c_double,
        kind: c_int,
        dimension: c_int,
        copy: c_int,
    ) -> *mut SislSurf;
    fn freeSurf(surface: *mut SislSurf);
    fn freeIntcrvlist(curves: *mut *mut u8, count: c_int);
    fn s1954(
        surface: *mut SislSurf,
        point: *const c_double,
        dimension: c_int,
        unused: c_double,
        tolerance: c_double,
        count: *mut c_int,
        parameters: *mut *mut c_double,
        curve_count: *mut c_int,
        curves: *mut *mut *mut u8,
        status: *mut c_int,
    );
    fn s1775(
        surface: *mut SislSurf,
        point: *const c_double,
        dimension: c_int,
        tolerance: c_double,
        start: *const c_double,
        end: *const c_double,
        guess: *const c_double,
        parameters: *mut c_double,
        status: *mut c_int,
    );
    fn s1506(
        surface: *mut SislSurf,
        derivatives: c_int,
        m1: c_int,
        x: *const c_double,
        m2: c_int,
        y: *const c_double,
        values: *mut c_double,
        normals: *mut c_double,
        status: *mut c_int,
    );
    fn s1421(
        surface: *mut SislSurf,
        derivatives: c_int,
        parameters: *const c_double,
        left1: *mut c_int,
        left2: *mut c_int,
        values: *mut c_double,
        normal: *mut c_double,
        status: *mut c_int,
    );
    fn free(pointer: *mut c_double);
}

/// Its geometric tolerance, m.
const TOLERANCE: f64 = 1e-9;

pub(super) struct Sisl {
    surface: NonNull<SislSurf>,
    domain: [[f64; 2]; 2],
    last: Option<[f64; 2]>,
    values: Vec<f64>,
    across: Vec<f64>,
}

fn convert(surface: &Surface) -> NonNull<SislSurf> {
    let clamped = surface.clamped();
    let (rows, columns) = (clamped.net().rows(), clamped.net().columns());
    // Its first parameter runs fastest.
    let coefficients: Vec<f64> = (0..columns)
        .flat_map(|j| (0..rows).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            let p = clamped.net().at(i, j);
            [p.x, p.y, p.z]
        })
        .collect();
    let order = |knots: &KnotVector| knots.degree() as c_int + 1;
    let (u, v) = (clamped.knots_u(), clamped.knots_v());
    // SAFETY: the arrays have the lengths that counts and orders say, and are copied (last argument
    // 1).
    let made = unsafe {
        newSurf(
            rows as c_int,
            columns as c_int,
            order(u),
            order(v),
            u.knots().as_ptr(),
            v.knots().as_ptr(),
            coefficients.as_ptr(),
            1,
            3,
            1,
        )
    };
    NonNull::new(made).expect("SISL is out of memory")
}

impl Sisl {
    pub fn new(surface: &Surface) -> Self {
        let domain = [surface.knots_u(), surface.knots_v()].map(|knots| knots.domain().into());
        Self {
            surface: convert(surface),
            domain,
            last: None,
            values: Vec::new(),
            across: Vec::new(),
        }
    }

    fn point(&mut self, at: [f64; 2]) -> Option<Point3> {
        let (mut left, mut status, mut value, mut normal) = ([0; 2], 0, [0.0; 3], [0.0; 3]);
        let [left1, left2] = &mut left;
        // SAFETY: order 0 writes three values.
        unsafe {
            s1421(
                self.surface.as_ptr(),
                0,
                at.as_ptr(),
                left1,
                left2,
                value.as_mut_ptr(),
                normal.as_mut_ptr(),
                &mut status,
            );
        }
        (status >= 0).then(|| Point3::from(value))
    }

    fn search(&self, q: &Point3) -> Option<[f64; 2]> {
        let (mut count, mut curve_count, mut status) = (0, 0, 0);
        let (mut parameters, mut curves) = (std::ptr::null_mut(), std::ptr::null_mut());
        let query = [q.x, q.y, q.z];
        // SAFETY: it allocates `parameters` (2 × count values) and `curves`; both are freed here.
        unsafe {
            s1954(
                self.surface.as_ptr(),
                query.as_ptr(),
                3,
                0.0,
                TOLERANCE,
                &mut count,
                &mut parameters,
                &mut curve_count,
                &mut curves,
                &mut status,
            );
            let found = (status >= 0 && count > 0 && !parameters.is_null())
                .then(|| [*parameters, *parameters.add(1)]);
            free(parameters);
            if !curves.is_null() {
                freeIntcrvlist(curves, curve_count);
            }
            found
        }
    }
}

impl Drop for Sisl {
    fn drop(&mut self) {
        // SAFETY: made by newSurf and freed once.
        unsafe { freeSurf(self.surface.as_ptr()) }
    }
}

impl Peer for Sisl {
    fn name(&self) -> &'static str {
        "SISL"
    }

    fn closest(&mut self, q: &Point3, warm: bool) -> Option<Point3> {
        self.last = match self.last.filter(|_| warm) {
            Some(guess) => {
                let (query, mut found, mut status) = ([q.x, q.y, q.z], [0.0; 2], 0);
                let [[a, b], [c, d]] = self.domain;
                // SAFETY: three coordinates and pairs of parameters, as it wants them.
                unsafe {
                    s1775(
                        self.surface.as_ptr(),
                        query.as_ptr(),
                        3,
                        TOLERANCE,
                        [a, c].as_ptr(),
                        [b, d].as_ptr(),
                        guess.as_ptr(),
                        found.as_mut_ptr(),
                        &mut status,
                    );
                }
                (status >= 0).then_some(found)
            }
            None => self.search(q),
        };
        self.point(self.last?)
    }

    fn moved(&mut self, surface: &Surface) {
        // SAFETY: made by newSurf, and replaced before anyone sees it again.
        unsafe { freeSurf(self.surface.as_ptr()) }
        self.surface = convert(surface);
    }

    fn grid(
        &mut self,
        us: &[f64],
        vs: &[f64],
        points: &mut [Point3],
        normals: &mut [Vector3],
    ) -> bool {
        let count = us.len() * vs.len();
        let order = i32::from(!normals.is_empty());
        let each = if order == 1 { 9 } else { 3 };
        self.values.resize(each * count, 0.0);
        self.across.resize(3 * count, 0.0);
        let mut status = 0;
        // SAFETY: order 1 writes point, S_u and S_v, nine values a pair; order 0 three.
        unsafe {
            s1506(
                self.surface.as_ptr(),
                order,
                us.len() as c_int,
                us.as_ptr(),
                vs.len() as c_int,
                vs.as_ptr(),
                self.values.as_mut_ptr(),
                self.across.as_mut_ptr(),
                &mut status,
            );
        }
        // The first parameter runs fastest; its normals have no length of their own.
        for i in 0..us.len() {
            for j in 0..vs.len() {
                let (k, theirs) = (i * vs.len() + j, j * us.len() + i);
                points[k] = Point3::from_slice(&self.values[each * theirs..each * theirs + 3]);
                if let Some(normal) = normals.get_mut(k) {
                    *normal = Vector3::from_column_slice(&self.across[3 * theirs..3 * theirs + 3])
                        .normalize();
                }
            }
        }
        status >= 0
    }
}
