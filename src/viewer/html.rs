//! A recording as one page that opens from disk: bundle and data in one file.

use super::files::bundle;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use palpate_proto::codec::encode;
use palpate_record::{Session, thinned};
use palpate_sim::scene::Scene;
use palpate_wire::{first_snapshot, tool_outlines};
use sha2::Digest as _;

/// Why no page could be made.
#[derive(Debug, thiserror::Error)]
pub enum HtmlError {
    /// The recording.
    #[error(transparent)]
    Recording(#[from] palpate_record::RecoverError),
    /// The page of this build cannot take data.
    #[error(
        "the page of this build has no {missing:?}: its bundle was not made by clients/web; build it with \
         `npm run build --prefix clients/web`"
    )]
    Bundle {
        /// What was looked for.
        missing: &'static str,
    },
}

const STYLE: &str = "<link rel=\"stylesheet\" href=\"app.css\">";
const SCRIPT: &str = "<script src=\"app.js\" defer></script>";

/// The page, and one tick in how many it has (1: all of them). `most`: bytes of the recording.
///
/// # Errors
/// A recording that cannot be read, or a build without a proper page.
pub fn html_page(
    session: &Session,
    scene: &Scene,
    name: &str,
    most: u64,
) -> Result<(String, u64), HtmlError> {
    let [page, style, script] = bundle();
    let part = thinned(session, scene, most)?;
    let hash = sha2::Sha256::digest(session.header.scene_text.as_bytes()).into();
    let snapshot = encode(&first_snapshot(scene, hash));
    let data = [
        data_element(
            "palpate-recording",
            &format!(" data-name=\"{}\"", attribute(name)),
            &BASE64_STANDARD.encode(&part.bytes),
        ),
        data_element("palpate-scene", "", &BASE64_STANDARD.encode(snapshot)),
        format!(
            "<script id=\"palpate-tools\" type=\"application/json\">{}</script>\n",
            // An id cannot hold this; it would end the element.
            tool_outlines(scene).replace("</", "<\\/")
        ),
    ]
    .concat();
    let around = |page: &'static str, mark: &'static str| {
        page.split_once(mark)
            .ok_or(HtmlError::Bundle { missing: mark })
    };
    let (before, rest) = around(page, STYLE)?;
    let (between, after) = around(rest, SCRIPT)?;
    // A deferred script that is inline is not deferred: it stands last.
    let (content, end) = match after.rsplit_once("</body>") {
        Some((content, end)) => (content, end),
        None => (after, ""),
    };
    let whole = [
        before,
        "<style>",
        style,
        "</style>",
        between,
        content,
        &data,
        "<script>",
        script,
        "</script>\n</body>",
        end,
    ];
    Ok((whole.concat(), part.every))
}

fn data_element(id: &str, more: &str, base64: &str) -> String {
    format!("<script id=\"{id}\" type=\"application/octet-stream\"{more}>{base64}</script>\n")
}

fn attribute(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('"', "&quot;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
