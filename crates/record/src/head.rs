//! What stands at the start of every file of a session.

use super::format::WriteError;
use super::message::wall_ns;
use super::{FORMAT_VERSION, build_id};
use palpate_proto::codec::encode;
use palpate_sim::scene::Scene;
use palpate_sim::scene::spec::{Clock, SceneSpec};
use palpate_wire::{first_snapshot, tool_outlines};
use sha2::Digest as _;
use std::collections::BTreeMap;

/// What a net message says of its body.
#[derive(Clone, Debug)]
pub(super) struct BodyHead {
    /// Id of the body in the scene.
    pub id: String,
    /// Degree, u then v.
    pub degree: [usize; 2],
    /// Net size, u then v.
    pub count: [usize; 2],
}

/// Head of a session.
#[derive(Clone, Debug)]
pub(super) struct Head {
    /// Scene name.
    pub scene: String,
    /// Scene file as the user wrote it.
    pub scene_text: String,
    /// Scene with defaults and surfaces written out: what a replay builds from.
    pub effective_scene: String,
    /// Length of a tick, ns.
    pub dt_ns: u64,
    /// Tools, by index.
    pub tools: Vec<String>,
    /// Bodies, by index.
    pub bodies: Vec<BodyHead>,
    /// More metadata.
    pub extra: BTreeMap<String, String>,
    /// What a page shows the recording with.
    pub shown: Shown,
}

/// What a page needs of the scene to show a recording without a server: it builds no scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    /// `SceneSnapshot` before the first tick.
    pub snapshot: Vec<u8>,
    /// Shapes of tools, JSON.
    pub tools: String,
}

/// A net of 400 × 400, or a hundred tools.
const MOST_SHOWN: usize = 8 << 20;

impl Shown {
    pub fn of(scene: &Scene, scene_text: &str) -> Self {
        let hash = sha2::Sha256::digest(scene_text.as_bytes()).into();
        let mut shown = Self {
            snapshot: encode(&first_snapshot(scene, hash)),
            tools: tool_outlines(scene),
        };
        // Every part of a recording has them: what is longer is asked of `palpate view` instead.
        if shown.snapshot.len() > MOST_SHOWN {
            shown.snapshot.clear();
        }
        if shown.tools.len() > MOST_SHOWN {
            shown.tools.clear();
        }
        shown
    }
}

impl Head {
    pub fn new(
        scene: &Scene,
        scene_text: &str,
        effective: &SceneSpec,
        bodies: Vec<BodyHead>,
    ) -> Result<Self, WriteError> {
        let clock = if scene.clock == Clock::Lockstep {
            "lockstep"
        } else {
            "realtime"
        };
        let seed_free = [
            ("clock", clock),
            (
                "float",
                "IEEE 754 binary64, round to nearest, subnormals kept",
            ),
        ];
        let mut extra: BTreeMap<String, String> = seed_free
            .iter()
            .map(|(key, value)| ((*key).to_owned(), (*value).to_owned()))
            .collect();
        extra.insert(
            "simd".into(),
            palpate_geometry::math::simd::path_name().into(),
        );
        extra.insert("rate_hz".into(), format!("{}", 1.0 / scene.dt_s));
        Ok(Self {
            scene: scene.name.clone(),
            scene_text: scene_text.to_owned(),
            effective_scene: toml::to_string(effective)
                .map_err(|e| WriteError::Scene(e.to_string()))?,
            dt_ns: (scene.dt_s * 1e9).round() as u64,
            tools: (0..scene.tool_count())
                .map(|tool| scene.tool_id(tool).to_owned())
                .collect(),
            bodies,
            extra,
            shown: Shown::of(scene, scene_text),
        })
    }

    /// The metadata record at the start of a file.
    pub fn metadata(&self) -> BTreeMap<String, String> {
        let mut run = BTreeMap::from([
            ("format".to_string(), FORMAT_VERSION.to_string()),
            ("build".to_string(), build_id()),
            ("target".to_string(), env!("PALPATE_TARGET").to_string()),
            ("rustc".to_string(), env!("PALPATE_RUSTC").to_string()),
            ("scene".to_string(), self.scene.clone()),
            ("scene_sha256".to_string(), sha256_hex(&self.scene_text)),
            ("dt_ns".to_string(), self.dt_ns.to_string()),
            ("tools".to_string(), self.tools.join(",")),
            (
                "bodies".to_string(),
                self.bodies
                    .iter()
                    .map(|body| body.id.as_str())
                    .collect::<Vec<_>>()
                    .join(","),
            ),
            ("started_unix_ns".to_string(), wall_ns().to_string()),
        ]);
        run.extend(self.extra.clone());
        run
    }
}

fn sha256_hex(text: &str) -> String {
    sha2::Sha256::digest(text.as_bytes())
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
