//! PLY and glTF as scanners and other programs write them.

use super::*;
use crate::exchange::testing::mutations;
use crate::exchange::{Format, read_mesh, read_points};
use crate::surface::builtin;
use crate::surface::file::Unit;

/// A ball's triangles, with the corners of its seam twice, as scanners have them.
fn ball() -> Mesh {
    let sphere = builtin("sphere", None, None).unwrap();
    let mesh = sphere.tessellated([1; 2]).unwrap();
    Mesh::from_triangles(mesh.points, mesh.triangles).unwrap()
}

/// The same with every corner once.
fn whole(mesh: &Mesh) -> Mesh {
    let corners = mesh
        .triangles
        .iter()
        .flatten()
        .map(|&k| mesh.points[k as usize]);
    stl::welded(corners.collect()).unwrap()
}

/// A PLY with what scanners add: comments, colours, normals, a face property and another element.
fn ply(mesh: &Mesh, form: &str) -> Vec<u8> {
    let mut out = format!(
        "ply\r\nformat {form} 1.0\r\ncomment made by a scanner\r\nelement vertex {}\r\nproperty float nx\r\nproperty double x\r\n\
         property double y\r\nproperty double z\r\nproperty uchar red\r\nelement face {}\r\nproperty uchar quality\r\n\
         property list uchar int vertex_indices\r\nelement edge 1\r\nproperty int vertex1\r\nproperty list ushort float rest\r\n\
         end_header\r\n",
        mesh.points.len(),
        mesh.triangles.len()
    )
    .into_bytes();
    let text = form == "ascii";
    let big = form == "binary_big_endian";
    let mut put = |word: String, bytes: &[u8]| {
        if text {
            out.extend_from_slice(word.as_bytes());
            out.push(b' ');
        } else if big {
            out.extend(bytes.iter().rev());
        } else {
            out.extend_from_slice(bytes);
        }
    };
    for p in &mesh.points {
        put("0.5".into(), &0.5f32.to_le_bytes());
        for x in p.iter() {
            put(format!("{x:?}"), &x.to_le_bytes());
        }
        put("200".into(), &[200]);
    }
    for t in &mesh.triangles {
        put("7".into(), &[7]);
        put("3".into(), &[3]);
        for k in t {
            put(k.to_string(), &(*k as i32).to_le_bytes());
        }
    }
    put("-2".into(), &(-2i32).to_le_bytes());
    put("2".into(), &2u16.to_le_bytes());
    put("1e-3".into(), &1e-3f32.to_le_bytes());
    put("4".into(), &4f32.to_le_bytes());
    out
}

#[test]
fn a_ply_of_every_form_gives_the_same_triangles() {
    let mesh = ball();
    for form in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let bytes = ply(&mesh, form);
        let read = read_mesh(&bytes, Format::Ply, Unit::Metre).unwrap();
        assert_eq!(read, whole(&mesh), "{form}");
        assert!(read.points.len() < mesh.points.len());
        let millimetres = read_points(&bytes, Format::Ply, Unit::Millimetre).unwrap();
        assert_eq!(millimetres[3], mesh.points[3] / 1000.0, "{form}");
    }
}

#[test]
fn a_face_with_five_corners_becomes_three_triangles_and_a_cloud_has_none() {
    let pentagon = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list uchar uint vertex_index\nend_header\n\
                    0 0 0\n1 0 0\n1 1 0\n0.5 2 0\n0 1 0\n5 0 1 2 3 4\n";
    let read = read_ply(pentagon.as_bytes(), Unit::Metre).unwrap();
    assert_eq!(read.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    let cloud = pentagon.replace(
        "element face 1\nproperty list uchar uint vertex_index\n",
        "",
    );
    assert_eq!(
        read_ply(cloud.as_bytes(), Unit::Metre),
        Err(MeshFileError::Empty("faces"))
    );
    assert_eq!(
        read_ply_points(cloud.as_bytes(), Unit::Metre)
            .unwrap()
            .len(),
        5
    );
}

// Ours has a node that turns z up to y up, and coordinates in single precision.
#[test]
fn a_gltf_of_ours_comes_back_where_it_was() {
    let mesh = ball();
    let read = read_glb(&write_glb(&mesh).unwrap()).unwrap();
    let mesh = whole(&mesh);
    assert_eq!(read.triangles.len(), mesh.triangles.len());
    let apart = |a: &Mesh, b: &Mesh| {
        let nearest = |p: &Point3| b.points.iter().map(|q| (p - q).norm()).fold(1.0, f64::min);
        a.points.iter().map(nearest).fold(0.0, f64::max)
    };
    assert!(apart(&read, &mesh) < 1e-8 && apart(&mesh, &read) < 1e-8);
}

/// A glTF of one triangle in another's hand: short indices, interleaved corners, nested nodes.
fn nested() -> Vec<u8> {
    let mut body = Vec::new();
    for point in [[0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]] {
        body.extend(point.iter().flat_map(|x| x.to_le_bytes()));
        body.extend([0u8; 4]);
    }
    body.extend([0u16, 1, 2, 0].iter().flat_map(|k| k.to_le_bytes()));
    let document = serde_json::json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [1]}],
        "nodes": [
            {"mesh": 0, "scale": [2, 2, 2]},
            {"children": [0], "translation": [0, 0, 5]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48, "byteStride": 16},
            {"buffer": 0, "byteOffset": 48, "byteLength": 8},
        ],
        "buffers": [{"byteLength": 56}],
    });
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(((12 + 8 + json.len() + 8 + body.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &body)] {
        out.extend((chunk.len() as u32).to_le_bytes());
        out.extend_from_slice(kind);
        out.extend_from_slice(chunk);
    }
    out
}

#[test]
fn nodes_place_and_scale_their_meshes_and_y_becomes_z() {
    let read = read_glb(&nested()).unwrap();
    let places: Vec<[f64; 3]> = read.points.iter().map(|p| (*p).into()).collect();
    // (x, y, z) of theirs is (x, −z, y) of ours.
    assert_eq!(
        places,
        [[0.0, -5.0, 0.0], [2.0, -5.0, 0.0], [0.0, -5.0, 2.0]]
    );
}

#[test]
fn damaged_scans_are_refused_or_read_and_never_more() {
    let mesh = ball();
    let glb = write_glb(&mesh).unwrap();
    for end in 0..glb.len().min(2000) {
        assert!(read_glb(&glb[..end]).is_err(), "cut at {end}");
    }
    for (seed, whole) in [(71, &glb), (72, &nested())] {
        mutations(whole, seed, |bytes| drop(read_glb(bytes)));
    }
    for form in ["ascii", "binary_little_endian"] {
        let whole = ply(&mesh, form);
        for end in (0..whole.len() - 8).step_by(7) {
            assert!(
                read_ply(&whole[..end], Unit::Metre).is_err(),
                "{form} cut at {end}"
            );
        }
        mutations(&whole, 73, |bytes| drop(read_ply(bytes, Unit::Metre)));
    }
    let many = "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
    assert_eq!(
        read_ply_points(many.as_bytes(), Unit::Metre),
        Err(MeshFileError::Cut("PLY"))
    );
    let draco = String::from_utf8_lossy(&nested()).replace(
        "\"asset\"",
        "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\"",
    );
    assert!(read_glb(draco.as_bytes()).is_err());
}

// Twenty nodes that each have the next twice: a million of the last.
#[test]
fn nodes_that_multiply_are_refused() {
    let nodes: Vec<serde_json::Value> = (0..20)
        .map(|k| serde_json::json!({"children": [k + 1, k + 1]}))
        .chain([serde_json::json!({})])
        .collect();
    let document = serde_json::json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": nodes});
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    out.extend((json.len() as u32).to_le_bytes());
    out.extend_from_slice(b"JSON");
    out.extend(json);
    assert!(matches!(
        read_glb(&out),
        Err(MeshFileError::Many { what: "nodes", .. })
    ));
}
