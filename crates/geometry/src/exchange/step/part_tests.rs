use super::*;
use crate::exchange::testing::{every_prefix, mutations};
use crate::math::Point3;
use crate::part::{BrepBound, BrepCurve, Carrier};
use crate::surface::Surface;
use std::f64::consts::FRAC_PI_4;

/// Millimetres, radians, 0.01 mm; and in #910 inches and degrees.
pub(super) const CONTEXTS: &str = "#900=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#904))\
    GLOBAL_UNIT_ASSIGNED_CONTEXT((#901,#902))REPRESENTATION_CONTEXT('',''));\
    #901=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));#902=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));\
    #904=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(0.01),#901,'','');\
    #910=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#911,#912))REPRESENTATION_CONTEXT('',''));\
    #911=(CONVERSION_BASED_UNIT('INCH',#913)LENGTH_UNIT()NAMED_UNIT(*));#913=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#901);\
    #912=(CONVERSION_BASED_UNIT('DEGREE',#914)NAMED_UNIT(*)PLANE_ANGLE_UNIT());\
    #914=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.01745329252),#902);";

pub(super) fn file(data: &str) -> String {
    format!("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n")
}

pub(super) fn read_text(data: &str) -> Result<ImportedPart, StepError> {
    read_part(file(data).as_bytes(), &PartPick::default())
}

/// A face within a circle of radius 2 at height z; surface #10, which may refer to #20 and up.
pub(super) fn within_circle(z: f64, surface: &str) -> String {
    format!(
        "{CONTEXTS}#1=CARTESIAN_POINT('',(2.,0.,{z:?}));#2=VERTEX_POINT('',#1);#3=CARTESIAN_POINT('',(0.,0.,{z:?}));\
         #4=AXIS2_PLACEMENT_3D('',#3,$,$);#5=CIRCLE('',#4,2.);#6=EDGE_CURVE('',#2,#2,#5,.T.);#7=ORIENTED_EDGE('',*,*,#6,.T.);\
         #8=EDGE_LOOP('',(#7));#9=FACE_BOUND('',#8,.T.);#11=ADVANCED_FACE('',(#9),#10,.T.);#12=OPEN_SHELL('',(#11));\
         #13=SHELL_BASED_SURFACE_MODEL('sheet',(#12));#14=SHAPE_REPRESENTATION('',(#13),#900);#20=CARTESIAN_POINT('',(0.,0.,0.));\
         #21=AXIS2_PLACEMENT_3D('',#20,$,$);#22=DIRECTION('',(0.,0.,1.));#23=DIRECTION('',(1.,0.,0.));#24=DIRECTION('',(0.,1.,0.));\
         #25=AXIS1_PLACEMENT('',#20,#22);#10={surface};"
    )
}

pub(super) fn face_of(data: &str) -> (Carrier, bool) {
    let read = read_text(data).unwrap();
    assert_eq!(read.brep.faces.len(), 1);
    let face = &read.brep.faces[0];
    (face.carrier.clone(), face.same_sense)
}

pub(super) fn product(base: u64, name: &str, representation: u64) -> String {
    let [a, b, c, d] = [1, 2, 3, 4].map(|k| base + k);
    format!(
        "#{base}=PRODUCT('{name}-1','{name}','',());#{a}=PRODUCT_DEFINITION_FORMATION('','',#{base});\
         #{b}=PRODUCT_DEFINITION('','',#{a},$);#{c}=PRODUCT_DEFINITION_SHAPE('','',#{b});\
         #{d}=SHAPE_DEFINITION_REPRESENTATION(#{c},#{representation});"
    )
}

/// A product's part in another's, both by their base; representations and frames in the order of the relation.
pub(super) fn usage(
    base: u64,
    [whole, part]: [u64; 2],
    ends: [u64; 2],
    frames: [u64; 2],
) -> String {
    let [a, b, c, d] = [1, 2, 3, 4].map(|k| base + k);
    let ([e, f], [i, j], whole, part) = (ends, frames, whole + 2, part + 2);
    format!(
        "#{base}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{whole},#{part},$);#{a}=PRODUCT_DEFINITION_SHAPE('','',#{base});\
         #{b}=ITEM_DEFINED_TRANSFORMATION('','',#{i},#{j});#{c}=(REPRESENTATION_RELATIONSHIP('','',#{e},#{f})\
         REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{b})SHAPE_REPRESENTATION_RELATIONSHIP());\
         #{d}=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{c},#{a});"
    )
}

/// The plane face as "disc" (#14), in an assembly "whole" (#50), whose frame #51 is at (10, 0, 0), or that in inches.
pub(super) fn assembly(context: u64) -> String {
    let disc = within_circle(0.0, "PLANE('',#21)");
    let (disc_product, whole) = (product(1000, "disc", 14), product(2000, "whole", 50));
    format!(
        "{disc}{disc_product}{whole}#50=SHAPE_REPRESENTATION('',(#51,#21),#{context});#51=AXIS2_PLACEMENT_3D('',#52,$,$);\
         #52=CARTESIAN_POINT('',(10.,0.,0.));"
    )
}

pub(super) fn data(name: &str) -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/parts");
    std::fs::read(path.join(name)).unwrap()
}

/// Each edge of a closed shell is walked once in each direction, and its ends are on its curve's end.
fn check_closed(brep: &crate::part::Brep) {
    let mut uses = vec![[0, 0]; brep.edges.len()];
    for bound in brep.faces.iter().flat_map(|face| &face.bounds) {
        if let BrepBound::Loop(walk) = bound {
            for &(edge, forward) in walk {
                uses[edge as usize][usize::from(forward)] += 1;
            }
        }
    }
    assert!(uses.iter().all(|both| *both == [1, 1]), "{uses:?}");
}

// Faces, their kinds and their order are OpenCASCADE's.
#[test]
fn parts_have_the_faces_that_opencascade_finds() {
    let names = [
        "filleted_box",
        "turned",
        "cone_tip",
        "pipe",
        "assembly",
        "seam_cut",
        "saddle",
    ];
    for name in names {
        let read = read_part(&data(&format!("{name}.step")), &PartPick::default()).unwrap();
        let expected: serde_json::Value =
            serde_json::from_slice(&data(&format!("{name}.json"))).unwrap();
        let kinds: Vec<&str> = read
            .brep
            .faces
            .iter()
            .map(|face| face.carrier.name())
            .collect();
        let wanted: Vec<String> = (expected["faces"].as_array().unwrap().iter())
            .map(|face| match face["type"].as_str().unwrap() {
                "BSplineSurface" | "BSpline" => "b-spline".to_owned(),
                other => other.to_lowercase(),
            })
            .collect();
        assert_eq!(kinds, wanted, "{name}");
        assert!(read.left_out.is_nothing(), "{name}: {}", read.left_out);
        assert_eq!(
            read.brep.edges.len() as u64,
            expected["edges"].as_u64().unwrap(),
            "{name}"
        );
        assert_eq!(
            read.solids.len() as u64,
            expected["solids"].as_u64().unwrap(),
            "{name}"
        );
        check_closed(&read.brep);
        for (axis, low, high) in (0..3).map(|k| (k, &expected["box"][0][k], &expected["box"][1][k]))
        {
            for vertex in &read.brep.vertices {
                let at = vertex[axis] * 1e3;
                let (low, high) = (low.as_f64().unwrap(), high.as_f64().unwrap());
                assert!((low - 1e-6..=high + 1e-6).contains(&at), "{name}: {vertex}");
            }
        }
    }
}

#[test]
fn a_cone_lies_on_the_nappe_of_its_face_and_angles_are_in_the_files_unit() {
    // Radius 1 at the origin, half angle 45°: the apex is at z = −1, the circles of radius 2 at 1 and −3 mm.
    let cone =
        |z: f64, angle: &str| within_circle(z, &format!("CONICAL_SURFACE('',#21,1.,{angle})"));
    for (z, up) in [(1.0, 1.0), (-3.0, -1.0)] {
        let (carrier, same) = face_of(&cone(z, "0.7853981633974483"));
        let Carrier::Cone {
            axes,
            half_angle_rad,
        } = carrier
        else {
            panic!("{carrier:?}")
        };
        assert!((axes.origin - Point3::new(0.0, 0.0, -1e-3)).norm() < 1e-18);
        assert_eq!((axes.z.z, same, half_angle_rad), (up, true, FRAC_PI_4));
        assert!((axes.x.cross(&axes.y) - axes.z).norm() < 1e-15);
    }
    let inches = cone(1.0, "45.").replace("(#13),#900", "(#13),#910");
    let (carrier, _) = face_of(&inches);
    assert!(matches!(carrier, Carrier::Cone { half_angle_rad, .. } if half_angle_rad == FRAC_PI_4));
    for (bad, wanted) in [("0.", "is 0.0;"), ("1.6", "is 1.6;"), ("-0.3", "is -0.3;")] {
        let message = read_text(&cone(1.0, bad)).unwrap_err().to_string();
        assert!(
            message.starts_with("#10: the half angle of CONICAL_SURFACE"),
            "{message}"
        );
        assert!(message.contains(wanted), "{message}");
    }
}

// The normal of what is swept is S_u × S_v, whatever the carrier's is.
#[test]
fn swept_lines_and_circles_are_elementary_surfaces() {
    let swept = |surface: &str| face_of(&within_circle(1.0, surface));
    let circle = "SURFACE_OF_LINEAR_EXTRUSION('',#30,#31);#30=CIRCLE('',#21,2.);#31=VECTOR('',#32,1.);#32=DIRECTION";
    let (up, same) = swept(&format!("{circle}('',(0.,0.,1.))"));
    assert!(
        matches!(up, Carrier::Cylinder { radius_m: 2e-3, .. }) && same,
        "{up:?}"
    );
    let (_, down) = swept(&format!("{circle}('',(0.,0.,-3.))"));
    assert!(!down);
    let line = "#30=LINE('',#33,#31);#31=VECTOR('',#32,1.)";
    let turned = |from: &str, along: &str| {
        swept(&format!(
            "SURFACE_OF_REVOLUTION('',#30,#25);{line};#33=CARTESIAN_POINT('',{from});#32=DIRECTION('',{along})"
        ))
    };
    let (carrier, same) = turned("(2.,0.,0.)", "(0.,0.,-1.)");
    assert!(
        matches!(carrier, Carrier::Cylinder { .. }) && !same,
        "{carrier:?}"
    );
    // From the axis outwards, x × y of the turn: (z × r) × r points down.
    let (carrier, same) = turned("(0.,0.,1.)", "(1.,0.,0.)");
    assert!(matches!(carrier, Carrier::Plane(axes) if axes.origin.z == 1e-3) && !same);
    let (carrier, same) = turned("(1.,0.,0.)", "(1.,0.,1.)");
    assert!(matches!(carrier, Carrier::Cone { axes, .. } if (axes.origin.z + 1e-3).abs() < 1e-18));
    assert!(same);
    let round = |x: f64| {
        swept(&format!(
            "SURFACE_OF_REVOLUTION('',#30,#25);#30=CIRCLE('',#31,0.5);#31=AXIS2_PLACEMENT_3D('',#33,#24,#23);\
             #33=CARTESIAN_POINT('',({x:?},0.,1.))"
        ))
    };
    assert!(matches!(
        round(0.0),
        (Carrier::Sphere { radius_m: 5e-4, .. }, _)
    ));
    // z × x about −y: the circle runs from outside downwards, and (z × r) × C' points into the tube.
    let (torus, same) = round(2.0);
    assert!(
        matches!(
            torus,
            Carrier::Torus {
                major_m: 2e-3,
                minor_m: 5e-4,
                ..
            }
        ) && !same
    );
}

// A line that passes the axis by makes a hyperboloid, an ellipse a spheroid: both by closed form.
#[test]
fn other_swept_surfaces_are_exact_b_splines() {
    let spline = |surface: &str| match face_of(&within_circle(1.0, surface)) {
        (Carrier::Spline(surface), same) => (surface, same),
        (other, _) => panic!("{other:?}"),
    };
    let steps = || (0..=20).map(|k| f64::from(k) / 20.0);
    let at = |surface: &Surface, s: f64, t: f64| {
        let (u, v) = (surface.knots_u().domain(), surface.knots_v().domain());
        surface.point(u.0 + s * (u.1 - u.0), v.0 + t * (v.1 - v.0)) * 1e3
    };
    let two_heights = within_circle(
        1.0,
        "SURFACE_OF_REVOLUTION('',#30,#25);#30=LINE('',#33,#31);#31=VECTOR('',#32,1.);#33=CARTESIAN_POINT('',(1.,0.,0.));\
         #32=DIRECTION('',(0.,1.,1.));#40=CARTESIAN_POINT('',(2.,0.,3.));#41=VERTEX_POINT('',#40);#42=VERTEX_LOOP('',#41);\
         #43=FACE_BOUND('',#42,.T.)",
    );
    let (Carrier::Spline(surface), _) = face_of(&two_heights.replace("(#9),#10", "(#9,#43),#10"))
    else {
        panic!("no spline")
    };
    for (s, t) in steps().flat_map(|s| steps().map(move |t| (s, t))) {
        let p = at(&surface, s, t);
        assert!(
            (p.x * p.x + p.y * p.y - p.z * p.z - 1.0).abs() < 1e-12,
            "{p}"
        );
    }
    assert!(at(&surface, 0.0, 0.0).z < 1.0 && at(&surface, 0.0, 1.0).z > 3.0);
    let (surface, same) = spline(
        "SURFACE_OF_REVOLUTION('',#30,#25);#30=ELLIPSE('',#31,3.,1.5);#31=AXIS2_PLACEMENT_3D('',#20,#24,#23)",
    );
    for (s, t) in steps().flat_map(|s| steps().map(move |t| (s, t))) {
        let p = at(&surface, s, t);
        assert!(
            ((p.x * p.x + p.y * p.y) / 9.0 + p.z * p.z / 2.25 - 1.0).abs() < 1e-12,
            "{p}"
        );
    }
    assert!(same);
    // As high as a second bound wants it.
    let cylinder = two_heights.split("#10=").next().unwrap().to_owned()
        + "#10=SURFACE_OF_LINEAR_EXTRUSION('',#30,#31);#30=ELLIPSE('',#21,3.,1.5);#31=VECTOR('',#22,1.);\
           #40=CARTESIAN_POINT('',(2.,0.,3.));#41=VERTEX_POINT('',#40);#42=VERTEX_LOOP('',#41);#43=FACE_BOUND('',#42,.T.);";
    let (Carrier::Spline(surface), _) = face_of(&cylinder.replace("(#9),#10", "(#9,#43),#10"))
    else {
        panic!("no spline")
    };
    for (s, t) in steps().flat_map(|s| steps().map(move |t| (s, t))) {
        let p = at(&surface, s, t);
        assert!(
            (p.x * p.x / 9.0 + p.y * p.y / 2.25 - 1.0).abs() < 1e-12,
            "{p}"
        );
    }
}

/// A unit cube of polygons, and what goes on behind its shell #30.
pub(super) fn cube(solid: &str) -> String {
    let mut text = CONTEXTS.to_owned();
    for k in 0..8 {
        let [x, y, z] = [k & 1, k >> 1 & 1, k >> 2];
        text += &format!("#{}=CARTESIAN_POINT('',({x}.,{y}.,{z}.));", 1 + k);
    }
    // Corners counter-clockwise from outside; the normals are z, −z, −y, y, −x, x.
    let sides = [
        ("5,6,8,7", "0.,0.,1."),
        ("1,3,4,2", "0.,0.,-1."),
        ("1,2,6,5", "0.,-1.,0."),
        ("3,7,8,4", "0.,1.,0."),
        ("1,5,7,3", "-1.,0.,0."),
        ("2,4,8,6", "1.,0.,0."),
    ];
    for (k, (corners, normal)) in sides.iter().enumerate() {
        let b = 100 + 10 * k;
        let corners = corners.replace(',', ",#");
        let first = corners.split(',').next().unwrap();
        text += &format!(
            "#{b}=POLY_LOOP('',(#{corners}));#{}=FACE_OUTER_BOUND('',#{b},.T.);#{}=DIRECTION('',({normal}));\
             #{}=AXIS2_PLACEMENT_3D('',#{first},#{},$);#{}=PLANE('',#{});#{}=FACE_SURFACE('',(#{}),#{},.T.);",
            b + 1,
            b + 2,
            b + 3,
            b + 2,
            b + 4,
            b + 3,
            b + 5,
            b + 1,
            b + 4
        );
    }
    text + "#30=CLOSED_SHELL('',(#105,#115,#125,#135,#145,#155));" + solid
}

#[test]
fn polygons_share_their_sides_and_reversed_shells_turn_senses_and_walks() {
    let plain = read_text(&cube("#31=FACETED_BREP('cube',#30);")).unwrap();
    assert_eq!((plain.brep.vertices.len(), plain.brep.edges.len()), (8, 12));
    check_closed(&plain.brep);
    assert_eq!(
        (plain.solids[0].name.as_str(), plain.solids[0].faces.clone()),
        ("cube", 0..6)
    );
    assert!(
        plain.notes.iter().any(|note| note.contains("no product")),
        "{:?}",
        plain.notes
    );
    let turned = "#31=MANIFOLD_SOLID_BREP('',#32);#32=ORIENTED_CLOSED_SHELL('',*,#30,.F.);";
    let turned = read_text(&cube(turned)).unwrap().brep;
    check_closed(&turned);
    for (a, b) in plain.brep.faces.iter().zip(&turned.faces) {
        assert!(a.same_sense && !b.same_sense);
        let (BrepBound::Loop(a), BrepBound::Loop(b)) = (&a.bounds[0], &b.bounds[0]) else {
            panic!("no loop")
        };
        // Edges are numbered as they are met, which turning does not change.
        let back: Vec<(u32, bool)> = b
            .iter()
            .rev()
            .map(|(edge, forward)| (*edge, !forward))
            .collect();
        assert_eq!(*a, back);
    }
    let hollow = "#31=BREP_WITH_VOIDS('',#30,(#32));#32=ORIENTED_CLOSED_SHELL('',*,#30,.F.);";
    let hollow = read_text(&cube(hollow)).unwrap().brep;
    assert_eq!(hollow.shells.len(), 2);
    assert!(
        hollow
            .shells
            .iter()
            .all(|shell| shell.closed && shell.solid == Some(0))
    );
}

#[test]
fn trimmed_and_surface_curves_are_their_curve_in_space_and_its_direction() {
    let disc = within_circle(0.0, "PLANE('',#21)");
    let wrapped = |sense: char| {
        disc.replace("#2,#2,#5,.T.", "#2,#2,#60,.T.")
            + &format!(
                "#60=SURFACE_CURVE('',#61,(#62),.PCURVE_S1.);#61=TRIMMED_CURVE('',#5,(PARAMETER_VALUE(0.)),\
                 (PARAMETER_VALUE(3.)),.{sense}.,.PARAMETER.);"
            )
    };
    for (sense, along) in [('T', true), ('F', false)] {
        let edge = read_text(&wrapped(sense)).unwrap().brep.edges[0].clone();
        assert_eq!(edge.along, along);
        assert!(matches!(
            edge.curve,
            BrepCurve::Circle { radius_m: 2e-3, .. }
        ));
    }
    let flat = disc.replace("#2,#2,#5,.T.", "#2,#2,#60,.T.") + "#60=PCURVE('',#10,#61);";
    let message = read_text(&flat).unwrap_err().to_string();
    assert_eq!(
        message,
        "#60: PCURVE is not read: edges need a curve in space, not in parameters alone"
    );
}

// SolidWorks writes the whole first, others the part: the products decide.
#[test]
fn a_relation_may_name_its_ends_in_either_order() {
    for (ends, frames) in [([14, 50], [21, 51]), ([50, 14], [51, 21])] {
        let text = assembly(900) + &usage(3000, [2000, 1000], ends, frames);
        let read = read_text(&text).unwrap();
        assert_eq!(read.brep.vertices, [Point3::new(12.0 / 1000.0, 0.0, 0.0)]);
        assert_eq!(
            (read.solids[0].name.as_str(), read.solids[0].instance),
            ("disc", 0)
        );
    }
    // A single surface as well.
    let sheet = "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,((#80,#81),(#82,#83)),.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(2,2),(0.,1.),\
        (0.,1.),.UNSPECIFIED.);#80=CARTESIAN_POINT('',(0.,0.,0.));#81=CARTESIAN_POINT('',(0.,1.,0.));\
        #82=CARTESIAN_POINT('',(1.,0.,0.));#83=CARTESIAN_POINT('',(1.,1.,0.))";
    for (ends, frames) in [([14, 50], [21, 51]), ([50, 14], [51, 21])] {
        let text = assembly(900).replace("PLANE('',#21)", sheet)
            + &usage(3000, [2000, 1000], ends, frames);
        let surface = read(file(&text).as_bytes(), Pick::First).unwrap().surface;
        assert_eq!(surface.point(0.0, 0.0), Point3::new(0.01, 0.0, 0.0));
    }
    // Placements are in the unit of their own representation, and only they.
    let text = assembly(910) + &usage(3000, [2000, 1000], [14, 50], [21, 51]);
    let vertex = read_text(&text).unwrap().brep.vertices[0];
    assert!((vertex.x - (0.254 + 0.002)).abs() < 1e-15, "{vertex}");
}

// A mirrored circle runs the other way, and the plane's y turns round: the face stays on the left.
#[test]
fn mapped_items_may_be_mirrored_and_scaled() {
    let text = assembly(900)
        + "#60=MAPPED_ITEM('',#61,#62);#61=REPRESENTATION_MAP(#21,#14);#63=DIRECTION('',(0.,-1.,0.));\
           #62=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#23,#63,#52,3.,#22);";
    let text = text.replace("(#51,#21),#900", "(#51,#21,#60),#900");
    let read = read_text(&text).unwrap().brep;
    assert!((read.vertices[0] - Point3::new(0.016, 0.0, 0.0)).norm() < 1e-17);
    let (edge, face) = (&read.edges[0], &read.faces[0]);
    assert!(
        matches!(edge.curve, BrepCurve::Circle { radius_m, .. } if (radius_m - 6e-3).abs() < 1e-17)
    );
    // Backwards on the mirrored circle, walked backwards: counter-clockwise about z, as before.
    assert!(!edge.along && face.same_sense);
    assert!(matches!(&face.bounds[0], BrepBound::Loop(walk) if walk == &[(0, false)]));
}

#[test]
fn parts_are_picked_by_name_and_place() {
    let mut text = assembly(900);
    for k in 0..1000 {
        text += &format!(
            "#{0}=AXIS2_PLACEMENT_3D('',#{1},$,$);#{1}=CARTESIAN_POINT('',({k}.,0.,0.));",
            10_000 + 10 * k,
            10_001 + 10 * k
        );
        text += &usage(
            100_000 + 10 * k,
            [2000, 1000],
            [14, 50],
            [21, 10_000 + 10 * k],
        );
    }
    let bytes = file(&text);
    let pick = |part: Option<&str>, instance: Option<usize>| {
        let part = part.map(str::to_owned);
        read_part(
            bytes.as_bytes(),
            &PartPick {
                part,
                instance,
                partial: false,
            },
        )
    };
    let all = pick(None, None).unwrap();
    assert_eq!(
        (all.brep.faces.len(), all.solids[999].instance),
        (1000, 999)
    );
    for part in [None, Some("disc"), Some("disc-1")] {
        let one = pick(part, Some(7)).unwrap();
        assert!((one.brep.vertices[0] - Point3::new(0.009, 0.0, 0.0)).norm() < 1e-17);
        assert_eq!(one.solids[0].instance, 7);
    }
    assert_eq!(pick(Some("whole"), Some(0)).unwrap().brep.faces.len(), 1000);
    let message = |result: Result<ImportedPart, StepError>| result.unwrap_err().to_string();
    assert_eq!(
        message(pick(Some("disk"), None)),
        "no part is called \"disk\"; there are: disc, whole"
    );
    assert_eq!(
        message(pick(Some("disc"), Some(1000))),
        "no place 1000 (from 0); the part has 1000 of them"
    );
}

#[test]
fn assemblies_that_explode_or_contain_themselves_are_refused() {
    // Each level has the one below twice: 2⁴⁰ discs.
    let mut text = assembly(900);
    let (mut below, mut representation) = (1000, 14);
    for level in 0..40 {
        let base = 10_000 + 100 * level;
        text += &product(base, &format!("level {level}"), base + 50);
        text += &format!("#{}=SHAPE_REPRESENTATION('',(#21),#900);", base + 50);
        for twice in [60, 70] {
            let ends = [representation, base + 50];
            text += &usage(base + twice, [base, below], ends, [21, 21]);
        }
        (below, representation) = (base, base + 50);
    }
    let error = read_text(&text).unwrap_err();
    assert!(matches!(error, StepError::TooMany { .. }), "{error}");
    let ring = assembly(900)
        + &usage(3000, [2000, 1000], [14, 50], [21, 51])
        + &usage(3100, [1000, 2000], [50, 14], [51, 21]);
    let error = read_text(&ring).unwrap_err();
    assert!(matches!(error, StepError::Cycle { .. }), "{error}");
}

#[test]
fn what_shares_too_much_is_refused_in_time() {
    let mut text = cube("");
    for k in 0..50_000 {
        text += &format!("#{}=MANIFOLD_SOLID_BREP('',#30);", 10_000 + k);
    }
    let error = read_text(&text).err();
    assert!(
        matches!(error, Some(StepError::TooOften { .. })),
        "{error:?}"
    );
}

#[test]
fn what_is_wrong_is_named_with_its_number() {
    let disc = within_circle(0.0, "PLANE('',#21)");
    let message = |from: &str, to: &str| {
        assert!(disc.contains(from), "{from}");
        read_text(&disc.replace(from, to)).unwrap_err().to_string()
    };
    for (from, to, wanted) in [
        (
            "SI_UNIT(.MILLI.,.METRE.)",
            "SI_UNIT($,.SECOND.)",
            "#900: its context names no unit of length",
        ),
        (
            "CIRCLE('',#4,2.)",
            "CIRCLE('',#4,-2.)",
            "#5: the radius of CIRCLE is -2.0; it should be a length above 0",
        ),
        (
            "CIRCLE('',#4,2.)",
            "CLOTHOID('',#4,2.)",
            "#5: CLOTHOID is not read: convert it to a B-spline",
        ),
        (
            "PLANE('',#21)",
            "SPHERICAL_SURFACE('',#21,0.)",
            "#10: the radius of SPHERICAL_SURFACE is 0.0;",
        ),
        (
            "PLANE('',#21)",
            "OFFSET_SURFACE('',#26,-2.,.F.);#26=SPHERICAL_SURFACE('',#21,2.)",
            "#26: SPHERICAL_SURFACE is not read: it is offset inwards by its radius",
        ),
        (
            "PLANE('',#21)",
            "PLANE('',#99)",
            "#10 refers to #99, which the file does not define",
        ),
        (
            "PLANE('',#21)",
            "DEGENERATE_TOROIDAL_SURFACE('',#21,1.,2.,.F.)",
            "#10: DEGENERATE_TOROIDAL_SURFACE is not read: the inner part",
        ),
        (
            "#21=AXIS2_PLACEMENT_3D('',#20,$,$)",
            "#21=AXIS2_PLACEMENT_3D('',#20,#26,$);#26=DIRECTION('',(0.,0.,0.))",
            "#26: DIRECTION should be three numbers that are not all 0, but is (0, 0, 0)",
        ),
        (
            "(2.,0.,0.0)",
            "(2.E300,0.,0.0)",
            "#1: a coordinate (m) of CARTESIAN_POINT is",
        ),
        (
            "#12=OPEN_SHELL('',(#11))",
            "#12=OPEN_SHELL('',())",
            "no solid or sheet with faces among",
        ),
        (
            "#11=ADVANCED_FACE('',(#9),#10,.T.)",
            "#11=ADVANCED_FACE('',(#9),#10,.U.)",
            "#11: attribute 4 of ADVANCED_FACE should be .T. or .F., but is .U.",
        ),
    ] {
        let message = message(from, to);
        assert!(message.starts_with(wanted), "{message}");
    }
    let open = cube("#31=FACETED_BREP('',#30);")
        + "#201=VERTEX_POINT('',#1);#202=VERTEX_POINT('',#2);\
        #203=DIRECTION('',(1.,0.,0.));#204=VECTOR('',#203,1.);#205=LINE('',#1,#204);#206=EDGE_CURVE('',#201,#202,#205,.T.);\
        #207=ORIENTED_EDGE('',*,*,#206,.T.);#208=EDGE_LOOP('',(#207));";
    let message = read_text(&open.replace("'',#100,.T.", "'',#208,.T."))
        .unwrap_err()
        .to_string();
    assert!(
        message.starts_with("#208: the loop is open by 1.000e-3 m behind edge #206"),
        "{message}"
    );
}

#[test]
fn faces_that_cannot_be_read_are_left_out_if_wanted_and_counted() {
    let bad = cube("#31=FACETED_BREP('',#30);")
        .replace("#104=PLANE('',#103)", "#104=BLOB_SURFACE('',#103)");
    assert!(matches!(
        read_text(&bad),
        Err(StepError::Unreadable { id: 104, .. })
    ));
    let pick = PartPick {
        partial: true,
        ..PartPick::default()
    };
    let text = bad
        + "#400=GEOMETRIC_CURVE_SET('',());#401=STYLED_ITEM('',(),#30);#402=TESSELLATED_SOLID('',());\
        #403=DOCUMENT_FILE('wing.stp','','',$,'','');";
    let read = read_part(file(&text).as_bytes(), &pick).unwrap();
    assert_eq!((read.brep.faces.len(), read.brep.edges.len()), (5, 12));
    assert_eq!(read.brep.shells[0].faces, [0, 1, 2, 3, 4]);
    assert_eq!(
        read.left_out.to_string(),
        "1 faces (1 at BLOB_SURFACE); 1 wireframes; 1 tessellated items; parts in other files: wing.stp"
    );
    assert!(read.notes.iter().any(|note| note.contains("1 colours")));
    // All its edges are gone with a face that stands alone.
    let lone = within_circle(0.0, "BLOB_SURFACE('',#21)");
    let error = read_part(file(&lone).as_bytes(), &pick)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("left out: 1 faces (1 at BLOB_SURFACE)"),
        "{error}"
    );
}

// Vertices of one loop that are apart by less than the file's uncertainty are one.
#[test]
fn a_loop_may_be_open_by_rounding() {
    let line = |k: u64, from: u64, to: u64, d: &str| {
        format!(
            "#{}=EDGE_CURVE('',#{from},#{to},#{},.T.);#{}=LINE('',#20,#{});#{}=VECTOR('',#{},1.);#{}=DIRECTION('',{d});\
             #{}=ORIENTED_EDGE('',*,*,#{},.T.);",
            k,
            k + 1,
            k + 1,
            k + 2,
            k + 2,
            k + 3,
            k + 3,
            k + 4,
            k
        )
    };
    let corners = "#70=CARTESIAN_POINT('',(3.,0.,0.));#71=VERTEX_POINT('',#70);#72=CARTESIAN_POINT('',(0.,3.,0.));\
        #73=VERTEX_POINT('',#72);#74=VERTEX_POINT('',#20);#75=CARTESIAN_POINT('',(3.,0.009,0.));#76=VERTEX_POINT('',#75);";
    let text = within_circle(0.0, "PLANE('',#21)")
        .replace("EDGE_LOOP('',(#7))", "EDGE_LOOP('',(#84,#94,#104))")
        + corners
        + &line(80, 74, 71, "(1.,0.,0.)")
        + &line(90, 76, 73, "(-1.,1.,0.)")
        + &line(100, 73, 74, "(0.,-1.,0.)");
    let read = read_text(&text).unwrap();
    assert_eq!((read.brep.vertices.len(), read.left_out.welded), (3, 1));
    assert_eq!(read.brep.edges[0].ends[1], read.brep.edges[1].ends[0]);
}

#[test]
fn parts_cut_short_or_changed_are_refused_or_read_but_never_more() {
    let mirrored = "#60=MAPPED_ITEM('',#61,#62);#61=REPRESENTATION_MAP(#21,#14);#63=DIRECTION('',(0.,-1.,0.));\
        #62=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#23,#63,#52,3.,#22);";
    let swept = "SURFACE_OF_REVOLUTION('',#30,#25);#30=ELLIPSE('',#31,3.,1.5);#31=AXIS2_PLACEMENT_3D('',#20,#24,#23)";
    let texts = [
        assembly(910) + &usage(3000, [2000, 1000], [14, 50], [21, 51]) + mirrored,
        cube("#31=BREP_WITH_VOIDS('',#30,(#32));#32=ORIENTED_CLOSED_SHELL('',*,#30,.F.);"),
        within_circle(1.0, swept),
        within_circle(1.0, "CONICAL_SURFACE('',#21,1.,0.7853981633974483)"),
    ];
    for (seed, text) in texts.iter().enumerate() {
        let text = file(text);
        let read = |partial: bool, bytes: &[u8]| {
            read_part(
                bytes,
                &PartPick {
                    partial,
                    ..PartPick::default()
                },
            )
            .is_ok()
        };
        assert!(read(false, text.as_bytes()));
        every_prefix(text.as_bytes(), text.trim_end().len(), |bytes| {
            read(false, bytes)
        });
        for partial in [false, true] {
            mutations(text.as_bytes(), seed as u64, |bytes| {
                read(partial, bytes);
            });
        }
    }
}
