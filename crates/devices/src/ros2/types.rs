//! Types by name, with the hash that stands in their keys and the text that bags carry.

/// A type of ROS 2.
#[derive(Debug, PartialEq, Eq)]
pub struct RosType {
    /// `geometry_msgs/msg/PoseStamped`.
    pub name: &'static str,
    /// `RIHS01_` and SHA-256 of its description (REP 2016). The same from Iron on.
    pub hash: &'static str,
    /// Its fields, as in its `.msg` file without comments and constants that we do not use.
    pub text: &'static str,
}

impl RosType {
    /// `geometry_msgs::msg::dds_::PoseStamped_`.
    pub fn dds_name(&self) -> String {
        let parts: Vec<&str> = self.name.split('/').collect();
        match parts[..] {
            [package, kind, name] => format!("{package}::{kind}::dds_::{name}_"),
            _ => self.name.to_owned(),
        }
    }
}

macro_rules! types {
    ($($constant:ident = $name:literal, $hash:literal, $text:literal;)*) => {
        $(pub(super) static $constant: RosType = RosType {
            name: $name,
            hash: concat!("RIHS01_", $hash),
            text: $text,
        };)*

        /// All types that are spoken.
        pub static TYPES: &[&RosType] = &[$(&$constant),*];
    };
}

types! {
    POSE_STAMPED = "geometry_msgs/msg/PoseStamped",
        "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
        "std_msgs/Header header\ngeometry_msgs/Pose pose\n";
    TWIST_STAMPED = "geometry_msgs/msg/TwistStamped",
        "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
        "std_msgs/Header header\ngeometry_msgs/Twist twist\n";
    WRENCH_STAMPED = "geometry_msgs/msg/WrenchStamped",
        "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77",
        "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n";
    WRENCH = "geometry_msgs/msg/Wrench",
        "018e8519d57c16adbe97c9fe1460ef21fec7e31bc541de3d653a35895677ce52",
        "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n";
    VECTOR3_STAMPED = "geometry_msgs/msg/Vector3Stamped",
        "d4829622288cbb443886e7ea94ea5671a3b1be6bab4ad04224432a65f7d7887a",
        "std_msgs/Header header\ngeometry_msgs/Vector3 vector\n";
    JOY = "sensor_msgs/msg/Joy",
        "0d356c79cad3401e35ffeb75a96a96e08be3ef896b8b83841d73e890989372c5",
        "std_msgs/Header header\nfloat32[] axes\nint32[] buttons\n";
    OPERATING_STATE = "crtk_msgs/msg/OperatingState",
        "5cc57eea589b217fe5194bf2735b91d4a7f2dd5ac1245ae657f7ea7590c2c80e",
        "std_msgs/Header header\nstring state\nbool is_homed\nbool is_busy\n";
    STRING_STAMPED = "crtk_msgs/msg/StringStamped",
        "83efb802e6596e03f69ac322e3231037329946f2bd13ed48874d97f5b8f5db1d",
        "std_msgs/Header header\nstring string\n";
    FLOAT64_MULTI_ARRAY = "std_msgs/msg/Float64MultiArray",
        "1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f",
        "std_msgs/MultiArrayLayout layout\nfloat64[] data\n";
    BOOL = "std_msgs/msg/Bool",
        "feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9",
        "bool data\n";
    EMPTY = "std_msgs/msg/Empty",
        "20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312",
        "";
    OMNI_FEEDBACK = "omni_msgs/msg/OmniFeedback",
        "ba84a6b698946ddb497c4d4b2062955836546f699b10724f3357b0a82c41dfff",
        "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 position\n";
    OMNI_BUTTON_EVENT = "omni_msgs/msg/OmniButtonEvent",
        "3d8e3c256b4d68ef6679f98b28e039d4dc1a01fe243d8b286137c73157937d78",
        "int32 grey_button\nint32 white_button\n";
    MARKER_ARRAY = "visualization_msgs/msg/MarkerArray",
        "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf",
        "visualization_msgs/Marker[] markers\n";
    TRIGGER = "std_srvs/srv/Trigger",
        "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f",
        "---\nbool success\nstring message\n";
}

/// Types that only occur inside others.
pub(super) static PARTS: &[(&str, &str)] = &[
    (
        "std_msgs/Header",
        "builtin_interfaces/Time stamp\nstring frame_id\n",
    ),
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
    (
        "geometry_msgs/Pose",
        "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n",
    ),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    (
        "geometry_msgs/Quaternion",
        "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    ),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    (
        "geometry_msgs/Twist",
        "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n",
    ),
    (
        "geometry_msgs/Wrench",
        "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n",
    ),
    (
        "std_msgs/ColorRGBA",
        "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n",
    ),
    (
        "std_msgs/MultiArrayLayout",
        "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n",
    ),
    (
        "std_msgs/MultiArrayDimension",
        "string label\nuint32 size\nuint32 stride\n",
    ),
    (
        "sensor_msgs/CompressedImage",
        "std_msgs/Header header\nstring format\nuint8[] data\n",
    ),
    ("visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"),
    (
        "visualization_msgs/MeshFile",
        "string filename\nuint8[] data\n",
    ),
    (
        "visualization_msgs/Marker",
        "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\nint32 LINE_LIST=5\n\
         int32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\nint32 TEXT_VIEW_FACING=9\n\
         int32 MESH_RESOURCE=10\nint32 TRIANGLE_LIST=11\nint32 ARROW_STRIP=12\nint32 ADD=0\nint32 MODIFY=0\n\
         int32 DELETE=2\nint32 DELETEALL=3\n\
         std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n\
         geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n\
         builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n\
         std_msgs/ColorRGBA[] colors\nstring texture_resource\nsensor_msgs/CompressedImage texture\n\
         visualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n\
         visualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n",
    ),
];
