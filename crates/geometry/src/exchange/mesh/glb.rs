//! glTF 2.0, binary: one mesh with positions, normals and indices, little-endian.

use super::{MeshFileError, check};
use crate::surface::Mesh;

/// Buffers of corners and of indices, in the format's numbers.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

/// The file of a mesh, in metres. The mesh keeps its coordinates; a node turns our z up to the
/// format's y up.
///
/// # Errors
/// A mesh that is empty, or whose parts do not fit each other or the format.
pub fn write(mesh: &Mesh) -> Result<Vec<u8>, MeshFileError> {
    check(mesh)?;
    let (corners, triangles) = (mesh.points.len(), mesh.triangles.len());
    let mut body = Vec::with_capacity(24 * corners + 12 * triangles);
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in &mesh.points {
        for (k, x) in point.iter().enumerate() {
            let x = *x as f32;
            (low[k], high[k]) = (low[k].min(x), high[k].max(x));
            body.extend_from_slice(&x.to_le_bytes());
        }
    }
    for normal in &mesh.normals {
        // The format has unit normals only; where there is none, any will do.
        let normal = normal
            .try_normalize(0.0)
            .filter(|n| n.iter().all(|x| x.is_finite()));
        let normal = normal.unwrap_or_else(crate::math::Vector3::z);
        body.extend(normal.iter().flat_map(|x| (*x as f32).to_le_bytes()));
    }
    body.extend(
        mesh.triangles
            .iter()
            .flatten()
            .flat_map(|corner| corner.to_le_bytes()),
    );
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let document = serde_json::json!({
        "asset": {"version": "2.0", "generator": concat!("palpate ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "surface", "rotation": [-half, 0.0, 0.0, half]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "mode": 4}]}],
        "accessors": [
            {"bufferView": 0, "componentType": FLOAT, "count": corners, "type": "VEC3", "min": low, "max": high},
            {"bufferView": 1, "componentType": FLOAT, "count": corners, "type": "VEC3"},
            {"bufferView": 2, "componentType": UNSIGNED_INT, "count": 3 * triangles, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 12 * corners, "target": ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": 12 * corners, "byteLength": 12 * corners, "target": ARRAY_BUFFER},
            {"buffer": 0, "byteOffset": 24 * corners, "byteLength": 12 * triangles, "target": ELEMENT_ARRAY_BUFFER},
        ],
        "buffers": [{"byteLength": body.len()}],
    });
    let mut json = document.to_string().into_bytes();
    // Chunks are multiples of four bytes; those of the body are already.
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + body.len();
    let count = |bytes: usize| {
        u32::try_from(bytes).map_err(|_| MeshFileError::Many {
            what: "bytes",
            count: bytes,
        })
    };
    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2u32.to_le_bytes());
    out.extend_from_slice(&count(length)?.to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &body)] {
        out.extend_from_slice(&count(chunk.len())?.to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(chunk);
    }
    Ok(out)
}
