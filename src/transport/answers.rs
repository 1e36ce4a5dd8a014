//! How queries are answered.

use super::post::Asked;
use palpate_client::encoding;
use palpate_proto::codec::encode;
use palpate_proto::messages::Message;
use palpate_proto::rpc::Answer;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;

/// Answers with a message, under the key of the query.
pub(super) fn reply<M: Message>(asked: &Asked, message: &M) {
    asked.answer(key_of(asked), encode(message), encoding::<M>());
}

/// Answers under a key with JSON.
pub(super) fn reply_json(asked: &Asked, key: KeyExpr<'static>, value: &impl serde::Serialize) {
    let text = serde_json::to_vec(value).unwrap_or_default();
    asked.answer(key, text, Encoding::APPLICATION_JSON);
}

/// Answers with text of a kind, under the key of the query.
pub(super) fn reply_text(asked: &Asked, text: String, encoding: Encoding) {
    asked.answer(key_of(asked), text.into_bytes(), encoding);
}

/// Answers a command.
pub(super) fn reply_to_call(asked: &Asked, answer: &Answer) {
    reply_json(asked, key_of(asked), answer);
}

/// Answers with an error: JSON like that of a refused command.
pub(super) fn reply_refused(asked: &Asked, reason: &str) {
    asked.refuse(serde_json::to_string(&Answer::<()>::refused(reason)).unwrap_or_default());
}

/// The key of a query.
pub(super) fn key_of(asked: &Asked) -> KeyExpr<'static> {
    asked.key_expr().clone().into_owned()
}
