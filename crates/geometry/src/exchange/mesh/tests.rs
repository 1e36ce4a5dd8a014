use super::*;
use crate::exchange::testing::mutations;
use crate::math::Vector3;
use crate::surface::file::Unit;
use crate::surface::{SampleGrid, builtin};

/// The teardrop on a grid: 8 × 6 cells.
fn drop_mesh() -> Mesh {
    let drop = builtin("teardrop", None, None).unwrap();
    let (rows, columns) = (9, 7);
    let parameters = |count: usize| {
        (0..count)
            .map(|k| k as f64 / (count - 1) as f64)
            .collect::<Vec<_>>()
    };
    let grid = SampleGrid::new(&drop, &parameters(rows), &parameters(columns));
    let mut samples = grid.samples();
    grid.evaluate_into(&drop, &mut samples);
    let mut triangles = Vec::new();
    for i in 0..rows as u32 - 1 {
        for j in 0..columns as u32 - 1 {
            let at = |i: u32, j: u32| i * columns as u32 + j;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            let turned = |t: [u32; 3]| {
                if drop.flip_normal() {
                    [t[0], t[2], t[1]]
                } else {
                    t
                }
            };
            triangles.extend([turned([a, b, c]), turned([a, c, d])]);
        }
    }
    Mesh {
        points: samples.points,
        normals: samples.normals,
        triangles,
    }
}

/// Six times the signed volume.
fn volume(mesh: &Mesh) -> f64 {
    let corner = |k: u32| mesh.points[k as usize].coords;
    mesh.triangles
        .iter()
        .map(|t| corner(t[0]).dot(&corner(t[1]).cross(&corner(t[2]))))
        .sum()
}

#[test]
fn stl_of_either_form_reads_back_as_the_same_triangles() {
    let mesh = drop_mesh();
    for unit in [Unit::Metre, Unit::Millimetre] {
        let text = read_stl(write_stl_ascii(&mesh, unit).unwrap().as_bytes(), unit).unwrap();
        let binary = read_stl(&write_stl(&mesh, unit).unwrap(), unit).unwrap();
        for (read, tolerance) in [(&text, 1e-15), (&binary, 1e-7)] {
            assert_eq!(read.triangles.len(), mesh.triangles.len());
            assert!(
                read.points.len() < mesh.points.len(),
                "the seam and the poles are one each"
            );
            for (a, b) in read.triangles.iter().zip(&mesh.triangles) {
                for (a, b) in a.iter().zip(b) {
                    let gap = (read.points[*a as usize] - mesh.points[*b as usize]).norm();
                    assert!(gap <= tolerance * 0.1, "{gap}");
                }
            }
            assert!(volume(read) > 0.0 && (volume(read) / volume(&mesh) - 1.0).abs() < 1e-5);
            // A facet's normal is at most a cell away from the surface's.
            let (k, normal) = (
                read.triangles[40][0] as usize,
                mesh.normals[mesh.triangles[40][0] as usize],
            );
            assert!(
                read.normals[k].dot(&normal) > 0.8,
                "{}",
                read.normals[k].dot(&normal)
            );
        }
    }
}

#[test]
fn obj_keeps_every_bit_of_the_corners() {
    let mesh = drop_mesh();
    let text = write_obj(&mesh, Unit::Metre).unwrap();
    assert_eq!(
        read_obj_points(text.as_bytes(), Unit::Metre).unwrap(),
        mesh.points
    );
    assert_eq!(
        text.lines().filter(|line| line.starts_with("vn ")).count(),
        mesh.normals.len()
    );
    let [a, b, c] = mesh.triangles[0].map(|k| k + 1);
    assert!(
        text.contains(&format!("\nf {a}//{a} {b}//{b} {c}//{c}\n")),
        "corners are counted from 1"
    );
}

#[test]
fn glb_chunks_hold_what_their_accessors_say() {
    let mesh = drop_mesh();
    let file = write_glb(&mesh).unwrap();
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!(
        (&file[..4], word(4), word(8)),
        (&b"glTF"[..], 2, file.len())
    );
    let json_length = word(12);
    assert_eq!((&file[16..20], json_length % 4), (&b"JSON"[..], 0));
    let document: serde_json::Value = serde_json::from_slice(&file[20..20 + json_length]).unwrap();
    let body_at = 20 + json_length + 8;
    assert_eq!(
        (&file[body_at - 4..body_at], word(body_at - 8)),
        (&b"BIN\0"[..], file.len() - body_at)
    );
    assert_eq!(document["buffers"][0]["byteLength"], file.len() - body_at);
    let view = |k: usize, key: &str| document["bufferViews"][k][key].as_u64().unwrap() as usize;
    let number = |at: usize| f32::from_le_bytes(file[at..at + 4].try_into().unwrap());
    let (mut low, mut high) = ([f32::MAX; 3], [f32::MIN; 3]);
    for (k, (point, normal)) in mesh.points.iter().zip(&mesh.normals).enumerate() {
        for c in 0..3 {
            let x = number(body_at + view(0, "byteOffset") + 12 * k + 4 * c);
            assert_eq!(x, point[c] as f32);
            (low[c], high[c]) = (low[c].min(x), high[c].max(x));
            assert!(
                (number(body_at + view(1, "byteOffset") + 12 * k + 4 * c) - normal[c] as f32).abs()
                    < 1e-7
            );
        }
    }
    let bounds = |key: &str| -> Vec<f32> {
        document["accessors"][0][key]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap() as f32)
            .collect()
    };
    assert_eq!(
        (bounds("min"), bounds("max")),
        (low.to_vec(), high.to_vec())
    );
    for (k, corner) in mesh.triangles.iter().flatten().enumerate() {
        assert_eq!(
            word(body_at + view(2, "byteOffset") + 4 * k),
            *corner as usize
        );
    }
    assert_eq!(
        view(2, "byteOffset") + view(2, "byteLength"),
        file.len() - body_at
    );
}

#[test]
fn points_are_read_from_text_of_many_habits() {
    let wanted = vec![Point3::new(1.0, 2.0, 3.0), Point3::new(-4.0, 5e-3, 6.0)];
    for text in [
        "1 2 3\n-4 5e-3 6\n",
        "x,y,z\n1,2,3\r\n-4,.005,6.\r\n",
        "# a scan\n\n1;2;3;0;0;1 # first\n-4;5.0E-3;6;0;0;1",
        "\"x\"\t\"y\"\t\"z\"\n 1\t2\t3 \n-4\t0.005\t6",
    ] {
        assert_eq!(
            read_text_points(text.as_bytes(), Unit::Metre).unwrap(),
            wanted,
            "{text:?}"
        );
    }
    let millimetres = read_text_points(b"1000 2000 3000\n-4000 5 6000", Unit::Millimetre).unwrap();
    assert_eq!(millimetres, wanted);
}

#[test]
fn what_is_no_mesh_or_point_is_refused_with_its_place() {
    let message = |read: Result<usize, MeshFileError>| read.unwrap_err().to_string();
    let text =
        |text: &str| message(read_text_points(text.as_bytes(), Unit::Metre).map(|p| p.len()));
    assert_eq!(
        text("1 2 3\n4 5\n"),
        "line 2: expected three numbers, x y z, found 2 numbers"
    );
    assert_eq!(
        text("1 2 3\nx y z\n"),
        "line 2: expected three numbers, x y z, found 3 words"
    );
    assert_eq!(
        text("1 2 inf"),
        "line 1: expected three numbers, x y z, found a word and 2 numbers"
    );
    assert_eq!(text("x y z\n"), "there are no points");
    let obj = |text: &str| message(read_obj_points(text.as_bytes(), Unit::Metre).map(|p| p.len()));
    assert_eq!(
        obj("v 1 2 3\nv 1 2 1e999"),
        "line 2: expected v and three numbers, found 2 words and 2 numbers"
    );
    assert_eq!(
        obj("f 1 2 3"),
        "there are no corners (lines that begin with v)"
    );
    let stl = |bytes: &[u8]| message(read_stl(bytes, Unit::Metre).map(|m| m.points.len()));
    assert_eq!(stl(b"soli"), "4 bytes are too few for an STL file");
    let mut huge = vec![0; 84];
    huge[80..].fill(255);
    assert_eq!(
        stl(&huge),
        "neither a text STL, which begins with the word solid, nor a binary one: its header counts 4294967295 triangles, which \
         need 214748364834 bytes, and the file has 84; export it anew as STL, or rename it if it is in another format"
    );
    assert_eq!(
        stl(b"solid\nvertex 1 2\n"),
        "line 2: expected vertex and three numbers, found a word and 2 numbers"
    );
    assert_eq!(
        stl(b"solid\nfacet\nvertex 1 2 3\nendloop"),
        "line 4: expected three vertices before endloop, found a word"
    );
    let mut not_finite = write_stl(&drop_mesh(), Unit::Metre).unwrap();
    not_finite[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    assert_eq!(
        stl(&not_finite),
        "corner 0 has coordinate NaN m, not a finite number within ±1e12 m"
    );
}

#[test]
fn meshes_whose_parts_disagree_are_not_written() {
    let good = drop_mesh();
    let mut mesh = good.clone();
    mesh.triangles[3][1] = 63;
    assert_eq!(
        write_obj(&mesh, Unit::Metre).unwrap_err().to_string(),
        "triangle 3 has corner 63, the mesh has 63"
    );
    let mut mesh = good.clone();
    mesh.normals.pop();
    assert_eq!(
        write_glb(&mesh).unwrap_err().to_string(),
        "62 normals for 63 corners"
    );
    let mut mesh = good.clone();
    mesh.points[2].y = 1e39;
    assert!(write_stl(&mesh, Unit::Metre).is_err() && write_stl_ascii(&mesh, Unit::Metre).is_err());
    assert!(matches!(
        write_glb(&Mesh::default()),
        Err(MeshFileError::Empty(_))
    ));
    assert_eq!(
        Mesh::from_triangles(vec![Point3::origin()], vec![[0, 0, 1]]),
        None
    );
    let flat = Mesh::from_triangles(vec![Point3::origin()], vec![[0, 0, 0]]).unwrap();
    assert_eq!(flat.normals, [Vector3::zeros()]);
}

#[test]
fn changed_files_are_refused_or_read_but_never_more() {
    let mesh = Mesh::from_triangles(
        vec![
            Point3::origin(),
            Point3::new(1.0, 0.0, 0.0),
            Point3::new(0.0, 1.5, 0.0),
        ],
        vec![[0, 1, 2], [0, 2, 1]],
    )
    .unwrap();
    let (binary, text) = (
        write_stl(&mesh, Unit::Metre).unwrap(),
        write_stl_ascii(&mesh, Unit::Metre).unwrap(),
    );
    let obj = write_obj(&mesh, Unit::Metre).unwrap();
    crate::exchange::testing::every_prefix(&binary, binary.len(), |bytes| {
        read_stl(bytes, Unit::Metre).is_ok()
    });
    let whole = text.find("endsolid").unwrap() + "endsolid".len();
    crate::exchange::testing::every_prefix(text.as_bytes(), whole, |bytes| {
        read_stl(bytes, Unit::Metre).is_ok()
    });
    for file in [&binary[..], text.as_bytes(), obj.as_bytes()] {
        mutations(file, 3, |bytes| {
            let _ = read_stl(bytes, Unit::Metre);
            let _ = read_obj_points(bytes, Unit::Metre);
            let _ = read_text_points(bytes, Unit::Metre);
        });
    }
}

#[test]
fn faces_of_an_obj_file_come_back_as_triangles() {
    let square =
        b"# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 3 -1\n";
    let mesh = read_obj(square, Unit::Metre).unwrap();
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert!(mesh.normals.iter().all(|n| *n == Vector3::z()));
    for (text, told) in [
        (
            "v 0 0 0\nf 1 2 3\n",
            "line 2: expected f and three or more corners that stand above",
        ),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "line 4"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "line 4"),
        ("v 0 0 0\n", "there are no faces"),
        ("f 1 x\n", "line 1"),
    ] {
        let error = read_obj(text.as_bytes(), Unit::Metre)
            .unwrap_err()
            .to_string();
        assert!(error.contains(told), "{text:?}: {error}");
    }
}
