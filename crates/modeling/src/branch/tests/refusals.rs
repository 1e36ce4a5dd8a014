//! What is refused, by which rule and where.

use super::*;

fn refused(change: impl Fn(&mut Tree)) -> BranchError {
    let mut tree = trees()[3].1.clone();
    change(&mut tree);
    grow(&tree).unwrap_err()
}

fn rule_of(error: &BranchError) -> Option<(Rule, &str)> {
    match error {
        BranchError::Rule { rule, place, .. } => Some((*rule, place)),
        _ => None,
    }
}

fn fork(tree: &mut Tree) -> &mut Fork {
    tree.stem.fork.as_mut().unwrap()
}

fn upper(tree: &mut Tree) -> &mut Fork {
    fork(tree).left.fork.as_mut().unwrap()
}

#[test]
fn trees_that_break_a_rule_are_refused_by_its_name_and_place() {
    type Change = fn(&mut Tree);
    let cases: [(Rule, &str, Change); 14] = [
        (Rule::R1, "R", |t| fork(t).right.front = vec![0.1]),
        (Rule::R1, "L", |t| fork(t).left.front[1] = 0.45),
        (Rule::R1, "LR", |t| {
            upper(t).right.end.outline = Some(vec![[0.0; 2]; 7])
        }),
        (Rule::R1, "LL", |t| {
            let mut outline = section::rectangle(3, 0.0, 0.1);
            outline[1][1] += 0.05;
            upper(t).left.end.outline = Some(outline);
        }),
        (Rule::R2, "the fork of stem", |t| fork(t).arch_m = 0.0),
        (Rule::R2, "the fork of L", |t| upper(t).arch_m = 0.0),
        (Rule::R2, "LR", |t| upper(t).right.shift_m = 0.0),
        (Rule::R3, "the fork of stem", |t| fork(t).raise = 0.0),
        (Rule::R3, "L", |t| {
            fork(t).left.end.outline = Some(section::rectangle(3, 0.0, 0.1))
        }),
        (Rule::R4, "L", |t| t.stem.neighbour_m = 0.05),
        (Rule::R4, "LL", |t| upper(t).left.shift_m = 0.2),
        (Rule::R4, "the fork of stem", |t| fork(t).raise = 1.3),
        (Rule::R4, "the fork of L", |t| upper(t).neighbour_m = 0.5),
        (Rule::R4, "stem", |t| t.stem.neighbour_m = 1.0),
    ];
    for (rule, place, change) in cases {
        let error = refused(change);
        assert_eq!(rule_of(&error), Some((rule, place)), "{error}");
    }
    let message = refused(|t| t.stem.neighbour_m = 0.05).to_string();
    assert_eq!(
        message,
        "rule R4 (no fold: neighbours of a joint no closer than the rows) is broken at L: e = 0.05 m below the fork is \
         less than delta = shift_m = 0.12 m; make shift_m at most 0.05"
    );
}

#[test]
fn numbers_out_of_range_are_named() {
    type Change = fn(&mut Tree);
    let cases: [(&str, Change); 12] = [
        ("degree_u", |t| t.degree_u = 1),
        ("degree_v", |t| t.degree_v = 16),
        ("half_width_m", |t| t.stem.half_width_m = f64::NAN),
        ("half_depth_m", |t| t.stem.half_depth_m = -1.0),
        ("arch_m", |t| fork(t).arch_m = f64::INFINITY),
        ("raise", |t| fork(t).raise = -0.5),
        ("shift_m", |t| fork(t).left.shift_m = -0.1),
        ("outer_m", |t| fork(t).left.outer_m[1] = f64::NAN),
        ("distance of outer_m and inner_m", |t| {
            fork(t).left.outer_m = fork(t).left.inner_m
        }),
        ("free_rows", |t| fork(t).right.free_rows = 0),
        ("turn_deg", |t| fork(t).right.turn_deg = f64::NEG_INFINITY),
        ("end.half_depth_m", |t| fork(t).right.end.half_depth_m = 0.0),
    ];
    for (name, change) in cases {
        match refused(change) {
            BranchError::Value { field, .. } => assert_eq!(field, name),
            other => panic!("{name}: {other}"),
        }
    }
    assert!(matches!(
        refused(|t| t.stem.free_rows = usize::MAX),
        BranchError::TooLarge { .. }
    ));
}

#[test]
fn unknown_fields_of_a_tree_are_refused() {
    let text = include_str!("../data/y.toml").replace("arch_m", "arc_m");
    let message = toml::from_str::<Tree>(&text).unwrap_err().to_string();
    assert!(message.contains("unknown field `arc_m`"), "{message}");
}

#[test]
fn surfaces_that_are_no_branching_net_say_why() {
    let y = grow(&trees()[0].1).unwrap().surface;
    let recovered = |u: KnotVector, v: KnotVector, keep: &dyn Fn(usize, usize) -> bool| {
        let mut points = Vec::new();
        for i in 0..y.net().rows() {
            points.extend(
                (0..y.net().columns())
                    .filter(|&j| keep(i, j))
                    .map(|j| *y.net().at(i, j)),
            );
        }
        let net = ControlNet::new(u.count(), v.count(), points).unwrap();
        PatchTable::recovered(&Surface::new(u, v, net, None).unwrap()).unwrap_err()
    };
    // R5: the fork's knot once less, and one of the two equal rows left out.
    let v = y.knots_v().without(6.0).unwrap();
    let error = recovered(y.knots_u().clone(), v, &|_, j| j != 8);
    assert_eq!(
        rule_of(&error),
        Some((Rule::R5, "the knot v = 6")),
        "{error}"
    );
    let u = y.knots_u().without(12.0).unwrap();
    let error = recovered(u, y.knots_v().clone(), &|i, _| i != 17);
    assert!(
        error.to_string().contains("u = 12 has not multiplicity 4"),
        "{error}"
    );
    let sheet = palpate_geometry::surface::builtin("sheet", None, None).unwrap();
    let error = PatchTable::recovered(&sheet).unwrap_err().to_string();
    assert!(
        error.contains("u has 1 arcs, not two for each leaf"),
        "{error}"
    );
    let torus = palpate_geometry::surface::builtin("torus", None, None).unwrap();
    assert!(
        PatchTable::recovered(&torus)
            .unwrap_err()
            .to_string()
            .contains("not clamped")
    );
    let sphere = palpate_geometry::surface::builtin("sphere", None, None).unwrap();
    assert!(
        PatchTable::recovered(&sphere)
            .unwrap_err()
            .to_string()
            .contains("rational")
    );
    // What is too large to be measured is no surface.
    let huge = y.affine(
        &(palpate_geometry::math::Matrix3::identity() * 1e150),
        &palpate_geometry::math::Vector3::zeros(),
    );
    assert!(huge.is_err());
}

// Every number of a tree replaced in turn by what no one means: an error, or a surface that is
// finite and measured.
#[test]
fn no_number_makes_a_tree_panic_or_a_measure_lie() {
    let plain = toml::Value::try_from(&trees()[0].1).unwrap();
    let strange = [
        0.0,
        -1.0,
        1e-40,
        1e-20,
        1e20,
        1e40,
        f64::MAX,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ];
    let mut places = Vec::new();
    floats(&plain, &mut Vec::new(), &mut places);
    assert!(places.len() > 35, "{} numbers", places.len());
    let (mut refused, mut made) = (0, 0);
    for (k, place) in places.iter().enumerate() {
        for value in strange {
            let mut changed = plain.clone();
            *at(&mut changed, place) = toml::Value::Float(value);
            let tree: Tree = changed.try_into().unwrap();
            match grow(&tree) {
                Err(_) => refused += 1,
                Ok(grown) => {
                    made += 1;
                    assert!(
                        grown
                            .surface
                            .net()
                            .points()
                            .iter()
                            .all(|p| p.coords.iter().all(|x| x.is_finite()))
                    );
                    // Measuring takes its time: a few of each kind.
                    if (k + made) % 7 == 0 {
                        let (m, _) = Measures::of(&grown.surface, &grown.patches);
                        assert!(
                            m.angle_deg.is_finite()
                                && m.gap_m.is_finite()
                                && m.coverage.is_finite(),
                            "{place:?}"
                        );
                    }
                }
            }
        }
    }
    assert!(
        refused > made && made > 20,
        "{refused} refused, {made} made"
    );
}

/// Ways to all floating-point numbers of a document.
fn floats(value: &toml::Value, way: &mut Vec<String>, out: &mut Vec<Vec<String>>) {
    let mut go = |key: String, value: &toml::Value| {
        way.push(key);
        floats(value, way, out);
        way.pop();
    };
    match value {
        toml::Value::Table(table) => table.iter().for_each(|(key, value)| go(key.clone(), value)),
        toml::Value::Array(array) => array
            .iter()
            .enumerate()
            .for_each(|(k, value)| go(k.to_string(), value)),
        toml::Value::Float(_) => out.push(way.clone()),
        _ => {}
    }
}

fn at<'a>(value: &'a mut toml::Value, way: &[String]) -> &'a mut toml::Value {
    way.iter().fold(value, |value, key| match value {
        toml::Value::Array(array) => &mut array[key.parse::<usize>().unwrap()],
        table => table.get_mut(key.as_str()).unwrap(),
    })
}
