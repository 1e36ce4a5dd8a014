//! What is made of a surface: faces of every kind, other shapes, places.

use super::tests::{GLOBAL, SHEET, file};
use super::*;
use crate::exchange::LeftOut;
use crate::exchange::testing::mutations;
use crate::math::Point3;

/// The sheet as entity 1, with the others that follow it; all but the last one are there as its parts.
fn made_of(others: &[(u32, u32, &str)]) -> Imported {
    let text = text_of(others);
    read(text.as_bytes(), Pick::First).unwrap_or_else(|error| panic!("{error}: {others:?}"))
}

fn text_of(others: &[(u32, u32, &str)]) -> String {
    let mut entities = vec![(128, 0, SHEET)];
    entities.extend_from_slice(others);
    let last = 2 * entities.len() - 1;
    let lines = file(GLOBAL, &entities);
    let lines = lines.lines().map(|line| {
        let number: usize = line[73..].trim().parse().unwrap();
        if line.as_bytes()[72] == b'D' && number % 2 == 1 && number < last {
            format!("{}00010000{}\n", &line[..64], &line[72..])
        } else {
            format!("{line}\n")
        }
    });
    lines.collect()
}

fn left(others: &[(u32, u32, &str)]) -> (bool, usize, usize) {
    let LeftOut {
        trimmed,
        other_faces,
        placements,
        ..
    } = made_of(others).left_out;
    (trimmed, other_faces, placements)
}

const WHOLE: (bool, usize, usize) = (false, 0, 0);
const TRIMMED: (bool, usize, usize) = (true, 0, 0);
const OTHER: (bool, usize, usize) = (false, 1, 0);

/// Round the sheet in its parameters, and round its first half.
const ROUND: &str = "106,1,5,0.,0.,0.,1.,0.,1.,1.,0.,1.,0.,0.;";
const HALF: &str = "106,1,5,0.,0.,0.,.5,0.,.5,1.,0.,1.,0.,0.;";
/// [`ROUND`] and [`HALF`] as curves in space.
const ROUND_SPACE: &str = "106,2,5,0.,0.,7.,1.,0.,7.,1.,1.,7.,0.,1.,7.,0.,0.,7.;";
const HALF_SPACE: &str = "106,2,5,0.,0.,7.,.5,0.,7.,.5,1.,7.,0.,1.,7.,0.,0.,7.;";

#[test]
fn faces_of_every_kind_are_whole_or_trimmed_by_their_boundaries() {
    for (curve, wanted) in [(ROUND, WHOLE), (HALF, TRIMMED)] {
        let faces: [&[(u32, u32, &str)]; 4] = [
            &[
                (106, 0, curve),
                (142, 0, "142,0,1,3,0,1;"),
                (144, 0, "144,1,1,0,5;"),
            ],
            &[
                (106, 0, curve),
                (142, 0, "142,0,1,3,0,1;"),
                (144, 0, "144,1,0,1,0,5;"),
            ],
            &[
                (106, 0, curve),
                (141, 0, "141,1,2,1,1,0,1,1,3;"),
                (143, 0, "143,1,1,1,5;"),
            ],
            &[
                (106, 0, curve),
                (508, 0, "508,1,0,0,1,1,1,0,3;"),
                (510, 0, "510,1,1,1,5;"),
            ],
        ];
        for face in faces {
            assert_eq!(left(face), wanted, "{face:?}");
        }
    }
    for (curve, wanted) in [
        (ROUND_SPACE, WHOLE),
        (HALF_SPACE, TRIMMED),
        ("104,1.,0.,1.,0.,0.,-1.,7.,1.,0.,1.,0.;", TRIMMED),
    ] {
        let kind = curve[..3].parse().unwrap();
        let faces: [&[(u32, u32, &str)]; 3] = [
            &[
                (kind, 0, curve),
                (142, 0, "142,0,1,0,3,2;"),
                (144, 0, "144,1,1,0,5;"),
            ],
            &[
                (kind, 0, curve),
                (141, 0, "141,0,1,1,1,3,1,0;"),
                (143, 0, "143,0,1,1,5;"),
            ],
            &[
                (kind, 0, curve),
                (504, 0, "504,1,3,0,0,0,0;"),
                (508, 0, "508,1,0,5,1,1,0;"),
                (510, 0, "510,1,1,1,7;"),
            ],
        ];
        for face in faces {
            assert_eq!(left(face), wanted, "{face:?}");
        }
    }
    assert_eq!(left(&[(144, 0, "144,1,0,0,0;")]), WHOLE);
    assert_eq!(left(&[(510, 0, "510,1,0,0;")]), WHOLE);
    assert_eq!(
        left(&[(144, 0, "144,1,1,0,99;")]),
        TRIMMED,
        "a boundary that is not there"
    );
    // An arc from edge to edge has both ends on the edge, and so has a notch between two of many points.
    let bite = "100,0.,0.,.5,0.,.25,0.,.75;";
    assert_eq!(
        left(&[
            (100, 0, bite),
            (142, 0, "142,0,1,3,0,1;"),
            (144, 0, "144,1,1,0,5;")
        ]),
        TRIMMED
    );
    let mut notched = String::from("126,100,1,0,0,1,0,0.");
    notched += &(0..=100).map(|k| format!(",{k}.")).collect::<String>();
    notched += ",100.";
    notched += &",1.".repeat(101);
    notched += &(0..=100)
        .map(|k| {
            format!(
                ",{},{},0.",
                f64::from(k) / 100.0,
                if k == 47 { 0.3 } else { 0.0 }
            )
        })
        .collect::<String>();
    notched += ",0.,100.,0.,0.,1.;";
    let straight = notched.replace("0.3,", "0.0,");
    for (curve, wanted) in [(straight, WHOLE), (notched, TRIMMED)] {
        assert_eq!(
            left(&[
                (126, 0, &curve),
                (142, 0, "142,0,1,3,0,1;"),
                (144, 0, "144,1,1,0,5;")
            ]),
            wanted
        );
    }
}

#[test]
fn what_is_made_of_the_surface_is_another_shape_whatever_its_number() {
    assert_eq!(left(&[(140, 0, "140,0.,0.,1.,.5,1;")]), OTHER);
    assert_eq!(
        left(&[(144, 0, "144,3,0,0,0;")]),
        (false, 1, 0),
        "a face on something else, of which the sheet is a part"
    );
    for (kind, text) in [
        (5001, "5001,2.5,1;"),
        (180, "180,3,-1,-1,1;"),
        (184, "184,1,1,0;"),
        (412, "412,1,1.,0.,0.,0.,2,2,1.,1.,0.,0,0;"),
    ] {
        assert_eq!(left(&[(kind, 0, text)]), OTHER, "{kind}");
    }
    // A part of nothing that is there.
    assert_eq!(left(&[(116, 0, "116,0.,0.,0.;")]), OTHER);
    // Groups, curves on it and drawings leave it as it is.
    assert_eq!(left(&[(402, 0, "402,1,1;")]), WHOLE);
    assert_eq!(
        left(&[
            (110, 0, "110,0.,0.,0.,1.,1.,0.;"),
            (142, 0, "142,0,1,3,0,1;"),
            (402, 0, "402,2,1,5;")
        ]),
        WHOLE
    );
    // A surface of revolution beside it, and one that is a part of a face.
    let beside = |kind: u32, text: &str| {
        let text = file(GLOBAL, &[(128, 0, SHEET), (kind, 0, text)]);
        let left = read(text.as_bytes(), Pick::First).unwrap().left_out;
        (left.faces, left.other_faces)
    };
    assert_eq!(beside(120, "120,5,7,0.,6.28;"), (2, 1));
    assert_eq!(beside(108, "108,0.,0.,1.,0.,5,0.,0.,0.,0.;"), (2, 1));
    assert_eq!(
        beside(108, "108,0.,0.,1.,0.,0,0.,0.,0.,0.;"),
        (1, 0),
        "a plane without end is no face"
    );
    assert_eq!(beside(110, "110,0.,0.,0.,1.,1.,0.;"), (1, 0));
}

#[test]
fn what_takes_the_surface_over_places_it() {
    let corner = |others: &[(u32, u32, &str)]| {
        let read = made_of(others);
        assert!(!read.left_out.is_any(), "{}: {others:?}", read.left_out);
        read.surface.point(1.0, 0.0)
    };
    let shift = "124,1.,0.,0.,10.,0.,1.,0.,0.,0.,0.,1.,0.;";
    assert_eq!(
        corner(&[(124, 0, shift), (144, 3, "144,1,0,0,0;")]),
        Point3::new(11.0, 0.0, 7.0)
    );
    // Its boundary in space is moved as it is.
    let boundary = [
        (124, 0, shift),
        (106, 0, ROUND_SPACE),
        (142, 0, "142,0,1,0,5,2;"),
        (144, 3, "144,1,1,0,7;"),
    ];
    assert_eq!(corner(&boundary), Point3::new(11.0, 0.0, 7.0));
    let solid = [
        (124, 0, shift),
        (510, 0, "510,1,0,0;"),
        (514, 0, "514,1,5,1;"),
        (186, 3, "186,7,1,0;"),
        (308, 0, "308,0,4Hpart,1,9;"),
        (408, 3, "408,11,0.,2.,0.,3.;"),
    ];
    // Ten along x, three times as large, two along y, after ten along x again.
    assert_eq!(corner(&solid[..4]), Point3::new(11.0, 0.0, 7.0));
    let twice = [&solid[..], &[(408, 0, "408,11,0.,0.,0.,1.;")]].concat();
    assert_eq!(left(&twice), (false, 0, 2));
    let once = [&solid[..5], &[(408, 0, "408,11,0.,2.,0.,3.;")]].concat();
    assert_eq!(corner(&once), Point3::new(33.0, 2.0, 21.0));
    assert_eq!(
        corner(&[&solid[..5], &[(408, 0, "408,11,0.,2.,0.;")]].concat()),
        Point3::new(11.0, 2.0, 7.0)
    );
}

#[test]
fn damaged_uses_are_read_or_refused() {
    let solid = [
        (106, 0, HALF_SPACE),
        (504, 0, "504,1,3,0,0,0,0;"),
        (508, 0, "508,1,0,5,1,1,0;"),
        (510, 0, "510,1,1,1,7;"),
        (514, 0, "514,1,9,1;"),
        (186, 0, "186,11,1,0;"),
        (308, 0, "308,0,4Hpart,1,13;"),
        (408, 0, "408,15,0.,2.,0.,3.;"),
        (143, 0, "143,1,1,1,21;"),
        (141, 0, "141,1,2,1,1,0,1,1,3;"),
    ];
    mutations(text_of(&solid).as_bytes(), 407, |bytes| {
        drop(read(bytes, Pick::First))
    });
    // Solids in each other.
    assert_eq!(
        left(&[
            (430, 0, "430,5;"),
            (430, 0, "430,3;"),
            (184, 0, "184,2,1,3,0,0;")
        ])
        .1,
        1
    );
    let text = format!("\u{feff}{}", text_of(&[(144, 0, "144,1,0,0,0;")]));
    assert_eq!(
        read(text.as_bytes(), Pick::First).unwrap().left_out.faces,
        1
    );
}
