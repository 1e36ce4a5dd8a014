//! From triangles as they come from a file to a solid, or a reason why they bound none.

use crate::math::{MOST_COORDINATE_M, Point3, first_outside};

/// Why a mesh cannot be a tool.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A part with faces that are missing or inconsistent.
    #[error(
        "the part is not closed, so it has no inside; a tool must be a solid: close it in the CAD system that wrote it"
    )]
    OpenPart,
    /// Fewer triangles than a tetrahedron has.
    #[error("the mesh has {triangles} triangles with three corners; a solid needs at least 4")]
    Few {
        /// How many.
        triangles: usize,
    },
    /// A coordinate that is not finite, or too large to calculate with.
    #[error(
        "vertex {vertex} is {position:?} m; coordinates are finite numbers within ±{MOST_COORDINATE_M:e} m"
    )]
    NotFinite {
        /// Which, as given.
        vertex: usize,
        /// Its position, m.
        position: [f64; 3],
    },
    /// A triangle over a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}; there are {vertices}")]
    Index {
        /// Which, as given.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// A triangle without area.
    #[error("triangle {triangle} has no area; merge its corners or remove it")]
    Degenerate {
        /// Which, as given.
        triangle: usize,
    },
    /// Edges with a triangle on one side only.
    #[error(
        "the mesh is not closed: {edges} edges have one triangle only, the first from {from:?} to {to:?} (m)"
    )]
    Open {
        /// How many.
        edges: usize,
        /// Start of the first, m.
        from: [f64; 3],
        /// Its end, m.
        to: [f64; 3],
    },
    /// An edge that two triangles run along in the same direction, or more than two share.
    #[error(
        "the edge from {from:?} to {to:?} (m) has two triangles that disagree which side is out, or more than two"
    )]
    Orientation {
        /// Start, m.
        from: [f64; 3],
        /// End, m.
        to: [f64; 3],
    },
    /// No volume.
    #[error("the mesh encloses {volume_m3} m³, nothing for its size of {size_m} m")]
    Flat {
        /// Enclosed volume, m³.
        volume_m3: f64,
        /// Size, m.
        size_m: f64,
    },
    /// What the distance queries cannot take.
    #[error("the mesh is refused: {reason}")]
    Refused {
        /// What the distance queries cannot take about it.
        reason: String,
    },
}

/// A mesh that bounds a volume: closed, oriented outwards, no vertex twice.
pub(super) struct Sound {
    pub vertices: Vec<Point3>,
    pub triangles: Vec<[u32; 3]>,
    pub volume_m3: f64,
    pub size_m: f64,
}

pub(super) fn check(vertices: &[Point3], triangles: &[[u32; 3]]) -> Result<Sound, MeshError> {
    if let Some((vertex, _)) = first_outside(vertices) {
        return Err(MeshError::NotFinite {
            vertex,
            position: vertices[vertex].coords.into(),
        });
    }
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&k| k as usize >= vertices.len()) {
            return Err(MeshError::Index {
                triangle,
                vertex,
                vertices: vertices.len(),
            });
        }
    }
    let (vertices, names) = merge(vertices);
    let mut kept = Vec::with_capacity(triangles.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|k| names[k as usize]);
        if a == b || b == c || c == a {
            continue;
        }
        let [p, q, r] = [a, b, c].map(|k| vertices[k as usize]);
        let (x, y) = (q - p, r - p);
        let longest = x.norm().max(y.norm()).max((r - q).norm());
        if x.cross(&y).norm() <= 1e-12 * longest * longest {
            return Err(MeshError::Degenerate { triangle });
        }
        kept.push([a, b, c]);
    }
    if kept.len() < 4 {
        return Err(MeshError::Few {
            triangles: kept.len(),
        });
    }
    closed(&vertices, &kept)?;
    let (low, high) = vertices
        .iter()
        .fold((vertices[0], vertices[0]), |(l, h), p| (l.inf(p), h.sup(p)));
    let (size_m, middle) = ((high - low).norm(), low + (high - low) * 0.5);
    let volume_m3: f64 = kept
        .iter()
        .map(|t| {
            let [p, q, r] = t.map(|k| vertices[k as usize] - middle);
            p.dot(&q.cross(&r)) / 6.0
        })
        .sum();
    if volume_m3.abs() <= 1e-12 * size_m * size_m * size_m {
        return Err(MeshError::Flat { volume_m3, size_m });
    }
    if volume_m3 < 0.0 {
        kept.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Ok(Sound {
        vertices,
        triangles: kept,
        volume_m3: volume_m3.abs(),
        size_m,
    })
}

/// One vertex for each place, along a curve that keeps neighbours together; and the new number of
/// each old one.
fn merge(vertices: &[Point3]) -> (Vec<Point3>, Vec<u32>) {
    let Some(first) = vertices.first() else {
        return (vec![], vec![]);
    };
    let (low, high) = vertices
        .iter()
        .fold((*first, *first), |(l, h), p| (l.inf(p), h.sup(p)));
    let scale = (high - low).amax().max(f64::MIN_POSITIVE);
    // Morton order: the bits of the three coordinates in turn.
    let code = |p: &Point3| {
        let cell = (p - low).map(|x| ((x / scale) * 65_535.0) as u64);
        (0..16).fold(0_u64, |code, bit| {
            code | (0..3).fold(0, |code, c| {
                code | ((cell[c] >> bit) & 1) << (3 * bit + c as u64)
            })
        })
    };
    // −0 is 0.
    let key = |p: &Point3| p.coords.map(|x| x + 0.0);
    let mut order: Vec<(u64, usize)> = vertices
        .iter()
        .enumerate()
        .map(|(k, p)| (code(p), k))
        .collect();
    order.sort_unstable_by(|a, b| {
        let (p, q) = (key(&vertices[a.1]), key(&vertices[b.1]));
        let place =
            p.x.total_cmp(&q.x)
                .then(p.y.total_cmp(&q.y))
                .then(p.z.total_cmp(&q.z));
        a.0.cmp(&b.0).then(place).then(a.1.cmp(&b.1))
    });
    let (mut merged, mut names): (Vec<Point3>, Vec<u32>) = (Vec::new(), vec![0; vertices.len()]);
    for (_, k) in order {
        let p = Point3::from(key(&vertices[k]));
        if merged.last() != Some(&p) {
            merged.push(p);
        }
        names[k] = merged.len() as u32 - 1;
    }
    (merged, names)
}

/// Every edge has one triangle on each side, which run along it in opposite directions.
fn closed(vertices: &[Point3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    let mut edges: Vec<(u32, u32)> = triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .collect();
    edges.sort_unstable();
    let place = |k: u32| vertices[k as usize].coords.into();
    if let Some(twice) = edges.windows(2).find(|w| w[0] == w[1]) {
        return Err(MeshError::Orientation {
            from: place(twice[0].0),
            to: place(twice[0].1),
        });
    }
    let mut alone = edges
        .iter()
        .filter(|&&(a, b)| edges.binary_search(&(b, a)).is_err());
    match alone.next() {
        None => Ok(()),
        Some(&(a, b)) => Err(MeshError::Open {
            edges: 1 + alone.count(),
            from: place(a),
            to: place(b),
        }),
    }
}
