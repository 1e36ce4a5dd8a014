use super::part_tests::{
    CONTEXTS, assembly, cube, data, face_of, product, read_text, usage, within_circle,
};
use super::*;
use crate::math::Point3;
use crate::part::{Brep, Carrier, Part};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

fn offset(by: &str, basis: &str) -> (Carrier, bool) {
    face_of(&within_circle(
        1.0,
        &format!("OFFSET_SURFACE('',#30,{by},.F.);#30={basis}"),
    ))
}

#[test]
fn offsets_of_elementary_surfaces_are_of_their_kind() {
    let (plane, same) = offset("-0.5", "PLANE('',#21)");
    assert!(matches!(plane, Carrier::Plane(axes) if axes.origin.z == -5e-4) && same);
    let (cylinder, _) = offset("0.5", "CYLINDRICAL_SURFACE('',#21,1.5)");
    assert!(matches!(cylinder, Carrier::Cylinder { radius_m: 2e-3, .. }));
    let (sphere, _) = offset("-1.", "SPHERICAL_SURFACE('',#21,3.)");
    assert!(matches!(sphere, Carrier::Sphere { radius_m: 2e-3, .. }));
    let (torus, _) = offset("0.25", "TOROIDAL_SURFACE('',#21,2.,0.25)");
    assert!(
        matches!(
            torus,
            Carrier::Torus {
                major_m: 2e-3,
                minor_m: 5e-4,
                ..
            }
        ),
        "{torus:?}"
    );
    // Half angle 45°, apex at −1: a distance d moves it by d √2.
    let by = FRAC_1_SQRT_2.to_string();
    let (cone, same) = offset(&by, "CONICAL_SURFACE('',#21,1.,0.7853981633974483)");
    let Carrier::Cone { axes, .. } = cone else {
        panic!("{cone:?}")
    };
    assert!(same && (axes.origin - Point3::new(0.0, 0.0, -2e-3)).norm() < 1e-18);
    // Offset twice, and along the normal of a plane that a trimmed surface turns over.
    let twice = "OFFSET_SURFACE('',#31,0.5,.F.);#31=PLANE('',#21)";
    let (plane, _) = offset("0.25", twice);
    assert!(matches!(plane, Carrier::Plane(axes) if axes.origin.z == 7.5e-4));
    let turned = "RECTANGULAR_TRIMMED_SURFACE('',#31,0.,1.,0.,1.,.F.,.T.);#31=PLANE('',#21)";
    let (plane, same) = offset("0.25", turned);
    assert!(matches!(plane, Carrier::Plane(axes) if axes.origin.z == -2.5e-4) && !same);
}

/// Distance of a place of the plane from an ellipse about the origin, all in mm.
fn from_ellipse([x, y]: [f64; 2], [a, b]: [f64; 2]) -> f64 {
    let at = |t: f64| libm::hypot(a * t.cos() - x, b * t.sin() - y);
    let count = 2000;
    let step = 2.0 * PI / f64::from(count);
    let best = (0..count).map(|k| step * f64::from(k));
    let best = best.min_by(|s, t| at(*s).total_cmp(&at(*t))).unwrap();
    let (mut low, mut high) = (best - step, best + step);
    for _ in 0..80 {
        let (s, t) = (low + 0.382 * (high - low), high - 0.382 * (high - low));
        if at(s) < at(t) { high = t } else { low = s }
    }
    at(0.5 * (low + high))
}

// An elliptic tube: its offset is no B-spline, and has every point at the distance from the ellipse.
#[test]
fn offsets_of_other_surfaces_are_fitted_and_their_error_is_said() {
    let tube = |by: &str| {
        within_circle(
            1.0,
            &format!(
                "OFFSET_SURFACE('',#36,{by},.F.);#36=SURFACE_OF_LINEAR_EXTRUSION('',#30,#31);#30=ELLIPSE('',#21,3.,1.5);\
                 #31=VECTOR('',#22,1.);#40=CARTESIAN_POINT('',(2.,0.,3.));#41=VERTEX_POINT('',#40);\
                 #42=VERTEX_LOOP('',#41);#43=FACE_BOUND('',#42,.T.)"
            ),
        )
        .replace("(#9),#10", "(#9,#43),#10")
    };
    let read = read_text(&tube("0.5")).unwrap();
    let Carrier::Spline(surface) = &read.brep.faces[0].carrier else {
        panic!("no spline")
    };
    let note = read.notes.iter().find(|note| note.contains("is fitted"));
    let said = note.expect("a note").split("it is ").nth(1).unwrap();
    let said_mm = said.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e3;
    assert!(said_mm < 1e-8, "{said_mm}");
    let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
    let mut worst = 0.0f64;
    for k in 0..500 {
        let s = (f64::from(k) * 0.618_033_988_749_895) % 1.0;
        let t = (f64::from(k) * 0.754_877_666_246_693) % 1.0;
        let p = surface.point(u.0 + s * (u.1 - u.0), v.0 + t * (v.1 - v.0)) * 1e3;
        worst = worst.max((from_ellipse([p.x, p.y], [3.0, 1.5]) - 0.5).abs());
    }
    // It was measured at other places, as many in each span; the golden section finds 1e-12 of the distance.
    assert!(worst <= 2.0 * said_mm + 1e-12, "{worst} of {said_mm}");
    // At the ends of the long axis its radius of curvature is 0.75 mm.
    let message = read_text(&tube("-0.8")).unwrap_err().to_string();
    assert_eq!(
        message,
        "#36: SURFACE_OF_LINEAR_EXTRUSION is not read: it is folded over, or has too many spans"
    );
}

/// The plane face within an edge from and to (2, 0, 0) along #60, in radians or in degrees.
fn within(curve: &str, degrees: bool) -> String {
    let disc = within_circle(0.0, "PLANE('',#21)").replace("#2,#2,#5,.T.", "#2,#2,#60,.T.");
    let disc = match degrees {
        true => disc.replace(
            "GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902))",
            "GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#912))",
        ),
        false => disc,
    };
    disc + curve
        + "#70=CARTESIAN_POINT('',(2.,0.,0.));#71=CARTESIAN_POINT('',(-2.,0.,0.));#72=CARTESIAN_POINT('',(0.,2.,0.));\
        #73=VECTOR('',#23,1.);#74=LINE('',#20,#73);#75=VECTOR('',#23,0.5);#76=LINE('',#71,#75);"
}

/// mm².
fn area(text: &str) -> f64 {
    let mut read = read_text(text).unwrap();
    let part = read.part(false).unwrap();
    assert!(read.notes.is_empty(), "{:?}", read.notes);
    part.measure().face_areas_m2.iter().sum::<f64>() * 1e6
}

const SEGMENTS: &str = "#61=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#63);#62=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#64);";

// A half disc from an arc and its diameter, each trimmed in every way that there is.
#[test]
fn curves_of_several_segments_are_joined_exactly() {
    let parameter = |t: f64| format!("(PARAMETER_VALUE({t:?}))");
    let arcs = [
        (parameter(0.0), parameter(PI), "T", "T", false),
        (parameter(0.0), parameter(180.0), "T", "T", true),
        ("(#70)".to_owned(), "(#71)".to_owned(), "T", "T", false),
        (
            format!("(#70,{}", &parameter(0.1)[1..]),
            "(#71,PARAMETER_VALUE(3.))".to_owned(),
            "T",
            "T",
            false,
        ),
        (parameter(PI), parameter(0.0), "F", "F", false),
        ("(#71)".to_owned(), parameter(2.0 * PI), "F", "F", false),
    ];
    let lines = [
        ("#74", "(#71)".to_owned(), "(#70)".to_owned(), "T"),
        ("#74", parameter(-2.0), parameter(2.0), "T"),
        ("#76", parameter(0.0), parameter(8.0), "T"),
        ("#76", parameter(8.0), parameter(0.0), "F"),
    ];
    for (a, b, sense, used, degrees) in &arcs {
        for (line, c, d, same) in &lines {
            let master = if a.starts_with("(#") {
                "CARTESIAN"
            } else {
                "PARAMETER"
            };
            let segments = SEGMENTS
                .replace(".T.,#63", &format!(".{used}.,#63"))
                .replace(".T.,#64", &format!(".{same}.,#64"));
            let text = within(
                &format!(
                    "#60=COMPOSITE_CURVE('',(#61,#62),.F.);{segments}#63=TRIMMED_CURVE('',#5,{a},{b},.{sense}.,.{master}.);\
                     #64=TRIMMED_CURVE('',{line},{c},{d},.{same}.,.UNSPECIFIED.);"
                ),
                *degrees,
            );
            let off = area(&text) / (2.0 * PI) - 1.0;
            assert!(off.abs() < 1e-13, "{a} {b} {c} {d}: {off}");
        }
    }
}

// Two parabolas, y² = 2 − x and its mirror image: 2 · ⅔ · base · height, or, with hyperbolas, by closed form.
#[test]
fn conics_and_b_splines_are_segments_too() {
    let two = |first: &str, second: &str| {
        within(
            &format!("#60=COMPOSITE_CURVE('',(#61,#62),.F.);{SEGMENTS}{first}{second}"),
            false,
        )
    };
    // f t² x + 2 f t y from (2, 0) with the axis −y through (0, 4/4f): y = 2 − x²/2 has f = ½.
    let parabola = |k: u64, up: &str, apex: &str, from: f64, to: f64| {
        let [a, b, c, d] = [100, 101, 102, 103].map(|n| 10 * k + n);
        format!(
            "#{k}=TRIMMED_CURVE('',#{a},(PARAMETER_VALUE({from:?})),(PARAMETER_VALUE({to:?})),.T.,.PARAMETER.);\
             #{a}=PARABOLA('',#{b},0.5);#{b}=AXIS2_PLACEMENT_3D('',#{c},#22,#{d});#{c}=CARTESIAN_POINT('',{apex});\
             #{d}=DIRECTION('',{up});"
        )
    };
    // With x of the parabola along −y, y of it is x; the other way round it is −x.
    let upper = parabola(63, "(0.,-1.,0.)", "(0.,2.,0.)", 2.0, -2.0);
    let lower = parabola(64, "(0.,1.,0.)", "(0.,-2.,0.)", 2.0, -2.0);
    let text = two(
        &upper.replace(".T.,.PARAMETER.", ".F.,.PARAMETER."),
        &lower.replace(".T.,.PARAMETER.", ".F.,.PARAMETER."),
    );
    let off = area(&text) / (2.0 * 2.0 / 3.0 * 4.0 * 2.0) - 1.0;
    assert!(off.abs() < 1e-13, "{off}");
    // The upper half of the circle as a B-spline of four quarters, from knot 0 to 2, and a polyline below.
    let spline = "#63=TRIMMED_CURVE('',#64,(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(2.)),.T.,.PARAMETER.);\
        #64=(BOUNDED_CURVE()B_SPLINE_CURVE(2,(#70,#80,#72,#81,#71,#82,#83,#84,#70),.UNSPECIFIED.,.T.,.F.)\
        B_SPLINE_CURVE_WITH_KNOTS((3,2,2,2,3),(0.,1.,2.,3.,4.),.UNSPECIFIED.)CURVE()GEOMETRIC_REPRESENTATION_ITEM()\
        RATIONAL_B_SPLINE_CURVE((1.,0.7071067811865476,1.,0.7071067811865476,1.,0.7071067811865476,1.,0.7071067811865476,1.))\
        REPRESENTATION_ITEM(''));#80=CARTESIAN_POINT('',(2.,2.,0.));#81=CARTESIAN_POINT('',(-2.,2.,0.));\
        #82=CARTESIAN_POINT('',(-2.,-2.,0.));#83=CARTESIAN_POINT('',(0.,-2.,0.));#84=CARTESIAN_POINT('',(2.,-2.,0.));";
    let polyline = "#65=POLYLINE('',(#71,#82,#84,#70));";
    let text = two(spline, polyline).replace(".T.,#64);", ".T.,#65);");
    let off = area(&text) / (2.0 * PI + 8.0) - 1.0;
    assert!(off.abs() < 1e-13, "{off}");
    // Backwards past the seam, from knot 1 over 0 to 3: the left three quarters' complement, with two corners.
    let past = spline.replace(
        "(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(2.)),.T.",
        "(PARAMETER_VALUE(1.)),(PARAMETER_VALUE(3.)),.F.",
    );
    let polyline = "#65=POLYLINE('',(#83,#71,#72));";
    let text = two(&past, polyline).replace(".T.,#64);", ".T.,#65);");
    let text = text.replace("FACE_BOUND('',#8,.T.)", "FACE_BOUND('',#8,.F.)");
    let off = area(&text) / (2.0 * PI + 4.0) - 1.0;
    assert!(off.abs() < 1e-13, "{off}");
}

#[test]
fn segments_that_are_wrong_are_named() {
    let text = |first: &str, second: &str| {
        within(
            &format!("#60=COMPOSITE_CURVE('',(#61,#62),.F.);{SEGMENTS}#63={first};#64={second};"),
            false,
        )
    };
    let arc = "TRIMMED_CURVE('',#5,(#70),(#71),.T.,.CARTESIAN.)";
    let message = |text: &str| read_text(text).unwrap_err().to_string();
    for (second, wanted) in [
        (
            "LINE('',#20,#73)",
            "#64: LINE is not read: a segment without ends: trim it",
        ),
        (
            "TRIMMED_CURVE('',#74,(#72),(#70),.T.,.CARTESIAN.)",
            "#60: the loop is open by 2.0",
        ),
        (
            "TRIMMED_CURVE('',#74,(#72),(#72),.T.,.CARTESIAN.)",
            "#64: TRIMMED_CURVE is not read: both its ends are at one place",
        ),
        (
            "TRIMMED_CURVE('',#74,(),(#70),.T.,.CARTESIAN.)",
            "#64: attribute 3 of TRIMMED_CURVE should be a parameter or a point",
        ),
        (
            "COMPOSITE_CURVE('',(#61,#62),.F.)",
            "#64: COMPOSITE_CURVE is not read: curves of curves are read eight deep",
        ),
        (
            "OFFSET_CURVE_3D('',#5,1.,.F.,#22)",
            "#64: OFFSET_CURVE_3D is not read: convert it to a B-spline",
        ),
    ] {
        let message = message(&text(arc, second));
        assert!(message.starts_with(wanted), "{message}");
    }
    // A hundredth of a millimetre is what the file allows twice of.
    let near = text(arc, "TRIMMED_CURVE('',#74,(#77),(#70),.T.,.CARTESIAN.)")
        + "#77=CARTESIAN_POINT('',(-1.99,0.,0.));";
    let read = read_text(&near).unwrap();
    assert_eq!(
        read.notes,
        ["#60: segments #61 and #62 are 1.0e-5 m apart and taken as joined"]
    );
}

// Each entity of curves that is read, as the edge of a plane face, and of surfaces.
#[test]
fn every_curve_and_surface_of_the_list_is_read() {
    let net = |k: u64| format!("#{k}=CARTESIAN_POINT('',({}.,{}.,0.));", k % 4, k / 4 % 4);
    let points: String = (120..136).map(net).collect();
    let row = |first: u64| format!("(#{},#{},#{},#{})", first, first + 1, first + 2, first + 3);
    let rows = format!("({},{},{},{})", row(120), row(124), row(128), row(132));
    let spline = format!("3,{},.UNSPECIFIED.,.F.,.F.", row(120));
    let curves = [
        "LINE('',#20,#73)".to_owned(),
        "CIRCLE('',#21,2.)".to_owned(),
        "ELLIPSE('',#21,2.,1.)".to_owned(),
        "HYPERBOLA('',#21,2.,1.)".to_owned(),
        "PARABOLA('',#21,2.)".to_owned(),
        "POLYLINE('',(#20,#70,#72))".to_owned(),
        format!("B_SPLINE_CURVE_WITH_KNOTS('',{spline},(4,4),(0.,1.),.UNSPECIFIED.)"),
        format!("BEZIER_CURVE('',{spline})"),
        format!("UNIFORM_CURVE('',{spline})"),
        format!("QUASI_UNIFORM_CURVE('',{spline})"),
        format!(
            "(BEZIER_CURVE()BOUNDED_CURVE()B_SPLINE_CURVE({spline})CURVE()RATIONAL_B_SPLINE_CURVE((1.,2.,2.,1.))\
                 GEOMETRIC_REPRESENTATION_ITEM()REPRESENTATION_ITEM(''))"
        ),
        "TRIMMED_CURVE('',#5,(#70),(#71),.T.,.CARTESIAN.)".to_owned(),
        "COMPOSITE_CURVE('',(#61),.F.);#61=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#5)".to_owned(),
        "SURFACE_CURVE('',#5,(),.CURVE_3D.)".to_owned(),
        "SEAM_CURVE('',#5,(),.PCURVE_S1.)".to_owned(),
        "INTERSECTION_CURVE('',#5,(),.PCURVE_S2.)".to_owned(),
    ];
    for curve in curves {
        let text = within(&format!("#60={curve};{points}"), false);
        let read = read_text(&text);
        let line = curve.starts_with("LINE");
        let found = read.map(|read| read.brep.edges.len());
        // A straight edge from a vertex to itself is that vertex.
        assert_eq!(found, Ok(usize::from(!line)), "{curve}");
    }
    let common = format!("3,3,{rows},.UNSPECIFIED.,.F.,.F.,.F.");
    let surfaces = [
        ("PLANE('',#21)".to_owned(), "plane"),
        ("CYLINDRICAL_SURFACE('',#21,2.)".to_owned(), "cylinder"),
        ("CONICAL_SURFACE('',#21,2.,0.5)".to_owned(), "cone"),
        ("SPHERICAL_SURFACE('',#21,2.)".to_owned(), "sphere"),
        ("TOROIDAL_SURFACE('',#21,2.,1.)".to_owned(), "torus"),
        ("DEGENERATE_TOROIDAL_SURFACE('',#21,1.,2.,.T.)".to_owned(), "torus"),
        (format!("B_SPLINE_SURFACE_WITH_KNOTS('',{common},(4,4),(4,4),(0.,1.),(0.,1.),.UNSPECIFIED.)"), "b-spline"),
        (format!("BEZIER_SURFACE('',{common})"), "b-spline"),
        (format!("UNIFORM_SURFACE('',{common})"), "b-spline"),
        (format!("QUASI_UNIFORM_SURFACE('',{common})"), "b-spline"),
        ("SURFACE_OF_LINEAR_EXTRUSION('',#5,#31);#31=VECTOR('',#22,1.)".to_owned(), "cylinder"),
        ("SURFACE_OF_REVOLUTION('',#30,#25);#30=CIRCLE('',#31,1.);#31=AXIS2_PLACEMENT_3D('',#20,#24,#23)".to_owned(), "sphere"),
        ("RECTANGULAR_TRIMMED_SURFACE('',#30,0.,1.,0.,1.,.T.,.T.);#30=PLANE('',#21)".to_owned(), "plane"),
        ("OFFSET_SURFACE('',#30,1.,.F.);#30=PLANE('',#21)".to_owned(), "plane"),
    ];
    for (surface, name) in surfaces {
        let (carrier, _) = face_of(&within_circle(
            0.0,
            &format!("{surface};{}", points.trim_end_matches(';')),
        ));
        assert_eq!(carrier.name(), name, "{surface}");
    }
}

// An edge off its surface: the face alone is left out, and the solid is open there.
#[test]
fn a_face_that_makes_no_part_is_left_out_if_wanted() {
    let text = cube("#31=FACETED_BREP('',#30);");
    let mut whole = read_text(&text).unwrap();
    let faces = whole.brep.faces.len();
    let id = whole.brep.faces[2].id;
    assert!(whole.part(true).unwrap().is_closed() && whole.left_out.is_nothing());
    let Carrier::Plane(axes) = &mut whole.brep.faces[2].carrier else {
        panic!("no plane")
    };
    axes.origin += axes.z * 0.1e-3;
    let error = whole.clone().part(false).unwrap_err().to_string();
    assert!(error.contains(&format!("off face #{id}")), "{error}");
    let part = whole.part(true).unwrap();
    assert_eq!((part.faces().len(), part.is_closed()), (faces - 1, false));
    assert!(part.faces().all(|face| face.id != id));
    assert_eq!(whole.solids[0].faces, 0..faces - 1);
    assert_eq!(whole.left_out.to_string(), "1 faces (1 at plane)");
    assert_eq!(whole.left_out.errors, [error]);
    assert!(
        whole
            .notes
            .iter()
            .any(|note| note.contains("belong to one face only: 4")),
        "{:?}",
        whole.notes
    );
    // All of them.
    for face in &mut whole.brep.faces {
        if let Carrier::Plane(axes) = &mut face.carrier {
            axes.origin += axes.z * 0.1e-3;
        }
    }
    let error = whole.part(true).unwrap_err().to_string();
    assert_eq!(error, "the part has no faces");
}

// Both the edge of the disc and its vertex are on the plane, and far from each other.
#[test]
fn an_edge_far_from_its_vertex_is_refused() {
    let text = within_circle(0.0, "PLANE('',#21)").replace("'',(2.,0.,0.0)", "'',(2.5,0.,0.0)");
    let message = read_text(&text)
        .unwrap()
        .part(false)
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with("edge #6 ends 5.000e-4 m from its vertex, more than the 2.0e-5 m"),
        "{message}"
    );
}

// What is written of a part whose faces were turned has nothing to turn, and is the part that was right from the start.
#[test]
fn senses_are_written_as_they_were_corrected() {
    for name in ["filleted_box", "turned", "seam_cut"] {
        let mut right = read_part(&data(&format!("{name}.step")), &PartPick::default()).unwrap();
        right.part(false).unwrap();
        let volume = |brep: &Brep| Part::new(brep).unwrap().measure().volume_m3.unwrap();
        for (sense, loops, k) in [(true, false, 0), (true, true, 1), (true, true, 3)] {
            let mut wrong = right.clone();
            let face = &mut wrong.brep.faces[k];
            face.same_sense ^= sense;
            face.bounds
                .iter_mut()
                .filter(|_| loops)
                .for_each(crate::part::BrepBound::reverse);
            if Part::new(&wrong.brep).unwrap().senses().turned.is_empty() {
                // Both sides of a loop are bounded there.
                continue;
            }
            wrong.part(false).unwrap();
            let text = write_part(&wrong.brep, &wrong.unit, name).unwrap();
            let again = read_part(text.as_bytes(), &PartPick::default()).unwrap();
            let part = Part::new(&again.brep).unwrap();
            assert!(part.senses().turned.is_empty(), "{name}, face {k}");
            assert!((volume(&again.brep) / volume(&right.brep) - 1.0).abs() < 1e-14);
        }
    }
}

/// A file's instances with their numbers raised, but for those of its contexts.
fn renumbered(text: &str, by: u64) -> String {
    let mut out = String::new();
    for (k, part) in text.split('#').enumerate() {
        let digits = part.chars().take_while(char::is_ascii_digit).count();
        let id = part[..digits].parse::<u64>().map(|id| match id {
            900..=930 => id,
            id => id + by,
        });
        match (k, id) {
            (0, _) => out += part,
            (_, Ok(id)) => out += &format!("#{id}{}", &part[digits..]),
            (_, Err(_)) => out += &format!("#{part}"),
        }
    }
    out
}

// A disc in millimetres in an assembly in inches in one in metres; beside it a cone of 45° in inches and degrees, whose mirror
// image stands in the assembly in millimetres. Each has a circle of radius 2 about the z axis of its own.
#[test]
fn one_assembly_may_mix_metres_millimetres_inches_degrees_and_mirrors() {
    let metres = "#920=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#921,#902))REPRESENTATION_CONTEXT('',''));\
        #921=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,.METRE.));";
    let cone = within_circle(2.0, "CONICAL_SURFACE('',#21,0.,45.)")
        .replace("(#13),#900", "(#13),#910")
        .replace(CONTEXTS, "");
    let frame = |id: u64, at: &str| {
        format!(
            "#{id}=AXIS2_PLACEMENT_3D('',#{0},$,$);#{0}=CARTESIAN_POINT('',{at});",
            id + 1
        )
    };
    let mirror = "#60=MAPPED_ITEM('',#61,#62);#61=REPRESENTATION_MAP(#5021,#5014);#63=DIRECTION('',(0.,-1.,0.));\
        #62=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#23,#63,#602,2.,#22);";
    let text = assembly(910)
        + metres
        + &renumbered(&cone, 5000)
        + &product(6000, "cone", 5014)
        + &product(7000, "top", 600)
        + "#600=SHAPE_REPRESENTATION('',(#601,#611,#21,#60),#920);"
        + &frame(601, "(1.,0.,0.)")
        + &frame(611, "(0.,3.,0.)")
        + mirror
        + &usage(3000, [2000, 1000], [14, 50], [21, 51])
        + &usage(3100, [7000, 2000], [50, 600], [21, 601])
        + &usage(3200, [7000, 6000], [5014, 600], [5021, 611]);
    let mut read = read_text(&text).unwrap();
    let part = read.part(false).unwrap();
    let mut vertices: Vec<[f64; 3]> = (read.brep.vertices.iter())
        .map(|p| [p.x, p.y, p.z])
        .collect();
    vertices.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let inch = 0.0254;
    let wanted = [
        // The cone at (0, 3 m, 0).
        [2.0 * inch, 3.0, 2.0 * inch],
        // Its mirror image, twice as large, at (1 m, 0, 0).
        [1.0 + 4.0 * inch, 0.0, 4.0 * inch],
        // The disc 10 inches from (1 m, 0, 0).
        [1.0 + 10.0 * inch + 0.002, 0.0, 0.0],
    ];
    assert_eq!(vertices.len(), 3);
    for (found, wanted) in vertices.iter().zip(wanted) {
        let off = (0..3).map(|k| (found[k] - wanted[k]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-15, "{found:?}, not {wanted:?}");
    }
    // π r² of the disc, π r² √2 of the cones.
    let circle = |r: f64| PI * r * r;
    let wanted = circle(0.002) + 2f64.sqrt() * (circle(2.0 * inch) + circle(4.0 * inch));
    let area: f64 = part.measure().face_areas_m2.iter().sum();
    assert!((area / wanted - 1.0).abs() < 1e-12, "{area}, not {wanted}");
    assert_eq!(part.faces().len(), 3);
}
