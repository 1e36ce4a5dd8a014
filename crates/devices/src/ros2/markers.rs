//! Control nets as markers that RViz and other viewers draw.

use super::messages::{Header, Marker};

const LINE_LIST: i32 = 5;
/// Width of the lines of a net, as a part of the body's size.
const LINE_WIDTH: f64 = 0.002;

/// A control net that is to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NetLines<'a> {
    /// Number of the body in its scene.
    pub number: usize,
    /// Its id.
    pub body: &'a str,
    /// Points in u and v.
    pub count: [usize; 2],
    /// The last points are joined to the first ones, in u and v.
    pub periodic: [bool; 2],
    /// m, u-major.
    pub points: &'a [[f64; 3]],
}

impl NetLines<'_> {
    /// The lines between neighbours, closed where the net is periodic. Points that are not there are
    /// left out.
    pub fn marker(&self, time_ns: u64, frame: &str) -> Marker {
        let [nu, nv] = self.count;
        let at = |u: usize, v: usize| self.points.get(u % nu.max(1) * nv + v % nv.max(1)).copied();
        let mut points = Vec::new();
        let mut line = |from: Option<[f64; 3]>, to: Option<[f64; 3]>| {
            if let (Some(from), Some(to)) = (from, to) {
                points.extend([from, to]);
            }
        };
        for u in 0..nu {
            for v in 0..nv {
                if u + 1 < nu || self.periodic[0] {
                    line(at(u, v), at(u + 1, v));
                }
                if v + 1 < nv || self.periodic[1] {
                    line(at(u, v), at(u, v + 1));
                }
            }
        }
        let extent = |c: usize| {
            let values = || self.points.iter().map(|point| point[c]);
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        };
        let size = extent(0).max(extent(1)).max(extent(2)).max(0.0);
        Marker {
            header: Header::new(time_ns, frame),
            ns: self.body.to_owned(),
            id: i32::try_from(self.number).unwrap_or(i32::MAX),
            shape: LINE_LIST,
            orientation: [0.0, 0.0, 0.0, 1.0],
            scale: [LINE_WIDTH * size, 0.0, 0.0],
            color: [0.2, 0.6, 0.9, 1.0],
            points,
            ..Marker::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_net_has_a_line_between_neighbours_and_is_closed_where_periodic() {
        let points: Vec<[f64; 3]> = (0..20).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        let lines = |periodic| {
            let net = NetLines {
                number: 0,
                body: "sheet",
                count: [4, 5],
                periodic,
                points: &points,
            };
            net.marker(0, "world").points.len() / 2
        };
        assert_eq!(lines([false, false]), 3 * 5 + 4 * 4);
        assert_eq!(lines([true, false]), 4 * 5 + 4 * 4);
        assert_eq!(lines([true, true]), 4 * 5 + 4 * 5);
    }
}
