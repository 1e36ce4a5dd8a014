//! The messages that are spoken. Vectors and points are arrays; quaternions are x y z w.

use super::types;
use super::types::RosType;
use crate::cdr::{Cdr, CdrError, CdrReader, CdrWriter};

/// A message with a type of its own.
pub trait RosMessage: Cdr {
    /// Its type.
    const TYPE: &'static RosType;
}

macro_rules! fields {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$about])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $name {
            $($(#[$doc])* pub $field: $kind,)*
        }

        impl Cdr for $name {
            fn write(&self, out: &mut CdrWriter) {
                $(self.$field.write(out);)*
            }

            fn read(from: &mut CdrReader<'_>) -> Result<Self, CdrError> {
                Ok(Self { $($field: Cdr::read(from)?,)* })
            }
        }
    };
}

macro_rules! messages {
    ($($(#[$about:meta])* $name:ident = $ros_type:ident {
        $($(#[$doc:meta])* $field:ident: $kind:ty,)*
    })*) => {$(
        fields! { $(#[$about])* $name { $($(#[$doc])* $field: $kind,)* } }

        impl RosMessage for $name {
            const TYPE: &'static RosType = &types::$ros_type;
        }
    )*};
}

fields! {
    /// `builtin_interfaces/Time` and `Duration`.
    Stamp {
        /// s.
        sec: i32,
        /// ns within the second.
        nanosec: u32,
    }
}

impl Stamp {
    /// A time in ns; one that does not fit (after 2038) is cut off there.
    pub fn from_ns(ns: u64) -> Self {
        Self {
            sec: i32::try_from(ns / 1_000_000_000).unwrap_or(i32::MAX),
            nanosec: (ns % 1_000_000_000) as u32,
        }
    }

    /// In ns; negative times are 0.
    pub fn to_ns(&self) -> u64 {
        u64::try_from(self.sec).map_or(0, |sec| sec * 1_000_000_000 + u64::from(self.nanosec))
    }
}

fields! {
    /// `std_msgs/Header`.
    Header {
        /// When. For CRTK, 0 means that the message is not valid.
        stamp: Stamp,
        /// In which frame.
        frame_id: String,
    }
}

impl Header {
    /// A time in ns and a frame.
    pub fn new(ns: u64, frame: &str) -> Self {
        Self {
            stamp: Stamp::from_ns(ns),
            frame_id: frame.to_owned(),
        }
    }
}

fields! {
    /// `std_msgs/MultiArrayDimension`.
    Dimension {
        /// Name.
        label: String,
        /// Count.
        size: u32,
        /// Distance.
        stride: u32,
    }
}

fields! {
    /// `visualization_msgs/Marker`.
    Marker {
        /// Time and frame.
        header: Header,
        /// Namespace; with the id it names a marker.
        ns: String,
        /// Number within the namespace.
        id: i32,
        /// 5: list of lines, 6: list of cubes, 7: list of spheres, 11: list of triangles.
        shape: i32,
        /// 0: add or modify, 2: delete, 3: delete all.
        action: i32,
        /// m.
        position: [f64; 3],
        /// x y z w.
        orientation: [f64; 4],
        /// m; for lines the first is their width.
        scale: [f64; 3],
        /// Red, green, blue, opacity, 0 to 1.
        color: [f32; 4],
        /// Until it vanishes; 0: never.
        lifetime: Stamp,
        /// Moves with its frame.
        frame_locked: bool,
        /// m.
        points: Vec<[f64; 3]>,
        /// One a point, or none.
        colors: Vec<[f32; 4]>,
        /// Unused.
        texture_resource: String,
        /// Unused.
        texture_header: Header,
        /// Unused.
        texture_format: String,
        /// Unused.
        texture_data: Vec<u8>,
        /// Unused.
        uv_coordinates: Vec<[f32; 2]>,
        /// Unused.
        text: String,
        /// Unused.
        mesh_resource: String,
        /// Unused.
        mesh_filename: String,
        /// Unused.
        mesh_data: Vec<u8>,
        /// Unused.
        mesh_use_embedded_materials: bool,
    }
}

messages! {
    /// A pose.
    PoseStamped = POSE_STAMPED {
        /// Time and frame.
        header: Header,
        /// m.
        position: [f64; 3],
        /// Unit quaternion x y z w.
        orientation: [f64; 4],
    }
    /// A velocity.
    TwistStamped = TWIST_STAMPED {
        /// Time and frame.
        header: Header,
        /// m/s.
        linear: [f64; 3],
        /// rad/s.
        angular: [f64; 3],
    }
    /// A force and a torque with their time.
    WrenchStamped = WRENCH_STAMPED {
        /// Time and frame.
        header: Header,
        /// N.
        force: [f64; 3],
        /// N·m.
        torque: [f64; 3],
    }
    /// A force and a torque.
    Wrench = WRENCH {
        /// N.
        force: [f64; 3],
        /// N·m.
        torque: [f64; 3],
    }
    /// A vector with its time.
    Vector3Stamped = VECTOR3_STAMPED {
        /// Time and frame.
        header: Header,
        /// The vector.
        vector: [f64; 3],
    }
    /// Buttons.
    Joy = JOY {
        /// Time and frame.
        header: Header,
        /// -1 to 1.
        axes: Vec<f32>,
        /// 0 up, 1 down.
        buttons: Vec<i32>,
    }
    /// The state of a CRTK device.
    OperatingState = OPERATING_STATE {
        /// Time and frame.
        header: Header,
        /// DISABLED, ENABLED, PAUSED or FAULT.
        state: String,
        /// It was homed.
        is_homed: bool,
        /// It moves by itself.
        is_busy: bool,
    }
    /// A word for a CRTK device: enable, disable, pause, resume, home.
    StringStamped = STRING_STAMPED {
        /// Time and frame.
        header: Header,
        /// The word.
        string: String,
    }
    /// Numbers.
    Float64MultiArray = FLOAT64_MULTI_ARRAY {
        /// Layout; empty for a plain list.
        dim: Vec<Dimension>,
        /// Unused.
        data_offset: u32,
        /// The numbers.
        data: Vec<f64>,
    }
    /// A flag.
    Bool = BOOL {
        /// It.
        data: bool,
    }
    /// Nothing: CRTK's `free`.
    Empty = EMPTY {
        /// CDR has no structure without a member.
        structure_needs_at_least_one_member: u8,
    }
    /// A force for a Phantom, and where it acts.
    OmniFeedback = OMNI_FEEDBACK {
        /// N.
        force: [f64; 3],
        /// Where the device is held when it is locked.
        position: [f64; 3],
    }
    /// The buttons of a Phantom.
    OmniButtonEvent = OMNI_BUTTON_EVENT {
        /// 1 down.
        grey_button: i32,
        /// 1 down.
        white_button: i32,
    }
    /// Things to draw.
    MarkerArray = MARKER_ARRAY {
        /// Them.
        markers: Vec<Marker>,
    }
}

fields! {
    /// Answer of `std_srvs/srv/Trigger`, whose request is an [`Empty`].
    TriggerResponse {
        /// It was done.
        success: bool,
        /// Words about it.
        message: String,
    }
}

impl RosMessage for TriggerResponse {
    const TYPE: &'static RosType = &types::TRIGGER;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cdr::{decode, encode};

    fn hex(text: &str) -> Vec<u8> {
        let digits: Vec<char> = text.chars().filter(|c| !c.is_whitespace()).collect();
        let byte = |pair: &[char]| u8::from_str_radix(&pair.iter().collect::<String>(), 16);
        digits.chunks(2).map(|pair| byte(pair).unwrap()).collect()
    }

    fn header(frame: &str) -> Header {
        Header::new(1_000_000_002, frame)
    }

    const HEADER: &str = "00010000 01000000 02000000 06000000 776f726c6400 000000000000";

    #[test]
    fn a_pose_has_the_golden_bytes() {
        let pose = PoseStamped {
            header: header("world"),
            position: [0.125, -0.25, 0.03],
            orientation: [0.0, 0.6, 0.0, 0.8],
        };
        let golden = hex(&format!(
            "{HEADER} 000000000000c03f 000000000000d0bf b81e85eb51b89e3f
             0000000000000000 333333333333e33f 0000000000000000 9a9999999999e93f"
        ));
        assert_eq!(golden.len(), 84);
        assert_eq!(encode(&pose), golden);
        assert_eq!(decode::<PoseStamped>(&golden), Ok(pose));
    }

    #[test]
    fn a_wrench_has_the_golden_bytes_whatever_its_frame() {
        let wrench = |frame: &str| WrenchStamped {
            header: header(frame),
            force: [1.0, 2.0, 3.0],
            torque: [4.0, 5.0, 6.0],
        };
        let mut golden = hex(HEADER);
        for number in [1.0, 2.0, 3.0, 4.0, 5.0, 6.0_f64] {
            golden.extend(number.to_le_bytes());
        }
        assert_eq!(golden.len(), 76);
        assert_eq!(encode(&wrench("world")), golden);
        assert_eq!(decode::<WrenchStamped>(&golden), Ok(wrench("world")));
        for frame in ["", "map"] {
            assert_eq!(encode(&wrench(frame)).len(), 68, "{frame:?}");
        }
    }

    #[test]
    fn an_array_of_numbers_has_the_golden_bytes() {
        let golden = hex("00010000 00000000 00000000 03000000 00000000
             000000000000e03f 0000000000000000 000000000000f0bf");
        let array = Float64MultiArray {
            data: vec![0.5, 0.0, -1.0],
            ..Float64MultiArray::default()
        };
        assert_eq!(encode(&array), golden);
        assert_eq!(decode::<Float64MultiArray>(&golden), Ok(array));
    }

    #[test]
    fn a_big_endian_pose_is_read_and_a_truncated_one_is_not() {
        let mut bytes = vec![0, 0, 0, 0];
        bytes.extend(5_i32.to_be_bytes());
        bytes.extend(6_u32.to_be_bytes());
        // An empty frame of length 0: the numbers begin at a multiple of 8.
        bytes.extend([0; 4]);
        bytes.extend([0; 4]);
        for number in [0.1, 0.2, 0.3, 0.0, 0.0, 0.0, 1.0_f64] {
            bytes.extend(number.to_be_bytes());
        }
        let pose: PoseStamped = decode(&bytes).unwrap();
        assert_eq!(
            (pose.position, pose.header.stamp.to_ns()),
            ([0.1, 0.2, 0.3], 5_000_000_006)
        );
        for cut in 0..bytes.len() {
            let error = decode::<PoseStamped>(&bytes[..cut]).unwrap_err();
            assert!(
                matches!(error, CdrError::Truncated { .. }),
                "{cut}: {error}"
            );
        }
    }

    #[test]
    fn times_beyond_those_of_ros_are_cut_off() {
        assert_eq!(Stamp::from_ns(u64::MAX).sec, i32::MAX);
        let before = Stamp {
            sec: -1,
            nanosec: 5,
        };
        assert_eq!(before.to_ns(), 0);
    }
}
