//! Reading glTF 2.0, binary: the triangles of all meshes, where the nodes of the scene place them.
//!
//! glTF is in metres with y up; what is read has z up, so that a file of ours comes back as it was.

use super::MeshFileError;
use super::stl::welded;
use crate::math::Point3;
use crate::surface::Mesh;
use nalgebra::{Matrix4, Quaternion, UnitQuaternion, Vector3};
use serde_json::Value;

/// Nodes inside each other at most; more is a circle.
const MOST_DEPTH: usize = 64;

/// Nodes in a scene and corners of its triangles at most. Nodes may share children, so that a small
/// file can ask for any number of either.
const MOST_NODES: usize = 100_000;
const MOST_CORNERS: usize = 12_000_000;
const TRIANGLES: u64 = 4;
const BYTE: u64 = 5121;
const SHORT: u64 = 5123;
const INT: u64 = 5125;
const FLOAT: u64 = 5126;

fn wrong(wanted: &'static str, found: impl std::fmt::Display) -> MeshFileError {
    let found = found.to_string().chars().take(60).collect();
    MeshFileError::Value {
        format: "glTF",
        wanted,
        found,
    }
}

fn short() -> MeshFileError {
    MeshFileError::Cut("glTF")
}

struct File<'a> {
    document: Value,
    body: &'a [u8],
}

/// What was gathered so far.
#[derive(Default)]
struct Gathered {
    nodes: usize,
    /// Three a triangle.
    corners: Vec<Point3>,
}

fn number(bytes: &[u8]) -> Option<usize> {
    Some(u32::from_le_bytes(bytes.get(..4)?.try_into().ok()?) as usize)
}

fn size(value: &Value) -> Option<usize> {
    usize::try_from(value.as_u64()?).ok()
}

impl<'a> File<'a> {
    fn open(bytes: &'a [u8]) -> Result<Self, MeshFileError> {
        if bytes.get(..4) != Some(b"glTF") {
            return Err(wrong("the first bytes glTF (a .glb file)", "others"));
        }
        match number(bytes.get(4..).ok_or_else(short)?) {
            Some(2) => {}
            Some(other) => return Err(wrong("version 2", other)),
            None => return Err(short()),
        }
        let (mut json, mut body, mut rest) =
            (None, &bytes[..0], bytes.get(12..).ok_or_else(short)?);
        while rest.len() >= 8 {
            let length = number(rest).ok_or_else(short)?;
            let chunk = rest.get(8..).and_then(|rest| rest.get(..length));
            let chunk = chunk.ok_or_else(short)?;
            match &rest[4..8] {
                b"JSON" => json = Some(chunk),
                b"BIN\0" => body = chunk,
                _ => {}
            }
            rest = &rest[8 + length..];
        }
        let document = serde_json::from_slice(json.ok_or_else(short)?)
            .map_err(|error| wrong("a JSON document", error))?;
        let file = Self { document, body };
        let packed = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];
        let needed = file.list("extensionsRequired").iter();
        let needed: Vec<&str> = needed.filter_map(Value::as_str).collect();
        if let Some(name) = needed.iter().find(|name| packed.contains(*name)) {
            return Err(wrong("a mesh without compression", name));
        }
        Ok(file)
    }

    fn list(&self, name: &str) -> &[Value] {
        self.document[name].as_array().map_or(&[], Vec::as_slice)
    }

    fn item(&self, list: &'static str, index: &Value) -> Result<&Value, MeshFileError> {
        let found = size(index).and_then(|index| self.list(list).get(index));
        found.ok_or_else(|| {
            wrong(
                "an index into a list of the file",
                format!("{list} {index}"),
            )
        })
    }

    /// Bytes of an accessor's rows of `row` bytes, and how many; `kinds` are the component types that
    /// it may have.
    fn rows(
        &self,
        accessor: &Value,
        kinds: &[(u64, usize)],
        columns: usize,
    ) -> Result<(Vec<&[u8]>, u64), MeshFileError> {
        if accessor.get("sparse").is_some() {
            return Err(wrong("accessors that are not sparse", "sparse"));
        }
        let kind = accessor["componentType"].as_u64().unwrap_or_default();
        let known = kinds.iter().find(|(known, _)| *known == kind);
        let (_, bytes) = known.ok_or_else(|| wrong("another component type", kind))?;
        let row = bytes * columns;
        let view = self.item("bufferViews", &accessor["bufferView"])?;
        if view["buffer"].as_u64() != Some(0) {
            return Err(wrong("the data inside the file", "another buffer"));
        }
        let of = |value: &Value| size(value).unwrap_or_default();
        let stride = match of(&view["byteStride"]) {
            0 => row,
            stride => stride.max(row),
        };
        let count = size(&accessor["count"]).ok_or_else(short)?;
        let start = of(&view["byteOffset"]).saturating_add(of(&accessor["byteOffset"]));
        let rows = (0..count).map(|k| {
            let at = k.checked_mul(stride).and_then(|at| at.checked_add(start));
            at.and_then(|at| self.body.get(at..at.checked_add(row)?))
                .ok_or_else(short)
        });
        // The first row beyond the end stops this: no list is longer than the file.
        Ok((rows.collect::<Result<_, _>>()?, kind))
    }

    fn points(&self, accessor: &Value) -> Result<Vec<Point3>, MeshFileError> {
        let (rows, _) = self.rows(accessor, &[(FLOAT, 4)], 3)?;
        let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let point = |row: &&[u8]| {
            Point3::new(0.0, 4.0, 8.0).map(|at| f64::from(float(&row[at as usize..])))
        };
        Ok(rows.iter().map(point).collect())
    }

    fn indices(&self, accessor: &Value) -> Result<Vec<usize>, MeshFileError> {
        let (rows, _) = self.rows(accessor, &[(BYTE, 1), (SHORT, 2), (INT, 4)], 1)?;
        let index = |row: &&[u8]| {
            row.iter()
                .rev()
                .fold(0, |all, &byte| all << 8 | usize::from(byte))
        };
        Ok(rows.iter().map(index).collect())
    }

    /// Adds a node and all below it.
    fn node(
        &self,
        index: &Value,
        placed: &Matrix4<f64>,
        depth: usize,
        gathered: &mut Gathered,
    ) -> Result<(), MeshFileError> {
        if depth > MOST_DEPTH {
            return Err(wrong("nodes that end", "a circle of nodes"));
        }
        gathered.nodes += 1;
        if gathered.nodes > MOST_NODES {
            let (what, count) = ("nodes", gathered.nodes);
            return Err(MeshFileError::Many { what, count });
        }
        let node = self.item("nodes", index)?;
        let placed = placed * local(node)?;
        if node.get("mesh").is_some() {
            let mesh = self.item("meshes", &node["mesh"])?;
            self.mesh(mesh, &placed, &mut gathered.corners)?;
        }
        let none = Vec::new();
        for child in node["children"].as_array().unwrap_or(&none) {
            self.node(child, &placed, depth + 1, gathered)?;
        }
        Ok(())
    }

    fn mesh(
        &self,
        mesh: &Value,
        placed: &Matrix4<f64>,
        corners: &mut Vec<Point3>,
    ) -> Result<(), MeshFileError> {
        let none = Vec::new();
        for primitive in mesh["primitives"].as_array().unwrap_or(&none) {
            if primitive["mode"].as_u64().unwrap_or(TRIANGLES) != TRIANGLES {
                return Err(wrong(
                    "primitives of triangles (mode 4)",
                    &primitive["mode"],
                ));
            }
            let positions = &primitive["attributes"]["POSITION"];
            let points = self.points(self.item("accessors", positions)?)?;
            let indices = match primitive.get("indices") {
                Some(indices) => self.indices(self.item("accessors", indices)?)?,
                None => (0..points.len()).collect(),
            };
            if corners.len() + indices.len() > MOST_CORNERS {
                let (what, count) = ("corners", corners.len() + indices.len());
                return Err(MeshFileError::Many { what, count });
            }
            for triangle in indices.chunks_exact(3) {
                for &corner in triangle {
                    let point = points.get(corner).ok_or(MeshFileError::Corner {
                        triangle: corners.len() / 3,
                        corner: corner as u32,
                        count: points.len(),
                    })?;
                    let [x, y, z] = placed.transform_point(point).into();
                    // Their y is up, ours is z.
                    corners.push(Point3::new(x, -z, y));
                }
            }
        }
        Ok(())
    }
}

/// Where a node is in the one above it.
fn local(node: &Value) -> Result<Matrix4<f64>, MeshFileError> {
    let numbers = |key: &'static str, count: usize| -> Result<Option<Vec<f64>>, MeshFileError> {
        let Some(value) = node.get(key) else {
            return Ok(None);
        };
        let numbers: Option<Vec<f64>> = value
            .as_array()
            .and_then(|list| list.iter().map(Value::as_f64).collect());
        match numbers.filter(|list| list.len() == count) {
            Some(list) => Ok(Some(list)),
            None => Err(wrong("numbers that place a node", format!("{key} {value}"))),
        }
    };
    if let Some(matrix) = numbers("matrix", 16)? {
        return Ok(Matrix4::from_column_slice(&matrix));
    }
    let mut placed = Matrix4::identity();
    if let Some(t) = numbers("translation", 3)? {
        placed = Matrix4::new_translation(&Vector3::new(t[0], t[1], t[2]));
    }
    if let Some(q) = numbers("rotation", 4)? {
        let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2]));
        placed *= turn.to_homogeneous();
    }
    if let Some(s) = numbers("scale", 3)? {
        placed *= Matrix4::new_nonuniform_scaling(&Vector3::new(s[0], s[1], s[2]));
    }
    Ok(placed)
}

/// The triangles of a file, m. Corners at the same place become one.
///
/// # Errors
/// A file cut short, compressed, with data in other files, or with primitives that are not triangles.
pub fn read(bytes: &[u8]) -> Result<Mesh, MeshFileError> {
    let file = File::open(bytes)?;
    let scene = size(&file.document["scene"]).unwrap_or_default();
    let none = Vec::new();
    let roots = match file.list("scenes").get(scene) {
        Some(scene) => scene["nodes"].as_array().unwrap_or(&none).clone(),
        // Without scenes every mesh counts, as it is.
        None => Vec::new(),
    };
    let mut gathered = Gathered::default();
    for root in &roots {
        file.node(root, &Matrix4::identity(), 0, &mut gathered)?;
    }
    if file.list("scenes").is_empty() {
        for mesh in file.list("meshes") {
            file.mesh(mesh, &Matrix4::identity(), &mut gathered.corners)?;
        }
    }
    welded(gathered.corners)
}
